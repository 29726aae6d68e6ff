//! Checks of options before the work.

use crate::error::Error;
use crate::error_budget::ErrorBudget;
use radsight_adaptive::{FIRST_SAMPLES, MAX_SAMPLES};
use radsight_film::{ErrorTarget, Interpolation, SamplingBudget};
use radsight_render::RenderOptions;

const _: () = assert!(FIRST_SAMPLES == 4 && MAX_SAMPLES == 65536, "the messages name these numbers");

/// The error of an option.
pub(crate) fn wrong(option: &'static str, value: impl ToString, expected: &'static str) -> Error {
    Error::Option { option, value: value.to_string(), expected }
}

/// Checks every number of the rendering options.
pub(crate) fn check_options(options: &RenderOptions) -> Result<(), Error> {
    options.check().map_err(|found| Error::Option {
        option: found.option,
        value: found.value,
        expected: found.expected,
    })
}

/// Checks the requested quality of a picture or a capture.
pub(crate) fn check_budget(budget: &ErrorBudget) -> Result<(), Error> {
    match budget.asked() {
        SamplingBudget::Error(ErrorTarget { error, most_samples }) => {
            if !(error > 0.0 && error.is_finite()) {
                return Err(wrong("error", error, "a relative error above 0, such as 0.02"));
            }
            if !(FIRST_SAMPLES..=MAX_SAMPLES).contains(&most_samples) {
                return Err(wrong(
                    "most_samples",
                    most_samples,
                    "4 to 65536: the error is estimated from 4 rays per pixel",
                ));
            }
        }
        SamplingBudget::Samples(samples) if !(1..=MAX_SAMPLES).contains(&samples) => {
            return Err(wrong("samples", samples, "1 to 65536"));
        }
        SamplingBudget::Samples(_) => {}
        SamplingBudget::Interpolated(Interpolation { spacing, contrast }) => {
            if !(spacing >= 1.0 && spacing.is_finite()) {
                return Err(wrong("preview spacing", spacing, "1 pixel or more"));
            }
            if !(contrast >= 0.0 && contrast.is_finite()) {
                return Err(wrong("preview contrast", contrast, "0 or more"));
            }
        }
    }
    Ok(())
}

/// Checks the side of the square in a pixel over which its rays are jittered.
pub(crate) fn check_pixel_jitter(side: f64) -> Result<(), Error> {
    match (0.0..=1.0).contains(&side) {
        true => Ok(()),
        false => Err(wrong("pixel_jitter", side, "a share of a pixel from 0 to 1")),
    }
}

/// Checks the diameter of an aperture.
pub(crate) fn check_aperture(diameter: f64) -> Result<(), Error> {
    match diameter >= 0.0 && diameter.is_finite() {
        true => Ok(()),
        false => Err(wrong("thin_lens", diameter, "the diameter of an aperture, 0 or more")),
    }
}
