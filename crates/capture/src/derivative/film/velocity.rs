//! The velocity with which the samples of a film follow what moves.

use crate::Progress;
use crate::derivative::ParameterStep;
use crate::derivative::outline::{PixelRays, seen_parts};
use crate::film::UnblurredFilm;
use glam::{DMat2, DVec2, DVec3};

/// Velocity of the points of a film, pixels per unit of the parameter: linear along both axes between the
/// corners of pixels.
#[derive(Debug)]
pub(super) struct FilmVelocity {
    /// Corners in a row.
    columns: usize,
    corners: Vec<DVec2>,
    /// Whether points of a pixel move.
    moves: Vec<bool>,
}

impl FilmVelocity {
    pub(super) fn new(step: &ParameterStep<'_>, film: &UnblurredFilm, progress: &dyn Progress) -> FilmVelocity {
        let rays = step.center.rays;
        let ray = |pixel: u64, u: [f64; 4]| film.ray(rays, pixel as usize, [u[0], u[1]], DVec2::ZERO).map(|on| on.ray);
        let parts = seen_parts(step, &PixelRays { size: film.size(), ray: &ray }, progress);
        let columns = film.size()[0] + 1;
        let mut sums = vec![(DVec2::ZERO, 0u32); columns * (film.size()[1] + 1)];
        for (pixel, part) in parts.iter().enumerate() {
            let Some(part) = *part else { continue };
            for corner in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(DVec2::from) {
                let at = film.corner(pixel) + corner;
                let (sum, count) = &mut sums[at.y as usize * columns + at.x as usize];
                if let Some(velocity) = velocity(step, film, at, part.point) {
                    (*sum, *count) = (*sum + velocity, *count + 1);
                }
            }
        }
        let corners = sums.into_iter().map(|(sum, count)| sum / f64::from(count.max(1))).collect();
        FilmVelocity { columns, corners, moves: parts.iter().map(Option::is_some).collect() }
    }

    /// Of a film of which some pixels move, at no speed.
    #[cfg(test)]
    pub(super) fn zero(film: &UnblurredFilm, moves: Vec<bool>) -> FilmVelocity {
        let [columns, rows] = film.size();
        FilmVelocity { columns: columns + 1, corners: vec![DVec2::ZERO; (columns + 1) * (rows + 1)], moves }
    }

    pub(super) fn moves(&self, pixel: usize) -> bool {
        self.moves[pixel]
    }

    /// Number of pixels whose points move.
    pub(super) fn moving_pixels(&self) -> usize {
        self.moves.iter().filter(|moves| **moves).count()
    }

    /// The velocity at a point of the film, and its derivatives by the point.
    pub(super) fn at(&self, point: DVec2) -> (DVec2, DMat2) {
        let corner = point.floor();
        let along = point - corner;
        let first = corner.y as usize * self.columns + corner.x as usize;
        let [a, b] = [self.corners[first], self.corners[first + 1]];
        let [c, d] = [self.corners[first + self.columns], self.corners[first + self.columns + 1]];
        let [above, below] = [a + along.x * (b - a), c + along.x * (d - c)];
        let by_x = (b - a).lerp(d - c, along.y);
        (above.lerp(below, along.y), DMat2::from_cols(by_x, below - above))
    }
}

/// The velocity of what moves at a point of the film, in the plane across the camera's axis through a
/// point of it. `None` where the camera's rays do not reach it.
fn velocity(step: &ParameterStep<'_>, film: &UnblurredFilm, at: DVec2, moving: DVec3) -> Option<DVec2> {
    let rays = step.center.rays;
    let ray = film.ray_of_point(rays, at)?;
    let axis = rays.camera().direction();
    let point = ray.at((moving - ray.origin).dot(axis) / ray.direction.dot(axis));
    let moved = step.motion.velocity(point) * step.step;
    let seen = |point: DVec3| rays.picture_point((point - ray.origin).normalize(), [0.0; 2]).map(DVec2::from);
    let velocity = (seen(point + moved)? - seen(point - moved)?) / (2.0 * step.step);
    Some(velocity).filter(|velocity| velocity.is_finite())
}
