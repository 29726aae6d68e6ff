//! Surfaces that send or receive, and points on them.

use crate::FluxError;
use glam::DVec3;
use radsight_triangulation::{OutlineError, TriangulatedPolygon};
use std::f64::consts::{PI, TAU};

/// Type of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// `polygon`.
    Polygon,
    /// `ring`.
    Ring,
    /// `source`.
    Source,
}

/// A sending or receiving surface.
#[derive(Clone, Debug)]
pub struct FluxSurface {
    /// Name of the surface.
    pub name: String,
    /// Unit normal; for a source against the direction to it.
    pub normal: DVec3,
    /// Area in square scene units; for a source its projected solid angle in sr.
    pub area: f64,
    points: PointMap,
}

/// Parametrisation of a surface's points.
#[derive(Clone, Debug)]
enum PointMap {
    Polygon(TriangulatedPolygon),
    Ring {
        middle: DVec3,
        axes: [DVec3; 2],
        /// Squares of the radii.
        squared: [f64; 2],
    },
    /// A distant source.
    Distant,
}

impl FluxSurface {
    /// A surface, from the real arguments of its type.
    ///
    /// # Errors
    /// If their number is wrong, or they do not form a surface.
    pub fn new(name: &str, shape: Shape, numbers: &[f64]) -> Result<FluxSurface, FluxError> {
        let wrong = |what| FluxError::Surface { surface: name.to_owned(), what };
        let found = match (shape, numbers) {
            (Shape::Ring, [x, y, z, u, v, w, a, b]) => {
                Ok(ring(DVec3::new(*x, *y, *z), DVec3::new(*u, *v, *w), [*a, *b]))
            }
            (Shape::Source, [x, y, z, angle]) => Ok(source(DVec3::new(*x, *y, *z), *angle)),
            (Shape::Polygon, numbers) if numbers.len() >= 9 && numbers.len() % 3 == 0 => {
                polygon(&numbers.chunks_exact(3).map(DVec3::from_slice).collect::<Vec<_>>())
            }
            _ => return Err(wrong("has a wrong number of arguments for its type")),
        };
        let found = found.map_err(|outline| FluxError::Outline { surface: name.to_owned(), outline })?;
        let (normal, area, points) = found
            .filter(|(_, area, _)| area.is_finite() && *area > 0.0)
            .ok_or_else(|| FluxError::NoArea { surface: name.to_owned() })?;
        Ok(FluxSurface { name: name.to_owned(), normal, area, points })
    }

    /// Whether it is a distant source.
    #[must_use]
    pub fn is_distant(&self) -> bool {
        matches!(self.points, PointMap::Distant)
    }

    /// Maps a point of the unit square to a point of the surface, uniform by area.
    pub(crate) fn point(&self, [a, b]: [f64; 2]) -> DVec3 {
        match &self.points {
            PointMap::Polygon(polygon) => polygon.point([a, b]),
            PointMap::Ring { middle, axes: [u, v], squared: [inner, outer] } => {
                let radius = (inner + a * (outer - inner)).sqrt();
                let (sin, cos) = (TAU * b).sin_cos();
                middle + u * (radius * cos) + v * (radius * sin)
            }
            PointMap::Distant => DVec3::ZERO,
        }
    }
}

/// Normal, area and parametrisation; `None` without area.
type Found = Option<(DVec3, f64, PointMap)>;

fn ring(middle: DVec3, normal: DVec3, radii: [f64; 2]) -> Found {
    let normal = normal.try_normalize()?;
    let (u, v) = normal.any_orthonormal_pair();
    let mut squared = radii.map(|radius| radius * radius);
    squared.sort_by(f64::total_cmp);
    Some((normal, PI * (squared[1] - squared[0]), PointMap::Ring { middle, axes: [u, v], squared }))
}

fn source(direction: DVec3, degrees: f64) -> Found {
    let sin = (0.5 * degrees).to_radians().sin();
    Some((-direction.try_normalize()?, PI * sin * sin, PointMap::Distant))
}

fn polygon(vertices: &[DVec3]) -> Result<Found, OutlineError> {
    let first = vertices[0];
    let doubled: DVec3 = vertices[1..].windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum();
    let Some(normal) = doubled.try_normalize() else { return Ok(None) };
    let polygon = TriangulatedPolygon::new(vertices, normal)?;
    Ok(polygon.map(|polygon| (normal, 0.5 * doubled.length(), PointMap::Polygon(polygon))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_uniform_by_area() {
        // An L of three unit squares.
        let corners = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];
        let numbers: Vec<f64> = corners.iter().flat_map(|[x, y]| [*x, *y, 3.0]).collect();
        let surface = FluxSurface::new("L", Shape::Polygon, &numbers).unwrap();
        assert!((surface.area - 3.0).abs() < 1e-12 && surface.normal == DVec3::Z);
        let side = 60;
        let mut within = 0;
        for i in 0..side * side {
            let at = |k: i32| (f64::from(k) + 0.5) / f64::from(side);
            let point = surface.point([at(i % side), at(i / side)]);
            assert!(point.z == 3.0 && (point.x <= 1.0 + 1e-9 || point.y <= 1.0 + 1e-9), "{point}");
            within += i32::from(point.x > 1.0);
        }
        assert!((f64::from(within) / f64::from(side * side) - 1.0 / 3.0).abs() < 0.02);
    }

    #[test]
    fn rings_have_their_hole() {
        let surface = FluxSurface::new("r", Shape::Ring, &[0., 0., 1., 0., 0., -2., 3., 1.]).unwrap();
        assert!((surface.area - 8.0 * PI).abs() < 1e-12);
        for point in [[0.0, 0.3], [0.5, 0.9], [0.999, 0.1]] {
            let point = surface.point(point);
            assert!((1.0..=3.0).contains(&point.truncate().length()) && (point.z - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn numbers_that_form_no_surface_are_rejected() {
        for (shape, numbers, message) in [
            (Shape::Polygon, &[0.0; 9][..], "surface \"s\" has no area"),
            (Shape::Polygon, &[0.0; 8], "surface \"s\" has a wrong number of arguments for its type"),
            (Shape::Ring, &[0., 0., 0., 0., 0., 0., 0., 1.], "surface \"s\" has no area"),
            (Shape::Source, &[0., 0., 1., 0.], "surface \"s\" has no area"),
        ] {
            assert_eq!(FluxSurface::new("s", shape, numbers).unwrap_err().to_string(), message);
        }
    }
}
