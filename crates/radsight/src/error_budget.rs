//! Splits a requested error between the irradiance cache and the pixels.

use radsight_film::{ErrorTarget, Interpolation, MAX_SAMPLES, SamplingBudget};
use radsight_render::{Gathering, LightDivision, RenderOptions, Uncached};

/// Error below which the limits of rays per pixel and per cache point are raised.
const COARSE_ERROR: f64 = 0.02;

/// Ratio of cache noise to the requested error, and of the interpolation distance. The smallest
/// distance suffices for any error.
const NOISE_SHARE: f64 = 1.5;
const REACH_SHARE: f64 = 0.5;
const NEAR_ENOUGH: f64 = 0.1;

/// With a requested error, the error of the whole picture counts, not visible unevenness in
/// corners.
const ALLOCATION_FLOOR: f64 = 0.1;

/// Largest factor on the rays of a cache point. Below the coarse error, cache points get more rays
/// in proportion to the required noise. More points with few rays each would reach the same noise
/// in more time.
const MOST_THOROUGH: f64 = 16.0;

/// Caustics are cached where records agree within this multiple of the noise. Elsewhere pixels get
/// as many rays as the requested error needs.
const CAUSTIC_NOISES: f64 = 2.0;

/// Relative noise of the irradiance from N rays, times √N, as measured for Radiance's records.
const NOISE_OF_A_RAY: f64 = 1.5;

/// Mean number of rays of a record without a requested error, relative to Radiance's records.
/// Neighbouring records share their rays.
const RECORD_SHARE: f64 = 0.75;

/// Number of Radiance's records relative to radsight's with the same `-aa`. Where the records of a
/// preview are closer, together they get no more rays than Radiance's.
const RADIANCE_RECORDS: f64 = 2.5;

/// With more than so many rays a record, Radiance's time grows with the number, radsight's hardly.
/// The time is spent on less noise, by this power of the number, and on records that the pre-pass
/// finds to be missing in corners, up to this spacing of its rays, pixels: a preview with many rays
/// is to be accurate.
const FEW_RAYS: f64 = 80.0;
const THOROUGHNESS: f64 = 0.15;
const FINEST_PREPASS: f64 = 2.0;

/// Accuracy (`-aa`) from which the pre-pass of a finer first grid (`-ps`) is as fine as the grid.
const FINE_ACCURACY: f64 = 0.05;

/// Maximum interpolation error of a preview's irradiance cache (`-aa`), relative to the noise of a
/// record: records of many rays are worth a smaller spacing.
const INTERPOLATION_NOISES: f64 = 3.0;

/// Rays at a diffuse surface without cache (`-aa 0`), relative to Radiance's: as much time, since a
/// ray costs more and its noise is lower. Cells that are refined because of noise cost further rays.
const SPLIT_SHARE: f64 = 0.8;
const SPLIT_SHARE_OF_CELLS: f64 = 0.6;

/// Points on each part of a light (`-ds`), together over the rays of a pixel. Radiance takes about
/// as many.
const POINTS_PER_SQUARE: f64 = 2.0;

/// Radiance's default of `-pj`. A picture with a requested error averages over whole pixels.
const USUAL_JITTER: f64 = 0.67;

