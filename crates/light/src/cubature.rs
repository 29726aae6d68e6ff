//! Cubature over the part of a small disk that lights a point.
//!
//! The radiance of a uniform disk is constant within its cone of emission, so the part that lights
//! a point is the whole disk or its overlap with another disk. A lobe that is not much narrower
//! than the disk is a smooth function there, and a rule of a few nodes integrates it far more
//! accurately than as many samples.
//!
//! The error of a rule is known beforehand from the shape of the lobe: `exp(a·x − b·r²)` over the
//! unit disk, with a the gradient of its logarithm per radius and b its curvature. The rules are
//! chosen by `s² = a² + 8b`; the limits below are measured in the tests of this file.

use crate::disk_overlap::{DiskOverlap, Overlap};
use std::f64::consts::PI;

/// A node of a rule: a point of the unit disk and its share of the disk's area.
type UnitNode = [f64; 3];

/// Seven nodes, exact up to degree 5: Stroud, "Approximate Calculation of Multiple Integrals",
/// 1971, S₂ 5-1.
const DEGREE_5: [UnitNode; 7] = {
    // The outer nodes are a hexagon of radius √(2/3); its upper vertices are at √3/2 of that radius.
    let (radius, height) = (0.816_496_580_927_726, 0.707_106_781_186_547_5);
    let (half, share) = (0.5 * radius, 0.125);
    [
        [0.0, 0.0, 0.25],
        [radius, 0.0, share],
        [half, height, share],
        [-half, height, share],
        [-radius, 0.0, share],
        [-half, -height, share],
        [half, -height, share],
    ]
};

/// Twelve nodes, exact up to degree 7: Stroud, S₂ 7-1.
const DEGREE_7: [UnitNode; 12] = {
    let (on_axis, axis_share) = (0.866_025_403_784_438_6, 2.0 / 27.0);
    // √((27 ∓ 3√29)/104), with shares (551 ± 41√29)/6264.
    let (near, near_share) = (0.322_914_992_067_400_5, 0.123_210_689_191_014_48);
    let (far, far_share) = (0.644_171_310_389_464_5, 0.052_715_236_734_911_45);
    [
        [on_axis, 0.0, axis_share],
        [-on_axis, 0.0, axis_share],
        [0.0, on_axis, axis_share],
        [0.0, -on_axis, axis_share],
        [near, near, near_share],
        [near, -near, near_share],
        [-near, near, near_share],
        [-near, -near, near_share],
        [far, far, far_share],
        [far, -far, far_share],
        [-far, far, far_share],
        [-far, -far, far_share],
    ]
};

/// A rule for the whole disk.
struct WholeRule {
    nodes: &'static [UnitNode],
    /// The error relative to the integral is at most `factor·s^power`.
    factor: f64,
    power: i32,
}

const WHOLE_RULES: [WholeRule; 2] =
    [WholeRule { nodes: &DEGREE_5, factor: 2.2e-5, power: 6 }, WholeRule { nodes: &DEGREE_7, factor: 8e-8, power: 8 }];

/// A rule for an overlap: strips at the nodes of Gauss's rule in the angle along each arc, and
/// Gauss's rule across each strip.
struct OverlapRule {
    /// Number of strips up to 1 rad, up to 2 rad and beyond.
    strips: [usize; 3],
    across: usize,
    /// The error relative to the integral over the whole disk is at most `factor·(1 + s²)²`.
    factor: f64,
}

const OVERLAP_RULES: [OverlapRule; 3] = [
    OverlapRule { strips: [3, 4, 5], across: 3, factor: 4e-4 },
    OverlapRule { strips: [4, 5, 6], across: 4, factor: 2e-5 },
    OverlapRule { strips: [6, 7, 7], across: 5, factor: 3e-6 },
];

/// The error of the value at the centroid, relative to the integral over the whole disk, is at most
/// this times `s²`: a second moment is at most 1/4 along each axis of the unit disk, and half of it
/// counts.
const CENTROID_FACTOR: f64 = 0.13;

/// Allowed error of an overlap relative to that of a whole disk. Few points lie on the edge of a
/// cone, and the error changes its sign along the width of the edge.
const OVERLAP_TOLERANCE: f64 = 4.0;

/// Largest s for which the limits hold.
const LARGEST_SHAPE: f64 = 4.0;

/// Shape of the integrand over a disk.
#[derive(Clone, Copy, Debug)]
pub(crate) struct IntegrandShape {
    /// `s² = a² + 8b`; see the head of this file.
    squared: f64,
}

impl IntegrandShape {
    /// Of `exp(gradient·x − curvature·r²)` over the unit disk.
    pub(crate) fn new(gradient: f64, curvature: f64) -> IntegrandShape {
        IntegrandShape { squared: gradient * gradient + 8.0 * curvature.abs() }
    }
}

