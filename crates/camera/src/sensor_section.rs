//! `[sensor]`.

use crate::inapplicable::{self, OF_A_MOSAIC, OF_A_POWER_LAW, OF_EMVA1288};
use crate::section::{Placed, Range, Section, load_beside, shorten};
use crate::{Found, NumberTable};
use radsight_diag::{Diagnostic, SourceMap, hint_nearest};
use radsight_loader::Loader;
use radsight_pinhole::{BandWeights, BandWeightsError, PinholeCamera};
use radsight_sensor::{
    Bayer, BitDepth, Emva1288, Emva1288Description, ExposureUnit, NonUniformity, PowerLaw, PowerLawDescription, Preset,
    QuantumEfficiencyTable, Sensor, SensorError, SpatialDeviation, dark_current_at,
};

/// The most bands of a scene.
const MOST_BANDS: usize = 10_000;

/// A preset states its quantum efficiency for wavelengths as near as this, metres.
const SAME_WAVELENGTH_M: f64 = 5e-9;

/// Bands of a coloured scene.
const COLORS: usize = 3;

/// The content of `[sensor]`.
pub(crate) struct SensorRead {
    pub(crate) sensor: Sensor,
    pub(crate) band_weights: Option<BandWeights>,
    pub(crate) mosaic: Option<Bayer>,
}

