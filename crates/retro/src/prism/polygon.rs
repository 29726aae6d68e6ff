//! Convex polygons in the plane of the front.

/// A point of the plane.
pub(super) type Point = (f64, f64);

/// Upper bound on the corners of a triangle clipped by seven lines.
const MOST_CORNERS: usize = 12;

/// A convex polygon, counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polygon {
    corners: [Point; MOST_CORNERS],
    count: usize,
}

impl Polygon {
    pub(super) fn triangle(corners: [Point; 3]) -> Self {
        let mut all = [(0.0, 0.0); MOST_CORNERS];
        all[..3].copy_from_slice(&corners);
        Polygon { corners: all, count: 3 }
    }

    /// The part to the left of the line through `from` along `direction`. Sutherland and Hodgman,
    /// "Reentrant Polygon Clipping", CACM 17(1), 1974.
    pub(super) fn left_of(&self, from: Point, direction: Point) -> Polygon {
        let height = |point: Point| direction.0 * (point.1 - from.1) - direction.1 * (point.0 - from.0);
        let mut cut = Polygon { corners: [(0.0, 0.0); MOST_CORNERS], count: 0 };
        for index in 0..self.count {
            let (here, next) = (self.corners[index], self.corners[(index + 1) % self.count]);
            let (height_here, height_next) = (height(here), height(next));
            if height_here >= 0.0 {
                cut.push(here);
            }
            if (height_here >= 0.0) != (height_next >= 0.0) {
                let share = height_here / (height_here - height_next);
                cut.push((here.0 + share * (next.0 - here.0), here.1 + share * (next.1 - here.1)));
            }
        }
        cut
    }

    fn push(&mut self, corner: Point) {
        if let Some(place) = self.corners.get_mut(self.count) {
            *place = corner;
            self.count += 1;
        }
    }

    pub(super) fn area(&self) -> f64 {
        let twice: f64 = (0..self.count)
            .map(|index| {
                let (here, next) = (self.corners[index], self.corners[(index + 1) % self.count]);
                here.0 * next.1 - next.0 * here.1
            })
            .sum();
        0.5 * twice.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clipped_triangle_has_the_remaining_area() {
        let triangle = Polygon::triangle([(0.0, 0.0), (4.0, 0.0), (0.0, 4.0)]);
        assert_eq!(triangle.area(), 8.0);
        // Left of the upward line x = 1 is x ≤ 1.
        assert_eq!(triangle.left_of((1.0, 0.0), (0.0, 1.0)).area(), 8.0 - 4.5);
        assert_eq!(triangle.left_of((-1.0, 0.0), (0.0, 1.0)).area(), 0.0);
    }
}
