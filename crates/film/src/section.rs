//! Convex polygons in a pixel, and area-preserving maps from the unit square to them and to the
//! rest of the pixel.
//!
//! A map takes the first coordinate to a vertical line, with a density proportional to the length of
//! its section, and the second to a point of the section. Sections of polygons are linear between
//! their corners, so the density is integrated and inverted exactly.

use glam::DVec2;

/// Intervals narrower than this are rounding errors.
const MIN_WIDTH: f64 = 1e-12;

/// Corners nearer to each other than this are one: rounding would turn the edge between them.
const MIN_EDGE: f64 = 1e-6;

/// A convex polygon with its corners counter-clockwise; empty if there are fewer than three.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ConvexPolygon(Vec<DVec2>);

impl ConvexPolygon {
    /// The convex hull of points (Andrew 1979).
    pub(crate) fn hull(mut points: Vec<DVec2>) -> ConvexPolygon {
        points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        let chain = |points: &mut dyn Iterator<Item = DVec2>| {
            let mut chain: Vec<DVec2> = Vec::new();
            for point in points {
                while let [.., before, last] = chain[..]
                    && (last - before).perp_dot(point - last) <= 0.0
                {
                    chain.pop();
                }
                if chain.last().is_none_or(|last| last.distance_squared(point) > MIN_EDGE * MIN_EDGE) {
                    chain.push(point);
                }
            }
            chain.pop();
            chain
        };
        let mut hull = chain(&mut points.iter().copied());
        hull.extend(chain(&mut points.iter().rev().copied()));
        ConvexPolygon(hull)
    }

    pub(crate) fn square() -> ConvexPolygon {
        ConvexPolygon([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(DVec2::from).to_vec())
    }

    pub(crate) fn corners(&self) -> &[DVec2] {
        &self.0
    }

    /// The lowest and the highest coordinates; infinite without corners.
    pub(crate) fn bounds(&self) -> [DVec2; 2] {
        let [low, high] = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        self.0.iter().fold([low, high], |[low, high], at| [low.min(*at), high.max(*at)])
    }

    pub(crate) fn map(&self, map: impl Fn(DVec2) -> DVec2) -> ConvexPolygon {
        ConvexPolygon(self.0.iter().map(|corner| map(*corner)).collect())
    }

    fn edges(&self) -> impl Iterator<Item = [DVec2; 2]> {
        let next = self.0.iter().cycle().skip(1);
        self.0.iter().zip(next).map(|(from, to)| [*from, *to])
    }

    pub(crate) fn area(&self) -> f64 {
        0.5 * self.edges().map(|[from, to]| from.perp_dot(to)).sum::<f64>()
    }

    /// The smallest distance of two parallel lines with the polygon between them.
    pub(crate) fn width(&self) -> f64 {
        let height = |[from, to]: [DVec2; 2]| {
            let normal = (to - from).perp().normalize_or_zero();
            self.0.iter().map(|at| normal.dot(*at - from)).fold(0.0, f64::max)
        };
        self.edges().map(height).reduce(f64::min).unwrap_or(0.0)
    }

    /// The part inside another convex polygon (Sutherland and Hodgman 1974).
    pub(crate) fn clipped(&self, by: &ConvexPolygon) -> ConvexPolygon {
        let inside = |[start, end]: [DVec2; 2]| move |point: DVec2| (end - start).perp_dot(point - start);
        by.edges().fold(self.clone(), |polygon, edge| polygon.where_positive(inside(edge)))
    }

    /// The part between two vertical coordinates.
    pub(crate) fn between(&self, low: f64, high: f64) -> ConvexPolygon {
        self.where_positive(|point| point.y - low).where_positive(|point| high - point.y)
    }

    /// The part in which a linear function is not negative.
    fn where_positive(&self, inside: impl Fn(DVec2) -> f64) -> ConvexPolygon {
        let mut kept = Vec::with_capacity(self.0.len() + 1);
        for [from, to] in self.edges() {
            let [a, b] = [from, to].map(&inside);
            if a >= 0.0 {
                kept.push(from);
            }
            if a * b < 0.0 {
                kept.push(from.lerp(to, a / (a - b)));
            }
        }
        ConvexPolygon(kept)
    }

    /// Whether a polygon lies entirely inside this one.
    pub(crate) fn holds(&self, other: &ConvexPolygon) -> bool {
        self.edges().all(|[from, to]| other.0.iter().all(|corner| (to - from).perp_dot(*corner - from) >= 0.0))
    }
}

/// Lengths of the vertical sections of a region, linear in intervals.
#[derive(Clone, Debug, Default)]
struct Density {
    /// Start and end of each interval, and the lengths there.
    intervals: Vec<[[f64; 2]; 2]>,
    /// Area up to the end of each interval.
    cumulative: Vec<f64>,
}

impl Density {
    fn new(intervals: Vec<[[f64; 2]; 2]>) -> Density {
        let mut area = 0.0;
        let cumulative = intervals.iter().map(|[[start, end], lengths]| {
            area += 0.5 * (end - start) * (lengths[0] + lengths[1]);
            area
        });
        Density { cumulative: cumulative.collect(), intervals }
    }

