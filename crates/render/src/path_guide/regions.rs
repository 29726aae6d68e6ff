//! Regions of points with similar surroundings, and the mixture learned for each.
//!
//! A region is a leaf of a k-d tree over position and normal (like the spatial tree of Müller et
//! al. 2017). The learned parameters are the weights of a mixture of cosine-distributed directions
//! and directions towards each portal. They are estimated by expectation maximisation over weighted
//! samples (Vorba et al. 2014, with fixed components). A portal's weight varies within a region
//! with its solid angle and its cosine; only a factor of it is learned.

use glam::DVec3;

/// A region with more points than this is divided.
const MAX_POINTS: usize = 48;

/// A rotation of the normal by one radian counts like this fraction of the extent of all points.
const ROTATION_WEIGHT: f64 = 0.5;

/// Weight of the prior, in samples of mean weight.
const PRIOR_SAMPLES: f64 = 16.0;

/// Minimum and maximum fraction of a region's rays towards portals: unknown light must still be
/// found.
const PORTAL_FRACTIONS: [f64; 2] = [0.05, 0.8];

/// Minimum factor relative to the largest: a portal may be visible from a part of the region.
const MIN_FACTOR: f64 = 0.01;

/// A point with a unit normal, in six dimensions.
type Coordinates = [f64; 6];

/// The tree over all regions.
#[derive(Debug)]
pub(crate) struct Regions {
    nodes: Vec<Node>,
    scale: f64,
    leaves: Vec<Region>,
}

#[derive(Clone, Copy, Debug)]
enum Node {
    /// Coordinate, position of the cut, and the node above it; the one below is next.
    Cut(usize, f64, usize),
    Leaf(usize),
}

/// The learned mixture of one region.
#[derive(Clone, Debug)]
pub(crate) struct Region {
    /// Selection weight of each portal relative to its size.
    pub(crate) factors: Vec<f64>,
    /// Fraction of rays towards portals.
    pub(crate) chance: f64,
}

/// Sufficient statistics of a region's samples.
#[derive(Clone, Debug)]
pub(crate) struct RegionStatistics {
    /// Sum of the samples' weights, and number of samples.
    weights: f64,
    samples: f64,
    /// The part for which rays towards portals are responsible.
    outward: f64,
    /// The part of each portal, and the sum over samples of its selection probability among
    /// portals.
    parts: Vec<f64>,
    shares: Vec<f64>,
}

impl Regions {
    /// Regions of these points with their unit normals; nothing is learned yet about the portals.
    pub(crate) fn new(points: &[(DVec3, DVec3)], portals: usize) -> Regions {
        let (least, most) = points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(least, most), (point, _)| {
            (least.min(*point), most.max(*point))
        });
        let scale = (most - least).max_element().max(f64::MIN_POSITIVE).recip();
        let mut regions = Regions { nodes: Vec::new(), scale, leaves: Vec::new() };
        let mut coordinates: Vec<Coordinates> =
            points.iter().map(|(point, normal)| regions.coordinates(*point, *normal)).collect();
        regions.divide(&mut coordinates);
        regions.forget(portals);
        regions
    }

    /// Starts again with other portals.
    pub(crate) fn forget(&mut self, portals: usize) {
        let unknown = Region { factors: vec![1.0; portals], chance: 0.5 };
        self.leaves.iter_mut().for_each(|region| *region = unknown.clone());
    }

    pub(crate) fn len(&self) -> usize {
        self.leaves.len()
    }

    fn coordinates(&self, point: DVec3, normal: DVec3) -> Coordinates {
        let (point, normal) = (point * self.scale, normal * ROTATION_WEIGHT);
        [point.x, point.y, point.z, normal.x, normal.y, normal.z]
    }

    fn divide(&mut self, points: &mut [Coordinates]) {
        let extent = |axis: usize| {
            let (least, most) = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), point| {
                (least.min(point[axis]), most.max(point[axis]))
            });
            most - least
        };
        let axis = (0..6).max_by(|one, two| extent(*one).total_cmp(&extent(*two))).unwrap_or(0);
        let node = self.nodes.len();
        if points.len() <= MAX_POINTS || extent(axis) <= 0.0 {
            self.nodes.push(Node::Leaf(self.leaves.len()));
            self.leaves.push(Region { factors: Vec::new(), chance: 0.0 });
            return;
        }
        points.sort_unstable_by(|one, two| one[axis].total_cmp(&two[axis]));
        let cut = points[points.len() / 2][axis];
        let below = points.partition_point(|point| point[axis] < cut);
        // If half of the points have the smallest coordinate, the others are cut off.
        let (below, cut) = match below {
            0 => {
                let below = points.partition_point(|point| point[axis] <= cut);
                (below, points[below][axis])
            }
            below => (below, cut),
        };
        self.nodes.push(Node::Leaf(0));
        let (low, high) = points.split_at_mut(below);
        self.divide(low);
        let above = self.nodes.len();
        self.divide(high);
        self.nodes[node] = Node::Cut(axis, cut, above);
    }

    /// The index of the region of a point with a unit normal.
    pub(crate) fn find(&self, point: DVec3, normal: DVec3) -> usize {
        let coordinates = self.coordinates(point, normal);
        let mut node = 0;
        loop {
            match self.nodes[node] {
                Node::Cut(axis, cut, above) => node = if coordinates[axis] < cut { node + 1 } else { above },
                Node::Leaf(leaf) => return leaf,
            }
        }
    }

    pub(crate) fn region(&self, index: usize) -> &Region {
        &self.leaves[index]
    }

    /// Updates each region from its statistics.
    pub(crate) fn learn(&mut self, statistics: &[RegionStatistics]) {
        for (region, statistics) in self.leaves.iter_mut().zip(statistics) {
            region.learn(statistics);
        }
    }
}

