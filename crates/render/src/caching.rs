//! How far cached irradiance is trusted.

use radsight_compile::RenderPlan;
use radsight_irradiance_cache::Limits;

/// Where records are farther apart than this makes them, too few are near each other to tell that they disagree.
const ACCURACY_FOR_CAUSTICS: f64 = 0.1;

/// Where less noise is allowed than this, what bends in caustics must not remain either: less of the noise explains it, but this share at least.
const COARSE_NOISE: f64 = 0.02;
const LEAST_EXPLAINED: f64 = 0.02;

/// Whether irradiance is shared between points at all.
pub(crate) fn caches_irradiance(plan: &RenderPlan) -> bool {
    plan.options.ambient_bounces > 0 && plan.options.gathering.accuracy > 0.0 && plan.options.gathering.rays() > 1
}

/// By what share records may disagree around a point and still be trusted there.
pub(crate) fn max_interpolation_error(plan: &RenderPlan) -> f64 {
    let gathering = &plan.options.gathering;
    if plan.has_caustics { gathering.caustic_error } else { gathering.most_residual }
}

/// How near and how far records are trusted: as Radiance does, from the scene's size.
pub(crate) fn gathering_limits(plan: &RenderPlan) -> Limits {
    let gathering = &plan.options.gathering;
    let size = 2.0 * plan.bounding_sphere().1.max(f64::MIN_POSITIVE) / 3f64.sqrt();
    let max_reach = 0.5 * size;
    let accuracy = if gathering.accuracy > 0.0 { gathering.accuracy } else { 1.0 };
    let accuracy = if plan.has_caustics { accuracy.min(ACCURACY_FOR_CAUSTICS) } else { accuracy };
    let resolved = size * accuracy / f64::from(gathering.resolution.max(1));
    let min_reach = if gathering.resolution > 0 && resolved < max_reach { resolved } else { max_reach / 64.0 };
    let explained = (gathering.noise / COARSE_NOISE).powi(2).clamp(LEAST_EXPLAINED, 1.0);
    let explained = if plan.has_caustics { explained } else { 1.0 };
    Limits { accuracy, min_reach, max_reach, explained }
}
