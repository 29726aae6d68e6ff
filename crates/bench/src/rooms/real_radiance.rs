//! Real Radiance in the same rooms: the time of its fastest setting to the error of our picture.

use super::comparison::Comparison;
use crate::curve::{Curve, TimeTo};
use crate::error::BenchError;
use crate::race::{Program, Real, RealKind, Scene};
use crate::radiance::Radiance;
use radsight_picture::Image;
use std::fmt;

/// The ratio of a program's time to ours at equal error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TimeRatio {
    About(f64),
    /// Even the cheapest of its pictures is better.
    AtMost(f64),
    /// None of its pictures is as good; this is the most expensive.
    MoreThan(f64),
}

impl TimeRatio {
    pub(super) fn value(self) -> f64 {
        match self {
            TimeRatio::About(times) | TimeRatio::AtMost(times) | TimeRatio::MoreThan(times) => times,
        }
    }
}

impl fmt::Display for TimeRatio {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mark = match self {
            TimeRatio::About(_) => "",
            TimeRatio::AtMost(_) => "<",
            TimeRatio::MoreThan(_) => ">",
        };
        write!(out, "{mark}{:.2}", self.value())
    }
}

/// Pictures of a room at several settings.
#[derive(Debug)]
pub(super) struct RealRadiance {
    /// Error and processor time of each, s.
    pictures: Vec<(f64, f64)>,
}

impl RealRadiance {
    /// Renders the rooms: every series of `rtrace` and of `rpict` continues until it reaches the error
    /// `least`, or until a picture takes longer than `limit` seconds of processor time.
    pub(super) fn new(
        radiance: &Radiance,
        scene: &Scene,
        references: [&Image<f32>; 2],
        (least, limit): (f64, u64),
    ) -> Result<RealRadiance, BenchError> {
        let mut pictures = Vec::new();
        for kind in [RealKind::Rtrace, RealKind::Rpict] {
            let mut real = Real::new(radiance, kind, limit);
            real.prepare(scene, &scene.folder)?;
            for series in real.series(scene) {
                for setting in &series.settings {
                    let (taken, picture) = match real.render(scene, setting, &scene.folder) {
                        Err(BenchError::TookTooLong { .. }) => break,
                        made => made?,
                    };
                    let error = Comparison::new(&picture, references).pixels.error();
                    pictures.push((error, taken.processor));
                    if error <= least {
                        break;
                    }
                }
            }
        }
        Ok(RealRadiance { pictures })
    }

    /// Relative to a picture with this error and time in seconds; `None` if there is nothing to
    /// compare.
    pub(super) fn ratio_to(&self, error: f64, seconds: f64) -> Option<TimeRatio> {
        if error.is_nan() || error <= 0.0 || seconds <= 0.0 {
            return None;
        }
        Some(match Curve::new(self.pictures.iter().copied()).time_to(error) {
            TimeTo::Interpolated(time) => TimeRatio::About(time / seconds),
            TimeTo::AtMost(time) => TimeRatio::AtMost(time / seconds),
            TimeTo::NotReached => {
                let dearest = self.pictures.iter().map(|(_, time)| *time).reduce(f64::max)?;
                TimeRatio::MoreThan(dearest / seconds)
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_those_to_the_same_error() {
        let real_radiance = RealRadiance { pictures: vec![(0.2, 1.0), (0.1, 4.0), (0.15, 9.0)] };
        assert_eq!(real_radiance.ratio_to(0.1, 2.0), Some(TimeRatio::About(2.0)));
        assert_eq!(real_radiance.ratio_to(0.3, 2.0), Some(TimeRatio::AtMost(0.5)));
        assert_eq!(real_radiance.ratio_to(0.05, 2.0).map(|times| times.to_string()), Some(">4.50".to_owned()));
        assert_eq!(real_radiance.ratio_to(0.0, 2.0), None);
        assert_eq!(RealRadiance { pictures: Vec::new() }.ratio_to(0.1, 2.0), None);
    }
}
