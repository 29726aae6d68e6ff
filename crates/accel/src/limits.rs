//! The part of a ray in which hits count.

use std::ops::Range;

/// A hit nearer than this share of the scene's largest coordinate is the surface that the ray starts from.
pub(crate) const SELF_HIT: f64 = 1e-10;

/// Which part of a ray counts, as distances along it.
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

    /// In the coordinates of something that is placed with this scale.
    pub(crate) fn seen_from(&self, scale: f64) -> Limits {
        Limits { nearest: self.nearest / scale, farthest: self.farthest / scale }
    }
}
