//! The cache: records by position.

use crate::fit::{Fit, neighbourhood};
use crate::grid::Grid;
use crate::obstacles::Occluders;
use crate::record::{Limits, Record};
use glam::DVec3;

/// Records, and interpolation of irradiance between them.
#[derive(Clone, Debug)]
pub struct Cache<const BANDS: usize> {
    pub(crate) limits: Limits,
    pub(crate) records: Vec<Record<BANDS>>,
    /// One per record; made from its own rays alone until another fit is adopted.
    pub(crate) fits: Vec<Fit<BANDS>>,
    /// Balls with the reach of the records.
    reaches: Grid,
    /// Balls with the neighbourhoods of the fits.
    neighbourhoods: Grid,
    /// Whether records nearby have changed since the last fit.
    pub(crate) is_stale: Vec<bool>,
    /// Number of gathers of each record through each stratum.
    pub(crate) gathers: Vec<[u8; STRATA]>,
}

/// Number of strata of each cell of a hemisphere. A gather samples one stratum of each cell.
/// Neighbours that sample different strata are together stratified like one hemisphere with all the
/// cells.
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
            reaches: Grid::new(limits.min_reach, limits.max_reach),
            neighbourhoods: Grid::new(wide * limits.min_reach, wide * limits.max_reach),
            is_stale: Vec::new(),
            gathers: Vec::new(),
        }
    }

    /// Number of records.
    #[must_use]
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// Whether there are no records.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// Number of rays that were gathered for all records.
    #[must_use]
    pub fn rays(&self) -> f64 {
        self.records.iter().map(|record| record.rays).sum()
    }

    /// The limits for the use of records.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The stratum least sampled by the records around a point. The number of a gather also counts
    /// how often its stratum was sampled: stratum s has the numbers s, s + [`STRATA`], s + 2
    /// [`STRATA`]…
    #[must_use]
    pub fn next_gather(&self, position: DVec3, normal: DVec3) -> usize {
        let mut gathers = [0u32; STRATA];
        self.neighbourhoods.visit(position, |index| {
            let record = &self.records[index as usize];
            let radius = neighbourhood(&self.limits) * record.reach(&self.limits);
            if record.relative_error(position, normal, radius, self.limits.accuracy) < 1.0 {
                for (sum, gathers) in gathers.iter_mut().zip(self.gathers[index as usize]) {
                    *sum += u32::from(gathers);
                }
            }
        });
        let stratum = (0..STRATA).min_by_key(|stratum| gathers[*stratum]).unwrap_or(0);
        stratum + STRATA * gathers[stratum] as usize
    }

    /// The number of the next gather of a record, which is counted from now on.
    ///
    /// # Panics
    /// If there is no such record.
    pub fn take_gather(&mut self, index: usize) -> usize {
        let gather = self.next_gather(self.records[index].position, self.records[index].normal);
        self.count_gather(index, gather);
        gather
    }

    fn count_gather(&mut self, index: usize, gather: usize) {
        let gathers = &mut self.gathers[index][gather % STRATA];
        *gathers = gathers.saturating_add(1);
    }

    /// Adds a record with the number of its gather ([`Cache::next_gather`]). It and its neighbours
    /// limit each other's reach.
    pub fn insert(&mut self, mut record: Record<BANDS>, gather: usize) {
        let mut near = Vec::new();
        self.neighbourhoods.visit(record.position, |index| near.push(index as usize));
        for &index in &near {
            record.clamp_to_neighbour(&self.records[index], self.limits.accuracy);
        }
        for index in near {
            // A record with a reduced reach stays in its cubes until all are sorted again.
            self.records[index].clamp_to_neighbour(&record, self.limits.accuracy);
            self.is_stale[index] = true;
        }
        let index = self.records.len() as u32;
        let reach = record.reach(&self.limits);
        self.reaches.insert(index, record.position, reach);
        self.neighbourhoods.insert(index, record.position, neighbourhood(&self.limits) * reach);
        self.fits.push(Fit::of(&record));
        self.records.push(record);
        self.is_stale.push(true);
        self.gathers.push([0; STRATA]);
        self.count_gather(index as usize, gather);
    }

    /// Adds the result of further rays to a record.
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

    /// Fits the irradiance around a record to the current records. The cache does not change until
    /// the fit is adopted, so fits can be made in parallel.
    ///
    /// # Panics
    /// If there is no such record.
    #[must_use]
    pub fn fit(&self, index: usize, occluders: &dyn Occluders) -> Fit<BANDS> {
        let record = &self.records[index];
        let mut near = Vec::new();
        self.neighbourhoods.visit(record.position, |index| near.push(&self.records[index as usize]));
        Fit::new(record, near.into_iter(), &self.limits, occluders)
    }

    /// Uses a fit from now on.
    ///
    /// # Panics
    /// If there is no such record.
    pub fn adopt(&mut self, index: usize, fit: Fit<BANDS>) {
        self.fits[index] = fit;
        self.is_stale[index] = false;
    }

    /// Limits the reach of records to the scale on which their neighbours agreed with the fit,
    /// which leaves gaps for new records.
    pub fn reduce_reaches(&mut self) {
        for (record, fit) in self.records.iter_mut().zip(&self.fits) {
            record.reduce_scale(fit.scale, self.limits.accuracy);
        }
        self.rebuild_index();
    }

    /// Restores fast lookup after many records were added and have limited each other.
    pub fn rebuild_index(&mut self) {
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

    /// The position, normal and rays of a record.
    ///
    /// # Panics
    /// If there is no such record.
    #[must_use]
    pub fn fitted(&self, index: usize) -> (&Record<BANDS>, &Fit<BANDS>) {
        (&self.records[index], &self.fits[index])
    }

    /// Whether a record that is in sight reaches a point of a surface with this unit normal.
    #[must_use]
    pub fn reaches(&self, position: DVec3, normal: DVec3, occluders: &dyn Occluders) -> bool {
        let mut weights = 0.0;
        let surface = SurfacePoint { position, normal, occluders };
        self.reaches.visit(position, |index| {
            // One record that is in sight suffices.
            if weights <= MIN_WEIGHT {
                weights += self.weight(&self.records[index as usize], &surface, 1.0);
            }
        });
        weights > MIN_WEIGHT
    }

    /// Appends the indices of the records that contribute to the irradiance at a point of a surface
    /// with this unit normal, with their normalised weights.
    pub fn shares(&self, position: DVec3, normal: DVec3, occluders: &dyn Occluders, shares: &mut Vec<(u32, f64)>) {
        let before = shares.len();
        let surface = SurfacePoint { position, normal, occluders };
        self.reaches.visit(position, |index| {
            let weight = self.weight(&self.records[index as usize], &surface, 1.0);
            if weight > 0.0 {
                shares.push((index, weight));
            }
        });
        let total: f64 = shares[before..].iter().map(|(_, weight)| weight).sum();
        shares[before..].iter_mut().for_each(|(_, weight)| *weight /= total);
    }

    /// The irradiance at a point of a surface with this unit normal, on a facet with the unit
    /// normal `facet`; `None` where no record reaches.
    #[must_use]
    pub fn irradiance(
        &self,
        position: DVec3,
        normal: DVec3,
        facet: DVec3,
        occluders: &dyn Occluders,
    ) -> Option<[f64; BANDS]> {
        let surface = SurfacePoint { position, normal, occluders };
        self.blend(&self.reaches, 1.0, (&surface, facet), f64::INFINITY).irradiance()
    }

    /// The same where the relative interpolation error of the records is at most `error`; elsewhere
    /// they cannot follow the irradiance. Small gaps between records are filled by extrapolation
    /// from records that do not quite reach.
    #[must_use]
    pub fn trusted_irradiance(
        &self,
        position: DVec3,
        normal: DVec3,
        facet: DVec3,
        occluders: &dyn Occluders,
        max_interpolation_error: f64,
    ) -> Option<[f64; BANDS]> {
        let surface = SurfacePoint { position, normal, occluders };
        let mut blend = self.blend(&self.reaches, 1.0, (&surface, facet), f64::INFINITY);
        if blend.irradiance().is_none() {
            blend = self.blend(&self.neighbourhoods, neighbourhood(&self.limits), (&surface, facet), f64::INFINITY);
        }
        if blend.interpolation_error() > max_interpolation_error { None } else { blend.irradiance() }
    }

    /// The same from records with at most this reach; `None` where there are none.
    #[must_use]
    pub fn fine_irradiance(
        &self,
        position: DVec3,
        normal: DVec3,
        facet: DVec3,
        occluders: &dyn Occluders,
        farthest_reach: f64,
    ) -> Option<[f64; BANDS]> {
        let surface = SurfacePoint { position, normal, occluders };
        self.blend(&self.reaches, 1.0, (&surface, facet), farthest_reach).irradiance()
    }

    fn blend(
        &self,
        near: &Grid,
        farther: f64,
        (surface, facet): (&SurfacePoint<'_>, DVec3),
        farthest_reach: f64,
    ) -> Blend<BANDS> {
        let mut blend = Blend { sum: [0.0; BANDS], interpolation_error: 0.0, weights: 0.0 };
        near.visit(surface.position, |index| {
            let record = &self.records[index as usize];
            if record.reach(&self.limits) > farthest_reach {
                return;
            }
            let weight = self.weight(record, surface, farther);
            if weight > 0.0 {
                let fit = &self.fits[index as usize];
                blend.weights += weight;
                blend.interpolation_error += weight * fit.interpolation_error;
                for (sum, value) in blend.sum.iter_mut().zip(fit.at(record, surface.position, facet)) {
                    *sum += weight * value;
                }
            }
        });
        blend
    }

    /// Falls to zero at the border of the reach, so that the interpolation is continuous (Tabellion
    /// and Lamorlette 2004). Zero for a record that is hidden from the point.
    fn weight(&self, record: &Record<BANDS>, surface: &SurfacePoint<'_>, farther: f64) -> f64 {
        let SurfacePoint { position, normal, occluders } = *surface;
        let reach = farther * record.reach(&self.limits);
        let weight = 1.0 - record.relative_error(position, normal, reach, self.limits.accuracy);
        if weight > 0.0 && !record.is_hidden_from(position, normal, occluders) { weight } else { 0.0 }
    }
}

/// A point where irradiance is requested.
#[derive(Clone, Copy)]
struct SurfacePoint<'o> {
    position: DVec3,
    /// Unit.
    normal: DVec3,
    occluders: &'o dyn Occluders,
}

/// Weighted sums over the records around a point.
#[derive(Clone, Copy, Debug)]
struct Blend<const BANDS: usize> {
    /// Of irradiance, and of the relative interpolation error of the records.
    sum: [f64; BANDS],
    interpolation_error: f64,
    weights: f64,
}

impl<const BANDS: usize> Blend<BANDS> {
    /// `None` where no record reaches.
    fn irradiance(&self) -> Option<[f64; BANDS]> {
        (self.weights > MIN_WEIGHT).then(|| self.sum.map(|band| band / self.weights))
    }

    /// The relative interpolation error.
    fn interpolation_error(&self) -> f64 {
        if self.weights > 0.0 { self.interpolation_error / self.weights } else { 0.0 }
    }
}

/// Below this total weight the nearest record is almost out of reach.
const MIN_WEIGHT: f64 = 1e-4;
