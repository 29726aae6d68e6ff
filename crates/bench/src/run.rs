//! One measured run.

use crate::accuracy::Accuracy;
use crate::cost::Cost;
use crate::figure::Figure;
use std::fmt;

/// The settings of a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Setting {
    /// `radsight capture --samples N`.
    Samples(u32),
    /// `radsight capture --error E`.
    Error(f64),
    /// Real `rtrace` with N rays per pixel.
    Radiance(RadianceOptions, u32),
}

/// The options of real `rtrace`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RadianceOptions {
    /// Its defaults, with which an LED is one point or few.
    Defaults,
    /// `-ds .002 -dj 1`: LEDs in small pieces, jittered.
    Subdivided,
}

impl RadianceOptions {
    /// In command-line syntax.
    pub(crate) fn words(self) -> &'static [&'static str] {
        match self {
            RadianceOptions::Defaults => &[],
            RadianceOptions::Subdivided => &["-ds", ".002", "-dj", "1"],
        }
    }
}

impl fmt::Display for RadianceOptions {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RadianceOptions::Defaults => out.write_str("defaults"),
            RadianceOptions::Subdivided => out.write_str("-ds .002 -dj 1"),
        }
    }
}

impl Setting {
    /// The program.
    pub(crate) fn program(self) -> &'static str {
        match self {
            Setting::Samples(_) | Setting::Error(_) => "radsight",
            Setting::Radiance(..) => "rtrace",
        }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Setting::Samples(samples) => write!(out, "--samples {samples}"),
            Setting::Error(error) => write!(out, "--error {error}"),
            Setting::Radiance(options, 1) => write!(out, "{options}, 1 ray"),
            Setting::Radiance(options, samples) => write!(out, "{options}, {samples} rays"),
        }
    }
}

/// A run, or the medians of its repetitions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Run {
    pub(crate) figure: Figure,
    pub(crate) setting: Setting,
    pub(crate) cost: Cost,
    pub(crate) accuracy: Accuracy,
    pub(crate) repetitions: u32,
}

/// The median of each quantity; `None` for no runs.
pub(crate) fn median(runs: &[(Cost, Accuracy)]) -> Option<(Cost, Accuracy)> {
    let of = |value: fn(&(Cost, Accuracy)) -> f64| middle(runs.iter().map(value).collect());
    Some((
        Cost { wall: of(|run| run.0.wall)?, processor: of(|run| run.0.processor)? },
        Accuracy {
            error: of(|run| run.1.error)?,
            own_error: of(|run| run.1.own_error)?,
            within_one_grey: of(|run| run.1.within_one_grey)?,
        },
    ))
}

pub(crate) fn middle(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let upper = *values.get(values.len() / 2)?;
    Some(if values.len() % 2 == 1 { upper } else { 0.5 * (values[values.len() / 2 - 1] + upper) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_ignores_one_disturbed_run() {
        assert_eq!(middle(vec![2.0, 90.0, 1.0]), Some(2.0));
        assert_eq!(middle(vec![4.0, 1.0]), Some(2.5));
        assert_eq!(middle(Vec::new()), None);
    }
}