/// A rule for a part of a disk.
#[derive(Clone, Copy, Debug)]
pub(crate) enum DiskRule {
    /// Nothing is to be integrated.
    Empty,
    /// The value at the centroid, for nearly constant integrands: its x, and the area of the part.
    Centroid { x: f64, area: f64 },
    /// Index of the rule, and radius and offset of the disk.
    Whole { rule: usize, radius: f64, offset: f64 },
    /// Index of the rule.
    Part { rule: usize, overlap: DiskOverlap },
}

impl DiskRule {
    /// A rule whose error relative to the integral over the whole disk of radius `radius` is at
    /// most `tolerance`, times [`OVERLAP_TOLERANCE`] for a part of it; `None` if there is none.
    pub(crate) fn new(overlap: &Overlap, radius: f64, shape: IntegrandShape, tolerance: f64) -> Option<DiskRule> {
        match overlap {
            Overlap::None => return Some(DiskRule::Empty),
            _ if shape.squared > LARGEST_SHAPE * LARGEST_SHAPE || !shape.squared.is_finite() => return None,
            _ => {}
        }
        if CENTROID_FACTOR * shape.squared <= tolerance {
            return Some(match overlap {
                Overlap::Part(overlap) => DiskRule::Centroid { x: overlap.centroid(), area: overlap.area() },
                _ => DiskRule::Centroid { x: 0.0, area: PI * radius * radius },
            });
        }
        let whole = |radius: f64, offset: f64| {
            let is_exact = |rule: &WholeRule| rule.factor * shape.squared.powi(rule.power / 2) <= tolerance;
            let rule = WHOLE_RULES.iter().position(is_exact)?;
            Some(DiskRule::Whole { rule, radius, offset })
        };
        match overlap {
            Overlap::Part(overlap) if !overlap.is_nested() => {
                let error = (1.0 + shape.squared).powi(2);
                let rule =
                    OVERLAP_RULES.iter().position(|rule| rule.factor * error <= OVERLAP_TOLERANCE * tolerance)?;
                Some(DiskRule::Part { rule, overlap: *overlap })
            }
            Overlap::Part(overlap) => whole(overlap.large(), -overlap.offset()),
            _ => whole(radius, 0.0),
        }
    }

    /// Calls `visit` with the coordinates of each node and its area, in the frame of
    /// [`DiskOverlap`].
    #[inline]
    pub(crate) fn for_each_node(&self, mut visit: impl FnMut(f64, f64, f64)) {
        match self {
            DiskRule::Empty => {}
            DiskRule::Centroid { x, area } => visit(*x, 0.0, *area),
            DiskRule::Whole { rule, radius, offset } => {
                let area = PI * radius * radius;
                for [x, y, share] in WHOLE_RULES[*rule].nodes {
                    visit(x * radius + offset, y * radius, share * area);
                }
            }
            DiskRule::Part { rule, overlap } => {
                let [small, large] = overlap.arcs();
                OVERLAP_RULES[*rule].arc(small.angle, small.angle, |cosine, y, area| {
                    let radius = small.radius;
                    visit(-radius * cosine, radius * y, radius * radius * area);
                });
                // A flat arc is cut into strips by its extent in units of the small disk.
                let extent = large.angle * large.radius / small.radius;
                OVERLAP_RULES[*rule].arc(large.angle, extent, |cosine, y, area| {
                    let radius = large.radius;
                    visit(radius * cosine - overlap.offset(), radius * y, radius * radius * area);
                });
            }
        }
    }
}

impl OverlapRule {
    /// Visits the nodes of the segment of the unit disk within `angle` of its axis: cosine of the
    /// strip's angle, coordinate across, area.
    #[inline]
    fn arc(&self, angle: f64, extent: f64, mut visit: impl FnMut(f64, f64, f64)) {
        let strips = gauss(self.strips[usize::from(extent > 1.0) + usize::from(extent > 2.0)]);
        let across = gauss(self.across);
        for [at, along] in strips {
            let (sin, cos) = (at * angle).sin_cos();
            let width = along * angle * sin * 2.0 * sin;
            for [at, weight] in across {
                visit(cos, (2.0 * at - 1.0) * sin, width * weight);
            }
        }
    }
}

/// Nodes and weights of Gauss's rule on the unit interval, for 3 to 7 nodes.
fn gauss(nodes: usize) -> &'static [[f64; 2]] {
    GAUSS[nodes - 3]
}

