//! The resolution of scattering data, and the least light that counts in them.

use std::f64::consts::PI;

/// Projected solid angles of the cells, within which directions are not distinguished, sr.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Smallest cell.
    pub least: f64,
    /// Largest cell.
    pub largest: f64,
}

impl Resolution {
    /// Resolution of two functions together.
    #[must_use]
    pub fn with(self, other: Resolution) -> Resolution {
        Resolution { least: self.least.min(other.least), largest: self.largest.max(other.largest) }
    }
}

/// Whether a Lambertian part is split off: above one per cent.
pub(crate) fn luminance_worth_splitting(luminance: f64) -> bool {
    luminance.is_finite() && luminance > 0.01 / PI
}

/// Scattering of a smaller total is not sampled.
pub(crate) const LEAST_TOTAL: f64 = 1e-6;

/// Whether the given direction is the incident one of the data, or the exit one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    Forward,
    Backward,
}
