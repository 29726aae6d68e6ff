//! Surfaces that become light sources (`mkillum`): rays over all their emission directions, and the
//! distribution of the radiance found.

use crate::surface::{FluxSurface, Shape};
use crate::{FluxError, Toward};
use glam::DVec3;
use radsight_sampling::{DimensionSet, RaySampler};
use std::f64::consts::{PI, TAU};

/// A surface that becomes a light source, with its emission directions and the rays for each.
///
/// Directions are cells of two angles. For a flat surface the cells have equal projected solid
/// angle: rows are uniform in the squared sine of the angle to the normal, columns in the azimuth
/// about it. For a sphere the cells have equal solid angle, about the scene's z axis.
#[derive(Clone, Debug)]
pub struct IllumSurface {
    outline: Outline,
    cells: [usize; 2],
    samples: usize,
    seed: u64,
}

#[derive(Clone, Debug)]
enum Outline {
    Flat {
        surface: FluxSurface,
        /// Unit vectors u, v and the normal.
        axes: [DVec3; 3],
        /// Distance of the ray origins in front of the surface, so that rays cross it.
        lift: f64,
    },
    Ball {
        middle: DVec3,
        radius: f64,
    },
}

/// Resolution of the distribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IllumDetail {
    /// Number of directions per steradian (projected, for a flat surface); 0 for a constant
    /// distribution.
    pub density: u32,
    /// Number of rays per direction.
    pub samples: u32,
}

/// Maximum number of rays, which are all in memory at once; more than any light needs.
const MOST_RAYS: u64 = 1 << 25;

/// Distance of the ray origins in front of the surface, relative to its size.
const LIFT: f64 = 0.005;

/// Distinguishes the samples of these surfaces from those of other rays.
const SEED: u64 = 0x696c_6c75;

impl IllumSurface {
    /// A polygon or ring, from its real arguments.
    ///
    /// # Errors
    /// If their number is wrong, they do not form a surface, or there are too many rays.
    pub fn flat(name: &str, shape: Shape, numbers: &[f64], detail: IllumDetail) -> Result<IllumSurface, FluxError> {
        let surface = FluxSurface::new(name, shape, numbers)?;
        if surface.is_distant() {
            return Err(FluxError::SendingSource { surface: name.to_owned() });
        }
        let normal = surface.normal;
        let u = long_edge(shape, numbers, surface.area).unwrap_or_else(|| normal.any_orthonormal_vector());
        let size = match (shape, numbers) {
            (Shape::Ring, [.., a, b]) => a.max(*b),
            _ => surface.area.sqrt(),
        };
        let axes = [u, normal.cross(u), normal];
        let directions = (PI * f64::from(detail.density)).floor();
        let rows = (directions / PI).sqrt();
        IllumSurface::new(name, Outline::Flat { surface, axes, lift: LIFT * size }, [rows, PI], detail)
    }

    /// A sphere, from its real arguments.
    ///
    /// # Errors
    /// If their number is wrong, they do not form a surface, or there are too many rays.
    pub fn ball(name: &str, numbers: &[f64], detail: IllumDetail) -> Result<IllumSurface, FluxError> {
        let wrong = |what| FluxError::Surface { surface: name.to_owned(), what };
        let [x, y, z, radius] = *numbers else { return Err(wrong("has a wrong number of arguments for its type")) };
        if radius.is_nan() || radius <= 0.0 {
            return Err(FluxError::NoArea { surface: name.to_owned() });
        }
        let directions = (4.0 * PI * f64::from(detail.density)).floor();
        let rows = (directions * 2.0 / PI).sqrt();
        IllumSurface::new(name, Outline::Ball { middle: DVec3::new(x, y, z), radius }, [rows, 0.5 * PI], detail)
    }

