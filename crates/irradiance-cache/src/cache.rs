//! Records by place.

use crate::fit::{Fit, neighbourhood};
use crate::grid::Grid;
use crate::record::{Limits, Record};
use glam::DVec3;

/// Records, and the irradiance that is interpolated between them.
#[derive(Clone, Debug)]
pub struct Cache<const BANDS: usize> {
    pub(crate) limits: Limits,
    pub(crate) records: Vec<Record<BANDS>>,
    /// One for each record; from its own rays alone until others are adopted.
    pub(crate) fits: Vec<Fit<BANDS>>,
    /// Balls of the records' reach.
    reaches: Grid,
    /// Balls of the neighbourhoods of fits.
    neighbourhoods: Grid,
    /// Whether something near has changed since the last fit.
    pub(crate) is_stale: Vec<bool>,
    /// How often each record has looked through each stratum.
    pub(crate) looks: Vec<[u8; STRATA]>,
}

/// Each cell of a hemisphere is divided into so many strata, of which a look takes one: neighbours that take different ones have together
/// looked around as evenly as one hemisphere of as many cells.
pub const STRATA: usize = 16;

impl<const BANDS: usize> Cache<BANDS> {
    /// An empty cache.
    #[must_use]
    pub fn new(limits: Limits) -> Self {
        let wide = neighbourhood(&limits);
        Cache {
            limits,
            records: Vec::new(),
            fits: Vec::new(),
            reaches: Grid::new(limits.least, limits.most),
            neighbourhoods: Grid::new(wide * limits.least, wide * limits.most),
            is_stale: Vec::new(),
            looks: Vec::new(),
        }
    }

    /// How many records there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// What bounds the use of the records.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The stratum through which fewest of those around a point have looked. Looks through it are told apart by how often that was: stratum s has the
    /// numbers s, s + [`STRATA`], s + 2 [`STRATA`]…
    #[must_use]
    pub fn next_gather(&self, position: DVec3, normal: DVec3) -> usize {
        let mut looks = [0u32; STRATA];
        self.neighbourhoods.visit(position, |index| {
            let record = &self.records[index as usize];
            let radius = neighbourhood(&self.limits) * record.reach(&self.limits);
            if record.misplacement(position, normal, radius, self.limits.accuracy) < 1.0 {
                for (sum, looks) in looks.iter_mut().zip(self.looks[index as usize]) {
                    *sum += u32::from(looks);
                }
            }
        });
        let stratum = (0..STRATA).min_by_key(|stratum| looks[*stratum]).unwrap_or(0);
        stratum + STRATA * looks[stratum] as usize
    }

    /// The next look from a record; it counts as done from now on.
    ///
    /// # Panics
    /// If there is no such record.
    pub fn take_gather(&mut self, index: usize) -> usize {
        let look = self.next_gather(self.records[index].position, self.records[index].normal);
        self.count_gather(index, look);
        look
    }

    fn count_gather(&mut self, index: usize, look: usize) {
        let looks = &mut self.looks[index][look % STRATA];
        *looks = looks.saturating_add(1);
    }

    /// Adds a record that has made this look ([`Cache::next_gather`]); it and its neighbours restrain each other's reach.
    pub fn insert(&mut self, mut record: Record<BANDS>, look: usize) {
        let mut near = Vec::new();
        self.neighbourhoods.visit(record.position, |index| near.push(index as usize));
        for &index in &near {
            record.restrain(&self.records[index], self.limits.accuracy);
        }
        for index in near {
            // A shrunken record stays in its cubes until all are sorted in; it only reaches less of them.
            self.records[index].restrain(&record, self.limits.accuracy);
            self.is_stale[index] = true;
        }
        let index = self.records.len() as u32;
        let reach = record.reach(&self.limits);
        self.reaches.insert(index, record.position, reach);
        self.neighbourhoods.insert(index, record.position, neighbourhood(&self.limits) * reach);
        self.fits.push(Fit::of(&record));
        self.records.push(record);
        self.is_stale.push(true);
        self.looks.push([0; STRATA]);
        self.count_gather(index as usize, look);
    }

    /// Adds what further rays found from the place of a record.
    ///
    /// # Panics
    /// If there is no such record.
    pub fn add(&mut self, index: usize, further: &Record<BANDS>) {
        self.records[index].add(further);
        let position = self.records[index].position;
        let is_stale = &mut self.is_stale;
        self.neighbourhoods.visit(position, |near| is_stale[near as usize] = true);
    }

    /// The records whose neighbourhood has changed since they were fitted.
    #[must_use]
    pub fn stale(&self) -> Vec<usize> {
        (0..self.len()).filter(|index| self.is_stale[*index]).collect()
    }

    /// Fits the irradiance around a record to what is there by now. Nothing changes until the fit is adopted, so many may be made at once.
    ///
    /// # Panics
    /// If there is no such record.
    #[must_use]
    pub fn fit(&self, index: usize) -> Fit<BANDS> {
        let record = &self.records[index];
        let mut near = Vec::new();
        self.neighbourhoods.visit(record.position, |index| near.push(&self.records[index as usize]));
        Fit::new(record, near.into_iter(), &self.limits)
    }

    /// Uses a fit from now on.
    ///
    /// # Panics
    /// If there is no such record.
    pub fn adopt(&mut self, index: usize, fit: Fit<BANDS>) {
        self.fits[index] = fit;
        self.is_stale[index] = false;
    }

    /// Trusts records no farther than their neighbours agreed when they were fitted, which leaves gaps for others.
    pub fn shorten_reaches(&mut self) {
        for (record, fit) in self.records.iter_mut().zip(&self.fits) {
            record.shorten(fit.scale, self.limits.accuracy);
        }
        self.sort_in();
    }

