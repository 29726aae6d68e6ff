//! Planar polygons in space.

use crate::{OutlineError, triangulate};
use glam::DVec3;

/// The vertices of a polygon with this unit normal in coordinates of its plane, relative to the first one.
#[must_use]
pub fn flattened(vertices: &[DVec3], normal: DVec3) -> Vec<[f64; 2]> {
    let (x, y) = normal.any_orthonormal_pair();
    vertices
        .iter()
        .map(|vertex| *vertex - vertices[0])
        .map(|from_first| [from_first.dot(x), from_first.dot(y)])
        .collect()
}

/// A polygon in triangles, for points that are uniform by area.
///
/// ```
/// use glam::DVec3;
/// let corners = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];
/// let vertices = corners.map(|[x, y]| DVec3::new(x, y, 5.));
/// let polygon = radsight_triangulation::TriangulatedPolygon::new(&vertices, DVec3::Z).unwrap().unwrap();
/// assert!((polygon.area() - 3.).abs() < 1e-12 && polygon.point([0.4, 0.7]).z == 5.);
/// ```
#[derive(Clone, Debug)]
pub struct TriangulatedPolygon {
    triangles: Vec<[DVec3; 3]>,
    /// Fraction of the area up to the end of each triangle; the last is 1.
    cumulative: Vec<f64>,
    area: f64,
}

impl TriangulatedPolygon {
    /// Triangulates a polygon with this unit normal; `None` if it has no area.
    ///
    /// # Errors
    /// As for [`triangulate`].
    pub fn new(vertices: &[DVec3], normal: DVec3) -> Result<Option<TriangulatedPolygon>, OutlineError> {
        let corners = triangulate(&flattened(vertices, normal))?;
        let triangles: Vec<_> = corners.iter().map(|corners| corners.map(|corner| vertices[corner as usize])).collect();
        let mut area = 0.0;
        let mut cumulative = Vec::with_capacity(triangles.len());
        for [a, b, c] in &triangles {
            area += 0.5 * (*b - *a).cross(*c - *a).length();
            cumulative.push(area);
        }
        if area.is_nan() || area <= 0.0 {
            return Ok(None);
        }
        cumulative.iter_mut().for_each(|sum| *sum /= area);
        Ok(Some(TriangulatedPolygon { triangles, cumulative, area }))
    }

    /// The corners of each triangle. There is at least one.
    #[must_use]
    pub fn triangles(&self) -> &[[DVec3; 3]] {
        &self.triangles
    }

    /// The sum of the triangles' areas.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Maps a point of the unit square to a point of the polygon, uniform by area.
    #[must_use]
    pub fn point(&self, [u, v]: [f64; 2]) -> DVec3 {
        let index = self.cumulative.partition_point(|share| *share <= u).min(self.triangles.len() - 1);
        let before = if index == 0 { 0.0 } else { self.cumulative[index - 1] };
        let u = ((u - before) / (self.cumulative[index] - before)).clamp(0.0, 1.0);
        let [a, b, c] = self.triangles[index];
        let root = u.sqrt();
        a + (b - a) * (root * (1.0 - v)) + (c - a) * (root * v)
    }

    /// The image of the polygon under a map that keeps areas, such as a reflection.
    #[must_use]
    pub fn image(&self, map: impl Fn(DVec3) -> DVec3) -> TriangulatedPolygon {
        let triangles = self.triangles.iter().map(|corners| corners.map(&map)).collect();
        TriangulatedPolygon { triangles, cumulative: self.cumulative.clone(), area: self.area }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_without_area_have_no_triangles() {
        let line = [DVec3::ZERO, DVec3::X, 2.0 * DVec3::X];
        assert!(TriangulatedPolygon::new(&line, DVec3::Z).unwrap().is_none());
        assert!(TriangulatedPolygon::new(&[DVec3::NAN; 3], DVec3::Z).unwrap().is_none());
    }

    #[test]
    fn an_image_keeps_its_points() {
        let corners = [DVec3::ZERO, 2.0 * DVec3::X, DVec3::new(1.0, 0.5, 0.0), DVec3::Y];
        let polygon = TriangulatedPolygon::new(&corners, DVec3::Z).unwrap().unwrap();
        let image = polygon.image(|point| DVec3::new(-point.x, point.y, 7.0));
        for point in [[0.1, 0.9], [0.5, 0.5], [0.99, 0.2]] {
            let [from, to] = [polygon.point(point), image.point(point)];
            assert_eq!(to, DVec3::new(-from.x, from.y, 7.0));
        }
        assert_eq!(image.area(), polygon.area());
    }
}
