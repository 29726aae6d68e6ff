//! Saves, restores and merges caches, as bytes.

use crate::cache::{Cache, STRATA};
use crate::fit::Fit;
use crate::obstacles::Occluders;
use crate::record::{Limits, Record};
use crate::stored::{Stored, StoredBytes};

impl<const BANDS: usize> Cache<BANDS> {
    /// Appends the cache to some bytes.
    pub fn save(&self, bytes: &mut Vec<u8>) {
        let Limits { accuracy, min_reach, max_reach, explained } = self.limits;
        [accuracy, min_reach, max_reach, explained].store(bytes);
        (self.records.len() as u64).store(bytes);
        for ((record, fit), gathers) in self.records.iter().zip(&self.fits).zip(&self.gathers) {
            record.store(bytes);
            fit.store(bytes);
            gathers.store(bytes);
        }
    }

    /// Reads a cache from the front of some bytes, for use within these limits. With the limits of
    /// the saved cache it gives the same irradiance, bit for bit; with others all fits are stale.
    ///
    /// `None` if the bytes were not written by [`Cache::save`].
    #[must_use]
    pub fn restored(bytes: &mut StoredBytes<'_>, limits: Limits) -> Option<Self> {
        let [accuracy, min_reach, max_reach, explained] = Stored::restore(bytes)?;
        let saved_limits = Limits { accuracy, min_reach, max_reach, explained };
        if !saved_limits.are_usable() {
            return None;
        }
        let mut saved = Cache::new(saved_limits);
        for _ in 0..u64::restore(bytes)? {
            let (record, fit) = (Record::restore(bytes)?, Fit::restore(bytes)?);
            let gathers: [u8; STRATA] = Stored::restore(bytes)?;
            if !record.is_usable(&saved_limits) || !fit.is_usable() {
                return None;
            }
            saved.records.push(record);
            saved.fits.push(fit);
            saved.gathers.push(gathers);
            saved.is_stale.push(false);
        }
        saved.rebuild_index();
        if saved_limits == limits {
            return Some(saved);
        }
        let mut cache = Cache::new(limits);
        (0..saved.len()).for_each(|index| cache.insert_from(&saved, index));
        cache.rebuild_index();
        Some(cache)
    }

    /// Adds the records of another cache, starting at index `first`, that lie where no record
    /// reaches yet. Returns their number.
    pub fn merge(&mut self, other: &Cache<BANDS>, first: usize, occluders: &dyn Occluders) -> usize {
        let before = self.len();
        for (index, record) in other.records.iter().enumerate().skip(first) {
            if !self.reaches(record.position, record.normal, occluders) {
                self.insert_from(other, index);
            }
        }
        self.rebuild_index();
        self.len() - before
    }

    fn insert_from(&mut self, other: &Cache<BANDS>, index: usize) {
        let record = other.records[index].within(&self.limits);
        self.insert(record, 0);
        let last = self.gathers.len() - 1;
        self.gathers[last] = other.gathers[index];
    }
}

impl Limits {
    /// Whether they are valid limits of a cache.
    fn are_usable(&self) -> bool {
        let Limits { accuracy, min_reach, max_reach, explained } = *self;
        [accuracy, min_reach, max_reach].iter().all(|limit| limit.is_finite() && *limit > 0.0) && explained.is_finite()
    }
}
