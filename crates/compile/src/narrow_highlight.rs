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

impl RenderPlan {
    /// Whether some surface has a glossy lobe: neither a perfect mirror nor sheeting.
    #[must_use]
    pub fn has_glossy_lobes(&self) -> bool {
        self.shaders.iter().any(|shader| lobe(&shader.kind).is_some())
    }

    /// Whether a highlight that is narrower than a pixel may lie among the rays of the pixel: its corners and
    /// its middle. Bumps of the surface and what hides a light are not regarded.
    #[must_use]
    pub fn sees_narrow_highlight(&self, rays: &[Ray]) -> bool {
        let hits: Vec<(Ray, Intersection)> =
            rays.iter().filter_map(|ray| Some((*ray, self.first_hit(ray, None)?))).collect();
        let of_hit = |(_, hit): &(Ray, Intersection)| lobe(&self.shader_at(hit.shader).kind);
        let Some((roughness, first)) = hits.iter().find_map(|hit| Some((of_hit(hit)?, hit.1.shader))) else {
            return false;
        };
        let on_surface = || hits.iter().filter(|(_, hit)| hit.shader == first);
        let is_shown = |light: &Light| {
            let slopes: Vec<DVec3> = on_surface().filter_map(|(ray, hit)| slope(ray, hit, light)).collect();
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
fn slope(ray: &Ray, hit: &Intersection, light: &Light) -> Option<DVec3> {
    let to_light = if light.primitive.is_none() { light.center } else { light.center - hit.point }.normalize_or_zero();
    let normal = -hit.front * hit.front.dot(ray.direction).signum();
    let facet = to_light - ray.direction;
    (to_light.dot(normal) > 0.0).then(|| facet / facet.dot(normal) - normal)
}
