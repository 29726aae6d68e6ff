//! Overlap of two disks: the part of a round source with a sharp cone that lights a point.

use crate::lobe_weighting::{exponential, exponential_pdf};
use std::f64::consts::PI;

/// Intersection of the disk of radius `small` at the origin with the disk of radius `large` at
/// `(-offset, 0)`, `offset ≥ 0`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DiskOverlap {
    small: f64,
    large: f64,
    offset: f64,
    /// x of the crossing of the circles.
    crossing: f64,
    /// Area left of the crossing of the circles. The small circle bounds the overlap there, the
    /// large one to the right.
    left_area: f64,
    /// Area of the overlap.
    area: f64,
}

/// An arc about the axis through both centres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arc {
    pub(crate) radius: f64,
    /// Half its angle, radians.
    pub(crate) angle: f64,
}

/// Part of the small disk that overlaps the large one.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Overlap {
    None,
    /// The whole small disk.
    Whole,
    Part(DiskOverlap),
}

impl Overlap {
    #[inline]
    pub(crate) fn new(small: f64, large: f64, offset: f64) -> Overlap {
        if offset + small <= large {
            return Overlap::Whole;
        }
        if offset >= small + large {
            return Overlap::None;
        }
        if offset + large <= small {
            // The large disk lies inside the small one: the circles do not cross.
            let overlap =
                DiskOverlap { small, large, offset, crossing: -small, left_area: 0.0, area: PI * large * large };
            return Overlap::Part(overlap);
        }
        // x² + y² = small² and (x + offset)² + y² = large².
        let crossing = (large * large - small * small - offset * offset) / (2.0 * offset);
        let left_area = segment(small, crossing);
        let right_area = PI * large * large - segment(large, crossing + offset);
        Overlap::Part(DiskOverlap { small, large, offset, crossing, left_area, area: left_area + right_area })
    }
}

/// Area left of `x` of a disk of this radius about the origin.
fn segment(radius: f64, x: f64) -> f64 {
    let x = x.clamp(-radius, radius);
    let height = (radius * radius - x * x).max(0.0).sqrt();
    radius * radius * (PI - height.atan2(x)) + x * height
}

/// Inverse of [`segment`]: the x left of which a disk of this radius has this area, by Newton's
/// method within a bracket.
fn inverse_segment(radius: f64, area: f64) -> f64 {
    let (mut low, mut high) = (-radius, radius);
    let mut x = (area / (PI * radius * radius) * 2.0 - 1.0).clamp(-1.0, 1.0) * radius;
    for _ in 0..40 {
        let miss = segment(radius, x) - area;
        if miss > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let width = 2.0 * (radius * radius - x * x).max(0.0).sqrt();
        let next = x - miss / width;
        let inside = next > low && next < high;
        let next = if inside { next } else { 0.5 * (low + high) };
        if (next - x).abs() <= 1e-14 * radius {
            return next;
        }
        x = next;
    }
    x
}

impl DiskOverlap {
    /// Whether the large disk lies inside the small one.
    pub(crate) fn is_nested(&self) -> bool {
        self.offset + self.large <= self.small
    }

    /// Radius of the large disk.
    pub(crate) fn large(&self) -> f64 {
        self.large
    }

    /// Distance of the centres.
    pub(crate) fn offset(&self) -> f64 {
        self.offset
    }

    /// The arcs of the small and of the large circle that bound the overlap.
    pub(crate) fn arcs(&self) -> [Arc; 2] {
        let x = self.crossing.clamp(-self.small, self.small);
        let height = (self.small * self.small - x * x).max(0.0).sqrt();
        [
            Arc { radius: self.small, angle: height.atan2(-x) },
            Arc { radius: self.large, angle: height.atan2(x + self.offset) },
        ]
    }

    /// Area of the overlap, in square units of the radii.
    pub(crate) fn area(&self) -> f64 {
        self.area
    }

    /// x of the centroid. The first moments of the two segments about the centres of their circles
    /// depend on their common chord alone, and cancel.
    pub(crate) fn centroid(&self) -> f64 {
        -self.offset * (self.area - self.left_area) / self.area
    }

    /// Maps a point of the unit square to a point of the overlap; returns its coordinates and its
    /// density by area.
    ///
    /// The first number chooses the fraction of the area left of the point, the second the position
    /// within the strip at that x. The density follows `gradient`, the gradient of the logarithm of
    /// the lobe along x and y.
    pub(crate) fn point(&self, [u, v]: [f64; 2], gradient: [f64; 2]) -> (f64, f64, f64) {
        let (u, pdf_u) = exponential(self.rate_along(gradient), u);
        let area = u * self.area;
        // The large circle bounds the overlap right of the crossing, the small one left of it.
        let x = if area < self.left_area {
            inverse_segment(self.small, area)
        } else {
            let before = PI * self.large * self.large - (self.area - self.left_area);
            inverse_segment(self.large, before + (area - self.left_area)) - self.offset
        };
        let half_width = self.half_width(x);
        let (v, pdf_v) = exponential(2.0 * half_width * gradient[1], v);
        (x, (2.0 * v - 1.0) * half_width, pdf_u * pdf_v / self.area)
    }

