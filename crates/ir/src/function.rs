//! Calls of compiled functions by modifiers.

use crate::{DataGrid, Handle, PictureData, Transform};
use radsight_cal::Program;
use std::sync::Arc;

/// A compiled program with its coordinate system.
#[derive(Clone, Debug)]
pub struct FunctionCall {
    /// Program with its roots in the order of the primitive's documentation; real arguments are
    /// folded in.
    pub program: Arc<Program>,
    /// Transform from the function's coordinates to the scene's; the program gets the ray through
    /// its inverse.
    pub to_scene: Transform,
    /// String arguments as written, without a final transform, for output.
    pub words: Vec<String>,
    /// Real arguments as written, for output.
    pub numbers: Vec<f64>,
}

/// A value from a grid: the program computes the coordinates, and a function of the value.
///
/// Program roots: first the functions of the values (one for brightness, three for colour), then
/// one coordinate per axis.
#[derive(Clone, Debug)]
pub struct GridCall {
    /// Functions and coordinates.
    pub call: FunctionCall,
    /// Grids: one for brightness, three for colour.
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
