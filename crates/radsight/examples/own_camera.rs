//! A custom camera: a push-broom line scanner that rotates about the vertical axis while it records
//! its columns.

use glam::DVec3;
use radsight::{Camera, CameraRay, Error, Renderer, Scene};
use std::f64::consts::TAU;

struct LineScanner {
    /// Half the vertical field of view, as the tangent of the angle.
    half_height: f64,
}

impl Camera for LineScanner {
    fn ray(&self, [turn, down]: [f64; 2], _aperture: [f64; 2]) -> Option<CameraRay> {
        let (sin, cos) = (TAU * turn).sin_cos();
        let direction = DVec3::new(sin, cos, self.half_height * (1.0 - 2.0 * down));
        Some(CameraRay { origin: DVec3::new(0.0, 0.0, 1.5), direction, weight: 1.0 })
    }
}

pub(crate) fn main() -> Result<(), Error> {
    let scene = Scene::load([concat!(env!("CARGO_MANIFEST_DIR"), "/../../radiance-scenes/gallery/daylight.rad")])?;
    let image = Renderer::new(&scene)?.samples(4).render_camera(&LineScanner { half_height: 0.7 }, 180, 40)?;
    image.save(std::env::temp_dir().join("panorama.hdr"))
}
