//! Caches as bytes: saved, restored, and put together from what several processes have found.

use crate::cache::{Cache, STRATA};
use crate::fit::Fit;
use crate::record::{Limits, Record};
use crate::stored::{Stored, StoredBytes};

impl<const BANDS: usize> Cache<BANDS> {
    /// Adds the cache to the end of some bytes.
    pub fn save(&self, bytes: &mut Vec<u8>) {
        let Limits { accuracy, least, most, explained } = self.limits;
        [accuracy, least, most, explained].store(bytes);
        (self.records.len() as u64).store(bytes);
        for ((record, fit), looks) in self.records.iter().zip(&self.fits).zip(&self.looks) {
            record.store(bytes);
            fit.store(bytes);
            looks.store(bytes);
        }
    }

    /// Reads a cache from the front of some bytes, for use within these limits. Where it was saved with the same ones it gives the same
    /// irradiance, bit for bit; else all of it is stale.
    ///
    /// `None` where the bytes are none that [`Cache::save`] makes.
    #[must_use]
    pub fn restored(bytes: &mut StoredBytes<'_>, limits: Limits) -> Option<Self> {
        let [accuracy, least, most, explained] = Stored::restore(bytes)?;
        let saved_limits = Limits { accuracy, least, most, explained };
        if !saved_limits.are_usable() {
            return None;
        }
        let mut saved = Cache::new(saved_limits);
        for _ in 0..u64::restore(bytes)? {
            let (record, fit) = (Record::restore(bytes)?, Fit::restore(bytes)?);
            let looks: [u8; STRATA] = Stored::restore(bytes)?;
            if !record.is_usable(&saved_limits) || !fit.is_usable() {
                return None;
            }
            saved.records.push(record);
            saved.fits.push(fit);
            saved.looks.push(looks);
            saved.is_stale.push(false);
        }
        saved.sort_in();
        if saved_limits == limits {
            return Some(saved);
        }
        let mut cache = Cache::new(limits);
        (0..saved.len()).for_each(|index| cache.insert_from(&saved, index));
        cache.sort_in();
        Some(cache)
    }

    /// Adds the records of another cache from this one on whose places none reaches yet, and says how many these were.
    pub fn take_over(&mut self, other: &Cache<BANDS>, first: usize) -> usize {
        let before = self.len();
        for (index, record) in other.records.iter().enumerate().skip(first) {
            if !self.reaches(record.position, record.normal) {
                self.insert_from(other, index);
            }
        }
        self.sort_in();
        self.len() - before
    }

    fn insert_from(&mut self, other: &Cache<BANDS>, index: usize) {
        let record = other.records[index].within(&self.limits);
        self.insert(record, 0);
        let last = self.looks.len() - 1;
        self.looks[last] = other.looks[index];
    }
}

impl Limits {
    /// Whether a cache can be made for them.
    fn are_usable(&self) -> bool {
        let Limits { accuracy, least, most, explained } = *self;
        [accuracy, least, most].iter().all(|limit| limit.is_finite() && *limit > 0.0) && explained.is_finite()
    }
}