/// The requested quality of a picture or of a capture: a relative error, a number of rays per
/// pixel, or a preview.
///
/// ```
/// use radsight::{ErrorBudget, RenderOptions, SamplingBudget};
/// let mut options = RenderOptions { ambient_bounces: 2, ..RenderOptions::default() };
/// let pixels = ErrorBudget::error(0.02).apply(&mut options);
/// // The cache is filled for a part of the error; pixels estimate the rest.
/// assert!(matches!(pixels, SamplingBudget::Error(target) if target.error == 0.02));
/// assert!(options.gathering.noise <= 0.03);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorBudget(Asked);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Asked {
    /// Its limit of samples is that at the coarse error.
    Error(ErrorTarget),
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
    /// Largest number of rays per pixel with a requested error.
    pub const MOST_SAMPLES: u32 = MAX_SAMPLES;

    /// A requested relative error: rms over the bands of all pixels, relative to their values.
    ///
    /// ```
    /// assert_eq!(radsight::ErrorBudget::error(0.02).asked_error(), Some(0.02));
    /// ```
    #[must_use]
    pub fn error(error: f64) -> ErrorBudget {
        ErrorBudget(Asked::Error(ErrorTarget::new(error)))
    }

    /// The same with a maximum number of rays per pixel; a number of rays or a preview is unchanged.
    /// The limit of a picture holds for an error of 0.02 or more; for a lower one it grows with the
    /// inverse square of the error. The error is estimated from the first four rays of a pixel, so
    /// pictures and captures refuse a limit below four with [`Error::Option`](crate::Error::Option).
    ///
    /// ```
    /// use radsight::{ErrorBudget, Renderer, Scene, View};
    /// let scene = Scene::from_text("void glow white 0 0 4 1 1 1 0  white sphere ball 0 0 4 0 9 0 .1")?;
    /// let view = View::from_args("-vp 0 0 0 -vd 0 1 0 -vh 3 -vv 3")?;
    /// let budget = ErrorBudget::error(0.02).at_most(16);
    /// let image = Renderer::new(&scene)?.budget(budget).render(&view, 16, 16)?;
    /// assert!(image.samples().unwrap().iter().all(|samples| *samples <= 16));
    /// assert!(image.report().is_stopped); // the ball's edge needs more
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn at_most(mut self, samples: u32) -> ErrorBudget {
        if let Asked::Error(target) = &mut self.0 {
            target.most_samples = samples.min(ErrorBudget::MOST_SAMPLES);
        }
        self
    }

    /// A number of rays per pixel.
    ///
    /// ```
    /// assert_eq!(radsight::ErrorBudget::samples(16).asked_samples(), Some(16));
    /// ```
    #[must_use]
    pub fn samples(samples: u32) -> ErrorBudget {
        ErrorBudget(Asked::Samples(samples))
    }

    /// Radiance's adaptive preview: smooth regions are interpolated between samples.
    ///
    /// ```
    /// use radsight::{ErrorBudget, Interpolation, SamplingBudget};
    /// let coarse = ErrorBudget::preview(Interpolation { spacing: 8.0, contrast: 0.1 });
    /// assert!(matches!(coarse.apply(&mut Default::default()), SamplingBudget::Interpolated(_)));
    /// ```
    #[must_use]
    pub fn preview(interpolation: Interpolation) -> ErrorBudget {
        ErrorBudget(Asked::Preview(interpolation))
    }

    /// The budget for a sampling budget given by a user.
    ///
    /// ```
    /// use radsight::{ErrorBudget, SamplingBudget};
    /// assert_eq!(ErrorBudget::of(SamplingBudget::Samples(3)), ErrorBudget::samples(3));
    /// ```
    #[must_use]
    pub fn of(budget: SamplingBudget) -> ErrorBudget {
        ErrorBudget(match budget {
            SamplingBudget::Error(target) => Asked::Error(target),
            SamplingBudget::Samples(samples) => Asked::Samples(samples),
            SamplingBudget::Interpolated(interpolation) => Asked::Preview(interpolation),
        })
    }

    /// What was requested.
    pub(crate) fn asked(&self) -> SamplingBudget {
        match self.0 {
            Asked::Error(target) => SamplingBudget::Error(target),
            Asked::Samples(samples) => SamplingBudget::Samples(samples),
            Asked::Preview(interpolation) => SamplingBudget::Interpolated(interpolation),
        }
    }

    /// The requested number of rays per pixel, if any.
    #[must_use]
    pub fn asked_samples(&self) -> Option<u32> {
        if let Asked::Samples(samples) = self.0 { Some(samples) } else { None }
    }

    /// The target of an exposure; `None` for a number of rays or a preview.
    pub(crate) fn target(&self) -> Option<ErrorTarget> {
        if let Asked::Error(target) = self.0 { Some(target) } else { None }
    }

    /// The requested error, if any.
    #[must_use]
    pub fn asked_error(&self) -> Option<f64> {
        match self.0 {
            Asked::Error(target) => Some(target.error),
            Asked::Samples(_) | Asked::Preview(_) => None,
        }
    }

    /// The default side of the square in a pixel over which its rays are jittered, pixels (`-pj`).
    ///
    /// ```
    /// use radsight::ErrorBudget;
    /// assert_eq!([ErrorBudget::error(0.1), ErrorBudget::default()].map(|budget| budget.pixel_jitter()), [1.0, 0.67]);
    /// ```
    #[must_use]
    pub fn pixel_jitter(&self) -> f64 {
        if let Asked::Preview(_) = self.0 { USUAL_JITTER } else { 1.0 }
    }

    /// The side in pixels of the squares that get one ray of the cache's pre-pass: half the spacing
    /// of a preview, less where records are to have many rays; at least two unless `-aa` is small.
    ///
    /// ```
    /// use radsight::options::Gathering;
    /// use radsight::{ErrorBudget, Interpolation};
    /// let coarse = ErrorBudget::preview(Interpolation { spacing: 8.0, contrast: 0.1 });
    /// let gathering = |divisions| Gathering { divisions, super_samples: 0, ..Gathering::default() };
    /// assert_eq!([64, 1024].map(|divisions| coarse.prepass_spacing(&gathering(divisions))), [4, 2]);
    /// let single = ErrorBudget::preview(Interpolation { spacing: 1.0, contrast: 0.0 });
    /// let accurate_to = |accuracy| Gathering { accuracy, ..gathering(256) };
    /// assert_eq!([0.2, 0.05].map(|accuracy| single.prepass_spacing(&accurate_to(accuracy))), [2, 1]);
    /// assert_eq!(ErrorBudget::error(0.1).prepass_spacing(&gathering(64)), 1);
    /// ```
    #[must_use]
    pub fn prepass_spacing(&self, gathering: &Gathering) -> usize {
        let Asked::Preview(Interpolation { spacing, .. }) = self.0 else { return 1 };
        let coarsest = 0.5 * spacing;
        let finer = (gathering.rays() as f64 / FEW_RAYS).max(1.0).sqrt();
        let finest = if gathering.accuracy <= FINE_ACCURACY { coarsest.min(FINEST_PREPASS) } else { FINEST_PREPASS };
        (coarsest / finer).max(finest).max(1.0) as usize
    }

    /// Allots the irradiance cache its part of the error, or Radiance's number of rays, and returns
    /// the budget of the pixels. The noise of a cached value may exceed the error, since a pixel
    /// averages several values; interpolation bias grows as the square of the interpolation
    /// distance.
    ///
    /// ```
    /// use radsight::{ErrorBudget, RenderOptions, SamplingBudget};
    /// let pixels = ErrorBudget::samples(4).apply(&mut RenderOptions::default());
    /// assert_eq!(pixels, SamplingBudget::Samples(4));
    /// ```
    #[must_use]
    pub fn apply(&self, options: &mut RenderOptions) -> SamplingBudget {
        let gathering = &mut options.gathering;
        match self.0 {
            Asked::Error(ErrorTarget { error, most_samples }) => {
                gathering.noise = NOISE_SHARE * error;
                gathering.allocation_floor = ALLOCATION_FLOOR;
                if gathering.accuracy > 0.0 && gathering.divisions > 1 {
                    let thoroughness = (COARSE_ERROR / error).powi(2).clamp(1.0, MOST_THOROUGH);
                    let divisions = f64::from(gathering.divisions) * thoroughness;
                    gathering.divisions = divisions.min(Gathering::MOST_RAYS.into()) as u32;
                }
                gathering.caustic_error = (CAUSTIC_NOISES * gathering.noise).min(Gathering::MAX_INTERPOLATION_ERROR);
                gathering.accuracy = gathering.accuracy.min((REACH_SHARE * error.sqrt()).max(NEAR_ENOUGH));
                let finer = (COARSE_ERROR / error).max(1.0).powi(2);
                let most_samples = (finer * f64::from(most_samples)).min(MAX_SAMPLES.into()) as u32;
                SamplingBudget::Error(ErrorTarget { error, most_samples })
            }
            Asked::Samples(samples) => SamplingBudget::Samples(samples),
            Asked::Preview(interpolation) => {
                let rays = gathering.rays() as f64;
                let thoroughness = (rays / FEW_RAYS).max(1.0).powf(THOROUGHNESS);
                gathering.noise = NOISE_OF_A_RAY / (thoroughness * rays.max(1.0).sqrt());
                let requested = gathering.accuracy;
                gathering.accuracy = requested.min(INTERPOLATION_NOISES * gathering.noise);
                let closeness = if requested > 0.0 { gathering.accuracy / requested } else { 1.0 };
                gathering.record_share = RECORD_SHARE * (RADIANCE_RECORDS * closeness * closeness).min(1.0);
                gathering.most_residual = f64::INFINITY;
                if gathering.accuracy == 0.0 {
                    split(gathering, interpolation.spacing);
                }
                let density = points_per_square(interpolation.spacing);
                options.light_division = match interpolation.spacing {
                    ..2.0 => LightDivision::BySize(density),
                    _ => LightDivision::Shared(density),
                };
                SamplingBudget::Interpolated(interpolation)
            }
        }
    }
}

