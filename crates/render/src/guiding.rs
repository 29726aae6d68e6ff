//! The guiding distribution of cache points: bright regions such as a window, or a patch of sun on
//! a wall, also as seen in mirrors.
//!
//! Hemisphere samples hit a small bright region rarely, and then get all of its light at once.
//! Bright hits are stored as virtual positions at their apparent distance. At a later cache point
//! nearby, these positions are counted in the cells of a fine hemisphere, and additional rays are
//! directed to cells that are much brighter than average. All rays are weighted by the balance
//! heuristic (Veach and Guibas, SIGGRAPH 1995), so nothing is counted twice, and an occluded region
//! costs only its rays.
//!
//! Guarantees: a function of the recorded samples and their order. Rays are sampled with the pdf
//! that is returned.

use glam::DVec3;
use radsight_irradiance_cache::{Hemisphere, Record};
use std::f64::consts::PI;

/// A hit that contributes many times the average.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GuidingSample {
    /// Its apparent position.
    pub(crate) position: DVec3,
    /// Its fraction of the irradiance, times the squared distance over the cosine.
    pub(crate) power: f64,
}

/// All known bright samples, with the points that found them.
#[derive(Debug)]
pub(crate) struct GuidingRecords {
    gathers: Vec<GuidingRecord>,
    /// Total number of samples.
    samples: usize,
    /// One in this many gathers is kept, besides the current one, and the number since the last one
    /// that was kept.
    rarity: usize,
    passed: usize,
    /// Squared distance within which the observer's position does not matter.
    blur: f64,
    hemisphere: Hemisphere,
}

/// An observer point, and its samples.
#[derive(Clone, Debug)]
struct GuidingRecord {
    point: DVec3,
    /// Unit.
    normal: DVec3,
    bright: Vec<GuidingSample>,
}

/// The guiding distribution of a point.
#[derive(Clone, Debug)]
pub(crate) struct GuidingDistribution<'p> {
    hemisphere: &'p Hemisphere,
    /// Expected rays through each cell.
    rays: Vec<f64>,
    /// The cells with rays, ascending, and the prefix sums of these.
    cells: Vec<usize>,
    cumulative: Vec<f64>,
}

/// A hit is bright above this multiple of the mean radiance.
pub(crate) const BRIGHT: f64 = 4.0;

/// Maximum number of gathers and of samples: with more, every other gather is dropped.
const MAX_GATHERS: usize = 1024;
const MAX_BRIGHT_SAMPLES: usize = 1024;

/// Maximum number of samples of one gather.
const MAX_PER_GATHER: usize = 4;

/// Gathers with less than this fraction of the largest weight are ignored.
const MIN_SHARE: f64 = 0.2;

/// Number of cells for counting samples.
const CELLS: usize = 2048;

/// Number of neighbouring gathers used to estimate the guiding distribution.
const NEIGHBOURING_GATHERS: f64 = 16.0;

/// Weight of gathers with another normal.
const OTHER_NORMAL_WEIGHT: f64 = 0.05;

/// Cells above this multiple of the mean brightness get rays of their own.
const BRIGHT_CELL_RATIO: f64 = 2.0;

impl Default for GuidingRecords {
    fn default() -> Self {
        let hemisphere = Hemisphere::with_divisions(CELLS);
        GuidingRecords { gathers: Vec::new(), samples: 0, rarity: 0, passed: 0, blur: 0.0, hemisphere }
    }
}

impl GuidingRecords {
    /// Whether nothing bright was found so far.
    pub(crate) fn is_empty(&self) -> bool {
        self.samples == 0
    }

    /// Records the bright hits of a gather from a point with this unit normal.
    pub(crate) fn note(&mut self, point: DVec3, normal: DVec3, bright: Vec<GuidingSample>) {
        self.passed += 1;
        if self.passed > self.rarity {
            self.passed = 0;
            let bright = representatives(&bright);
            self.samples += bright.len();
            self.gathers.push(GuidingRecord { point, normal, bright });
        }
    }

    /// Makes recorded samples available, and drops every other gather if there are too many.
    pub(crate) fn settle(&mut self) {
        while self.gathers.len() > MAX_GATHERS || self.samples > MAX_BRIGHT_SAMPLES && self.gathers.len() > 1 {
            let mut index = 0;
            self.gathers.retain(|_| {
                index += 1;
                index % 2 == 0
            });
            self.samples = self.gathers.iter().map(|gather| gather.bright.len()).sum();
            self.rarity = 2 * self.rarity + 1;
        }
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let within =
            |(least, most): (DVec3, DVec3), gather: &GuidingRecord| (least.min(gather.point), most.max(gather.point));
        let (least, most) = self.gathers.iter().fold(start, within);
        self.blur = NEIGHBOURING_GATHERS / (2.0 * PI) * least.distance_squared(most) / self.gathers.len() as f64;
    }

