//! Options of the irradiance cache.

use radsight_compile::RenderPlan;
use radsight_irradiance_cache::Limits;

/// Maximum `-aa` with caustics: a larger one separates records so far that too few neighbours
/// detect nonlinearity.
const ACCURACY_FOR_CAUSTICS: f64 = 0.1;

/// If less noise is allowed than this, nonlinearity in caustics must be found as well: a smaller
/// part of the residual is explained by noise, down to this fraction.
const COARSE_NOISE: f64 = 0.02;
const MIN_EXPLAINED: f64 = 0.02;

/// Whether the options use an irradiance cache.
pub(crate) fn caches_irradiance(plan: &RenderPlan) -> bool {
    plan.options.ambient_bounces > 0 && plan.options.gathering.accuracy > 0.0 && plan.options.gathering.rays() > 1
}

/// The maximum relative interpolation error at which records are still used.
pub(crate) fn max_interpolation_error(plan: &RenderPlan) -> f64 {
    let gathering = &plan.options.gathering;
    if plan.has_caustics { gathering.caustic_error } else { gathering.most_residual }
}

/// The limits of the reach of records: as in Radiance, from the scene's size.
pub(crate) fn gathering_limits(plan: &RenderPlan) -> Limits {
    let gathering = &plan.options.gathering;
    let size = 2.0 * plan.bounding_sphere().1.max(f64::MIN_POSITIVE) / 3f64.sqrt();
    let max_reach = 0.5 * size;
    let accuracy = if gathering.accuracy > 0.0 { gathering.accuracy } else { 1.0 };
    let accuracy = if plan.has_caustics { accuracy.min(ACCURACY_FOR_CAUSTICS) } else { accuracy };
    let resolved = size * accuracy / f64::from(gathering.resolution.max(1));
    let min_reach = if gathering.resolution > 0 && resolved < max_reach { resolved } else { max_reach / 64.0 };
    let explained = (gathering.noise / COARSE_NOISE).powi(2).clamp(MIN_EXPLAINED, 1.0);
    let explained = if plan.has_caustics { explained } else { 1.0 };
    Limits { accuracy, min_reach, max_reach, explained }
}
