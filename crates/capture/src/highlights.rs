//! Pixels with highlights that a few rays miss.

use crate::Exposer;
use crate::film::UnblurredFilm;
use glam::DVec2;
use radsight_render::Ray;
use rayon::prelude::*;

/// The places of a pixel through which it is tested.
const PLACES: [[f64; 2]; 5] = [[0.5, 0.5], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];

/// Whether each pixel of the film, or of the picture if there is none, may see a highlight that is narrower
/// than a pixel; empty without glossy surfaces.
pub(crate) fn highlights(exposer: &Exposer<'_>, film: Option<&UnblurredFilm>) -> Vec<bool> {
    let (rays, plan) = (exposer.rays, exposer.renderer.plan());
    if !plan.has_glossy_lobes() {
        return Vec::new();
    }
    let ray = |pixel: usize, place: [f64; 2]| match film {
        Some(film) => film.ray_of_point(rays, film.corner(pixel) + DVec2::from(place)),
        None => {
            let ray = rays.ray_through(pixel as u64, place, [0.0; 2])?;
            Ray::new(ray.origin, ray.direction)
        }
    };
    let of_pixel = |pixel: usize| {
        let tested: Vec<Ray> = PLACES.iter().filter_map(|place| ray(pixel, *place)).collect();
        plan.sees_narrow_highlight(&tested)
    };
    let pixels = film.map_or(rays.camera().pixel_count() as usize, UnblurredFilm::pixel_count);
    (0..pixels).into_par_iter().with_min_len(64).map(of_pixel).collect()
}