    /// The guiding distribution of a point with this unit normal, if it is worth at least one ray
    /// besides `around` others.
    pub(crate) fn seen_from(&self, point: DVec3, normal: DVec3, around: f64) -> Option<GuidingDistribution<'_>> {
        if self.is_empty() {
            return None;
        }
        let [x, y, z] = Record::<1>::frame(normal);
        let mut importances = vec![0.0; self.hemisphere.len()];
        // Samples are in few of the cells.
        let mut cells = Vec::new();
        let mut weights = 0.0;
        let gather_weights: Vec<f64> =
            self.gathers.iter().map(|gather| gather.weight(point, normal, self.blur)).collect();
        let least = MIN_SHARE * gather_weights.iter().copied().fold(0.0, f64::max);
        for (gather, weight) in self.gathers.iter().zip(gather_weights).filter(|(_, weight)| *weight >= least) {
            weights += weight;
            for sample in &gather.bright {
                let offset = sample.position - point;
                let squared = offset.length_squared();
                let local = DVec3::new(x.dot(offset), y.dot(offset), z.dot(offset)) / squared.sqrt();
                if local.z > 0.0 {
                    let importance = weight * sample.power * local.z / squared;
                    self.hemisphere.splat(local, |cell, share| {
                        if importances[cell] == 0.0 {
                            cells.push(cell);
                        }
                        importances[cell] += share * importance;
                    });
                }
            }
        }
        cells.sort_unstable();
        let all = weights + cells.iter().map(|cell| importances[*cell]).sum::<f64>();
        let least = BRIGHT_CELL_RATIO / importances.len() as f64;
        let mut rays = importances;
        cells.iter().for_each(|cell| rays[*cell] = around * (rays[*cell] / all - least).max(0.0));
        cells.retain(|cell| rays[*cell] > 0.0);
        let total: f64 = cells.iter().map(|cell| rays[*cell]).sum();
        let whole = total.round();
        if whole < 1.0 {
            return None;
        }
        let mut sum = 0.0;
        let scaled = |cell: &usize| {
            rays[*cell] *= whole / total;
            sum += rays[*cell];
            sum
        };
        let cumulative = cells.iter().map(scaled).collect();
        Some(GuidingDistribution { hemisphere: &self.hemisphere, rays, cells, cumulative })
    }
}

/// A few samples that represent all: in equal steps of their power, which they share.
fn representatives(bright: &[GuidingSample]) -> Vec<GuidingSample> {
    let step = bright.iter().map(|sample| sample.power).sum::<f64>() / MAX_PER_GATHER as f64;
    if bright.len() <= MAX_PER_GATHER {
        return bright.to_vec();
    }
    let mut due = 0.5 * step;
    let mut kept = Vec::with_capacity(MAX_PER_GATHER);
    for sample in bright {
        due -= sample.power;
        while due < 0.0 && kept.len() < MAX_PER_GATHER {
            due += step;
            kept.push(GuidingSample { power: step, ..*sample });
        }
    }
    kept
}

impl GuidingRecord {
    /// The relevance of a gather for a point with this unit normal.
    fn weight(&self, point: DVec3, normal: DVec3, blur: f64) -> f64 {
        let turned = self.normal.dot(normal).max(OTHER_NORMAL_WEIGHT);
        turned / (self.point.distance_squared(point) + blur).max(f64::MIN_POSITIVE)
    }
}