/// Lets the rays of a preview without cache (`-aa 0`) split at surfaces as in Radiance, into fewer
/// rays (`-ad`, `-as`).
fn split(gathering: &mut Gathering, spacing: f64) {
    let share = if spacing < 2.0 { SPLIT_SHARE } else { SPLIT_SHARE_OF_CELLS };
    let fewer = |rays: u32| (share * f64::from(rays)).ceil() as u32;
    gathering.uncached = Uncached::Split;
    gathering.divisions = fewer(gathering.divisions);
    gathering.super_samples = fewer(gathering.super_samples);
}

/// Points in each part of a light for one ray of a preview, whose first grid has this spacing.
fn points_per_square(spacing: f64) -> f64 {
    POINTS_PER_SQUARE / f64::from(Interpolation { spacing, contrast: 0.0 }.most_rays())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The options of a preview with this spacing and cache (`-aa`, `-ad`).
    fn preview(spacing: f64, accuracy: f64, divisions: u32) -> RenderOptions {
        let gathering = Gathering { accuracy, divisions, ..Gathering::default() };
        let mut options = RenderOptions { gathering, ..RenderOptions::default() };
        let pixels = ErrorBudget::preview(Interpolation { spacing, contrast: 0.05 }).apply(&mut options);
        assert!(matches!(pixels, SamplingBudget::Interpolated(_)));
        options
    }

    #[test]
    fn single_rays_take_as_many_points_on_lights_as_several_rays() {
        let [single, several] = [1.0, 4.0].map(|spacing| preview(spacing, 0.1, 64).light_division);
        assert_eq!([single, several], [LightDivision::BySize(2.0), LightDivision::Shared(0.5)]);
    }

    #[test]
    fn many_rays_reduce_noise_by_more_than_their_number() {
        let [few, many] = [64, 6400].map(|divisions| preview(4.0, 0.1, divisions).gathering);
        assert!(many.noise < 0.06 * few.noise, "{} and {}", few.noise, many.noise);
        // Below, the noise is that of Radiance's records.
        assert_eq!(few.noise, NOISE_OF_A_RAY / 8.0);
    }

    #[test]
    fn closer_records_get_no_more_rays_in_all() {
        let [usual, far] = [0.2, 0.5].map(|accuracy| preview(4.0, accuracy, 1024).gathering);
        assert_eq!(usual.accuracy, far.accuracy, "the noise decides");
        assert!(usual.record_share < RECORD_SHARE && far.record_share < 0.2 * usual.record_share);
        assert_eq!(preview(4.0, 0.1, 64).gathering.record_share, RECORD_SHARE);
    }

    #[test]
    fn records_of_many_rays_are_nearer_to_each_other() {
        assert_eq!(preview(4.0, 0.3, 64).gathering.accuracy, 0.3);
        assert!(preview(4.0, 0.1, 3600).gathering.accuracy < 0.05);
        assert_eq!(preview(4.0, 0.0, 3600).gathering.accuracy, 0.0);
    }
}
