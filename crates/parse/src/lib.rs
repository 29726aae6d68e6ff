//! Reads Radiance scene text and lowers it to the scene.
#![forbid(unsafe_code)]

mod kind;
pub mod syntax;

pub use kind::{Kind, Role};
