//! Direct light by cubature: the points of a rule replace samples on small uniform lights.
//!
//! At the first surface of a camera ray, where light sampling alone finds the lights. A light that
//! may be partly hidden, and one that no rule integrates accurately, is sampled as always.

use crate::cubature_error::CubatureError;
use crate::direct::{DirectSampler, ReachingLight};
use crate::trace::PathIntegrator;
use radsight_bsdf::{Bsdf, SmoothLobe};
use radsight_compile::{RenderPlan, VisibilityClass, given};
use radsight_light::{Light, LightCubature};
use radsight_texture::bands;

impl DirectSampler<'_> {
    /// The allowed error of rules at this point, and what it reflects; `None` where lights are
    /// sampled.
    #[inline]
    pub(crate) fn light_cubature<const BANDS: usize>(
        &self,
        tracer: &PathIntegrator<'_, BANDS>,
        point: &Bsdf<'_, BANDS>,
    ) -> Option<(CubatureError, SmoothLobe<BANDS>)> {
        let allowed = tracer.light_cubature?;
        let is_alone = self.highlight_draws == 0 && !self.shares_diffuse && !self.drawn;
        let is_plain = tracer.tree.is_none() && tracer.contributions.is_none() && !tracer.plan.shadow_rays_interact;
        if is_alone && is_plain { Some((allowed, point.smooth_lobe()?)) } else { None }
    }

    /// The contribution of a light by cubature; `None` where it must be sampled. `u` gives the point
    /// of the unit square of its sample.
    #[inline]
    pub(crate) fn integrate<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        (allowed, lobe): (CubatureError, &SmoothLobe<BANDS>),
        lit: &ReachingLight<'_>,
        u: impl FnOnce(&mut PathIntegrator<'_, BANDS>) -> [f64; 2],
    ) -> Option<[f64; BANDS]> {
        let light = lit.light;
        let uniform = uniform_radiance(tracer, light);
        if uniform.is_none() && allowed.0 > LARGEST_ERROR_OF_PATTERNS {
            return None;
        }
        let cubature = light.cubature(self.point, &self.reception.peak, allowed.0)?;
        let is_free = *lit.between == VisibilityClass::Nothing || self.sees_all_of(tracer.plan, light, lit.between);
        if !is_free {
            return None;
        }
        if let Some(radiance) = uniform {
            return Some(scattered(tracer, lobe, (light, &cubature), &RadiancePlane::uniform(radiance)));
        }
        let plane = self.radiance_plane(tracer, light, &cubature)?;
        let mut sum = scattered(tracer, lobe, (light, &cubature), &plane);
        // The difference is small, so few of the rays sample it.
        let [u, v] = u(tracer);
        if u >= SAMPLED_SHARE {
            return Some(sum);
        }
        let sampler = light.sampler(self.point, &self.reception.peak);
        let Some(sample) = self.light_sample(tracer, &sampler, [u / SAMPLED_SHARE, v]) else { return Some(sum) };
        let value = lobe.value(sample.direction);
        let fit = plane.at(cubature.coordinates(&sample));
        let radiance = self.radiance(tracer, light, &sample);
        let share = light.focal_factor(sample.distance) / (SAMPLED_SHARE * sample.pdf);
        for (band, sum) in sum.iter_mut().enumerate() {
            *sum += share * value[band] * (radiance[band] - fit[band]);
        }
        Some(sum)
    }

    /// The radiance of a light with a pattern, as a linear function; `None` if it varies much over
    /// the light.
    fn radiance_plane<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        light: &Light,
        cubature: &LightCubature,
    ) -> Option<RadiancePlane<BANDS>> {
        let mut corners = [[0.0; BANDS]; 3];
        for (corner, at) in corners.iter_mut().zip(RadiancePlane::<BANDS>::CORNERS) {
            *corner = self.radiance(tracer, light, &cubature.sample_at(at)?);
        }
        let plane = RadiancePlane::new(corners);
        (0..BANDS).all(|band| plane.slope(band) <= STEEPEST * plane.mean[band]).then_some(plane)
    }
}

/// Radiance scattered from the nodes of a light.
#[inline]
fn scattered<const BANDS: usize>(
    tracer: &mut PathIntegrator<'_, BANDS>,
    lobe: &SmoothLobe<BANDS>,
    (light, cubature): (&Light, &LightCubature),
    plane: &RadiancePlane<BANDS>,
) -> [f64; BANDS] {
    let nodes = &mut tracer.workspace.disk_nodes;
    cubature.nodes(nodes);
    let [along, across] = plane.slopes;
    lobe.scattered((nodes, cubature.frame()), light.focal_distance, [plane.mean, along, across])
}

/// Largest error for which lights with patterns are integrated: their radiance is evaluated several
/// times, and a few cheaper samples are accurate enough beyond it.
const LARGEST_ERROR_OF_PATTERNS: f64 = 1e-3;

/// Share of the rays that sample the difference of a pattern from its control variate.
const SAMPLED_SHARE: f64 = 0.25;

/// Largest change of a pattern over the radius of a light, relative to its mean: the limits of the
/// rules are those of the lobe.
const STEEPEST: f64 = 0.3;

/// A linear function over a disk: the control variate of a pattern's radiance.
#[derive(Clone, Copy, Debug)]
struct RadiancePlane<const BANDS: usize> {
    mean: [f64; BANDS],
    /// Along both axes, per radius.
    slopes: [[f64; BANDS]; 2],
}

impl<const BANDS: usize> RadiancePlane<BANDS> {
    /// The corners of an equilateral triangle, relative to the radius of the disk.
    const CORNERS: [[f64; 2]; 3] = [[0.7, 0.0], [-0.35, 0.606_217_782_649_107], [-0.35, -0.606_217_782_649_107]];

    fn uniform(radiance: [f64; BANDS]) -> RadiancePlane<BANDS> {
        RadiancePlane { mean: radiance, slopes: [[0.0; BANDS]; 2] }
    }

    /// From the values at the corners.
    fn new(corners: [[f64; BANDS]; 3]) -> RadiancePlane<BANDS> {
        let [[ax, _], [bx, by], _] = Self::CORNERS;
        let [a, b, c] = corners;
        RadiancePlane {
            mean: std::array::from_fn(|band| (a[band] + b[band] + c[band]) / 3.0),
            slopes: [
                std::array::from_fn(|band| (a[band] - 0.5 * (b[band] + c[band])) / (ax - bx)),
                std::array::from_fn(|band| (b[band] - c[band]) / (2.0 * by)),
            ],
        }
    }

    fn at(&self, [x, y]: [f64; 2]) -> [f64; BANDS] {
        std::array::from_fn(|band| self.mean[band] + self.slopes[0][band] * x + self.slopes[1][band] * y)
    }

    /// Change over the radius.
    fn slope(&self, band: usize) -> f64 {
        self.slopes[0][band].hypot(self.slopes[1][band])
    }
}

/// Whether rules suit the shapes of all lights.
pub(crate) fn integrates_all_lights(plan: &RenderPlan) -> bool {
    plan.light_tree.is_none() && plan.lights.iter().all(Light::is_plain_disk)
}

/// The radiance of a light without pattern, in all directions of its cone.
#[inline]
fn uniform_radiance<const BANDS: usize>(tracer: &PathIntegrator<'_, BANDS>, light: &Light) -> Option<[f64; BANDS]> {
    let shader = tracer.plan.shader(light.surface);
    let emitter = shader.kind.emitter()?;
    shader.textures.steps.is_empty().then(|| given(bands(emitter.radiance)))
}