impl RegionStatistics {
    /// Without samples.
    pub(crate) fn new(portals: usize) -> RegionStatistics {
        let nothing = vec![0.0; portals];
        RegionStatistics { weights: 0.0, samples: 0.0, outward: 0.0, parts: nothing.clone(), shares: nothing }
    }

    /// Adds a sample with a weight and a unit direction, and the terms of its pdf: the fraction of
    /// cosine-distributed rays times their pdf and, for each portal, the index, its selection
    /// probability among portals, and that times its pdf.
    pub(crate) fn add(
        &mut self,
        weight: f64,
        by_cosine: f64,
        chance: f64,
        portals: impl Iterator<Item = (usize, f64, f64)> + Clone,
    ) {
        let outward = chance * portals.clone().map(|(_, _, pdf)| pdf).sum::<f64>();
        let pdf = by_cosine + outward;
        self.weights += weight;
        self.samples += 1.0;
        self.outward += weight * outward / pdf;
        for (index, share, of_one) in portals {
            self.parts[index] += weight * chance * of_one / pdf;
            self.shares[index] += weight * chance * share;
        }
    }
}

impl Region {
    fn learn(&mut self, statistics: &RegionStatistics) {
        let RegionStatistics { weights, samples, .. } = *statistics;
        if weights <= 0.0 {
            return;
        }
        let prior = PRIOR_SAMPLES * weights / samples;
        let all = weights + prior;
        for (factor, (part, share)) in self.factors.iter_mut().zip(statistics.parts.iter().zip(&statistics.shares)) {
            if *share > 0.0 {
                let before = share / weights;
                *factor *= (part + prior * before) / (all * before);
            }
        }
        let most = self.factors.iter().copied().fold(0.0, f64::max);
        self.factors.iter_mut().for_each(|factor| *factor = factor.max(MIN_FACTOR * most));
        self.chance =
            ((statistics.outward + prior * self.chance) / all).clamp(PORTAL_FRACTIONS[0], PORTAL_FRACTIONS[1]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_sampling::{DimensionSet, RaySampler};

    fn points() -> Vec<(DVec3, DVec3)> {
        (0..500)
            .map(|index| {
                let [x, y, z, _] = RaySampler::new(1, index).take(DimensionSet::CAMERA);
                let normal = if index % 2 == 0 { DVec3::X } else { -DVec3::X };
                (DVec3::new(4.0 * x, y, z), normal)
            })
            .collect()
    }

    #[test]
    fn regions_hold_neighbours_that_face_the_same_way() {
        let points = points();
        let regions = Regions::new(&points, 1);
        assert!((10..=40).contains(&regions.len()), "{} regions", regions.len());
        let mut counts = vec![[0, 0]; regions.len()];
        for (point, normal) in &points {
            counts[regions.find(*point, *normal)][usize::from(normal.x > 0.0)] += 1;
        }
        assert!(counts.iter().all(|[one, two]| (one + two <= MAX_POINTS) && (*one == 0 || *two == 0)), "{counts:?}");
    }

    #[test]
    fn many_points_at_one_place_are_a_region() {
        let same = vec![(DVec3::ONE, DVec3::Z); 300];
        assert_eq!(Regions::new(&same, 2).len(), 1);
        let mut most = same;
        most.push((DVec3::ZERO, DVec3::Z));
        assert_eq!(Regions::new(&most, 2).len(), 2);
    }

    /// All light comes from the second of two portals of equal size and brightness; the first is
    /// occluded.
    #[test]
    fn a_hidden_opening_is_given_up_and_what_shines_is_drawn() {
        let mut regions = Regions::new(&[(DVec3::ZERO, DVec3::Z)], 2);
        for _ in 0..8 {
            let region = regions.region(0).clone();
            let shares =
                [region.factors[0], region.factors[1]].map(|factor| factor / region.factors.iter().sum::<f64>());
            let mut statistics = RegionStatistics::new(2);
            for index in 0..400 {
                // Half of the directions are in each portal, where its pdf is 2 and that of the
                // cosine 1.
                let inside = index % 2;
                let parts = (0..2).map(|portal| {
                    let density = if portal == inside { 2.0 } else { 0.0 };
                    (portal, shares[portal], shares[portal] * density)
                });
                statistics.add(if inside == 1 { 1.0 } else { 0.0 }, 1.0 - region.chance, region.chance, parts);
            }
            regions.learn(&[statistics]);
        }
        let Region { factors, chance } = regions.region(0);
        assert!(factors[1] > 20.0 * factors[0], "{factors:?}");
        assert!(*chance > 0.7, "{chance}");
    }
}