    fn new(
        name: &str,
        outline: Outline,
        [rows, columns_per_row]: [f64; 2],
        detail: IllumDetail,
    ) -> Result<IllumSurface, FluxError> {
        let rounded = |number: f64| (number + 0.5).floor().max(1.0);
        let cells = if detail.density == 0 {
            [1.0, 1.0]
        } else {
            let rows = rounded(rows);
            [rows, rounded(columns_per_row * rows)]
        };
        let samples = f64::from(detail.samples.max(1));
        if cells[0] * cells[1] * samples > MOST_RAYS as f64 {
            return Err(FluxError::Surface { surface: name.to_owned(), what: "needs too many rays" });
        }
        Ok(IllumSurface { outline, cells: cells.map(|count| count as usize), samples: samples as usize, seed: SEED })
    }

    /// Samples with the seed of a command; 0 is the one of a new surface.
    #[must_use]
    pub fn with_seed(self, seed: u64) -> IllumSurface {
        IllumSurface { seed: SEED ^ seed, ..self }
    }

    /// Number of rows and columns of directions.
    #[must_use]
    pub fn cells(&self) -> [usize; 2] {
        self.cells
    }

    /// Number of rays per direction.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Number of rays: those of a direction are consecutive, rows follow each other.
    #[must_use]
    pub fn rays(&self) -> usize {
        self.cells[0] * self.cells[1] * self.samples
    }

    /// Unit vectors u, v and the normal, to which the directions of a flat surface refer.
    #[must_use]
    pub fn axes(&self) -> Option<[DVec3; 3]> {
        match &self.outline {
            Outline::Flat { axes, .. } => Some(*axes),
            Outline::Ball { .. } => None,
        }
    }

    /// Origin and unit direction of ray number `number`. It starts just in front of the surface and
    /// crosses it, against the future light.
    #[must_use]
    pub fn ray(&self, number: usize) -> [DVec3; 2] {
        let [a, b, c, d] = RaySampler::new(self.seed, number as u64).take(DimensionSet::CAMERA);
        let cell = number / self.samples;
        let row = ((cell / self.cells[1]) as f64 + a) / self.cells[0] as f64;
        let around = TAU * ((cell % self.cells[1]) as f64 + b - 0.5) / self.cells[1] as f64;
        match &self.outline {
            Outline::Flat { surface, axes: [u, v, normal], lift } => {
                let (sin, cos) = (row.sqrt(), (1.0 - row).max(0.0).sqrt());
                let shining = *u * (sin * around.cos()) + *v * (sin * around.sin()) + *normal * cos;
                [surface.point([c, d]) + shining * *lift, -shining]
            }
            Outline::Ball { middle, radius } => {
                let height = 1.0 - 2.0 * row;
                let sin = (1.0 - height * height).max(0.0).sqrt();
                let shining = DVec3::new(sin * around.cos(), sin * around.sin(), height);
                let (u, v) = shining.any_orthonormal_pair();
                // Uniform over the disk visible from there, slightly outside the sphere.
                let (side, out) = (c.sqrt() * *radius, *radius * (1.01 - c).sqrt());
                let (up, across) = (TAU * d).sin_cos();
                [*middle + u * (side * across) + v * (side * up) + shining * out, -shining]
            }
        }
    }

    /// A ray from point number `number` of a flat surface to a light behind it; `None` if the light
    /// is not behind it.
    #[must_use]
    pub fn ray_to_light(&self, light: &Toward, number: usize) -> Option<LightRay> {
        let Outline::Flat { surface, axes: [u, v, normal], lift } = &self.outline else { return None };
        let [a, b, c, d] = RaySampler::new(!self.seed, number as u64).take(DimensionSet::CAMERA);
        let place = surface.point([a, b]);
        let (direction, solid_angle) = light.sample(place, [c, d])?;
        let cosine = -normal.dot(direction);
        if cosine <= 1e-6 {
            return None;
        }
        let row = ((1.0 - cosine * cosine).max(0.0) * self.cells[0] as f64) as usize;
        let around = (-v.dot(direction)).atan2(-u.dot(direction)) / TAU;
        let column = (around.rem_euclid(1.0) * self.cells[1] as f64 + 0.5) as usize % self.cells[1];
        let cells = (self.cells[0] * self.cells[1]) as f64;
        Some(LightRay {
            origin: place - direction * *lift,
            direction,
            cell: row.min(self.cells[0] - 1) * self.cells[1] + column,
            weight: cells / PI * cosine * solid_angle,
        })
    }

