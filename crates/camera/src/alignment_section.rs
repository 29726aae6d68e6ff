//! `[alignment]` and `[tolerances]`.

use crate::alignment::{Alignment, LedAlignment, Tolerances};
use crate::section::{Range, Section};
use crate::{Found, Rig};
use radsight_diag::{Diagnostic, SourceMap};
use radsight_pinhole::{FilmPlane, PinholeCamera};

/// A turn of more degrees is no misalignment.
const LARGEST_TURN_DEG: f64 = 45.0;

/// The number of LEDs that the alignment can move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Leds {
    /// The number of LEDs of the [rig].
    Known(usize),
    /// The file has no [rig].
    None,
    /// The [rig] is wrong, which has been reported.
    Wrong,
}

impl Leds {
    fn count(self) -> usize {
        if let Leds::Known(count) = self { count } else { 0 }
    }
}

/// The sum of both tables; `None` if neither is there, or one is wrong.
pub(crate) fn read(
    stated: Option<Section<'_>>,
    tolerated: Option<Section<'_>>,
    leds: Leds,
    sources: &SourceMap,
    found: &mut Found,
) -> Option<Alignment> {
    let before = found.errors.len();
    let is_asked = stated.is_some() || tolerated.is_some();
    let alignment = stated.map_or_else(Alignment::default, |section| read_stated(section, leds, sources, found));
    let drawn = match tolerated {
        Some(section) => {
            let (tolerances, specimen) = read_tolerances(section, sources, found);
            alignment.drawn(&tolerances, leds.count(), specimen)
        }
        None => alignment,
    };
    (is_asked && found.errors.len() == before).then_some(drawn)
}

/// Keys with numbers for each LED.
const LED_KEYS: [&str; 3] = ["led_shift_mm", "led_tilt_deg", "led_intensity"];

fn read_stated(section: Section<'_>, leds: Leds, sources: &SourceMap, found: &mut Found) -> Alignment {
    let mut list = |key, length| {
        let values = section.optional_numbers(key, Some(length), Range::Finite, sources, found);
        values.unwrap_or_else(|| vec![0.0; length])
    };
    let three = |values: Vec<f64>| [values[0], values[1], values[2]];
    let two = |values: Vec<f64>| [values[0], values[1]];
    let mut alignment = Alignment {
        camera_shift_mm: three(list("camera_shift_mm", 3)),
        camera_turn_deg: three(list("camera_turn_deg", 3)),
        sensor_shift_um: two(list("sensor_shift_um", 2)),
        sensor_tilt_deg: two(list("sensor_tilt_deg", 2)),
        ring_shift_mm: three(list("ring_shift_mm", 3)),
        ring_turn_deg: three(list("ring_turn_deg", 3)),
        leds: Vec::new(),
    };
    let tilts = read_leds(&section, leds, &mut alignment, sources, found);
    let turns = [("camera_turn_deg", &alignment.camera_turn_deg[..]), ("sensor_tilt_deg", &alignment.sensor_tilt_deg)];
    let turns = turns.into_iter().chain([("ring_turn_deg", &alignment.ring_turn_deg[..]), ("led_tilt_deg", &tilts)]);
    for (key, values) in turns {
        if let Some(turn) = values.iter().find(|turn| turn.abs() > LARGEST_TURN_DEG) {
            let message = format!("\"{key}\" must be from -{LARGEST_TURN_DEG} to {LARGEST_TURN_DEG}, not {turn}");
            found.errors.push(Diagnostic::error(message).at(section.span_of(key, sources)));
        }
    }
    section.close(sources, found);
    alignment
}

/// Puts the LEDs into the alignment; gives their tilts, degrees.
fn read_leds(
    section: &Section<'_>,
    leds: Leds,
    alignment: &mut Alignment,
    sources: &SourceMap,
    found: &mut Found,
) -> Vec<f64> {
    let stated = LED_KEYS.into_iter().find(|key| section.has(key));
    let (Some(_), Leds::Known(count)) = (stated, leds) else {
        // Numbers of any length, so that other mistakes in them are reported.
        LED_KEYS.into_iter().for_each(|key| drop(section.optional_numbers(key, None, Range::Finite, sources, found)));
        if let (Some(key), Leds::None) = (stated, leds) {
            let message = format!("\"{key}\" needs LEDs, but the camera file has no [rig]");
            found.errors.push(Diagnostic::error(message).at(section.span_of(key, sources)));
        }
        return Vec::new();
    };
    let mut list = |key, length| {
        let values = section.optional_numbers(key, Some(length), Range::Finite, sources, found);
        values.unwrap_or_else(|| vec![0.0; length])
    };
    let (shifts, tilts) = (list(LED_KEYS[0], 3 * count), list(LED_KEYS[1], 2 * count));
    let intensities = section.optional_numbers(LED_KEYS[2], Some(count), Range::NotNegative, sources, found);
    let led = |index: usize| LedAlignment {
        shift_mm: [shifts[3 * index], shifts[3 * index + 1], shifts[3 * index + 2]],
        tilt_deg: [tilts[2 * index], tilts[2 * index + 1]],
        intensity: intensities.as_ref().map_or(1.0, |all| all[index]),
    };
    alignment.leds = (0..count).map(led).collect();
    tilts
}

fn read_tolerances(section: Section<'_>, sources: &SourceMap, found: &mut Found) -> (Tolerances, u64) {
    let mut spread = |key, most: f64| {
        let value = section.optional_number(key, Range::NotNegative, sources, found).unwrap_or(0.0);
        if value > most {
            let message = format!("\"{key}\" must be at most {most}, not {value}");
            found.errors.push(Diagnostic::error(message).at(section.span_of(key, sources)));
        }
        value
    };
    // A draw reaches three standard deviations.
    let turn = LARGEST_TURN_DEG / 3.0;
    let tolerances = Tolerances {
        camera_shift_mm: spread("camera_shift_mm", 1e6),
        camera_turn_deg: spread("camera_turn_deg", turn),
        sensor_shift_um: spread("sensor_shift_um", 1e6),
        sensor_tilt_deg: spread("sensor_tilt_deg", turn),
        ring_shift_mm: spread("ring_shift_mm", 1e6),
        ring_turn_deg: spread("ring_turn_deg", turn),
        led_shift_mm: spread("led_shift_mm", 1e6),
        led_tilt_deg: spread("led_tilt_deg", turn),
        led_intensity_percent: spread("led_intensity_percent", 33.0),
    };
    let specimen = section.optional_whole("specimen", [0, i64::MAX], sources, found);
    section.close(sources, found);
    (tolerances, specimen.map_or(0, i64::unsigned_abs))
}

/// Puts camera and ring where they are.
pub(crate) fn apply(
    alignment: &Alignment,
    camera: PinholeCamera,
    rig: Option<Rig>,
    found: &mut Found,
) -> Option<(PinholeCamera, Option<Rig>)> {
    let film = FilmPlane {
        shift_m: alignment.sensor_shift_um.map(|shift| shift * 1e-6),
        tilt: alignment.sensor_tilt_deg.map(f64::to_radians),
    };
    let shift = alignment.camera_shift_mm.map(|shift| shift * 1e-3);
    let moved = camera.moved(shift, alignment.camera_turn_deg.map(f64::to_radians));
    let moved = moved.map_err(|error| found.errors.push(Diagnostic::error(error.to_string()))).ok()?;
    let rig = rig.map(|rig| Rig { camera: moved.clone(), alignment: Some(alignment.clone()), ..rig });
    Some((moved.with_film_plane(film), rig))
}
