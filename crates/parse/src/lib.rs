//! Reads Radiance scene text and lowers it to the scene.
#![forbid(unsafe_code)]

mod commands;
mod kind;
mod number_text;
mod placement;
pub mod syntax;
mod transform_words;
mod xform;

pub use kind::{Kind, Role};
pub use xform::xform;
