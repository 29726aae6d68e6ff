//! Highlights that are narrower than a pixel.
//!
//! A curved glossy surface shows a small light as a highlight. Where the surface turns by more than the
//! width of its lobe within a pixel, the highlight fills a fraction of the pixel, and a few rays miss it.

use crate::plan::RenderPlan;
use crate::shader::Kind;
use glam::DVec3;
use radsight_accel::{Intersection, Ray};
use radsight_light::Light;

/// Width of a lobe, in roots of the mean square slope. Beyond, it has a ten-thousandth of its peak.
const LOBE_WIDTH: f64 = 3.0;

/// A ray with the surface that it meets first.
#[derive(Clone, Debug)]
pub struct SeenSurface {
    ray: Ray,
    hit: Intersection,
}

impl RenderPlan {
    /// Whether some surface has a glossy lobe: neither a perfect mirror nor sheeting.
    #[must_use]
    pub fn has_glossy_lobes(&self) -> bool {
        self.shaders.iter().any(|shader| lobe(&shader.kind).is_some())
    }

    /// The surface that a ray meets first.
    #[must_use]
    pub fn seen_surface(&self, ray: Ray) -> Option<SeenSurface> {
        self.first_hit(&ray, None).map(|hit| SeenSurface { ray, hit })
    }

    /// Whether a highlight that is narrower than a pixel may lie among what its corners and its middle see.
    /// Bumps of the surface and what hides a light are not regarded.
    #[must_use]
    pub fn sees_narrow_highlight(&self, seen: &[&SeenSurface]) -> bool {
        let of_surface = |seen: &&SeenSurface| lobe(&self.shader_at(seen.hit.shader).kind);
        let Some((roughness, first)) = seen.iter().find_map(|seen| Some((of_surface(seen)?, seen.hit.shader))) else {
            return false;
        };
        let on_surface = || seen.iter().filter(|seen| seen.hit.shader == first);
        let is_shown = |light: &Light| {
            let slopes: Vec<DVec3> = on_surface().filter_map(|seen| slope(seen, light)).collect();
            let extent = slopes.iter().map(|slope| slope.distance(slopes[0])).fold(0.0, f64::max);
            extent > roughness && slopes.iter().any(|slope| slope.length() < extent + LOBE_WIDTH * roughness)
        };
        self.lights.iter().any(is_shown)
    }
}

/// The roughness of a glossy lobe.
fn lobe(kind: &Kind) -> Option<f64> {
    match kind {
        Kind::Glossy(glossy) if glossy.specularity > 0.0 && !glossy.is_smooth() => Some(glossy.roughness),
        _ => None,
    }
}

/// The slope of a facet that reflects a light along a ray, relative to the surface; `None` if the light is
/// behind the surface.
fn slope(SeenSurface { ray, hit }: &SeenSurface, light: &Light) -> Option<DVec3> {
    let to_light = if light.primitive.is_none() { light.center } else { light.center - hit.point }.normalize_or_zero();
    let normal = -hit.front * hit.front.dot(ray.direction).signum();
    let facet = to_light - ray.direction;
    (to_light.dot(normal) > 0.0).then(|| facet / facet.dot(normal) - normal)
}