    fn area(&self) -> f64 {
        self.cumulative.last().copied().unwrap_or(0.0)
    }

    /// The coordinate for a fraction of the area.
    fn place(&self, u: f64) -> Option<f64> {
        let wanted = u * self.area();
        let interval =
            self.cumulative.partition_point(|area| *area <= wanted).min(self.intervals.len().checked_sub(1)?);
        let before = interval.checked_sub(1).map_or(0.0, |before| self.cumulative[before]);
        let ([[start, end], [first, last]], area) = (self.intervals[interval], (wanted - before).max(0.0));
        // first·x + (last − first)·x²/(2·width) = area, in the form that is stable for equal lengths.
        let width = end - start;
        let root = (first * first + 2.0 * (last - first) / width * area).max(0.0).sqrt();
        let x = if first + root > 0.0 { 2.0 * area / (first + root) } else { 0.0 };
        Some(start + x.min(width))
    }
}

/// The vertical sections of a convex polygon.
#[derive(Clone, Debug)]
pub(crate) struct Sections {
    /// Start and end of each interval, the lower ends of the sections there, and the upper ones.
    intervals: Vec<[[f64; 2]; 3]>,
    density: Density,
}

impl Sections {
    pub(crate) fn new(polygon: &ConvexPolygon) -> Sections {
        let mut places: Vec<f64> = polygon.0.iter().map(|corner| corner.x).collect();
        places.sort_by(f64::total_cmp);
        let intervals: Vec<[[f64; 2]; 3]> = (places.windows(2))
            .filter(|pair| pair[1] - pair[0] > MIN_WIDTH)
            .map(|pair| {
                let ends = [pair[0], pair[1]].map(|x| polygon.section(x, 0.5 * (pair[0] + pair[1])));
                [[pair[0], pair[1]], ends.map(|section| section[0]), ends.map(|section| section[1])]
            })
            .collect();
        let length = |[places, low, high]: &[[f64; 2]; 3]| [*places, [0, 1].map(|end| (high[end] - low[end]).max(0.0))];
        Sections { density: Density::new(intervals.iter().map(length).collect()), intervals }
    }

    /// A point of the polygon, for a point of the unit square.
    pub(crate) fn point(&self, [u, v]: [f64; 2]) -> Option<[f64; 2]> {
        let x = self.density.place(u)?;
        let [low, high] = self.at(x)?;
        Some([x, low + v * (high - low)])
    }

    /// The section at a coordinate; `None` beside the polygon.
    fn at(&self, x: f64) -> Option<[f64; 2]> {
        let [[start, end], low, high] =
            self.intervals.iter().find(|[[start, end], ..]| (*start..=*end).contains(&x))?;
        let share = (x - start) / (end - start);
        Some([low, high].map(|ends| ends[0] + share * (ends[1] - ends[0])))
    }
}

impl ConvexPolygon {
    /// The section at a coordinate by the edges over the middle of an interval.
    fn section(&self, x: f64, middle: f64) -> [f64; 2] {
        let mut section = [0.0; 2];
        for [from, to] in self.edges() {
            if (from.x.min(to.x)..from.x.max(to.x)).contains(&middle) {
                // Counter-clockwise, the lower edges lead to the right.
                let upper = usize::from(to.x < from.x);
                section[upper] = from.y + (to.y - from.y) * ((x - from.x) / (to.x - from.x));
            }
        }
        section
    }
}

/// A partition of the unit square into disjoint convex polygons and the rest.
#[derive(Clone, Debug)]
pub(crate) struct Partition {
    polygons: Vec<Sections>,
    /// The share of each polygon in the points of all.
    shares: Vec<f64>,
    rest: Density,
}

/// Fraction of the points of the unit square that are mapped to the rest. A power of two: then the
/// low-discrepancy sequence divides the points exactly, from the first two on.
const REST: f64 = 0.5;

/// Fraction of the polygons' points that is distributed by area, the others evenly.
const BY_AREA: f64 = 0.5;

impl Partition {
    /// `None` without polygons. They must not overlap, and must lie within the square.
    pub(crate) fn new(polygons: &[ConvexPolygon]) -> Option<Partition> {
        let polygons: Vec<Sections> =
            polygons.iter().map(Sections::new).filter(|one| one.density.area() > 0.0).collect();
        let (count, area) = (polygons.len() as f64, polygons.iter().map(|one| one.density.area()).sum::<f64>());
        let share = |one: &Sections| BY_AREA * one.density.area() / area + (1.0 - BY_AREA) / count;
        let (shares, rest) = (polygons.iter().map(share).collect(), rest_of(&polygons));
        (!polygons.is_empty()).then_some(Partition { polygons, shares, rest })
    }

