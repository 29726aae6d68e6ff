//! How an asked error is split between the irradiance cache and the pixels.

use radsight_film::{Interpolation, MAX_SAMPLES, SamplingBudget};
use radsight_render::{Gathering, LightDivision, RenderOptions};

/// For less error than this pixels may have more rays than usual, and cache points more.
const COARSE_ERROR: f64 = 0.02;

/// What of an error goes to the noise and the reach of cached irradiance; records that reach no farther than this
/// are good enough for any error.
const NOISE_SHARE: f64 = 1.5;
const REACH_SHARE: f64 = 0.5;
const NEAR_ENOUGH: f64 = 0.1;

/// Where an error is asked for, the whole picture's counts, not what is seen in its corners.
const ALLOCATION_FLOOR: f64 = 0.1;

/// For errors below the coarse one cache points have more rays, in proportion to what noise needs, at most so many times: many
/// points with few rays each come to no less noise, for more time.
const MOST_THOROUGH: f64 = 16.0;

/// Caustics are cached where records disagree by less than so many times the noise; elsewhere pixels have as many rays as the
/// asked error needs.
const CAUSTIC_NOISES: f64 = 2.0;

/// Relative noise of the irradiance that N rays find, times √N: what Radiance's records have.
const NOISE_OF_A_RAY: f64 = 1.5;

/// Rays that a record traces in the mean where no error is asked for, as a share of those that Radiance's records do: neighbours
/// share them.
const RECORD_SHARE: f64 = 0.75;

/// Radiance's default of `-pj`; a picture of which an error is asked averages whole pixels.
const USUAL_JITTER: f64 = 0.67;

/// How good a picture is to be.
///
/// ```
/// use radsight::{ErrorBudget, RenderOptions, SamplingBudget};
/// let mut options = RenderOptions { ambient_bounces: 2, ..RenderOptions::default() };
/// let pixels = ErrorBudget::error(0.02).apply(&mut options);
/// // The cache is filled for a part of the error; pixels find out what is left of it.
/// assert!(matches!(pixels, SamplingBudget::Error { error, .. } if error == 0.02));
/// assert!(options.gathering.noise <= 0.03);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorBudget(Asked);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Asked {
    /// Relative error, and the most rays a pixel at the coarse error.
    Error(f64, u32),
    Samples(u32),
    Preview(Interpolation),
}

/// A preview with Radiance's defaults: a sample every four pixels, contrast 0.05.
impl Default for ErrorBudget {
    fn default() -> Self {
        ErrorBudget::preview(Interpolation { spacing: 4.0, contrast: 0.05 })
    }
}

impl ErrorBudget {
    /// Rays a pixel at most, where an error is asked for.
    pub const MOST_SAMPLES: u32 = MAX_SAMPLES;

    /// This relative error: rms over the bands of all pixels, as a share of their values.
    #[must_use]
    pub fn error(error: f64) -> ErrorBudget {
        ErrorBudget(Asked::Error(error, ErrorBudget::MOST_SAMPLES))
    }

    /// So many rays through every pixel.
    #[must_use]
    pub fn samples(samples: u32) -> ErrorBudget {
        ErrorBudget(Asked::Samples(samples))
    }

    /// What Radiance's options say: smooth parts are interpolated between samples.
    #[must_use]
    pub fn preview(interpolation: Interpolation) -> ErrorBudget {
        ErrorBudget(Asked::Preview(interpolation))
    }

    /// The budget that a sampling budget stands for, as a user gives it.
    #[must_use]
    pub fn of(budget: SamplingBudget) -> ErrorBudget {
        ErrorBudget(match budget {
            SamplingBudget::Error { error, most } => Asked::Error(error, most),
            SamplingBudget::Samples(samples) => Asked::Samples(samples),
            SamplingBudget::Interpolated(interpolation) => Asked::Preview(interpolation),
        })
    }

    /// The error that is asked for, if one is.
    #[must_use]
    pub fn asked_error(&self) -> Option<f64> {
        match self.0 {
            Asked::Error(error, _) => Some(error),
            Asked::Samples(_) | Asked::Preview(_) => None,
        }
    }

    /// Side of the square in a pixel over which its rays are spread, in pixels, unless something else is asked for (`-pj`).
    #[must_use]
    pub fn pixel_jitter(&self) -> f64 {
        if let Asked::Preview(_) = self.0 { USUAL_JITTER } else { 1.0 }
    }

    /// The side in pixels of the squares that have one ray of the cache's pre-pass.
    #[must_use]
    pub fn prepass_spacing(&self) -> usize {
        match self.0 {
            Asked::Preview(Interpolation { spacing, .. }) => (0.5 * spacing).max(1.0) as usize,
            _ => 1,
        }
    }

    /// Gives the irradiance cache its part, or that of the rays that Radiance would trace, and says what is left to the pixels. A
    /// value's noise may be more than the error, since a pixel sees several values; interpolation bias grows as the square of the
    /// distance that records reach.
    #[must_use]
    pub fn apply(&self, options: &mut RenderOptions) -> SamplingBudget {
        let gathering = &mut options.gathering;
        match self.0 {
            Asked::Error(error, most) => {
                gathering.noise = NOISE_SHARE * error;
                gathering.allocation_floor = ALLOCATION_FLOOR;
                if gathering.accuracy > 0.0 && gathering.divisions > 1 {
                    let thoroughness = (COARSE_ERROR / error).powi(2).clamp(1.0, MOST_THOROUGH);
                    gathering.divisions = (f64::from(gathering.divisions) * thoroughness) as u32;
                }
                gathering.caustic_error = (CAUSTIC_NOISES * gathering.noise).min(Gathering::MAX_INTERPOLATION_ERROR);
                gathering.accuracy = gathering.accuracy.min((REACH_SHARE * error.sqrt()).max(NEAR_ENOUGH));
                let finer = (COARSE_ERROR / error).max(1.0).powi(2);
                let most = (finer * f64::from(most)).min(MAX_SAMPLES.into()) as u32;
                SamplingBudget::Error { error, most }
            }
            Asked::Samples(samples) => SamplingBudget::Samples(samples),
            Asked::Preview(interpolation) => {
                let rays = f64::from(gathering.divisions + gathering.super_samples);
                gathering.noise = NOISE_OF_A_RAY / rays.max(1.0).sqrt();
                gathering.record_share = RECORD_SHARE;
                gathering.most_residual = f64::INFINITY;
                options.light_division = LightDivision::BySize;
                SamplingBudget::Interpolated(interpolation)
            }
        }
    }
}
