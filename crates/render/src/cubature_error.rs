//! The allowed error of cubature over lights.

/// Largest error of a rule, relative to the contribution of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubatureError(pub f64);
