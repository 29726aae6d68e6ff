//! Real Radiance in the same rooms: how long the best of its settings takes to the error that our picture has.

use super::judge::Judgement;
use crate::curve::{Curve, TimeTo};
use crate::error::BenchError;
use crate::race::{Program, Real, RealKind, Scene};
use crate::radiance::Radiance;
use radsight_picture::Image;
use std::fmt;

/// How many times as long as ours a program takes to an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TimesAsLong {
    About(f64),
    /// Even the cheapest of its pictures is better.
    AtMost(f64),
    /// None of its pictures is so good; this is the dearest.
    MoreThan(f64),
}

impl TimesAsLong {
    pub(super) fn value(self) -> f64 {
        match self {
            TimesAsLong::About(times) | TimesAsLong::AtMost(times) | TimesAsLong::MoreThan(times) => times,
        }
    }
}

impl fmt::Display for TimesAsLong {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mark = match self {
            TimesAsLong::About(_) => "",
            TimesAsLong::AtMost(_) => "<",
            TimesAsLong::MoreThan(_) => ">",
        };
        write!(out, "{mark}{:.2}", self.value())
    }
}

/// Pictures of a room at several settings.
#[derive(Debug)]
pub(super) struct Rival {
    /// Error and processor time of each, s.
    pictures: Vec<(f64, f64)>,
}

impl Rival {
    /// Makes them: every series of `rtrace` and of `rpict` goes on until it has the error `least`, or until a picture takes longer than `limit`
    /// seconds of processor time.
    pub(super) fn new(
        radiance: &Radiance,
        scene: &Scene,
        references: [&Image<f32>; 2],
        (least, limit): (f64, u64),
    ) -> Result<Rival, BenchError> {
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
                    let error = Judgement::new(&picture, references).pixels.error();
                    pictures.push((error, taken.processor));
                    if error <= least {
                        break;
                    }
                }
            }
        }
        Ok(Rival { pictures })
    }

    /// Beside a picture of this error that took so many seconds; `None` where there is nothing to compare.
    pub(super) fn beside(&self, error: f64, seconds: f64) -> Option<TimesAsLong> {
        if error.is_nan() || error <= 0.0 || seconds <= 0.0 {
            return None;
        }
        Some(match Curve::new(self.pictures.iter().copied()).time_to(error) {
            TimeTo::Interpolated(time) => TimesAsLong::About(time / seconds),
            TimeTo::AtMost(time) => TimesAsLong::AtMost(time / seconds),
            TimeTo::NotReached => {
                let dearest = self.pictures.iter().map(|(_, time)| *time).reduce(f64::max)?;
                TimesAsLong::MoreThan(dearest / seconds)
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_those_to_the_same_error() {
        let rival = Rival { pictures: vec![(0.2, 1.0), (0.1, 4.0), (0.15, 9.0)] };
        assert_eq!(rival.beside(0.1, 2.0), Some(TimesAsLong::About(2.0)));
        assert_eq!(rival.beside(0.3, 2.0), Some(TimesAsLong::AtMost(0.5)));
        assert_eq!(rival.beside(0.05, 2.0).map(|times| times.to_string()), Some(">4.50".to_owned()));
        assert_eq!(rival.beside(0.0, 2.0), None);
        assert_eq!(Rival { pictures: Vec::new() }.beside(0.1, 2.0), None);
    }
}
