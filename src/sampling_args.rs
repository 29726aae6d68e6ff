//! The sampling budget of a value: `--samples N`, or `--error E`.

use crate::failure::Failure;
use crate::render_args::number;
use radsight_film::{ErrorTarget, MAX_SAMPLES, SamplingBudget};

/// Parses one such option at the front; returns the number of words it used, 0 for another option.
/// `most` limits the rays for an error.
pub(crate) fn take_one(
    words: &[String],
    most: u32,
    sampling_budget: &mut Option<SamplingBudget>,
) -> Result<usize, Failure> {
    let word = words[0].as_str();
    let refused = |found: String, expected: String| {
        Err(Failure::usage(format!("option \"{word}\" is {found}, expected {expected}")))
    };
    match word {
        "--samples" => match number(words, word, "a number of rays")? {
            samples @ 1..=MAX_SAMPLES => *sampling_budget = Some(SamplingBudget::Samples(samples)),
            other => return refused(other.to_string(), format!("1 to {MAX_SAMPLES}")),
        },
        "--error" => match number(words, word, "a relative error above 0, such as 0.02")? {
            error if error > 0.0 && f64::is_finite(error) => {
                *sampling_budget = Some(SamplingBudget::Error(ErrorTarget { error, most_samples: most }))
            }
            error => return refused(error.to_string(), "a relative error above 0, such as 0.02".to_owned()),
        },
        _ => return Ok(0),
    }
    Ok(2)
}
