//! Counts of samples, for reports of progress.

use std::sync::atomic::{AtomicU64, Ordering};

/// Samples that threads have traced, and how many they will trace as far as is known.
///
/// ```
/// let counter = radsight_adaptive::SampleCounter::new(0, 8);
/// counter.plan(4);
/// assert_eq!(counter.add(8), [8, 12]);
/// // There are never more samples than planned ones.
/// assert_eq!(counter.add(6), [14, 14]);
/// ```
#[derive(Debug)]
pub struct SampleCounter {
    traced: AtomicU64,
    planned: AtomicU64,
}

impl SampleCounter {
    /// With this number of traced samples, and of samples planned in all.
    #[must_use]
    pub fn new(traced: u64, planned: u64) -> SampleCounter {
        SampleCounter { traced: AtomicU64::new(traced), planned: AtomicU64::new(planned) }
    }

    /// Announces additional samples that will be traced.
    pub fn plan(&self, samples: u64) {
        self.planned.fetch_add(samples, Ordering::Relaxed);
    }

    /// Counts traced samples. Returns the number of traced and of planned samples.
    pub fn add(&self, samples: u64) -> [u64; 2] {
        let traced = self.traced.fetch_add(samples, Ordering::Relaxed) + samples;
        [traced, self.planned.load(Ordering::Relaxed).max(traced)]
    }

    /// The number of traced samples.
    #[must_use]
    pub fn traced(&self) -> u64 {
        self.traced.load(Ordering::Relaxed)
    }
}
