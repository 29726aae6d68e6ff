//! A custom integrator: ambient occlusion, the cosine-weighted share of the sky visible from a
//! point.

use glam::DVec3;
use radsight::{Camera, CameraRay, Error, Integrator, Ray, RayQueries, Renderer, Scene};
use std::f64::consts::TAU;

struct AmbientOcclusion {
    /// Distance beyond which surfaces do not occlude, scene units.
    range: f64,
}

impl Integrator for AmbientOcclusion {
    fn radiance(&self, queries: &mut RayQueries<'_, '_>, ray: &Ray) -> [f64; 3] {
        let Some(hit) = queries.first_hit(ray).filter(|hit| hit.distance.is_finite()) else { return [1.0; 3] };
        let normal = if hit.normal.dot(ray.direction) < 0.0 { hit.normal } else { -hit.normal };
        let [u, v, ..] = queries.random();
        // A point sampled uniformly on the unit sphere tangent to the surface gives a
        // cosine-weighted direction from the point of tangency.
        let (z, angle) = (1.0 - 2.0 * u, TAU * v);
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let direction = normal + DVec3::new(radius * angle.cos(), radius * angle.sin(), z);
        let Some(outward) = Ray::new(hit.point + 1e-6 * normal, direction) else { return [0.0; 3] };
        let is_open = queries.first_hit(&outward).is_none_or(|hit| hit.distance > self.range);
        [f64::from(u8::from(is_open)); 3]
    }
}

/// Views two by two units from straight above.
struct FromAbove;

impl Camera for FromAbove {
    fn ray(&self, [x, y]: [f64; 2], _aperture: [f64; 2]) -> Option<CameraRay> {
        let origin = DVec3::new(2.0 * x - 1.0, 1.0 - 2.0 * y, 0.4);
        Some(CameraRay { origin, direction: -DVec3::Z, weight: 1.0 })
    }
}

/// A disk of radius 1 at height h above the centre of a floor leaves the share 1 − 1/(1 + h²) of
/// the sky visible there.
pub(crate) fn main() -> Result<(), Error> {
    let scene = Scene::from_text(
        "void plastic grey 0 0 5 .5 .5 .5 0 0
         grey polygon floor 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0
         grey ring disk 0 0 8 0 0 .5 0 0 -1 0 1",
    )?;
    let occlusion = AmbientOcclusion { range: 20.0 };
    let image = Renderer::new(&scene)?.samples(256).render_with(&occlusion, &FromAbove, 33, 33)?;
    let (open, expected) = (f64::from(image.pixel(16, 16)[1]), 1.0 - 1.0 / (1.0 + 0.5 * 0.5));
    assert!((open - expected).abs() < 0.05, "{open} of the sky is seen, expected {expected}");
    Ok(())
}
