//! Keys that a camera file may have, but not in this combination.

use crate::Found;
use crate::section::Section;
use radsight_diag::SourceMap;

/// Keys of a pinhole, which a lens does not have, and what takes their place.
pub(crate) const OF_A_PINHOLE: [(&str, &str); 3] = [
    ("focal_distance_mm", "lens_focal_length_mm and focus_distance_m give the place of the sensor"),
    ("pinhole_diameter_mm", "f_number gives its aperture"),
    ("pinhole_model", "its rays cover the aperture"),
];

/// Keys of a lens.
pub(crate) const OF_A_LENS: [(&str, &str); 3] = [
    ("f_number", "pinhole_diameter_mm gives its aperture"),
    ("focus_distance_m", "it is sharp at every distance"),
    ("front_stop_mm", "it has no vignetting"),
];

/// Keys of a camera without a calibration.
pub(crate) const OF_NO_MATRIX: [(&str, &str); 2] = [
    ("pixel_pitch_um", "the focal lengths of the matrix give it"),
    ("projection", "the calibration gives the distortion"),
];

/// Keys of a diffraction pattern.
pub(crate) const OF_DIFFRACTION: [(&str, &str); 2] = [
    ("band_wavelengths_nm", "only pinhole_model = \"diffraction\" uses it"),
    ("object_distance_m", "only pinhole_model = \"diffraction\" uses it"),
];

/// The key of a rolling shutter.
pub(crate) const OF_A_ROLLING_SHUTTER: [(&str, &str); 1] =
    [("line_time_us", "only shutter = \"rolling\" exposes one row after the other")];

/// The key of a square wave.
pub(crate) const OF_A_SQUARE_WAVE: [(&str, &str); 1] =
    [("duty", "only waveform = \"square\" is off for a part of its period")];

/// Keys of colour filters.
pub(crate) const OF_A_MOSAIC: [(&str, &str); 3] = [
    ("filter_red", "it has no colour filters"),
    ("filter_green", "it has no colour filters"),
    ("filter_blue", "it has no colour filters"),
];

/// Keys of a power law.
pub(crate) const OF_A_POWER_LAW: [(&str, &str); 5] = [
    ("k", "gain_dn_per_e and quantum_efficiency give its slope"),
    ("gamma", "it is linear"),
    ("grey_background", "dark_offset_dn gives it"),
    ("grey_max", "full_well_e gives its saturation"),
    ("exposure_unit", "it counts photons"),
];

const NO_PHOTONS: &str = "it knows neither photons nor noise";

/// Keys of a linear sensor.
pub(crate) const OF_EMVA1288: [(&str, &str); 18] = [
    ("preset", NO_PHOTONS),
    ("quantum_efficiency", NO_PHOTONS),
    ("quantum_efficiency_table", NO_PHOTONS),
    ("gain_dn_per_e", NO_PHOTONS),
    ("full_well_e", "grey_max gives its saturation"),
    ("read_noise_e", NO_PHOTONS),
    ("dark_offset_dn", "grey_background gives it"),
    ("dark_current_e_per_s", NO_PHOTONS),
    ("temperature_c", NO_PHOTONS),
    ("dark_reference_c", NO_PHOTONS),
    ("dark_doubling_k", NO_PHOTONS),
    ("dsnu_e", NO_PHOTONS),
    ("dsnu_row_e", NO_PHOTONS),
    ("dsnu_column_e", NO_PHOTONS),
    ("prnu_percent", NO_PHOTONS),
    ("prnu_row_percent", NO_PHOTONS),
    ("prnu_column_percent", NO_PHOTONS),
    ("specimen", NO_PHOTONS),
];

/// Refuses those of `keys` that the section has; each has its reason. `with` is what it does not
/// apply with.
pub(crate) fn refuse(
    section: &Section<'_>,
    keys: &[(&'static str, &str)],
    with: &str,
    sources: &SourceMap,
    found: &mut Found,
) {
    for (key, reason) in keys.iter().filter(|(key, _)| section.has(key)) {
        section.refuse(key, format!("{key} does not apply with {with}: {reason}"), sources, found);
    }
}
