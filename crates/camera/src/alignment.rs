//! Where camera, sensor, ring and LEDs really are, and how one specimen's are drawn from
//! tolerances.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::fmt::Write;

/// Samples beyond this number of standard deviations are drawn again: such a part does not pass
/// inspection.
const INSPECTED: f64 = 3.0;

/// How far everything is off, in the units of the camera file, so that what is written can be read
/// back exactly.
///
/// Shifts are along the nominal right, up and direction of the camera; turns are rotation vectors
/// about them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Alignment {
    /// Shift of camera and ring together, millimetres.
    pub camera_shift_mm: [f64; 3],
    /// Turn of camera and ring together, degrees.
    pub camera_turn_deg: [f64; 3],
    /// Shift of the image on the sensor, right and up, micrometres.
    pub sensor_shift_um: [f64; 2],
    /// Turn of the sensor about right and up, degrees.
    pub sensor_tilt_deg: [f64; 2],
    /// Shift of the ring against the camera, millimetres.
    pub ring_shift_mm: [f64; 3],
    /// Turn of the ring against the camera, degrees.
    pub ring_turn_deg: [f64; 3],
    /// Each LED against the ring; as many as there are, or none.
    pub leds: Vec<LedAlignment>,
}

/// How far an LED is off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LedAlignment {
    /// Shift, millimetres.
    pub shift_mm: [f64; 3],
    /// Turn about right and up, degrees.
    pub tilt_deg: [f64; 2],
    /// Intensity over the nominal one.
    pub intensity: f64,
}

impl Default for LedAlignment {
    fn default() -> Self {
        LedAlignment { shift_mm: [0.0; 3], tilt_deg: [0.0; 2], intensity: 1.0 }
    }
}

/// Standard deviations, of each component, in the units of the camera file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerances {
    /// Of the camera's place, millimetres.
    pub camera_shift_mm: f64,
    /// Of its turn, degrees.
    pub camera_turn_deg: f64,
    /// Of the sensor's shift, micrometres.
    pub sensor_shift_um: f64,
    /// Of the sensor's tilt, degrees.
    pub sensor_tilt_deg: f64,
    /// Of the ring's place, millimetres.
    pub ring_shift_mm: f64,
    /// Of the ring's turn, degrees.
    pub ring_turn_deg: f64,
    /// Of each LED's place, millimetres.
    pub led_shift_mm: f64,
    /// Of each LED's direction, degrees.
    pub led_tilt_deg: f64,
    /// Of each LED's intensity, percent.
    pub led_intensity_percent: f64,
}

impl Alignment {
    /// This alignment with the deviations of one specimen, of `leds` LEDs. Each quantity has a
    /// stream of random numbers of its own: a tolerance that changes, changes no other draw.
    #[must_use]
    pub fn drawn(&self, tolerances: &Tolerances, leds: usize, specimen: u64) -> Alignment {
        let draw = |stream: u64, deviation: f64| {
            let mut random = ChaCha8Rng::seed_from_u64(specimen);
            random.set_stream(stream);
            std::iter::repeat_with(move || inspected(&mut random) * deviation)
        };
        let add = |to: &mut [f64], stream, deviation: f64| {
            if deviation > 0.0 {
                to.iter_mut().zip(draw(stream, deviation)).for_each(|(value, drawn)| *value += drawn);
            }
        };
        let mut all = self.clone();
        add(&mut all.camera_shift_mm, 1, tolerances.camera_shift_mm);
        add(&mut all.camera_turn_deg, 2, tolerances.camera_turn_deg);
        add(&mut all.sensor_shift_um, 3, tolerances.sensor_shift_um);
        add(&mut all.sensor_tilt_deg, 4, tolerances.sensor_tilt_deg);
        add(&mut all.ring_shift_mm, 5, tolerances.ring_shift_mm);
        add(&mut all.ring_turn_deg, 6, tolerances.ring_turn_deg);
        let spread = [tolerances.led_shift_mm, tolerances.led_tilt_deg, tolerances.led_intensity_percent];
        if spread.iter().any(|deviation| *deviation > 0.0) {
            all.leds.resize(leds, LedAlignment::default());
        }
        for (number, led) in (0..).zip(&mut all.leds) {
            let stream = 16 + 3 * number;
            add(&mut led.shift_mm, stream, spread[0]);
            add(&mut led.tilt_deg, stream + 1, spread[1]);
            let mut share = [0.0];
            add(&mut share, stream + 2, 0.01 * spread[2]);
            led.intensity = (led.intensity * (1.0 + share[0])).max(0.0);
        }
        all
    }

    /// The table `[alignment]` of a camera file that gives this specimen again.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let list = |values: &[f64]| {
            let words: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
            format!("[{}]", words.join(", "))
        };
        let mut out = String::from("[alignment]\n");
        let rows: [(&str, &[f64]); 6] = [
            ("camera_shift_mm", &self.camera_shift_mm),
            ("camera_turn_deg", &self.camera_turn_deg),
            ("sensor_shift_um", &self.sensor_shift_um),
            ("sensor_tilt_deg", &self.sensor_tilt_deg),
            ("ring_shift_mm", &self.ring_shift_mm),
            ("ring_turn_deg", &self.ring_turn_deg),
        ];
        for (key, values) in rows {
            let _ = writeln!(out, "{key} = {}", list(values));
        }
        if !self.leds.is_empty() {
            let shifts: Vec<f64> = self.leds.iter().flat_map(|led| led.shift_mm).collect();
            let tilts: Vec<f64> = self.leds.iter().flat_map(|led| led.tilt_deg).collect();
            let intensities: Vec<f64> = self.leds.iter().map(|led| led.intensity).collect();
            for (key, values) in [("led_shift_mm", shifts), ("led_tilt_deg", tilts), ("led_intensity", intensities)] {
                let _ = writeln!(out, "{key} = {}", list(&values));
            }
        }
        out
    }
}

/// A standard normal number within inspection.
fn inspected(random: &mut ChaCha8Rng) -> f64 {
    loop {
        let normal: f64 = StandardNormal.sample(random);
        if normal.abs() <= INSPECTED {
            return normal;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_have_their_spread_and_depend_on_nothing_else() {
        let tolerances = Tolerances { led_tilt_deg: 0.5, led_intensity_percent: 10.0, ..Tolerances::default() };
        let all = Alignment::default().drawn(&tolerances, 4000, 7);
        let square = all.leds.iter().map(|led| led.tilt_deg[0].powi(2)).sum::<f64>() / 4000.0;
        // A Gaussian cut at three standard deviations keeps 0.9733 of its variance.
        assert!((square / (0.25 * 0.9733) - 1.0).abs() < 0.08, "{square}");
        assert!(all.leds.iter().all(|led| (0.7..=1.3).contains(&led.intensity) && led.shift_mm == [0.0; 3]));
        let other = Tolerances { camera_shift_mm: 1.0, ..tolerances };
        let moved = Alignment::default().drawn(&other, 4000, 7);
        assert_eq!(moved.leds, all.leds);
        assert_ne!(Alignment::default().drawn(&other, 4000, 8).camera_shift_mm, moved.camera_shift_mm);
    }
}
