//! Calls of compiled functions: what connects a modifier with the function language.

use crate::{DataGrid, Handle, PictureData, Transform};
use radsight_cal::Program;
use std::sync::Arc;

/// Compiled expressions with the frame in which they see the ray.
#[derive(Clone, Debug)]
pub struct FunctionCall {
    /// The roots, in the order that the primitive's documentation gives. Real arguments are folded in.
    pub program: Arc<Program>,
    /// From the function's coordinates to the scene's; the program sees the ray through its inverse.
    pub to_scene: Transform,
    /// The words as written, without a transform at their end, for writing back.
    pub words: Vec<String>,
    /// The numbers as written, for writing back.
    pub numbers: Vec<f64>,
}

/// A value from a grid: the coordinates come from a program, the value goes through a function.
///
/// Program roots: first the functions that take the values (one for brightness, three for colour), then one coordinate an axis.
#[derive(Clone, Debug)]
pub struct GridCall {
    /// Functions and coordinates.
    pub call: FunctionCall,
    /// One grid a band: one for brightness, three for colour.
    pub grids: Vec<Handle<DataGrid>>,
}

/// A colour from a picture.
///
/// Program roots: three functions of (red, green, blue), then the coordinates u and v.
#[derive(Clone, Debug)]
pub struct PictureCall {
    /// Functions and coordinates.
    pub call: FunctionCall,
    /// The picture.
    pub picture: Handle<PictureData>,
}