    /// Table of the mean radiance by direction, extended for interpolation as in data files: the
    /// first column is repeated at the end, and rows extend beyond the pole so that the mean of the
    /// first row is at the pole.
    #[must_use]
    pub fn table(&self, means: &[f64]) -> Vec<Vec<f64>> {
        let closed = |row: &[f64]| row.iter().chain(row.first()).copied().collect::<Vec<f64>>();
        let mirrored = |row: &[f64]| {
            let twice = 2.0 * row.iter().sum::<f64>() / row.len() as f64;
            closed(&row.iter().map(|value| twice - value).collect::<Vec<f64>>())
        };
        let rows: Vec<&[f64]> = means.chunks_exact(self.cells[1]).collect();
        let past_pole = |row: Option<&&[f64]>| row.map(|row| mirrored(row));
        let last = if self.axes().is_none() { past_pole(rows.last()) } else { None };
        past_pole(rows.first()).into_iter().chain(rows.iter().map(|row| closed(row))).chain(last).collect()
    }

    /// Coordinates of the first and the last row of [`IllumSurface::table`]: squared cosine of the
    /// angle to the normal; for a sphere cosine of the angle to the z axis.
    #[must_use]
    pub fn row_ends(&self) -> [f64; 2] {
        let rows = self.cells[0] as f64;
        match self.outline {
            Outline::Flat { .. } => [1.0 + 0.5 / rows, 0.5 / rows],
            Outline::Ball { .. } => [1.0 + 1.0 / rows, -1.0 - 1.0 / rows],
        }
    }
}

/// A ray towards a light.
#[derive(Clone, Copy, Debug)]
pub struct LightRay {
    /// Origin, scene coordinates.
    pub origin: DVec3,
    /// Unit direction.
    pub direction: DVec3,
    /// Index of the direction's cell.
    pub cell: usize,
    /// Weight of the light's radiance; the mean over all points is added to that of the cell.
    pub weight: f64,
}

