//! Small bright patches, found from single bright hits of rays.
//!
//! A patch is a box, such as a sunlit floor, the slats of a blind with their gaps, or a window in a
//! mirror. Rays towards a patch leave a variance in proportion to its visible area A times S, the
//! integral of the squared radiance over it. Points are divided among boxes as long as that lowers
//! the sum of `√(A·S)` over all: with rays in proportion to it, the square of that sum is the total
//! second moment.

use glam::DVec3;
use radsight_compile::Portal;

/// A hit of a ray with its radiance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BrightPoint {
    pub(crate) position: DVec3,
    /// Relative to the mean radiance.
    pub(crate) radiance: f64,
    /// The represented area across the ray: one over the density of points there.
    pub(crate) area: f64,
    /// The ray's contribution to the mean square of all: large where it was not expected.
    pub(crate) second_moment: f64,
}

/// Maximum number of patches per round.
pub(crate) const MAX_PATCHES: usize = 8;

/// Minimum number of points of a patch: fewer do not determine its extent.
const MIN_POINTS: usize = 4;

/// Margin of a patch beyond its points, relative to their extent. The outermost of N uniform points
/// are on average 1/(N − 1) of their extent from the border; several times that leaves hardly
/// anything outside.
const MARGIN: f64 = 0.1;
const MARGIN_OF_FEW: f64 = 3.0;

/// Minimum fraction of bright points in a patch; below it the bright ones are due to chance.
const MIN_BRIGHT: f64 = 0.3;

/// Minimum relative reduction for dividing a patch.
const MIN_GAIN: f64 = 0.15;

/// Patches that contribute less than this fraction of the mean square of all rays are ignored.
const MIN_SURPRISE: f64 = 0.01;

/// Number of candidate cuts along each axis.
const CUTS: usize = 15;

/// Boxes thinner than this fraction of their length are flat.
const FLAT: f64 = 0.01;

/// Points and their box.
#[derive(Clone, Debug)]
struct Patch {
    points: Vec<BrightPoint>,
    bounds: [DVec3; 2],
    area: f64,
    cost: f64,
}

/// The patches among these points where at least `bright` is bright and was not expected, the most
/// important first.
pub(crate) fn patches(points: &[BrightPoint], bright: f64) -> Vec<Portal> {
    let unexpected: Vec<BrightPoint> = points
        .iter()
        .copied()
        .filter(|point| point.second_moment.sqrt() >= bright && point.radiance >= bright)
        .collect();
    let all: f64 = points.iter().map(|point| point.second_moment).sum();
    let mut patches: Vec<Patch> = Patch::new(unexpected).into_iter().collect();
    let mut finished = Vec::new();
    while let Some(patch) = patches.pop() {
        match patch.divided() {
            Some(parts) => patches.extend(parts),
            None => finished.push(patch),
        }
    }
    finished.retain(|patch| {
        patch.second_moment() >= MIN_SURPRISE * all && patch.share_of_bright(points, bright) >= MIN_BRIGHT
    });
    finished.sort_by(|one, two| two.second_moment().total_cmp(&one.second_moment()));
    finished.iter().filter_map(Patch::portal).take(MAX_PATCHES).collect()
}

