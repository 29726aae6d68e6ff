//! Pixels with highlights that a few rays miss.

use crate::Exposer;
use crate::film::UnblurredFilm;
use glam::DVec2;
use radsight_render::{Ray, SeenSurface};
use rayon::prelude::*;

/// Whether each pixel of the film, or of the picture if there is none, may see a highlight that is narrower
/// than a pixel; empty without glossy surfaces.
pub(crate) fn highlights(exposer: &Exposer<'_>, film: Option<&UnblurredFilm>) -> Vec<bool> {
    let (rays, plan) = (exposer.rays, exposer.renderer.plan());
    if !plan.has_glossy_lobes() {
        return Vec::new();
    }
    let camera = rays.camera();
    let [columns, rows] =
        film.map_or([camera.columns(), camera.rows()].map(|count| count as usize), UnblurredFilm::size);
    let ray = |pixel: [usize; 2], place: DVec2| match film {
        Some(film) => film.ray_of_point(rays, DVec2::from(pixel.map(|index| index as f64)) + place),
        None => {
            let ray = rays.ray_through((pixel[1] * columns + pixel[0]) as u64, place.into(), [0.0; 2])?;
            Ray::new(ray.origin, ray.direction)
        }
    };
    // Corners beyond the last pixels are those of their other sides.
    let corner = |index: usize| {
        let at = [index % (columns + 1), index / (columns + 1)];
        let pixel = [at[0].min(columns - 1), at[1].min(rows - 1)];
        let place = DVec2::new((at[0] - pixel[0]) as f64, (at[1] - pixel[1]) as f64);
        plan.seen_surface(ray(pixel, place)?)
    };
    let corners: Vec<Option<SeenSurface>> =
        (0..(columns + 1) * (rows + 1)).into_par_iter().with_min_len(64).map(corner).collect();
    let of_pixel = |pixel: usize| {
        let at = [pixel % columns, pixel / columns];
        let middle = ray(at, DVec2::splat(0.5)).and_then(|ray| plan.seen_surface(ray));
        let first = at[1] * (columns + 1) + at[0];
        let others = [first, first + 1, first + columns + 1, first + columns + 2].map(|index| corners[index].as_ref());
        let seen: Vec<&SeenSurface> = [middle.as_ref()].into_iter().chain(others).flatten().collect();
        plan.sees_narrow_highlight(&seen)
    };
    (0..columns * rows).into_par_iter().with_min_len(64).map(of_pixel).collect()
}