/// Direction of the first edge at least as long as the side of a square of the same area: rows of
/// windows lie along it.
fn long_edge(shape: Shape, numbers: &[f64], area: f64) -> Option<DVec3> {
    if shape != Shape::Polygon {
        return None;
    }
    let vertices: Vec<DVec3> = numbers.chunks_exact(3).map(DVec3::from_slice).collect();
    let before = vertices.last().into_iter().chain(&vertices);
    let edges = before.zip(&vertices).map(|(from, to)| *to - *from);
    let mut long = edges.filter(|edge| edge.length_squared() >= area - 1e-6);
    long.next()?.try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: [f64; 12] = [0., 0., 1., 0., 0., 3., 4., 0., 3., 4., 0., 1.];

    fn window(density: u32, samples: u32) -> IllumSurface {
        IllumSurface::flat("w", Shape::Polygon, &WINDOW, IllumDetail { density, samples }).unwrap()
    }

    #[test]
    fn rays_go_through_the_surface_against_its_light() {
        let surface = window(48, 4);
        assert_eq!((surface.cells(), surface.rays()), ([7, 22], 7 * 22 * 4));
        let [u, _, normal] = surface.axes().unwrap();
        assert!(u.x.abs() == 1.0 && normal.y.abs() == 1.0, "{u} {normal}");
        for number in 0..surface.rays() {
            let [origin, direction] = surface.ray(number);
            let distance = -origin.y / direction.y;
            let at = origin + direction * distance;
            assert!(distance > 0.0 && normal.dot(direction) < 0.0);
            assert!((0.0..=4.0).contains(&at.x) && (1.0..=3.0).contains(&at.z), "{at}");
        }
    }

    #[test]
    fn directions_of_a_flat_surface_have_the_same_projected_solid_angle() {
        let surface = window(20, 8);
        let [_, _, normal] = surface.axes().unwrap();
        let mean = (0..surface.rays()).map(|number| -normal.dot(surface.ray(number)[1])).sum::<f64>();
        // The mean cosine of a cosine distribution is two thirds.
        assert!((mean / surface.rays() as f64 - 2.0 / 3.0).abs() < 0.003);
    }

    #[test]
    fn rays_of_a_sphere_come_from_all_directions() {
        let detail = IllumDetail { density: 10, samples: 8 };
        let surface = IllumSurface::ball("b", &[1., 2., 3., 0.5], detail).unwrap();
        let middle = DVec3::new(1.0, 2.0, 3.0);
        let mut sum = DVec3::ZERO;
        for number in 0..surface.rays() {
            let [origin, direction] = surface.ray(number);
            assert!((origin - middle).length() > 0.5 && (middle - origin).cross(direction).length() <= 0.5);
            sum += direction;
        }
        assert!(sum.length() / (surface.rays() as f64) < 0.01, "{sum}");
    }

    #[test]
    fn the_light_of_a_small_source_has_its_projected_solid_angle() {
        let surface = window(48, 1);
        let [_, _, normal] = surface.axes().unwrap();
        let direction = DVec3::new(0.3, -2.0 * normal.y, 1.0).normalize();
        let sun = Toward::Distant { direction, cosine: 5f64.to_radians().cos() };
        let cells: f64 = (surface.cells()[0] * surface.cells()[1]) as f64;
        let count = 500;
        let rays: Vec<LightRay> = (0..count).filter_map(|number| surface.ray_to_light(&sun, number)).collect();
        assert_eq!(rays.len(), count);
        let found = rays.iter().map(|ray| ray.weight).sum::<f64>() / count as f64;
        let cosine = 2.0 / 5.09f64.sqrt();
        let expected = cells * cosine * 5f64.to_radians().sin().powi(2);
        assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
        assert!(rays.iter().all(|ray| ray.cell < cells as usize));
        // Its own rays in that direction are in the same cell.
        let [origin, direction] = surface.ray(rays[0].cell);
        assert!(direction.dot(rays[0].direction) > 0.9 && origin.is_finite());
    }

    #[test]
    fn tables_are_periodic_and_extend_beyond_the_pole() {
        let surface = window(1, 1);
        assert_eq!(surface.cells(), [1, 3]);
        assert_eq!(surface.table(&[1.0, 2.0, 6.0]), [vec![5.0, 4.0, 0.0, 5.0], vec![1.0, 2.0, 6.0, 1.0]]);
        assert_eq!(surface.row_ends(), [1.5, 0.5]);
        let even = window(0, 1);
        assert_eq!((even.cells(), even.rays()), ([1, 1], 1));
    }

    #[test]
    fn surfaces_that_make_no_light_are_rejected() {
        let detail = IllumDetail { density: 1 << 30, samples: 1 << 20 };
        let error = IllumSurface::flat("w", Shape::Polygon, &WINDOW, detail).unwrap_err();
        assert_eq!(error.to_string(), "surface \"w\" needs too many rays");
        let detail = IllumDetail { density: 1, samples: 1 };
        for numbers in [&[0., 0., 0., 0.][..], &[0., 0., 0., f64::NAN], &[1.0]] {
            assert!(IllumSurface::ball("b", numbers, detail).is_err());
        }
        assert!(IllumSurface::flat("s", Shape::Source, &[0., 0., 1., 5.], detail).is_err());
    }
}
