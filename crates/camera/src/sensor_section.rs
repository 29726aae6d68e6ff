//! `[sensor]`.

use crate::Found;
use crate::section::{Range, Section, shorten};
use radsight_diag::{Diagnostic, SourceMap, hint_nearest};
use radsight_pinhole::{BandWeights, BandWeightsError, PinholeCamera};
use radsight_sensor::{
    BitDepth, Emva1288, Emva1288Description, ExposureUnit, PowerLaw, PowerLawDescription, Sensor, SensorError,
};

/// The most bands of a scene.
const MOST_BANDS: usize = 10_000;

/// The sensor and the band weights; nothing where either is wrong.
pub(crate) fn read(
    section: Section<'_>,
    camera: Option<&PinholeCamera>,
    sources: &SourceMap,
    found: &mut Found,
) -> Option<(Sensor, Option<BandWeights>)> {
    let before = found.errors.len();
    let weights = band_weights(&section, sources, found);
    let response = section.string("response", "\"power-law\"", sources, found);
    let sensor = match response.as_ref().map(|name| name.value) {
        Some("power-law") => power_law(&section, sources, found),
        Some("emva1288") => emva1288(&section, camera, sources, found),
        Some(other) => {
            let message = format!("unknown response \"{}\", expected \"power-law\" or \"emva1288\"", shorten(other));
            let error = Diagnostic::error(message).at(section.span_of("response", sources));
            found.errors.push(error.maybe_hint(hint_nearest(other, ["power-law", "emva1288"])));
            return None;
        }
        None => None,
    };
    // Without a response nothing says which keys are known.
    if response.is_some() {
        section.close(sources, found);
    } else {
        section.close_without_keys(found);
    }
    sensor.filter(|_| found.errors.len() == before).map(|sensor| (sensor, weights))
}

fn band_weights(section: &Section<'_>, sources: &SourceMap, found: &mut Found) -> Option<BandWeights> {
    let weights = section.optional_numbers("band_weights", None, Range::NotNegative, sources, found)?;
    let span = section.span_of("band_weights", sources);
    if weights.is_empty() || weights.len() > MOST_BANDS {
        let message = format!("\"band_weights\" must have 1 to {MOST_BANDS} numbers, not {}", weights.len());
        found.errors.push(Diagnostic::error(message).at(span));
        return None;
    }
    let normalised = BandWeights::new(&weights);
    normalised.map_err(|error: BandWeightsError| found.errors.push(Diagnostic::error(error.to_string()).at(span))).ok()
}

fn power_law(section: &Section<'_>, sources: &SourceMap, found: &mut Found) -> Option<Sensor> {
    let k = section.number("k", Range::Positive, "33844.0", sources, found);
    let gamma = section.number("gamma", Range::Positive, "0.85", sources, found);
    let grey_background = section.number("grey_background", Range::NotNegative, "12", sources, found);
    let grey_max = section.number("grey_max", Range::Positive, "161", sources, found);
    let exposure_unit = exposure_unit(section, sources, found);
    let bits = bits(section, sources, found);
    let asked = PowerLawDescription {
        k: k?,
        gamma: gamma?,
        grey_background: grey_background?,
        grey_max: grey_max?,
        exposure_unit: exposure_unit?,
        bits: bits?,
    };
    let sensor = PowerLaw::new(&asked);
    sensor.map(Sensor::PowerLaw).map_err(|error| refuse(&error, section, sources, found)).ok()
}

fn emva1288(
    section: &Section<'_>,
    camera: Option<&PinholeCamera>,
    sources: &SourceMap,
    found: &mut Found,
) -> Option<Sensor> {
    let quantum_efficiency = section.number("quantum_efficiency", Range::Positive, "0.6", sources, found);
    let gain_dn_per_e = section.number("gain_dn_per_e", Range::Positive, "0.25", sources, found);
    let full_well_e = section.number("full_well_e", Range::Positive, "14000", sources, found);
    let read_noise_e = section.number("read_noise_e", Range::NotNegative, "12", sources, found);
    let dark_offset_dn = section.optional_number("dark_offset_dn", Range::NotNegative, sources, found);
    let dark_current = section.optional_number("dark_current_e_per_s", Range::NotNegative, sources, found);
    let bits = bits(section, sources, found);
    let camera = camera?;
    if camera.wavelength_m().is_none() {
        let message = "response \"emva1288\" needs the wavelength: [camera] has no \"wavelength_nm\"";
        let error = Diagnostic::error(message).at(section.span_of("response", sources));
        found.errors.push(error.hint("for example wavelength_nm = 650.0"));
    }
    let asked = Emva1288Description {
        quantum_efficiency: quantum_efficiency?,
        gain_dn_per_e: gain_dn_per_e?,
        dark_offset_dn: dark_offset_dn.unwrap_or(0.0),
        dark_current_e_per_s: dark_current.unwrap_or(0.0),
        read_noise_e: read_noise_e?,
        full_well_e: full_well_e?,
        bits: bits?,
        pixel_area_m2: camera.pixel_area_m2(),
        wavelength_m: camera.wavelength_m()?,
        exposure_s: camera.exposure_s(),
    };
    let sensor = Emva1288::new(&asked);
    sensor.map(Sensor::Emva1288).map_err(|error| refuse(&error, section, sources, found)).ok()
}

fn exposure_unit(section: &Section<'_>, sources: &SourceMap, found: &mut Found) -> Option<ExposureUnit> {
    let name = section.string("exposure_unit", "\"uJ/cm2\"", sources, found)?;
    let unit = ExposureUnit::from_name(name.value);
    if unit.is_none() {
        let known = ExposureUnit::ALL.map(ExposureUnit::name);
        let message =
            format!("unknown exposure_unit \"{}\", expected one of {}", shorten(name.value), known.join(", "));
        let error = Diagnostic::error(message).at(name.span);
        found.errors.push(error.maybe_hint(hint_nearest(name.value, known)));
    }
    unit
}

/// `bits`; 8 where it is not given.
fn bits(section: &Section<'_>, sources: &SourceMap, found: &mut Found) -> Option<BitDepth> {
    if !section.has("bits") {
        section.optional_whole("bits", [8, 16], sources, found);
        return Some(BitDepth::EIGHT);
    }
    let bits = section.optional_whole("bits", [8, 16], sources, found)?;
    BitDepth::new(bits).map_err(|error| refuse(&error, section, sources, found)).ok()
}

/// Puts a sensor's own complaint at the key that it names.
fn refuse(error: &SensorError, section: &Section<'_>, sources: &SourceMap, found: &mut Found) {
    let key = match error {
        SensorError::OutOfRange { quantity, .. } => *quantity,
        SensorError::TooBright { .. } | SensorError::NoRange { .. } => "grey_max",
        SensorError::Bits { .. } => "bits",
        _ => "response",
    };
    found.errors.push(Diagnostic::error(error.to_string()).at(section.span_of(key, sources)));
}
