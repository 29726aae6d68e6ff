//! What hides irradiance records from the points around them: opaque surfaces of the scene.

use glam::DVec3;
use radsight_accel::Ray;
use radsight_compile::RenderPlan;
use radsight_irradiance_cache::Occluders;

/// The opaque surfaces of a scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpaqueSurfaces<'p>(pub(crate) &'p RenderPlan);

/// Sine of the elevation of test rays above the surface: 20 degrees, which passes over what is too
/// low to matter. The angle of Radiance's `plugaleak` (`ambient.c`).
const ELEVATION_SINE: f64 = 0.342;

/// The part of a test ray at its start that is not tested, so that it leaves its own surface.
const UNTESTED: f64 = 1e-3;

/// A test ray that passes more transparent surfaces is not blocked.
const MAX_CROSSINGS: usize = 64;

impl Occluders for OpaqueSurfaces<'_> {
    fn separate(&self, from: DVec3, normal: DVec3, to: DVec3) -> bool {
        let offset = to - from;
        let along = offset - normal * offset.dot(normal);
        let distance = along.length();
        let Some(along) = along.try_normalize() else { return false };
        let elevation_cosine = (1.0 - ELEVATION_SINE * ELEVATION_SINE).sqrt();
        // The ray ends above the other point.
        self.block(from, along * elevation_cosine + normal * ELEVATION_SINE, distance / elevation_cosine)
    }

    fn cover(&self, from: DVec3, normal: DVec3, height: f64) -> bool {
        self.block(from, normal, height)
    }
}

impl OpaqueSurfaces<'_> {
    /// Whether one of them lies on a ray that starts on a surface, up to this distance.
    fn block(&self, from: DVec3, direction: DVec3, length: f64) -> bool {
        let start = UNTESTED * length;
        let (mut ray, mut left) = (Ray { origin: from + direction * start, direction }, length - start);
        let mut passed = None;
        for _ in 0..MAX_CROSSINGS {
            match self.0.first_hit(&ray, passed) {
                Some(hit) if hit.distance < left => {
                    if !self.0.shader_at(hit.shader).passes_irradiance() {
                        return true;
                    }
                    left -= hit.distance;
                    ray.origin = hit.point;
                    passed = Some(hit.primitive);
                }
                _ => return false,
            }
        }
        false
    }
}
