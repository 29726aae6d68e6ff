//! The part of a disk in a polygon.

use glam::{DMat2, DVec2};
use std::f64::consts::PI;

/// Area and first moments of the part of the unit disk that a polygon contains, relative to the area
/// of the disk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct DiskOverlap {
    /// From 0 to 1.
    pub(crate) area: f64,
    /// The integral of the position.
    pub(crate) moment: DVec2,
}

impl DiskOverlap {
    /// The mean of some.
    pub(crate) fn mean<const COUNT: usize>(overlaps: [DiskOverlap; COUNT]) -> DiskOverlap {
        let share = 1.0 / COUNT as f64;
        let add = |sum: DiskOverlap, next: DiskOverlap| DiskOverlap {
            area: sum.area + share * next.area,
            moment: sum.moment + share * next.moment,
        };
        overlaps.into_iter().fold(DiskOverlap::default(), add)
    }

    /// For the corners of a convex polygon in order.
    pub(crate) fn new(corners: &[DVec2]) -> DiskOverlap {
        let mut sum = Sum::default();
        for (index, corner) in corners.iter().enumerate() {
            sum.add_edge(*corner, corners[(index + 1) % corners.len()]);
        }
        // The sign is that of the sense of the corners.
        let unit = sum.area.signum() / PI;
        DiskOverlap { area: unit * sum.area, moment: unit * sum.moment }
    }
}

/// Parallelograms of one size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parallelogram {
    /// Half of its sides.
    half: [DVec2; 2],
    /// Relative to that of the unit disk.
    area: f64,
    /// Distance of the farthest corner from the middle.
    reach: f64,
}

impl Parallelogram {
    /// The image of the unit square.
    pub(crate) fn new(map: DMat2) -> Parallelogram {
        let half @ [x, y] = [0.5 * map.x_axis, 0.5 * map.y_axis];
        let area = map.determinant().abs() / PI;
        Parallelogram { half, area, reach: (x + y).length().max((x - y).length()) }
    }

    /// The part of the unit disk in the one around a point.
    pub(crate) fn overlap(&self, middle: DVec2) -> DiskOverlap {
        let distance = middle.length();
        if distance + self.reach <= 1.0 {
            return DiskOverlap { area: self.area, moment: self.area * middle };
        }
        if distance >= 1.0 + self.reach {
            return DiskOverlap::default();
        }
        let [x, y] = self.half;
        DiskOverlap::new(&[-x - y, x - y, x + y, y - x].map(|corner| middle + corner))
    }
}

/// Signed sums over the triangles and sectors between the centre and the outline (Green's theorem).
#[derive(Default)]
struct Sum {
    area: f64,
    moment: DVec2,
}

impl Sum {
    fn add_edge(&mut self, from: DVec2, to: DVec2) {
        let along = to - from;
        // Where the line passes the circle: |from + t·along| = 1.
        let [a, b, c] = [along.length_squared(), from.dot(along), from.length_squared() - 1.0];
        let discriminant = b * b - a * c;
        if a == 0.0 {
            return;
        }
        if discriminant <= 0.0 {
            return self.add_sector(from, to);
        }
        let root = discriminant.sqrt();
        let [enters, leaves] = [(-b - root) / a, (-b + root) / a].map(|t| from + t.clamp(0.0, 1.0) * along);
        self.add_sector(from, enters);
        self.add_triangle(enters, leaves);
        self.add_sector(leaves, to);
    }

    fn add_triangle(&mut self, from: DVec2, to: DVec2) {
        let area = 0.5 * from.perp_dot(to);
        self.area += area;
        self.moment += area * (from + to) / 3.0;
    }

    /// Of the unit disk, between two directions less than half a turn apart.
    fn add_sector(&mut self, from: DVec2, to: DVec2) {
        let angle = from.perp_dot(to).atan2(from.dot(to));
        if angle != 0.0 {
            let turned = from.normalize() - to.normalize();
            self.area += 0.5 * angle;
            self.moment += DVec2::new(-turned.y, turned.x) / 3.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the centres of small squares.
    fn counted(corners: &[DVec2]) -> DiskOverlap {
        let steps = 1000;
        let mut sum = DiskOverlap::default();
        for (x, y) in (0..2 * steps).flat_map(|x| (0..2 * steps).map(move |y| (x, y))) {
            let at = (DVec2::new(f64::from(x), f64::from(y)) + 0.5) / f64::from(steps) - 1.0;
            let is_left = |index: usize| {
                let (from, to) = (corners[index], corners[(index + 1) % corners.len()]);
                (to - from).perp_dot(at - from) > 0.0
            };
            let left = (0..corners.len()).filter(|index| is_left(*index)).count();
            if at.length_squared() < 1.0 && (left == 0 || left == corners.len()) {
                let area = f64::from(steps * steps).recip() / PI;
                sum = DiskOverlap { area: sum.area + area, moment: sum.moment + area * at };
            }
        }
        sum
    }

    #[test]
    fn overlaps_agree_with_counted_points() {
        let square = |x: f64, y: f64, side: f64| {
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|corner| DVec2::new(x, y) + side * DVec2::from(corner))
        };
        let slanted = [[0.2, -1.3], [0.9, 0.1], [-0.3, 0.8], [-1.2, -0.4]].map(DVec2::from);
        let mut reversed = slanted;
        reversed.reverse();
        let inside = square(-0.3, 0.1, 0.4);
        for corners in
            [square(0.1, 0.2, 1.5), square(-0.9, -0.95, 0.3), square(0.6, 0.6, 1.0), inside, slanted, reversed]
        {
            let (found, expected) = (DiskOverlap::new(&corners), counted(&corners));
            assert!((found.area - expected.area).abs() < 1e-3, "{found:?} for {expected:?}");
            assert!(found.moment.distance(expected.moment) < 1e-3, "{found:?} for {expected:?}");
        }
    }

    #[test]
    fn a_parallelogram_overlaps_as_its_corners_do() {
        let map = DMat2::from_cols(DVec2::new(0.3, 0.1), DVec2::new(-0.15, 0.25));
        for (x, y) in (-14..15).flat_map(|x| (-14..15).map(move |y| (x, y))) {
            let middle = 0.1 * DVec2::new(f64::from(x), f64::from(y));
            let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y].map(|corner| middle + map * (corner - 0.5));
            let (found, expected) = (Parallelogram::new(map).overlap(middle), DiskOverlap::new(&corners));
            assert!((found.area - expected.area).abs() < 1e-14, "{middle}");
            assert!(found.moment.distance(expected.moment) < 1e-14, "{middle}");
        }
    }

    #[test]
    fn the_squares_of_a_grid_make_up_the_disk() {
        let side = 0.31;
        let mut sum = DiskOverlap::default();
        for (x, y) in (-5..5).flat_map(|x| (-5..5).map(move |y| (x, y))) {
            let least = DVec2::new(f64::from(x) + 0.4, f64::from(y) - 0.2) * side;
            let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y].map(|corner| least + side * corner);
            let overlap = DiskOverlap::new(&corners);
            sum = DiskOverlap { area: sum.area + overlap.area, moment: sum.moment + overlap.moment };
        }
        assert!((sum.area - 1.0).abs() < 1e-12 && sum.moment.length() < 1e-12, "{sum:?}");
        let far = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y].map(|corner| corner + 2.0);
        assert!(DiskOverlap::new(&far).area.abs() < 1e-15);
    }
}
