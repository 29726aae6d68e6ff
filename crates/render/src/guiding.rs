//! Places that bring much light to points around which rays look: a window, a patch of sun on a wall, also as a mirror shows them.
//!
//! Hemisphere samples hit a small bright region seldom, and then all of its light at once. What earlier rays found bright is kept here, as virtual
//! places at the distance at which it appears. From there where rays look next, these places are counted in the cells of a fine hemisphere, and
//! further rays are sent through cells that promise more light than the others find. All rays are weighted with the balance heuristic
//! (Veach and Guibas, SIGGRAPH 1995), so nothing is counted twice, and a place that is not seen from here costs no more than its rays.
//!
//! Guarantees: a function of what was noted, in its order. Rays are sent with the density that is claimed.

use glam::DVec3;
use radsight_irradiance_cache::{Hemisphere, Record};
use std::f64::consts::PI;

/// What a ray found that brings many times its share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GuidingSample {
    /// Where it appears.
    pub(crate) position: DVec3,
    /// The share of the irradiance that it brought, times the squared distance over the cosine.
    pub(crate) power: f64,
}

/// All that is known to be bright, and from where.
#[derive(Debug)]
pub(crate) struct GuidingRecords {
    looks: Vec<GuidingRecord>,
    /// How many places they found.
    places: usize,
    /// One look in so many is kept by now, beside the one that is, and how many were not since one was.
    rarity: usize,
    passed: usize,
    /// Squared distance within which it makes no difference from where a place was seen.
    blur: f64,
    hemisphere: Hemisphere,
}

/// From where was looked, and what was found.
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
    /// Rays through each cell, expected, and through it and those before.
    rays: Vec<f64>,
    cumulative: Vec<f64>,
}

/// What brings more than so many times the mean radiance is bright.
pub(crate) const BRIGHT: f64 = 4.0;

/// No more looks are kept, and no more places: every other look goes when there are more.
const MOST_LOOKS: usize = 1024;
const MOST_PLACES: usize = 1024;

/// Of one look no more are kept.
const MOST_OF_A_LOOK: usize = 4;

/// Looks that count less than this share of the one that counts most say nothing.
const LEAST_SHARE: f64 = 0.05;

/// Cells in which the places are counted.
const CELLS: usize = 2048;

/// From so many looks around a point is told what is bright there, about.
const LOOKS_AROUND: f64 = 16.0;

/// Looks in another direction still count so much.
const AVERTED: f64 = 0.05;

/// Cells get rays of their own where they promise more than so many times what all promise in the mean.
const OUTSTANDING: f64 = 2.0;

impl Default for GuidingRecords {
    fn default() -> Self {
        let hemisphere = Hemisphere::with_divisions(CELLS);
        GuidingRecords { looks: Vec::new(), places: 0, rarity: 0, passed: 0, blur: 0.0, hemisphere }
    }
}

impl GuidingRecords {
    /// Whether nothing bright was found so far.
    pub(crate) fn is_empty(&self) -> bool {
        self.places == 0
    }

    /// Takes in what a further look has found from a point with this unit normal.
    pub(crate) fn note(&mut self, point: DVec3, normal: DVec3, bright: Vec<GuidingSample>) {
        self.passed += 1;
        if self.passed > self.rarity {
            self.passed = 0;
            let bright = representatives(&bright);
            self.places += bright.len();
            self.looks.push(GuidingRecord { point, normal, bright });
        }
    }

    /// Makes use of what was noted, and forgets every other look where there are too many.
    pub(crate) fn settle(&mut self) {
        while self.looks.len() > MOST_LOOKS || self.places > MOST_PLACES && self.looks.len() > 1 {
            let mut index = 0;
            self.looks.retain(|_| {
                index += 1;
                index % 2 == 0
            });
            self.places = self.looks.iter().map(|look| look.bright.len()).sum();
            self.rarity = 2 * self.rarity + 1;
        }
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let within =
            |(least, most): (DVec3, DVec3), look: &GuidingRecord| (least.min(look.point), most.max(look.point));
        let (least, most) = self.looks.iter().fold(start, within);
        self.blur = LOOKS_AROUND / (2.0 * PI) * least.distance_squared(most) / self.looks.len() as f64;
    }

