//! The interval of a ray in which hits count.

use std::ops::Range;

/// A hit nearer than this fraction of the scene's largest coordinate is the surface from which the
/// ray starts.
pub(crate) const SELF_HIT: f64 = 1e-10;

/// The interval of a ray, as distances along it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    pub(crate) nearest: f64,
    pub(crate) farthest: f64,
}

impl Limits {
    #[inline]
    pub(crate) fn range(&self) -> Range<f64> {
        self.nearest..self.farthest
    }

    /// The same interval in the coordinates of an instance with this scale.
    pub(crate) fn seen_from(&self, scale: f64) -> Limits {
        Limits { nearest: self.nearest / scale, farthest: self.farthest / scale }
    }
}
