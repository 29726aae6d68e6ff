//! Rays whose radiance no picture can hold.

use crate::first_hit::FirstHit;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// The largest value of a band, 2¹²⁷: what the pixels of Radiance's pictures hold, with room below
/// the end of single precision for filters.
pub(crate) const MOST: f64 = 1.701_411_834_604_692_3e38;

/// Counts rays whose radiance was not a number that pictures can hold, and keeps them in bounds.
#[derive(Debug, Default)]
pub struct Unbounded {
    count: AtomicU64,
    first: OnceLock<Option<FirstHit>>,
}

impl Unbounded {
    /// Brings values into ±2¹²⁷, with 0 for what is no number.
    #[inline]
    pub fn bound(&self, values: &mut [f64], first_hit: Option<&FirstHit>) {
        if !values.iter().all(|value| value.abs() <= MOST) {
            self.bring_back(values, first_hit);
        }
    }

    /// How many rays there were, and what one of the first met; `None` where there were none.
    pub(crate) fn met(&self) -> Option<(u64, Option<FirstHit>)> {
        self.first.get().map(|first| (self.count.load(Ordering::Relaxed), *first))
    }

    #[cold]
    fn bring_back(&self, values: &mut [f64], first_hit: Option<&FirstHit>) {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.first.get_or_init(|| first_hit.copied());
        for value in values {
            *value = if value.is_nan() { 0.0 } else { value.clamp(-MOST, MOST) };
        }
    }
}
