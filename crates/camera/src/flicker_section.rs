//! `[flicker.MODIFIER]`, and the shutter of `[camera]`.

use crate::Found;
use crate::inapplicable::{self, OF_A_ROLLING_SHUTTER, OF_A_SQUARE_WAVE};
use crate::section::{Range, Section, shorten};
use crate::shutter::{Flicker, FlickeringLamp, Shutter, Waveform};
use radsight_diag::{Diagnostic, SourceMap, hint_nearest};

/// `shutter` and, where it is rolling, `line_time_us`.
pub(crate) fn shutter(section: &Section<'_>, sources: &SourceMap, found: &mut Found) -> Shutter {
    let global = |found: &mut Found| {
        inapplicable::refuse(section, &OF_A_ROLLING_SHUTTER, "shutter = \"global\"", sources, found);
        Shutter::Global
    };
    if !section.has("shutter") {
        section.optional_string("shutter", sources, found);
        return global(found);
    }
    let Some(name) = section.optional_string("shutter", sources, found) else { return Shutter::Global };
    match name.value {
        "global" => global(found),
        "rolling" => {
            let line_time_us = section.number("line_time_us", Range::Positive, "15.0", sources, found);
            line_time_us.map_or(Shutter::Global, |time| Shutter::Rolling { line_time_s: time * 1e-6 })
        }
        other => {
            let message = format!("unknown shutter \"{}\", expected \"global\" or \"rolling\"", shorten(other));
            let hint = hint_nearest(other, ["global", "rolling"]);
            found.errors.push(Diagnostic::error(message).at(name.span).maybe_hint(hint));
            Shutter::Global
        }
    }
}

/// One lamp.
pub(crate) fn read(
    modifier: &str,
    section: Section<'_>,
    sources: &SourceMap,
    found: &mut Found,
) -> Option<FlickeringLamp> {
    let frequency_hz = section.number("frequency_hz", Range::Positive, "100.0", sources, found);
    let modulation = section.number("modulation", Range::NotNegative, "0.3", sources, found);
    let phase_deg = section.optional_number("phase_deg", Range::Finite, sources, found).unwrap_or(0.0);
    let waveform = waveform(&section, sources, found);
    let mut at_most_one = |key, value: Option<f64>| {
        if let Some(value) = value.filter(|value| *value > 1.0) {
            let message = format!("\"{key}\" must be at most 1, not {value}");
            found.errors.push(Diagnostic::error(message).at(section.span_of(key, sources)));
        }
    };
    at_most_one("modulation", modulation);
    if let Some(Waveform::Square { duty }) = waveform {
        at_most_one("duty", Some(duty));
    }
    section.close(sources, found);
    let flicker = Flicker { frequency_hz: frequency_hz?, modulation: modulation?, phase_deg, waveform: waveform? };
    Some(FlickeringLamp { modifier: modifier.to_owned(), flicker })
}

fn waveform(section: &Section<'_>, sources: &SourceMap, found: &mut Found) -> Option<Waveform> {
    let sine = |found: &mut Found| {
        inapplicable::refuse(section, &OF_A_SQUARE_WAVE, "waveform = \"sine\"", sources, found);
        Some(Waveform::Sine)
    };
    if !section.has("waveform") {
        section.optional_string("waveform", sources, found);
        return sine(found);
    }
    let name = section.optional_string("waveform", sources, found)?;
    match name.value {
        "sine" => sine(found),
        "square" => {
            let duty = section.number("duty", Range::Positive, "0.5", sources, found);
            duty.map(|duty| Waveform::Square { duty })
        }
        other => {
            let message = format!("unknown waveform \"{}\", expected \"sine\" or \"square\"", shorten(other));
            let hint = hint_nearest(other, ["sine", "square"]);
            found.errors.push(Diagnostic::error(message).at(name.span).maybe_hint(hint));
            None
        }
    }
}
