//! Reads Radiance scene text and lowers it to the scene.
#![forbid(unsafe_code)]

mod bounds;
mod commands;
mod kind;
mod lower;
mod number_text;
mod placement;
mod signature;
pub mod syntax;
mod transform_words;
mod xform;

pub use bounds::{Bounds, Cube, bounds, cube};
pub use kind::{Kind, Role};
pub use lower::{BrdfReplacement, Input, Read, ReadOptions, Tolerance, UnusedModifiers, read_scene};
pub use xform::xform;