/// The sensor and what is before it; nothing where any of that is wrong.
pub(crate) fn read(
    section: Section<'_>,
    camera: Option<&PinholeCamera>,
    file: &str,
    sources: &mut SourceMap,
    loader: &dyn Loader,
    found: &mut Found,
) -> Option<SensorRead> {
    let before = found.errors.len();
    let weights = band_weights(&section, sources, found);
    let mosaic = mosaic(&section, sources, found);
    let band_weights = match (mosaic, camera) {
        (Some(mosaic), Some(camera)) => filtered(weights, mosaic, camera, &section, sources, found),
        _ => weights,
    };
    if !section.has("mosaic") {
        inapplicable::refuse(&section, &OF_A_MOSAIC, "a sensor without mosaic", sources, found);
    }
    let response = section.string("response", "\"power-law\"", sources, found);
    let sensor = match response.as_ref().map(|name| name.value) {
        Some("power-law") => {
            inapplicable::refuse(&section, &OF_EMVA1288, "response = \"power-law\"", sources, found);
            power_law(&section, sources, found)
        }
        Some("emva1288") => {
            inapplicable::refuse(&section, &OF_A_POWER_LAW, "response = \"emva1288\"", sources, found);
            emva1288(&section, camera, file, sources, loader, found)
        }
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
    sensor.filter(|_| found.errors.len() == before).map(|sensor| SensorRead { sensor, band_weights, mosaic })
}

fn mosaic(section: &Section<'_>, sources: &SourceMap, found: &mut Found) -> Option<Bayer> {
    let name = section.optional_string("mosaic", sources, found)?;
    let mosaic = Bayer::from_name(name.value);
    if mosaic.is_none() {
        let known = Bayer::ALL.map(Bayer::name);
        let message = format!("unknown mosaic \"{}\", expected one of {}", shorten(name.value), known.join(", "));
        found.errors.push(Diagnostic::error(message).at(name.span).maybe_hint(hint_nearest(name.value, known)));
    }
    mosaic
}

/// The weights of the bands behind the filters of a mosaic. A filter passes its own band where the
/// file says nothing else.
fn filtered(
    weights: Option<BandWeights>,
    mosaic: Bayer,
    camera: &PinholeCamera,
    section: &Section<'_>,
    sources: &SourceMap,
    found: &mut Found,
) -> Option<BandWeights> {
    let weights = weights.unwrap_or_else(|| BandWeights::equal(COLORS));
    let mut filters: [Vec<f64>; 3] = Default::default();
    for (index, key) in ["filter_red", "filter_green", "filter_blue"].into_iter().enumerate() {
        let bands = weights.as_slice().len();
        let own = || (0..bands).map(|band| f64::from(u8::from(band == index))).collect();
        filters[index] = match section.has(key) {
            true => section.optional_numbers(key, Some(bands), Range::NotNegative, sources, found)?,
            false => {
                section.optional_numbers(key, Some(bands), Range::NotNegative, sources, found);
                own()
            }
        };
        if let Some(passed) = filters[index].iter().find(|passed| **passed > 1.0) {
            let message = format!("\"{key}\" passes {passed} of a band, expected 0 to 1");
            found.errors.push(Diagnostic::error(message).at(section.span_of(key, sources)));
            return None;
        }
    }
    let refused = |error: BandWeightsError| {
        found.errors.push(Diagnostic::error(error.to_string()).at(section.span_of("mosaic", sources)));
    };
    weights.with_mosaic(camera.columns(), mosaic.cell(), &filters).map_err(refused).ok()
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
    file: &str,
    sources: &mut SourceMap,
    loader: &dyn Loader,
    found: &mut Found,
) -> Option<Sensor> {
    let preset = preset(section, sources, found);
    let bits = bits(section, sources, found);
    let gain = preset.and_then(|preset| preset.electrons_per_16_bit_grey).zip(bits).map(|(electrons, bits)| {
        // Grey levels of fewer bits are so much coarser.
        (electrons * (16.0 - f64::from(bits.bits())).exp2()).recip()
    });
    let efficiency = quantum_efficiency(section, camera, preset, file, sources, loader, found);
    let gain_dn_per_e = number_or(section, "gain_dn_per_e", Range::Positive, "0.25", gain, sources, found);
    let well = preset.map(|preset| preset.full_well_e);
    let full_well_e = number_or(section, "full_well_e", Range::Positive, "14000", well, sources, found);
    let noise = preset.map(|preset| preset.read_noise_e);
    let read_noise_e = number_or(section, "read_noise_e", Range::NotNegative, "12", noise, sources, found);
    let dark_offset_dn = section.optional_number("dark_offset_dn", Range::NotNegative, sources, found);
    let dark_current = dark_current(section, sources, found);
    let uneven = non_uniformity(section, camera, sources, found);
    let camera = camera?;
    if camera.wavelength_m().is_none() {
        let message = "response \"emva1288\" needs the wavelength: [camera] has no \"wavelength_nm\"";
        let error = Diagnostic::error(message).at(section.span_of("response", sources));
        found.errors.push(error.hint("for example wavelength_nm = 650.0"));
    }
    let asked = Emva1288Description {
        quantum_efficiency: efficiency?,
        gain_dn_per_e: gain_dn_per_e?,
        dark_offset_dn: dark_offset_dn.unwrap_or(0.0),
        dark_current_e_per_s: dark_current,
        read_noise_e: read_noise_e?,
        full_well_e: full_well_e?,
        bits: bits?,
        pixel_area_m2: camera.pixel_area_m2(),
        wavelength_m: camera.wavelength_m()?,
        exposure_s: camera.exposure_s(),
    };
    let sensor = Emva1288::new(&asked).and_then(|sensor| match uneven {
        Some(uneven) => sensor.with_non_uniformity(uneven),
        None => Ok(sensor),
    });
    sensor.map(Sensor::Emva1288).map_err(|error| refuse(&error, section, sources, found)).ok()
}

/// A number that a preset may give.
fn number_or(
    section: &Section<'_>,
    key: &'static str,
    range: Range,
    example: &str,
    preset: Option<f64>,
    sources: &SourceMap,
    found: &mut Found,
) -> Option<f64> {
    match preset {
        None => section.number(key, range, example, sources, found),
        Some(preset) if !section.has(key) => {
            section.optional_number(key, range, sources, found);
            Some(preset)
        }
        Some(_) => section.optional_number(key, range, sources, found),
    }
}

fn preset(section: &Section<'_>, sources: &SourceMap, found: &mut Found) -> Option<Preset> {
    let name = section.optional_string("preset", sources, found)?;
    let preset = Preset::from_name(name.value);
    if preset.is_none() {
        let known = Preset::ALL.map(|preset| preset.name);
        let message = format!("unknown preset \"{}\", expected one of {}", shorten(name.value), known.join(", "));
        found.errors.push(Diagnostic::error(message).at(name.span).maybe_hint(hint_nearest(name.value, known)));
    }
    preset
}

/// A number, a table against wavelength, or what a preset states for the camera's wavelength.
fn quantum_efficiency(
    section: &Section<'_>,
    camera: Option<&PinholeCamera>,
    preset: Option<Preset>,
    file: &str,
    sources: &mut SourceMap,
    loader: &dyn Loader,
    found: &mut Found,
) -> Option<f64> {
    let wavelength = camera.and_then(PinholeCamera::wavelength_m);
    if let Some(name) = section.optional_string("quantum_efficiency_table", sources, found) {
        if section.has("quantum_efficiency") {
            section.optional_number("quantum_efficiency", Range::Positive, sources, found);
            let message = "\"quantum_efficiency\" is not used: \"quantum_efficiency_table\" wins";
            let span = section.span_of("quantum_efficiency", sources);
            found.warnings.push(Diagnostic::warning(message).at(span));
        }
        let table = load_efficiency(&name, file, sources, loader, found)?;
        let value = table.at(wavelength?);
        return value.map_err(|error| found.errors.push(Diagnostic::error(error.to_string()).at(name.span))).ok();
    }
    let near = |stated: f64| wavelength.is_some_and(|wavelength| (wavelength - stated).abs() <= SAME_WAVELENGTH_M);
    let stated =
        preset.and_then(|preset| preset.quantum_efficiency).filter(|(_, at)| near(*at)).map(|(value, _)| value);
    if let (Some(preset), None, false) = (preset, stated, section.has("quantum_efficiency")) {
        section.optional_number("quantum_efficiency", Range::Positive, sources, found);
        // A camera that is wrong has no wavelength to look for.
        camera?;
        let error = Diagnostic::error(missing_efficiency(&preset)).at(section.span_of("preset", sources));
        found.errors.push(error.hint("for example quantum_efficiency = 0.6"));
        return None;
    }
    number_or(section, "quantum_efficiency", Range::Positive, "0.6", stated, sources, found)
}

fn missing_efficiency(preset: &Preset) -> String {
    let name = preset.name;
    match preset.quantum_efficiency {
        Some((_, at)) => {
            format!(
                "[sensor] has no \"quantum_efficiency\", and preset \"{name}\" states it at {:.0} nm alone",
                at * 1e9
            )
        }
        None => format!("[sensor] has no \"quantum_efficiency\", and preset \"{name}\" does not state it"),
    }
}

fn load_efficiency(
    name: &Placed<&str>,
    file: &str,
    sources: &mut SourceMap,
    loader: &dyn Loader,
    found: &mut Found,
) -> Option<QuantumEfficiencyTable> {
    let source = load_beside(name, file, sources, loader, found)?;
    let table = NumberTable::read(source, sources, ["wavelength_nm", "quantum_efficiency"]);
    let table = table.map_err(|errors| found.errors.extend(errors)).ok()?;
    let rows: Vec<[f64; 2]> = table.rows.iter().map(|row| [row.values[0] * 1e-9, row.values[1]]).collect();
    let checked = QuantumEfficiencyTable::new(&rows);
    checked.map_err(|error| found.errors.push(Diagnostic::error(error.to_string()).at(name.span))).ok()
}

/// Electrons a second at the sensor's temperature.
fn dark_current(section: &Section<'_>, sources: &SourceMap, found: &mut Found) -> f64 {
    let at_reference = section.optional_number("dark_current_e_per_s", Range::NotNegative, sources, found);
    let temperature = section.optional_number("temperature_c", Range::Finite, sources, found);
    let reference = section.optional_number("dark_reference_c", Range::Finite, sources, found);
    let doubling = section.optional_number("dark_doubling_k", Range::Positive, sources, found);
    let current = at_reference.unwrap_or(0.0);
    match (temperature, reference, doubling) {
        (None, None, None) => current,
        (Some(temperature), Some(reference), Some(doubling)) => {
            dark_current_at(temperature, current, reference, doubling)
        }
        _ => {
            let message = "\"temperature_c\", \"dark_reference_c\" and \"dark_doubling_k\" go together";
            let given =
                ["temperature_c", "dark_reference_c", "dark_doubling_k"].into_iter().find(|key| section.has(key));
            let span = section.span_of(given.unwrap_or("temperature_c"), sources);
            let hint = "for example dark_reference_c = 25.0 and dark_doubling_k = 8.0";
            found.errors.push(Diagnostic::error(message).at(span).hint(hint));
            current
        }
    }
}

/// Differences between pixels, where the file gives any.
fn non_uniformity(
    section: &Section<'_>,
    camera: Option<&PinholeCamera>,
    sources: &SourceMap,
    found: &mut Found,
) -> Option<NonUniformity> {
    let mut part = |key| section.optional_number(key, Range::NotNegative, sources, found);
    let dark = ["dsnu_e", "dsnu_row_e", "dsnu_column_e"].map(&mut part);
    let response = ["prnu_percent", "prnu_row_percent", "prnu_column_percent"].map(&mut part);
    let specimen = section.optional_whole("specimen", [0, i64::MAX], sources, found);
    let is_asked = dark.iter().chain(&response).any(|part| part.is_some_and(|part| part > 0.0));
    let spread = |[pixel, row, column]: [Option<f64>; 3], unit: f64| SpatialDeviation {
        pixel: unit * pixel.unwrap_or(0.0),
        row: unit * row.unwrap_or(0.0),
        column: unit * column.unwrap_or(0.0),
    };
    is_asked.then(|| NonUniformity {
        dsnu_e: spread(dark, 1.0),
        prnu: spread(response, 0.01),
        columns: camera.map_or(1, PinholeCamera::columns),
        specimen: specimen.map_or(0, i64::unsigned_abs),
    })
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
