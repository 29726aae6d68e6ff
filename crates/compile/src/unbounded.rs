//! Rays whose radiance exceeds the range of pictures.

use crate::first_hit::FirstHit;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// Largest value of a band, 2¹²⁷: what pixels of Radiance pictures hold, with room below the limit
/// of single precision for filters.
pub(crate) const MOST: f64 = 1.701_411_834_604_692_3e38;

/// Counts rays whose radiance exceeds the range of pictures, and clamps it.
#[derive(Debug, Default)]
pub struct Unbounded {
    count: AtomicU64,
    first: OnceLock<Option<FirstHit>>,
}

impl Unbounded {
    /// Clamps values to ±2¹²⁷; not-a-number becomes 0.
    #[inline]
    pub fn bound(&self, values: &mut [f64], first_hit: Option<&FirstHit>) {
        if !values.iter().all(|value| value.abs() <= MOST) {
            self.clamp(values, first_hit);
        }
    }

    /// Number of such rays, and the first hit of one of the first; `None` if there were none.
    pub(crate) fn found(&self) -> Option<(u64, Option<FirstHit>)> {
        self.first.get().map(|first| (self.count.load(Ordering::Relaxed), *first))
    }

    #[cold]
    fn clamp(&self, values: &mut [f64], first_hit: Option<&FirstHit>) {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.first.get_or_init(|| first_hit.copied());
        for value in values {
            *value = if value.is_nan() { 0.0 } else { value.clamp(-MOST, MOST) };
        }
    }
}
