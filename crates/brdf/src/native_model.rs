//! What a built-in model says of itself.

use crate::Brdf;
use std::sync::Arc;

/// A built-in model.
#[derive(Clone, Copy, Debug)]
pub struct NativeModel {
    /// Name in a scene.
    pub name: &'static str,
    /// Description in one line.
    pub summary: &'static str,
    /// Parameters in the order of a scene's numbers.
    pub parameters: &'static [Parameter],
    /// Makes the model from a number for each parameter, in their ranges. A colour has three
    /// numbers, of which the first `bands` (one or three) are used.
    pub make: fn(numbers: &[f64], bands: usize) -> Arc<dyn Brdf>,
}

/// A numeric parameter of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name, for messages and manuals.
    pub name: &'static str,
    /// Unit, such as "rad".
    pub unit: &'static str,
    /// Minimum and maximum.
    pub range: [f64; 2],
    /// Default; none if the parameter is required.
    pub default: Option<f64>,
    /// Description in one line.
    pub doc: &'static str,
}

impl Parameter {
    /// A parameter without a default.
    #[must_use]
    pub const fn required(name: &'static str, unit: &'static str, range: [f64; 2], doc: &'static str) -> Parameter {
        Parameter { name, unit, range, default: None, doc }
    }
}

/// The reflectance of a model, in three bands.
pub(crate) const REFLECTANCE: [Parameter; 3] = [
    Parameter::required("red", "1", [0.0, 1.0], "reflectance, red"),
    Parameter::required("green", "1", [0.0, 1.0], "reflectance, green"),
    Parameter::required("blue", "1", [0.0, 1.0], "reflectance, blue"),
];