    /// Makes looking for records fast again, after many were added and restrained each other.
    pub fn sort_in(&mut self) {
        self.reaches = self.reaches.cleared();
        self.neighbourhoods = self.neighbourhoods.cleared();
        for (index, record) in (0..).zip(&self.records) {
            let reach = record.reach(&self.limits);
            self.reaches.insert(index, record.position, reach);
            self.neighbourhoods.insert(index, record.position, neighbourhood(&self.limits) * reach);
        }
    }

    /// The mean of [`Fit::brightness`] over all records.
    #[must_use]
    pub fn typical(&self) -> f64 {
        self.fits.iter().map(Fit::brightness).sum::<f64>() / self.len().max(1) as f64
    }

    /// What a record's irradiance rests on.
    ///
    /// # Panics
    /// If there is no such record.
    #[must_use]
    pub fn fitted(&self, index: usize) -> (&Record<BANDS>, &Fit<BANDS>) {
        (&self.records[index], &self.fits[index])
    }

    /// Whether some record reaches a point of a surface with this unit normal.
    #[must_use]
    pub fn reaches(&self, position: DVec3, normal: DVec3) -> bool {
        let mut weights = 0.0;
        self.reaches
            .visit(position, |index| weights += self.weight(&self.records[index as usize], position, normal, 1.0));
        weights > LEAST_WEIGHT
    }

    /// Adds the numbers of the records that give the irradiance at a point of a surface with this unit normal, with the share of each.
    pub fn shares(&self, position: DVec3, normal: DVec3, shares: &mut Vec<(u32, f64)>) {
        let before = shares.len();
        self.reaches.visit(position, |index| {
            let weight = self.weight(&self.records[index as usize], position, normal, 1.0);
            if weight > 0.0 {
                shares.push((index, weight));
            }
        });
        let total: f64 = shares[before..].iter().map(|(_, weight)| weight).sum();
        shares[before..].iter_mut().for_each(|(_, weight)| *weight /= total);
    }

    /// The irradiance at a point of a surface with this unit normal, on a facet of it that is turned to the unit normal `facet`;
    /// `None` where no record reaches.
    #[must_use]
    pub fn irradiance(&self, position: DVec3, normal: DVec3, facet: DVec3) -> Option<[f64; BANDS]> {
        self.blend(&self.reaches, 1.0, [position, normal, facet], f64::INFINITY).irradiance()
    }

    /// The same where records disagree around it by no more than this share: where irradiance bends more they cannot follow. In the small gaps between
    /// places that were looked around from it is told by records that do not quite reach.
    #[must_use]
    pub fn trusted_irradiance(
        &self,
        position: DVec3,
        normal: DVec3,
        facet: DVec3,
        max_interpolation_error: f64,
    ) -> Option<[f64; BANDS]> {
        let place = [position, normal, facet];
        let mut blend = self.blend(&self.reaches, 1.0, place, f64::INFINITY);
        if blend.irradiance().is_none() {
            blend = self.blend(&self.neighbourhoods, neighbourhood(&self.limits), place, f64::INFINITY);
        }
        if blend.interpolation_error() > max_interpolation_error { None } else { blend.irradiance() }
    }

    /// The same from records that reach no farther than this; `None` where there are none.
    #[must_use]
    pub fn fine_irradiance(
        &self,
        position: DVec3,
        normal: DVec3,
        facet: DVec3,
        farthest_reach: f64,
    ) -> Option<[f64; BANDS]> {
        self.blend(&self.reaches, 1.0, [position, normal, facet], farthest_reach).irradiance()
    }

    fn blend(
        &self,
        near: &Grid,
        farther: f64,
        [position, normal, facet]: [DVec3; 3],
        farthest_reach: f64,
    ) -> Blend<BANDS> {
        let mut blend = Blend { sum: [0.0; BANDS], interpolation_error: 0.0, weights: 0.0 };
        near.visit(position, |index| {
            let record = &self.records[index as usize];
            if record.reach(&self.limits) > farthest_reach {
                return;
            }
            let weight = self.weight(record, position, normal, farther);
            if weight > 0.0 {
                let fit = &self.fits[index as usize];
                blend.weights += weight;
                blend.interpolation_error += weight * fit.interpolation_error;
                for (sum, value) in blend.sum.iter_mut().zip(fit.at(record, position, facet)) {
                    *sum += weight * value;
                }
            }
        });
        blend
    }

    /// Falls to zero at the border of the reach, so that nothing jumps there (Tabellion and Lamorlette 2004).
    fn weight(&self, record: &Record<BANDS>, position: DVec3, normal: DVec3, farther: f64) -> f64 {
        let reach = farther * record.reach(&self.limits);
        (1.0 - record.misplacement(position, normal, reach, self.limits.accuracy)).max(0.0)
    }
}

/// What the records around a point say, weighted.
#[derive(Clone, Copy, Debug)]
struct Blend<const BANDS: usize> {
    /// Of irradiance, and of the share by which the records disagree around them.
    sum: [f64; BANDS],
    interpolation_error: f64,
    weights: f64,
}

impl<const BANDS: usize> Blend<BANDS> {
    /// `None` where no record reaches.
    fn irradiance(&self) -> Option<[f64; BANDS]> {
        (self.weights > LEAST_WEIGHT).then(|| self.sum.map(|band| band / self.weights))
    }

    /// By how much the records disagree, as a share.
    fn interpolation_error(&self) -> f64 {
        if self.weights > 0.0 { self.interpolation_error / self.weights } else { 0.0 }
    }
}

/// Below this total the nearest record is all but out of reach.
const LEAST_WEIGHT: f64 = 1e-4;