impl GuidingDistribution<'_> {
    /// Number of guided rays.
    pub(crate) fn rays(&self) -> u32 {
        self.cumulative.last().map_or(0, |rays| rays.round() as u32)
    }

    /// The unit direction of ray `index`, for one random `shift` of all rays and two coordinates;
    /// +z along the normal.
    pub(crate) fn draw(&self, index: u32, shift: f64, within: [f64; 2]) -> DVec3 {
        let at = f64::from(index) + shift;
        let cell = self.cumulative.partition_point(|rays| *rays <= at).min(self.cumulative.len() - 1);
        self.hemisphere.direction(self.cells[cell], within)
    }

    /// Rays per projected solid angle in a unit direction, +z along the normal, 1/sr.
    pub(crate) fn pdf(&self, local: DVec3) -> f64 {
        self.rays[self.hemisphere.cell(local)] * self.rays.len() as f64 / PI
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_sampling::{DimensionSet, RaySampler};

    /// Two positions, one behind the other's horizon, as found from a floor.
    fn known() -> GuidingRecords {
        let mut known = GuidingRecords::default();
        for index in 0..200 {
            let u = RaySampler::new(1, index).take(DimensionSet::CAMERA);
            let point = DVec3::new(4.0 * u[0] - 2.0, 4.0 * u[1] - 2.0, 0.0);
            let lamp = DVec3::new(0.1 * u[2], 0.0, 2.0);
            let sunken = DVec3::new(1.0, 0.1 * u[3], -0.5);
            known.note(point, DVec3::Z, [lamp, sunken].map(|position| GuidingSample { position, power: 1.0 }).to_vec());
        }
        known.settle();
        known
    }

    #[test]
    fn rays_are_drawn_with_the_density_that_is_claimed() {
        let known = known();
        let view = known.seen_from(DVec3::new(0.3, 0.2, 0.0), DVec3::Z, 64.0).expect("the lamp is seen");
        assert!((1..=64).contains(&view.rays()));
        let turns = 4096;
        let (mut drawn, mut claimed) = ([0.0; 3], [0.0; 3]);
        let moments = |local: DVec3| [1.0, local.x, local.z * local.y];
        let lamp = DVec3::new(-0.25, -0.2, 2.0).normalize();
        for turn in 0..turns {
            let [shift, u, v, _] = RaySampler::new(2, turn).take(DimensionSet::CAMERA);
            for ray in 0..view.rays() {
                let local = view.draw(ray, shift, [u, v]);
                assert!(view.pdf(local) > 0.0 && local.angle_between(lamp) < 0.3);
                for (sum, moment) in drawn.iter_mut().zip(moments(local)) {
                    *sum += moment / turns as f64;
                }
            }
        }
        let fine = Hemisphere::with_divisions(1 << 18);
        for cell in 0..fine.len() {
            let local = fine.direction(cell, [0.5, 0.5]);
            for (sum, moment) in claimed.iter_mut().zip(moments(local)) {
                *sum += moment * view.pdf(local) * PI / fine.len() as f64;
            }
        }
        for (drawn, claimed) in drawn.iter().zip(claimed) {
            assert!((drawn - claimed).abs() < 0.01 * f64::from(view.rays()), "{drawn} is not {claimed}");
        }
    }

    #[test]
    fn what_is_not_seen_gets_no_rays() {
        assert!(
            known()
                .seen_from(DVec3::ZERO, -DVec3::X, 64.0)
                .is_none_or(|view| { (0..view.rays()).all(|ray| view.draw(ray, 0.5, [0.5; 2]).z > 0.0) })
        );
        assert!(known().seen_from(DVec3::new(0.0, 0.0, 3.0), DVec3::Z, 64.0).is_none());
        assert!(GuidingRecords::default().seen_from(DVec3::ZERO, DVec3::Z, 64.0).is_none());
    }

    #[test]
    fn few_places_stand_for_many_with_their_power() {
        let samples: Vec<GuidingSample> = (0..40)
            .map(|index| GuidingSample { position: DVec3::X * f64::from(index), power: f64::from(index) })
            .collect();
        let kept = representatives(&samples);
        let power = |samples: &[GuidingSample]| samples.iter().map(|sample| sample.power).sum::<f64>();
        assert!(kept.len() == MAX_PER_GATHER && (power(&kept) - power(&samples)).abs() < 1e-9);
        assert!(kept.iter().all(|sample| sample.position.x > 10.0), "{kept:?}");
    }

    #[test]
    fn no_more_than_so_many_are_kept() {
        let mut known = GuidingRecords::default();
        let bright = vec![GuidingSample { position: DVec3::Z, power: 1.0 }; 2];
        for index in 0..10_000 {
            known.note(DVec3::X * f64::from(index), DVec3::Z, bright.clone());
            known.settle();
            assert!(known.gathers.len() <= MAX_GATHERS && known.samples <= MAX_BRIGHT_SAMPLES);
        }
        // The kept gathers are distributed over all recorded ones.
        assert!(known.gathers.first().is_some_and(|gather| gather.point.x < 200.0));
        assert!(known.gathers.last().is_some_and(|gather| gather.point.x > 9_800.0));
    }
}
