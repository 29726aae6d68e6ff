//! When each row of the sensor is exposed, and how bright a flickering lamp is then.

use std::f64::consts::TAU;

/// How the rows are exposed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Shutter {
    /// All rows at the same time.
    #[default]
    Global,
    /// One row after the other, from the top of the picture, each for the whole exposure time.
    Rolling {
        /// From the start of a row to the start of the next, seconds.
        line_time_s: f64,
    },
}

impl Shutter {
    /// When the exposure of a row begins, seconds after that of row 0.
    #[must_use]
    pub fn start_s(self, row: u32) -> f64 {
        match self {
            Shutter::Global => 0.0,
            Shutter::Rolling { line_time_s } => f64::from(row) * line_time_s,
        }
    }
}

/// Exposures of fewer periods see one moment of a waveform.
const INSTANT: f64 = 1e-9;

/// The course of a lamp's radiance over one period. Its mean is that of the scene's text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Waveform {
    /// `1 + m cos(2π f t + φ)`.
    Sine,
    /// On for a share of the period, from φ = 0 on: `1 − m + m/duty` while it is on, `1 − m` else.
    Square {
        /// Fraction of a period during which the lamp is on, above 0 and at most 1.
        duty: f64,
    },
}

/// How a lamp flickers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flicker {
    /// f, hertz; that of the light, twice that of the mains for most lamps.
    pub frequency_hz: f64,
    /// m, from 0 (steady) to 1.
    pub modulation: f64,
    /// φ at the start of row 0, degrees.
    pub phase_deg: f64,
    /// The course over a period.
    pub waveform: Waveform,
}

impl Flicker {
    /// The mean radiance over an exposure relative to the mean over all time: the integral of the
    /// waveform in closed form.
    #[must_use]
    pub fn mean(&self, start_s: f64, exposure_s: f64) -> f64 {
        let periods = self.frequency_hz * exposure_s;
        // In periods; the phase alone matters, so whole ones go first.
        let start = (self.frequency_hz * start_s + self.phase_deg / 360.0).rem_euclid(1.0);
        let share = match self.waveform {
            Waveform::Sine => {
                let half = 0.5 * TAU * periods;
                let blurred = if half > 0.0 { half.sin() / half } else { 1.0 };
                blurred * (TAU * (start + 0.5 * periods)).cos()
            }
            // An instant, of which the difference below would keep no digit.
            Waveform::Square { duty } if periods < INSTANT => f64::from(u8::from(start < duty)) / duty - 1.0,
            Waveform::Square { duty } => {
                (time_on(start + periods, duty) - time_on(start, duty)) / (duty * periods) - 1.0
            }
        };
        (1.0 + self.modulation * share).max(0.0)
    }
}

/// How long a square wave was on from 0 to `time`, in periods.
fn time_on(time: f64, duty: f64) -> f64 {
    time.floor() * duty + (time - time.floor()).min(duty)
}

/// A lamp of the scene that flickers.
#[derive(Clone, Debug, PartialEq)]
pub struct FlickeringLamp {
    /// The name of its material in the scene's text.
    pub modifier: String,
    /// How it flickers.
    pub flicker: Flicker,
}

#[cfg(test)]
mod tests {
    use super::*;

    const WAVEFORMS: [Waveform; 3] = [Waveform::Sine, Waveform::Square { duty: 0.3 }, Waveform::Square { duty: 1.0 }];

    fn flicker(waveform: Waveform) -> Flicker {
        Flicker { frequency_hz: 100.0, modulation: 0.8, phase_deg: 40.0, waveform }
    }

    /// The waveform itself.
    fn at(flicker: &Flicker, time_s: f64) -> f64 {
        let phase = (flicker.frequency_hz * time_s + flicker.phase_deg / 360.0).rem_euclid(1.0);
        match flicker.waveform {
            Waveform::Sine => 1.0 + flicker.modulation * (TAU * phase).cos(),
            Waveform::Square { duty } => 1.0 + flicker.modulation * (f64::from(u8::from(phase < duty)) / duty - 1.0),
        }
    }

    #[test]
    fn the_mean_is_the_integral_of_the_waveform() {
        for flicker in WAVEFORMS.map(flicker) {
            for (start, exposure) in [(0.0, 0.002), (0.0043, 0.0007), (1.2345, 0.0271), (7.0, 0.01)] {
                let steps = 200_000;
                let sum: f64 = (0..steps)
                    .map(|step| at(&flicker, start + exposure * (f64::from(step) + 0.5) / f64::from(steps)))
                    .sum();
                let expected = sum / f64::from(steps);
                let mean = flicker.mean(start, exposure);
                assert!((mean - expected).abs() < 2e-5, "{flicker:?} {start} {exposure}: {mean} against {expected}");
            }
        }
    }

    #[test]
    fn whole_periods_show_no_flicker() {
        for flicker in WAVEFORMS.map(flicker) {
            assert!((0..50).all(|row| (flicker.mean(1.7e-4 * f64::from(row), 0.03) - 1.0).abs() < 1e-12));
        }
    }

    #[test]
    fn a_lamp_that_is_off_between_its_pulses_is_dark_then() {
        let pulsed = Flicker { modulation: 1.0, phase_deg: 0.0, ..flicker(Waveform::Square { duty: 0.25 }) };
        assert_eq!(pulsed.mean(0.004, 0.002), 0.0);
        assert!((pulsed.mean(0.0005, 0.001) - 4.0).abs() < 1e-12);
    }

    #[test]
    fn an_exposure_of_almost_no_time_sees_one_moment() {
        for flicker in WAVEFORMS.map(flicker) {
            for start in [0.0, 0.0017, 0.0043, 0.0091] {
                let mean = Flicker { frequency_hz: 1e-30, phase_deg: 3.6e4 * start, ..flicker }.mean(0.0, 0.01);
                let moment = Flicker { phase_deg: 0.0, ..flicker };
                assert!((mean - at(&moment, start)).abs() < 1e-9, "{mean}");
            }
        }
    }
}
