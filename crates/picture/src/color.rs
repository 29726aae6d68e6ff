//! Colour: primaries.

/// Chromaticities (x, y) of red, green, blue and white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RgbPrimaries {
    /// Red.
    pub red: [f32; 2],
    /// Green.
    pub green: [f32; 2],
    /// Blue.
    pub blue: [f32; 2],
    /// White.
    pub white: [f32; 2],
}

impl RgbPrimaries {
    /// In the order of a `PRIMARIES=` line: x and y of red, green, blue, white.
    #[must_use]
    pub fn from_array([rx, ry, gx, gy, bx, by, wx, wy]: [f32; 8]) -> Self {
        RgbPrimaries { red: [rx, ry], green: [gx, gy], blue: [bx, by], white: [wx, wy] }
    }
}
