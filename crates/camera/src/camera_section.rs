//! `[camera]`.

use crate::Found;
use crate::section::{Range, Section};
use radsight_diag::{Diagnostic, SourceMap, hint_nearest};
use radsight_pinhole::{CameraDescription, CameraError, PinholeCamera, PinholeModel};

/// The most columns or rows that are accepted one way.
const MOST_PIXELS_ACROSS: i64 = 1_000_000;

pub(crate) fn read(section: Section<'_>, sources: &SourceMap, found: &mut Found) -> Option<PinholeCamera> {
    let camera = read_keys(&section, sources, found);
    section.close(sources, found);
    camera
}

fn read_keys(section: &Section<'_>, sources: &SourceMap, found: &mut Found) -> Option<PinholeCamera> {
    let position_m = section.numbers::<3>("position_m", Range::Finite, "[0.0, 0.0, 0.48]", sources, found);
    let direction = section.numbers::<3>("direction", Range::Finite, "[0.0, 0.0, -1.0]", sources, found);
    let up = section.numbers::<3>("up", Range::Finite, "[0.0, 1.0, 0.0]", sources, found);
    let pixels = section.whole_pair("pixels", [1, MOST_PIXELS_ACROSS], "[192, 165]", sources, found);
    let pitch_um = section.numbers::<2>("pixel_pitch_um", Range::Positive, "[13.75, 16.0]", sources, found);
    let focal_mm = section.number("focal_distance_mm", Range::Positive, "6.75", sources, found);
    let diameter_mm = section.number("pinhole_diameter_mm", Range::Positive, "0.1", sources, found);
    let model = pinhole_model(section, sources, found);
    let exposure_ms = section.number("exposure_ms", Range::Positive, "10.0", sources, found);
    let wavelength_nm = section.optional_number("wavelength_nm", Range::Positive, sources, found);
    let scene_unit_m = section.optional_number("scene_unit_m", Range::Positive, sources, found);
    let asked = CameraDescription {
        position_m: position_m?,
        direction: direction?,
        up: up?,
        pixels: pixels?.map(|count| u32::try_from(count).unwrap_or(u32::MAX)),
        pixel_pitch_m: pitch_um?.map(|pitch| pitch * 1e-6),
        focal_distance_m: focal_mm? * 1e-3,
        pinhole_diameter_m: diameter_mm? * 1e-3,
        pinhole_model: model?,
        exposure_s: exposure_ms? * 1e-3,
        wavelength_m: wavelength_nm.map(|wavelength| wavelength * 1e-9),
        scene_unit_m: scene_unit_m.unwrap_or(1.0),
    };
    warn(&asked, section, sources, found);
    PinholeCamera::new(&asked)
        .map_err(|error| {
            let key = match error {
                CameraError::PixelCount { .. } => "pixels",
                CameraError::ZeroVector { quantity: "direction" } => "direction",
                CameraError::ZeroVector { .. } | CameraError::UpParallel => "up",
                // What is left is an underflow: a quantity above 0 in its own unit that is 0 in the SI unit.
                _ => "",
            };
            found.errors.push(Diagnostic::error(error.to_string()).at(section.span_of(key, sources)));
        })
        .ok()
}

/// `pinhole_model`; finite where it is not given.
fn pinhole_model(section: &Section<'_>, sources: &SourceMap, found: &mut Found) -> Option<PinholeModel> {
    const MODELS: [&str; 3] = ["point", "finite", "diffraction"];
    if !section.has("pinhole_model") {
        section.optional_string("pinhole_model", sources, found);
        return Some(PinholeModel::Finite);
    }
    let name = section.optional_string("pinhole_model", sources, found)?;
    let error = match name.value {
        "finite" => return Some(PinholeModel::Finite),
        "point" => return Some(PinholeModel::Point),
        "diffraction" => Diagnostic::error("pinhole_model \"diffraction\" is not available yet")
            .hint("\"finite\" averages over the hole without diffraction"),
        other => {
            let message = format!(
                "unknown pinhole_model \"{}\", expected \"point\", \"finite\" or \"diffraction\"",
                crate::section::shorten(other)
            );
            Diagnostic::error(message).maybe_hint(hint_nearest(other, MODELS))
        }
    };
    found.errors.push(error.at(name.span));
    None
}

/// What is possible, but more likely a wrong unit.
fn warn(asked: &CameraDescription, section: &Section<'_>, sources: &SourceMap, found: &mut Found) {
    let mut warn = |key, message: String| {
        found.warnings.push(Diagnostic::warning(message).at(section.span_of(key, sources)));
    };
    if asked.pinhole_diameter_m > 0.5 * asked.focal_distance_m {
        let message = "the pinhole is more than half as wide as its distance from the sensor: is the unit right?";
        warn("pinhole_diameter_mm", message.to_owned());
    }
    if asked.pixel_pitch_m.iter().any(|pitch| !(0.1e-6..=1e-3).contains(pitch)) {
        warn("pixel_pitch_um", "pixels are usually 0.1 to 1000 um apart: is the unit right?".to_owned());
    }
    if asked.wavelength_m.is_some_and(|wavelength| !(100e-9..=20e-6).contains(&wavelength)) {
        warn("wavelength_nm", "light is usually between 100 and 20000 nm: is the unit right?".to_owned());
    }
}