    /// Density of [`DiskOverlap::point`].
    pub(crate) fn pdf(&self, [x, y]: [f64; 2], gradient: [f64; 2]) -> f64 {
        let left_of_crossing = segment(self.small, x) < self.left_area;
        let area = if left_of_crossing {
            segment(self.small, x)
        } else {
            self.area - (PI * self.large * self.large - segment(self.large, x + self.offset))
        };
        let pdf_u = exponential_pdf(self.rate_along(gradient), area / self.area);
        let half_width = self.half_width(x);
        let v = (0.5 + 0.5 * y / half_width).clamp(0.0, 1.0);
        pdf_u * exponential_pdf(2.0 * half_width * gradient[1], v) / self.area
    }

    /// Half the length of the strip at x.
    fn half_width(&self, x: f64) -> f64 {
        let small = self.small * self.small - x * x;
        let large = self.large * self.large - (x + self.offset) * (x + self.offset);
        small.min(large).max(0.0).sqrt()
    }

    fn rate_along(&self, gradient: [f64; 2]) -> f64 {
        let left = (-self.small).max(-self.large - self.offset);
        let right = self.small.min(self.large - self.offset);
        gradient[0] * (right - left)
    }

    #[cfg(test)]
    fn holds(&self, x: f64, y: f64) -> bool {
        let slack = 1e-9 * self.small.max(self.large);
        x.hypot(y) <= self.small + slack && (x + self.offset).hypot(y) <= self.large + slack
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_agrees_with_a_grid() {
        for (small, large, offset) in
            [(1.0, 10.0, 9.5), (1.0, 10.0, 10.4), (1.0, 1.5, 1.0), (2.0, 0.5, 0.3), (2.0, 1.0, 1.7)]
        {
            let Overlap::Part(overlap) = Overlap::new(small, large, offset) else { panic!("a part overlaps") };
            let steps = 2000;
            let at = |step: i32| (2.0 * (f64::from(step) + 0.5) / f64::from(steps) - 1.0) * small;
            let count: i32 = (0..steps)
                .map(|i| {
                    (0..steps)
                        .filter(|j| at(i).hypot(at(*j)) <= small && (at(i) + offset).hypot(at(*j)) <= large)
                        .count() as i32
                })
                .sum();
            let counted = f64::from(count) * (2.0 * small / f64::from(steps)).powi(2);
            assert!(
                (overlap.area() / counted - 1.0).abs() < 2e-3,
                "{small} {large} {offset}: {} {counted}",
                overlap.area()
            );
        }
    }

    #[test]
    fn points_lie_in_the_overlap_and_are_uniform() {
        for (small, large, offset) in [(1.0, 10.0, 9.5), (1.0, 10.0, 10.4), (2.0, 1.0, 1.7), (2.0, 0.5, 0.3)] {
            let Overlap::Part(overlap) = Overlap::new(small, large, offset) else { panic!("a part overlaps") };
            let steps = 300;
            let (mut sum, mut square) = (0.0, 0.0);
            for i in 0..steps {
                for j in 0..steps {
                    let at = |k: i32| (f64::from(k) + 0.5) / f64::from(steps);
                    let gradient = [0.8 / small, -0.5 / small];
                    let (x, y, pdf) = overlap.point([at(i), at(j)], gradient);
                    assert!(overlap.holds(x, y), "{x} {y} in {overlap:?}");
                    assert!((overlap.pdf([x, y], gradient) / pdf - 1.0).abs() < 1e-6);
                    sum += x / (pdf * overlap.area());
                    square += y * y / (pdf * overlap.area());
                }
            }
            let count = f64::from(steps * steps);
            let (mean_x, mean_yy) = moments(small, large, offset);
            assert!((sum / count - mean_x).abs() < 2e-3 * small, "{} {mean_x}", sum / count);
            assert!((square / count - mean_yy).abs() < 5e-3 * small * small, "{} {mean_yy}", square / count);
        }
    }

    /// Mean x and mean y² of the overlap, by a grid.
    fn moments(small: f64, large: f64, offset: f64) -> (f64, f64) {
        let steps = 1500;
        let at = |step: i32| (2.0 * (f64::from(step) + 0.5) / f64::from(steps) - 1.0) * small;
        let (mut count, mut x_sum, mut yy_sum) = (0.0, 0.0, 0.0);
        for i in 0..steps {
            for j in 0..steps {
                let (x, y) = (at(i), at(j));
                if x.hypot(y) <= small && (x + offset).hypot(y) <= large {
                    count += 1.0;
                    x_sum += x;
                    yy_sum += y * y;
                }
            }
        }
        (x_sum / count, yy_sum / count)
    }

    #[test]
    fn disjoint_and_nested_disks_are_distinguished() {
        assert!(matches!(Overlap::new(1.0, 2.0, 3.1), Overlap::None));
        assert!(matches!(Overlap::new(1.0, 2.0, 0.9), Overlap::Whole));
    }
}