const GAUSS: [&[[f64; 2]]; 5] = [
    &[
        [0.112_701_665_379_258_3, 0.277_777_777_777_777_85],
        [0.5, 0.444_444_444_444_444_4],
        [0.887_298_334_620_741_7, 0.277_777_777_777_777_85],
    ],
    &[
        [0.069_431_844_202_973_71, 0.173_927_422_568_726_79],
        [0.330_009_478_207_571_87, 0.326_072_577_431_273_2],
        [0.669_990_521_792_428_1, 0.326_072_577_431_273_2],
        [0.930_568_155_797_026_2, 0.173_927_422_568_726_79],
    ],
    &[
        [0.046_910_077_030_668_02, 0.118_463_442_528_094_64],
        [0.230_765_344_947_158_45, 0.239_314_335_249_683_15],
        [0.5, 0.284_444_444_444_444_33],
        [0.769_234_655_052_841_5, 0.239_314_335_249_683_15],
        [0.953_089_922_969_331_9, 0.118_463_442_528_094_64],
    ],
    &[
        [0.033_765_242_898_424_03, 0.085_662_246_189_585_14],
        [0.169_395_306_766_867_76, 0.180_380_786_524_069_36],
        [0.380_690_406_958_401_56, 0.233_956_967_286_345_52],
        [0.619_309_593_041_598_5, 0.233_956_967_286_345_52],
        [0.830_604_693_233_132_2, 0.180_380_786_524_069_36],
        [0.966_234_757_101_575_9, 0.085_662_246_189_585_14],
    ],
    &[
        [0.025_446_043_828_620_7, 0.064_742_483_084_434_87],
        [0.129_234_407_200_302_77, 0.139_852_695_744_638_43],
        [0.297_077_424_311_301_4, 0.190_915_025_252_559_35],
        [0.5, 0.208_979_591_836_734_65],
        [0.702_922_575_688_698_5, 0.190_915_025_252_559_35],
        [0.870_765_592_799_697_2, 0.139_852_695_744_638_43],
        [0.974_553_956_171_379_3, 0.064_742_483_084_434_87],
    ],
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Sum of `value` over the nodes of a rule.
    fn integral(rule: &DiskRule, value: impl Fn(f64, f64) -> f64) -> f64 {
        let mut sum = 0.0;
        rule.for_each_node(|x, y, area| sum += area * value(x, y));
        sum
    }

    /// The same over the overlap by strips of equal width.
    fn brute_force([small, large, offset]: [f64; 3], value: impl Fn(f64, f64) -> f64) -> f64 {
        let (strips, across) = (2000, 60);
        let (left, right) = ((-small).max(-large - offset), small.min(large - offset));
        let mut sum = 0.0;
        for strip in 0..strips {
            // The widths vanish at both ends as the sine does.
            let angle = PI * (f64::from(strip) + 0.5) / f64::from(strips);
            let x = 0.5 * (left + right) - 0.5 * (right - left) * angle.cos();
            let width = 0.5 * (right - left) * angle.sin() * PI / f64::from(strips);
            let half = (small * small - x * x).min(large * large - (x + offset).powi(2)).max(0.0).sqrt();
            for step in 0..across {
                let y = half * (2.0 * (f64::from(step) + 0.5) / f64::from(across) - 1.0);
                sum += width * 2.0 * half / f64::from(across) * value(x, y);
            }
        }
        sum
    }

    fn lobe(gradient: f64, turn: f64, curvature: f64) -> impl Fn(f64, f64) -> f64 {
        let (sin, cos) = turn.sin_cos();
        move |x, y| (gradient * (cos * x + sin * y) - curvature * (x * x + y * y)).exp()
    }

    /// The mean of `x^i·y^j` over the unit disk.
    fn moment(i: i32, j: i32) -> f64 {
        if i % 2 == 1 || j % 2 == 1 {
            return 0.0;
        }
        let odd = |n: i32| (1..n).step_by(2).map(f64::from).product::<f64>();
        // ⟨r^(i+j)⟩ times the mean over the circle.
        let even: f64 = (2..=i + j).step_by(2).map(f64::from).product();
        2.0 / f64::from(i + j + 2) * odd(i) * odd(j) / even
    }

    #[test]
    fn rules_for_the_disk_are_exact_up_to_their_degree() {
        for (rule, degree) in [(0, 5), (1, 7)] {
            let rule = DiskRule::Whole { rule, radius: 1.0, offset: 0.0 };
            for (i, j) in (0..=degree).flat_map(|i| (0..=degree - i).map(move |j| (i, j))) {
                let mean = integral(&rule, |x, y| x.powi(i) * y.powi(j)) / PI;
                assert!((mean - moment(i, j)).abs() < 1e-14, "x^{i} y^{j}: {mean}, not {}", moment(i, j));
            }
        }
    }

    #[test]
    fn the_error_over_a_disk_is_within_its_limit() {
        for (index, limits) in WHOLE_RULES.iter().enumerate() {
            let rule = DiskRule::Whole { rule: index, radius: 1.0, offset: 0.0 };
            let cases = [(0.5, 0.0), (1.8, 0.2), (2.2, 0.2), (0.0, 1.0), (2.5, 0.8), (3.5, 0.0)];
            for (gradient, curvature) in cases {
                let squared = IntegrandShape::new(gradient, curvature).squared;
                let limit = limits.factor * squared.powi(limits.power / 2);
                for turn in [0.0, 0.3, PI / 6.0, PI / 4.0] {
                    let truth = brute_force([1.0, 3.0, 0.0], lobe(gradient, turn, curvature));
                    let error = integral(&rule, lobe(gradient, turn, curvature)) / truth - 1.0;
                    assert!(error.abs() < limit + 2e-5, "rule {index}, {gradient} {curvature}: {error}, not {limit}");
                }
            }
        }
    }

    #[test]
    fn the_areas_of_a_rule_add_up_to_that_of_the_overlap() {
        for [small, large, offset] in [[1.0, 10.0, 9.5], [1.0, 10.0, 10.4], [1.0, 1.5, 1.0], [2.0, 1.0, 1.7]] {
            let Overlap::Part(overlap) = Overlap::new(small, large, offset) else { panic!("a part overlaps") };
            for (rule, slack) in [(0, 2e-3), (1, 2e-4), (2, 2e-5)] {
                let sum = integral(&DiskRule::Part { rule, overlap }, |_, _| 1.0);
                assert!((sum - overlap.area()).abs() < slack * PI * small * small, "{sum}, not {}", overlap.area());
            }
        }
    }

    #[test]
    fn the_error_over_an_overlap_is_within_its_limit() {
        for (large, share) in
            [1.2, 3.0, 12.0, 60.0].into_iter().flat_map(|large| [0.1, 0.4, 0.7, 0.95].map(|s| (large, s)))
        {
            let offset = large - 1.0 + 2.0 * share;
            let Overlap::Part(overlap) = Overlap::new(1.0, large, offset) else { panic!("a part overlaps") };
            for (gradient, turn) in [(0.0, 0.0), (1.8, 0.0), (1.8, PI), (2.5, 1.0), (3.0, PI)] {
                let whole = brute_force([1.0, 10.0, 0.0], lobe(gradient, turn, 0.2));
                let truth = brute_force([1.0, large, offset], lobe(gradient, turn, 0.2));
                let error = (1.0 + IntegrandShape::new(gradient, 0.2).squared).powi(2);
                for (rule, limits) in OVERLAP_RULES.iter().enumerate() {
                    let miss = (integral(&DiskRule::Part { rule, overlap }, lobe(gradient, turn, 0.2)) - truth) / whole;
                    let limit = limits.factor * error + 2e-5;
                    assert!(miss.abs() < limit, "rule {rule}, {large} {share} {gradient} {turn}: {miss}, not {limit}");
                }
            }
        }
    }

    #[test]
    fn the_error_of_the_centroid_is_within_its_limit() {
        for [large, offset] in [[3.0, 0.0], [12.0, 11.4], [12.0, 12.6], [1.2, 0.9], [0.6, 0.3]] {
            for (gradient, turn, curvature) in [(0.1, 0.0, 0.0), (0.3, 1.0, 0.0), (0.2, 3.0, 0.02), (0.0, 0.0, 0.05)] {
                let shape = IntegrandShape::new(gradient, curvature);
                let limit = CENTROID_FACTOR * shape.squared;
                let rule =
                    DiskRule::new(&Overlap::new(1.0, large, offset), 1.0, shape, limit).expect("it is exact enough");
                assert!(matches!(rule, DiskRule::Centroid { .. }));
                let truth = brute_force([1.0, large, offset], lobe(gradient, turn, curvature));
                let error = (integral(&rule, lobe(gradient, turn, curvature)) - truth) / PI;
                assert!(error.abs() < 1.05 * limit + 2e-5, "{large} {offset} {gradient}: {error}, not {limit}");
            }
        }
    }

    #[test]
    fn a_narrow_lobe_has_no_rule_and_darkness_needs_none() {
        let narrow = IntegrandShape::new(5.0, 0.0);
        assert!(DiskRule::new(&Overlap::Whole, 1.0, narrow, 0.1).is_none());
        assert!(matches!(DiskRule::new(&Overlap::None, 1.0, narrow, 1e-9), Some(DiskRule::Empty)));
        assert!(DiskRule::new(&Overlap::Whole, 1.0, IntegrandShape::new(2.0, 0.0), 1e-9).is_none());
    }
}