impl Patch {
    /// `None` for too few points.
    fn new(points: Vec<BrightPoint>) -> Option<Patch> {
        if points.len() < MIN_POINTS {
            return None;
        }
        // Half the side of the square that a point represents. Light outside the box is found by
        // chance only, so the box is rather too large.
        let mut sides: Vec<f64> = points.iter().map(|point| 0.5 * point.area.sqrt()).collect();
        sides.sort_unstable_by(f64::total_cmp);
        let margin = sides[sides.len() / 2];
        let (least, most) = points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(least, most), point| {
            (least.min(point.position), most.max(point.position))
        });
        let size = most - least;
        let thin = FLAT * size.max_element();
        let beyond = MARGIN.max(MARGIN_OF_FEW / points.len() as f64);
        let margins =
            DVec3::from_array(size.to_array().map(|size| if size <= thin { thin } else { margin.max(beyond * size) }));
        let (least, most) = (least - margins, most + margins);
        let size = most - least;
        let area = 0.5 * size.dot(DVec3::new(size.y, size.z, size.x));
        let squares: f64 = points.iter().map(|point| point.radiance * point.radiance * point.area).sum();
        Some(Patch { cost: (area * squares).sqrt(), points, bounds: [least, most], area })
    }

    /// Two patches, if these leave clearly less variance.
    fn divided(&self) -> Option<[Patch; 2]> {
        let mut best: Option<[Patch; 2]> = None;
        let mut lowest = (1.0 - MIN_GAIN) * self.cost;
        let [least, most] = self.bounds;
        for axis in 0..3 {
            for cut in 1..=CUTS {
                let cut = least[axis] + (most[axis] - least[axis]) * cut as f64 / (CUTS + 1) as f64;
                let (below, above): (Vec<_>, Vec<_>) = self.points.iter().partition(|point| point.position[axis] < cut);
                let (Some(below), Some(above)) = (Patch::new(below), Patch::new(above)) else { continue };
                let parts = [below, above];
                let cost = parts[0].cost + parts[1].cost;
                if cost < lowest {
                    lowest = cost;
                    best = Some(parts);
                }
            }
        }
        best
    }

    fn second_moment(&self) -> f64 {
        self.points.iter().map(|point| point.second_moment).sum()
    }

    /// The fraction of bright points among all points inside.
    fn share_of_bright(&self, points: &[BrightPoint], bright: f64) -> f64 {
        let [least, most] = self.bounds;
        let is_inside = |point: &&BrightPoint| point.position.cmpge(least).all() && point.position.cmple(most).all();
        let (mut inside, mut found) = (0.0_f64, 0.0);
        for point in points.iter().filter(is_inside) {
            inside += 1.0;
            found += f64::from(u8::from(point.radiance >= bright));
        }
        found / inside.max(1.0)
    }

    fn portal(&self) -> Option<Portal> {
        let power: f64 = self.points.iter().map(|point| point.radiance * point.area).sum();
        Portal::within(self.bounds, power / self.area)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_sampling::{DimensionSet, RaySampler};

    /// Points of a floor of 10 × 10, of which two small squares are bright.
    fn floor() -> Vec<BrightPoint> {
        let corners = [[1.0, 1.0], [6.0, 7.0]];
        (0..20_000)
            .map(|index| {
                let [x, y, ..] = RaySampler::new(1, index).take(DimensionSet::CAMERA).map(|u| 10.0 * u);
                let is_bright = corners.iter().any(|[left, low]| (x - left).abs() < 0.25 && (y - low).abs() < 0.25);
                let radiance = if is_bright { 50.0 } else { 0.5 };
                let position = DVec3::new(x, y, 0.0);
                BrightPoint { position, radiance, area: 0.005, second_moment: radiance * radiance }
            })
            .collect()
    }

    #[test]
    fn two_bright_squares_are_two_patches() {
        let patches = patches(&floor(), 3.0);
        assert_eq!(patches.len(), 2);
        for patch in patches {
            let center = patch.center.truncate();
            assert!(center.distance(glam::dvec2(1.0, 1.0)) < 0.05 || center.distance(glam::dvec2(6.0, 7.0)) < 0.05);
            assert!((0.3..0.5).contains(&patch.radius), "{patch:?}");
        }
    }

    #[test]
    fn points_that_are_bright_by_chance_are_no_patch() {
        let mut points = floor();
        for (index, point) in points.iter_mut().enumerate() {
            let radiance = if index % 10 == 0 { 30.0 } else { 0.5 };
            (point.radiance, point.second_moment) = (radiance, radiance * radiance);
        }
        assert!(patches(&points, 3.0).is_empty());
    }

    #[test]
    fn what_was_expected_is_no_patch() {
        let mut points = floor();
        points.iter_mut().for_each(|point| point.second_moment = 1.0);
        assert!(patches(&points, 3.0).is_empty());
    }
}