    /// A point of the square and its weight, for a point of the unit square that is uniformly
    /// distributed.
    pub(crate) fn point(&self, [u, v]: [f64; 2]) -> Option<([f64; 2], f64)> {
        if u < REST {
            let x = self.rest.place(u / REST)?;
            return Some(([x, self.beside(x, v)], self.rest.area() / REST));
        }
        let (chosen, u) = radsight_sampling::choose(self.shares.iter().copied(), (u - REST) / (1.0 - REST))?;
        let sections = &self.polygons[chosen];
        let weight = sections.density.area() / (self.shares[chosen] * (1.0 - REST));
        Some((sections.point([u, v])?, weight))
    }

    /// A point outside the polygons, for a point of the unit square.
    pub(crate) fn outside(&self, [u, v]: [f64; 2]) -> Option<[f64; 2]> {
        self.point([REST * u, v]).map(|(at, _)| at)
    }

    /// A point of the first polygon.
    pub(crate) fn inside(&self, u: [f64; 2]) -> Option<[f64; 2]> {
        self.polygons.first()?.point(u)
    }

    /// The point at a fraction of the part of a vertical line that lies outside the polygons.
    fn beside(&self, x: f64, v: f64) -> f64 {
        let mut sections: Vec<[f64; 2]> = self.polygons.iter().filter_map(|polygon| polygon.at(x)).collect();
        sections.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let free = 1.0 - sections.iter().map(|[low, high]| high - low).sum::<f64>();
        let mut y = v * free;
        for [low, high] in sections {
            if y >= low {
                y += high - low;
            }
        }
        y.clamp(0.0, 1.0)
    }
}

/// The sections of the square outside the polygons.
fn rest_of(polygons: &[Sections]) -> Density {
    let mut places: Vec<f64> = polygons.iter().flat_map(|one| &one.intervals).flat_map(|[ends, ..]| *ends).collect();
    places.extend([0.0, 1.0]);
    places.sort_by(f64::total_cmp);
    let covered = |x: f64, middle: f64| {
        let lengths = polygons.iter().flat_map(|one| &one.density.intervals).map(|[[start, end], lengths]| {
            let is_here = (*start..=*end).contains(&middle);
            if is_here { lengths[0] + (lengths[1] - lengths[0]) * (x - start) / (end - start) } else { 0.0 }
        });
        lengths.sum::<f64>()
    };
    let interval = |pair: &[f64]| {
        let middle = 0.5 * (pair[0] + pair[1]);
        [[pair[0], pair[1]], [pair[0], pair[1]].map(|x| (1.0 - covered(x, middle)).max(0.0))]
    };
    Density::new(places.windows(2).filter(|pair| pair[1] - pair[0] > MIN_WIDTH).map(interval).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(points: &[[f64; 2]]) -> ConvexPolygon {
        ConvexPolygon::hull(points.iter().copied().map(DVec2::from).collect())
    }

    fn cases() -> Vec<Vec<ConvexPolygon>> {
        let triangle = polygon(&[[0.1, 0.2], [0.8, 0.3], [0.4, 0.9]]);
        let small = polygon(&[[0.9, 0.9], [0.95, 0.9], [0.95, 0.93], [0.9, 0.94]]);
        let strip = polygon(&[[0.0, 0.0], [1.0, 0.05], [1.0, 0.1], [0.0, 0.02]]);
        vec![
            vec![triangle.clone()],
            vec![polygon(&[[0.0, 0.0], [0.5, 0.0], [0.5, 1.0], [0.0, 1.0]])],
            vec![triangle, small, strip],
        ]
    }

    fn is_in(polygon: &ConvexPolygon, at: [f64; 2]) -> bool {
        polygon.edges().all(|[from, to]| (to - from).perp_dot(DVec2::from(at) - from) >= 0.0)
    }

    #[test]
    fn the_hull_of_points_is_convex_and_holds_them() {
        let points = [[0.0, 0.0], [0.5, 0.1], [1.0, 0.0], [0.5, 0.5], [0.9, 0.8], [0.2, 0.7], [1.0, 0.0]];
        let hull = polygon(&points);
        assert!(points.iter().all(|point| is_in(&hull, *point)));
        assert_eq!(hull.corners().len(), 4);
        assert!((polygon(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).area()).abs() < 1e-15);
    }

    #[test]
    fn rounding_of_equal_points_turns_no_edge() {
        let corners = [[10.0, 10.0], [20.0, 10.0], [20.0, 20.0], [10.0, 20.0]];
        let rounded = (0..64).map(|step: u32| {
            let off = |shift: u32| f64::from(step.wrapping_mul(2_654_435_761) >> shift & 7) * 1e-14;
            let [x, y] = corners[step as usize % 4];
            [x + off(5), y + off(11)]
        });
        let frame = polygon(&rounded.collect::<Vec<_>>());
        let light = polygon(&[[12.0, 12.0], [12.1, 12.0], [12.0, 12.1]]);
        assert!((light.clipped(&frame).area() - light.area()).abs() < 1e-12, "{frame:?}");
    }

    #[test]
    fn a_width_is_the_smallest_one() {
        let strip = polygon(&[[0.0, 0.0], [4.0, 3.0], [4.0 - 0.3, 3.0 + 0.4], [-0.3, 0.4]]);
        assert!((strip.width() - 0.5).abs() < 1e-12, "{}", strip.width());
        assert_eq!(polygon(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).width(), 0.0);
    }

    #[test]
    fn clipping_leaves_the_common_part() {
        let diamond = polygon(&[[0.5, -0.5], [1.5, 0.5], [0.5, 1.5], [-0.5, 0.5]]);
        let clipped = diamond.clipped(&ConvexPolygon::square());
        assert!((clipped.area() - 1.0).abs() < 1e-12, "{clipped:?}");
        let half = diamond.map(|at| at + DVec2::new(1.0, 0.0)).clipped(&ConvexPolygon::square());
        assert!((half.area() - 0.25).abs() < 1e-12, "{half:?}");
        assert!(polygon(&[[2.0, 2.0], [3.0, 2.0], [3.0, 3.0]]).clipped(&ConvexPolygon::square()).area() == 0.0);
    }

    #[test]
    fn points_of_a_partition_integrate_any_function_over_the_square() {
        let side = 512;
        for polygons in cases() {
            let partition = Partition::new(&polygons).unwrap();
            let value = |at: [f64; 2]| {
                let bright = polygons.iter().position(|polygon| is_in(polygon, at));
                (1.0 + at[0] + 0.3 * at[1] * at[1]) * bright.map_or(1.0, |index| 100.0 * (1.0 + index as f64))
            };
            let (mut found, mut expected) = (0.0, 0.0);
            for index in 0..side * side {
                let at = [index % side, index / side].map(|index| (f64::from(index) + 0.5) / f64::from(side));
                let (point, weight) = partition.point(at).unwrap();
                found += weight * value(point);
                expected += value(at);
            }
            assert!((found / expected - 1.0).abs() < 3e-3, "{found} for {expected}: {polygons:?}");
        }
    }

    #[test]
    fn a_point_lies_in_the_region_that_its_first_coordinate_chooses() {
        for polygons in cases() {
            let partition = Partition::new(&polygons).unwrap();
            for index in 0..10_000 {
                let u = [f64::from(index % 100) / 100.0 + 0.004, f64::from(index / 100) / 100.0 + 0.006];
                let (at, weight) = partition.point(u).unwrap();
                let inside = polygons.iter().any(|polygon| is_in(polygon, at));
                assert_eq!(inside, u[0] >= REST, "{u:?} is {at:?} with {weight}");
            }
        }
    }
}
