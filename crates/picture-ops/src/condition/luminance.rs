//! Adaptation luminance of pixels.

use crate::ToolError;
use radsight_picture::{Encoding, Header, RgbPrimaries, WHITE_EFFICACY};

/// Ratio of scotopic to photopic luminance of white, as in Radiance.
pub(super) const SCOTOPIC_WHITE: f64 = 2.26;

/// The weights of red, green and blue in scotopic luminance, for a white of 1.
pub(crate) const RODS: [f64; 3] = [0.062, 0.608, 0.330];

/// Computes the luminance of a picture's pixels.
#[derive(Clone, Debug)]
pub(crate) struct Luminance {
    /// The weights of red, green and blue in the luminance; `None` for X, Y and Z pixels.
    weights: Option<[f32; 3]>,
    /// The total exposure of the values.
    pub(crate) exposure: f64,
    /// The input's primaries.
    pub(crate) primaries: RgbPrimaries,
}

impl Luminance {
    pub(crate) fn new(header: &Header, encoding: Encoding) -> Result<Luminance, ToolError> {
        let primaries = header.primaries()?.unwrap_or(RgbPrimaries::STANDARD);
        let mut weights = None;
        if encoding != Encoding::Xyze {
            let to_xyz = primaries.rgb_to_xyz().ok_or(ToolError::Primaries)?;
            weights = Some(to_xyz.row(1).to_array().map(|weight| weight as f32));
        }
        Ok(Luminance { weights, exposure: header.exposure()?, primaries })
    }

    pub(crate) fn is_xyz(&self) -> bool {
        self.weights.is_none()
    }

    /// Luminance in cd/m² of a value of 1, before the exposure is undone.
    pub(crate) fn efficacy(&self) -> f64 {
        if self.is_xyz() { 1.0 } else { WHITE_EFFICACY }
    }

    /// The luminance in the scene, in cd/m².
    pub(super) fn of(&self, color: [f32; 3]) -> f64 {
        let stored = match self.weights {
            Some([red, green, blue]) => WHITE_EFFICACY * f64::from(color[0] * red + color[1] * green + color[2] * blue),
            None => f64::from(color[1]),
        };
        stored / self.exposure
    }

    /// The approximate scotopic luminance, in scotopic cd/m².
    pub(super) fn scotopic(&self, color: [f32; 3]) -> f64 {
        let [a, b, c] = color.map(f64::from);
        let stored = match self.weights {
            Some(_) => SCOTOPIC_WHITE * WHITE_EFFICACY * (a * RODS[0] + b * RODS[1] + c * RODS[2]),
            None if color[0] == 0.0 => 0.0,
            None => b * (1.33 * (1.0 + f64::from((color[1] + color[2]) / color[0])) - 1.68),
        };
        stored / self.exposure
    }
}