    /// What a point with this unit normal sees of them, where that deserves at least one ray beside `around` others.
    pub(crate) fn seen_from(&self, point: DVec3, normal: DVec3, around: f64) -> Option<GuidingDistribution<'_>> {
        if self.is_empty() {
            return None;
        }
        let [x, y, z] = Record::<1>::frame(normal);
        let mut importances = vec![0.0; self.hemisphere.len()];
        let mut weights = 0.0;
        let of_looks: Vec<f64> = self.looks.iter().map(|look| look.weight(point, normal, self.blur)).collect();
        let least = LEAST_SHARE * of_looks.iter().copied().fold(0.0, f64::max);
        for (look, weight) in self.looks.iter().zip(of_looks).filter(|(_, weight)| *weight >= least) {
            weights += weight;
            for place in &look.bright {
                let offset = place.position - point;
                let squared = offset.length_squared();
                let local = DVec3::new(x.dot(offset), y.dot(offset), z.dot(offset)) / squared.sqrt();
                if local.z > 0.0 {
                    let importance = weight * place.power * local.z / squared;
                    self.hemisphere.splat(local, |cell, share| importances[cell] += share * importance);
                }
            }
        }
        let all = weights + importances.iter().sum::<f64>();
        let cells = importances.len() as f64;
        let own = |importance: &f64| around * (importance / all - OUTSTANDING / cells).max(0.0);
        let mut rays: Vec<f64> = importances.iter().map(own).collect();
        let total: f64 = rays.iter().sum();
        let whole = total.round();
        if whole < 1.0 {
            return None;
        }
        let mut sum = 0.0;
        let cumulative = rays
            .iter_mut()
            .map(|rays| {
                *rays *= whole / total;
                sum += *rays;
                sum
            })
            .collect();
        Some(GuidingDistribution { hemisphere: &self.hemisphere, rays, cumulative })
    }
}

/// A few of these places that stand for all of them: in even steps of their power, which they share.
fn representatives(bright: &[GuidingSample]) -> Vec<GuidingSample> {
    let step = bright.iter().map(|place| place.power).sum::<f64>() / MOST_OF_A_LOOK as f64;
    if bright.len() <= MOST_OF_A_LOOK {
        return bright.to_vec();
    }
    let mut due = 0.5 * step;
    let mut kept = Vec::with_capacity(MOST_OF_A_LOOK);
    for place in bright {
        due -= place.power;
        while due < 0.0 && kept.len() < MOST_OF_A_LOOK {
            due += step;
            kept.push(GuidingSample { power: step, ..*place });
        }
    }
    kept
}

impl GuidingRecord {
    /// How much it says of what is bright around a point with this unit normal.
    fn weight(&self, point: DVec3, normal: DVec3, blur: f64) -> f64 {
        let turned = self.normal.dot(normal).max(AVERTED);
        turned / (self.point.distance_squared(point) + blur).max(f64::MIN_POSITIVE)
    }
}

impl GuidingDistribution<'_> {
    /// Rays that go there.
    pub(crate) fn rays(&self) -> u32 {
        self.cumulative.last().map_or(0, |rays| rays.round() as u32)
    }

    /// The unit direction of ray `index`, for one `shift` of all rays from here and two coordinates of its own; +z on the normal.
    pub(crate) fn draw(&self, index: u32, shift: f64, within: [f64; 2]) -> DVec3 {
        let at = f64::from(index) + shift;
        let cell = self.cumulative.partition_point(|rays| *rays <= at).min(self.cumulative.len() - 1);
        self.hemisphere.direction(cell, within)
    }

    /// Rays per projected solid angle in a unit direction, +z on the normal, 1/sr.
    pub(crate) fn pdf(&self, local: DVec3) -> f64 {
        self.rays[self.hemisphere.cell(local)] * self.rays.len() as f64 / PI
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_sampling::{DimensionSet, RaySampler};

    /// Two places, one behind the other's horizon, as looks from a floor have found them.
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
        let places: Vec<GuidingSample> = (0..40)
            .map(|index| GuidingSample { position: DVec3::X * f64::from(index), power: f64::from(index) })
            .collect();
        let kept = representatives(&places);
        let power = |places: &[GuidingSample]| places.iter().map(|place| place.power).sum::<f64>();
        assert!(kept.len() == MOST_OF_A_LOOK && (power(&kept) - power(&places)).abs() < 1e-9);
        assert!(kept.iter().all(|place| place.position.x > 10.0), "{kept:?}");
    }

    #[test]
    fn no_more_than_so_many_are_kept() {
        let mut known = GuidingRecords::default();
        let bright = vec![GuidingSample { position: DVec3::Z, power: 1.0 }; 2];
        for index in 0..10_000 {
            known.note(DVec3::X * f64::from(index), DVec3::Z, bright.clone());
            known.settle();
            assert!(known.looks.len() <= MOST_LOOKS && known.places <= MOST_PLACES);
        }
        // What is kept is spread over all that was noted.
        assert!(known.looks.first().is_some_and(|look| look.point.x < 200.0));
        assert!(known.looks.last().is_some_and(|look| look.point.x > 9_800.0));
    }
}
