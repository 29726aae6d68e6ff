//! A surface that sends or receives, and places on it.

use crate::FluxError;
use earcut::Earcut;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// What kind of surface it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// `polygon`.
    Polygon,
    /// `ring`.
    Ring,
    /// `source`.
    Source,
}

/// A surface.
#[derive(Clone, Debug)]
pub struct FluxSurface {
    /// Its name.
    pub name: String,
    /// Unit; of a source against the direction to it.
    pub normal: DVec3,
    /// Area, or of a source its projected solid angle.
    pub area: f64,
    places: Places,
}

/// How a place on it is found.
#[derive(Clone, Debug)]
enum Places {
    /// With the share of the area up to the end of each.
    Triangles(Vec<(f64, [DVec3; 3])>),
    Ring {
        middle: DVec3,
        axes: [DVec3; 2],
        /// Squares of the radii.
        squared: [f64; 2],
    },
    /// Far away.
    Nowhere,
}

impl FluxSurface {
    /// One with the real arguments of its type.
    ///
    /// # Errors
    /// When their number is wrong, or they make no surface.
    pub fn new(name: &str, shape: Shape, numbers: &[f64]) -> Result<FluxSurface, FluxError> {
        let wrong = |what| FluxError::Surface { surface: name.to_owned(), what };
        let found = match (shape, numbers) {
            (Shape::Ring, [x, y, z, u, v, w, a, b]) => ring(DVec3::new(*x, *y, *z), DVec3::new(*u, *v, *w), [*a, *b]),
            (Shape::Source, [x, y, z, angle]) => source(DVec3::new(*x, *y, *z), *angle),
            (Shape::Polygon, numbers) if numbers.len() >= 9 && numbers.len() % 3 == 0 => {
                polygon(&numbers.chunks_exact(3).map(DVec3::from_slice).collect::<Vec<_>>())
            }
            _ => return Err(wrong("has not as many numbers as its type")),
        };
        let (normal, area, places) = found.ok_or_else(|| wrong("has no area"))?;
        if !(area.is_finite() && area > 0.0) {
            return Err(wrong("has no area"));
        }
        Ok(FluxSurface { name: name.to_owned(), normal, area, places })
    }

    /// Whether it is far away.
    #[must_use]
    pub fn is_distant(&self) -> bool {
        matches!(self.places, Places::Nowhere)
    }

    /// A place on it, even by area, from a point of the unit square.
    pub(crate) fn place(&self, [a, b]: [f64; 2]) -> DVec3 {
        match &self.places {
            Places::Triangles(triangles) => {
                let at = triangles.partition_point(|(end, _)| *end <= a).min(triangles.len() - 1);
                let start = if at == 0 { 0.0 } else { triangles[at - 1].0 };
                let (end, [p, q, r]) = triangles[at];
                let within = ((a - start) / (end - start)).clamp(0.0, 1.0).sqrt();
                p + (q - p) * (within * (1.0 - b)) + (r - p) * (within * b)
            }
            Places::Ring { middle, axes: [u, v], squared: [inner, outer] } => {
                let radius = (inner + a * (outer - inner)).sqrt();
                let (sin, cos) = (TAU * b).sin_cos();
                middle + u * (radius * cos) + v * (radius * sin)
            }
            Places::Nowhere => DVec3::ZERO,
        }
    }
}

/// Normal, area and places.
type Found = Option<(DVec3, f64, Places)>;

fn ring(middle: DVec3, normal: DVec3, radii: [f64; 2]) -> Found {
    let normal = normal.try_normalize()?;
    let (u, v) = normal.any_orthonormal_pair();
    let mut squared = radii.map(|radius| radius * radius);
    squared.sort_by(f64::total_cmp);
    Some((normal, PI * (squared[1] - squared[0]), Places::Ring { middle, axes: [u, v], squared }))
}

fn source(direction: DVec3, degrees: f64) -> Found {
    let sin = (0.5 * degrees).to_radians().sin();
    Some((-direction.try_normalize()?, PI * sin * sin, Places::Nowhere))
}

fn polygon(vertices: &[DVec3]) -> Found {
    let first = vertices[0];
    let doubled: DVec3 = vertices[1..].windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum();
    let normal = doubled.try_normalize()?;
    let (x, y) = normal.any_orthonormal_pair();
    let flat = vertices.iter().map(|vertex| [(*vertex - first).dot(x), (*vertex - first).dot(y)]);
    let mut corners: Vec<u32> = Vec::new();
    Earcut::new().earcut(flat, &[], &mut corners);
    let mut total = 0.0;
    let mut triangles: Vec<(f64, [DVec3; 3])> = Vec::new();
    for triangle in corners.chunks_exact(3) {
        let [p, q, r] = [0, 1, 2].map(|corner| vertices[triangle[corner] as usize]);
        total += 0.5 * (q - p).cross(r - p).length();
        triangles.push((total, [p, q, r]));
    }
    if triangles.is_empty() || total.is_nan() || total <= 0.0 {
        return None;
    }
    triangles.iter_mut().for_each(|(end, _)| *end /= total);
    Some((normal, 0.5 * doubled.length(), Places::Triangles(triangles)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_spread_by_area() {
        // An L of three unit squares.
        let corners = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];
        let numbers: Vec<f64> = corners.iter().flat_map(|[x, y]| [*x, *y, 3.0]).collect();
        let surface = FluxSurface::new("L", Shape::Polygon, &numbers).unwrap();
        assert!((surface.area - 3.0).abs() < 1e-12 && surface.normal == DVec3::Z);
        let side = 60;
        let mut within = 0;
        for i in 0..side * side {
            let at = |k: i32| (f64::from(k) + 0.5) / f64::from(side);
            let place = surface.place([at(i % side), at(i / side)]);
            assert!(place.z == 3.0 && (place.x <= 1.0 + 1e-9 || place.y <= 1.0 + 1e-9), "{place}");
            within += i32::from(place.x > 1.0);
        }
        assert!((f64::from(within) / f64::from(side * side) - 1.0 / 3.0).abs() < 0.02);
    }

    #[test]
    fn rings_have_their_hole() {
        let surface = FluxSurface::new("r", Shape::Ring, &[0., 0., 1., 0., 0., -2., 3., 1.]).unwrap();
        assert!((surface.area - 8.0 * PI).abs() < 1e-12);
        for point in [[0.0, 0.3], [0.5, 0.9], [0.999, 0.1]] {
            let place = surface.place(point);
            assert!((1.0..=3.0).contains(&place.truncate().length()) && (place.z - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn numbers_that_make_no_surface_are_told() {
        for (shape, numbers, message) in [
            (Shape::Polygon, &[0.0; 9][..], "surface \"s\" has no area"),
            (Shape::Polygon, &[0.0; 8], "surface \"s\" has not as many numbers as its type"),
            (Shape::Ring, &[0., 0., 0., 0., 0., 0., 0., 1.], "surface \"s\" has no area"),
            (Shape::Source, &[0., 0., 1., 0.], "surface \"s\" has no area"),
        ] {
            assert_eq!(FluxSurface::new("s", shape, numbers).unwrap_err().to_string(), message);
        }
    }
}
