//! The keys of a parallel view: a telecentric lens.

use crate::Found;
use crate::section::{Range, Section};
use radsight_diag::{Diagnostic, SourceMap};
use radsight_pinhole::TelecentricLens;

/// The `projection` of a telecentric lens.
pub(crate) const PARALLEL: &str = "parallel";

/// Keys of a pinhole, a thin lens or a calibration, which a telecentric lens does not have, and
/// what takes their place.
const OTHERS: [(&str, &str); 6] = [
    ("focal_distance_mm", "field_width_mm gives its scale"),
    ("pinhole_diameter_mm", "f_number gives its aperture"),
    ("pinhole_model", "its rays cover the aperture"),
    ("lens_focal_length_mm", "field_width_mm gives its scale"),
    ("front_stop_mm", "it has no vignetting"),
    ("camera_matrix", "field_width_mm gives its scale"),
];

/// Whether the section asks for a parallel view.
pub(crate) fn is_parallel(section: &Section<'_>) -> bool {
    section.text("projection") == Some(PARALLEL)
}

/// Refuses the keys of a parallel view in another one.
pub(crate) fn refuse(section: &Section<'_>, sources: &SourceMap, found: &mut Found) {
    for key in ["field_width_mm", "aperture_half_angle_deg"].into_iter().filter(|key| section.has(key)) {
        section.refuse(key, format!("{key} applies to projection = \"{PARALLEL}\" only"), sources, found);
    }
}

/// The lens, from the field that it sees and its aperture.
pub(crate) fn read(
    section: &Section<'_>,
    (pixels, pitch_um): (Option<[i64; 2]>, Option<[f64; 2]>),
    sources: &SourceMap,
    found: &mut Found,
) -> Option<TelecentricLens> {
    let before = found.errors.len();
    for (key, reason) in OTHERS.into_iter().filter(|(key, _)| section.has(key)) {
        let message = format!("{key} does not apply to projection \"{PARALLEL}\": {reason}");
        section.refuse(key, message, sources, found);
    }
    let field_mm = section.number("field_width_mm", Range::Positive, "40.0", sources, found);
    let f_number = aperture(section, sources, found);
    let focus_m = section.number("focus_distance_m", Range::Positive, "0.11", sources, found);
    let width_um = pixels?[0] as f64 * pitch_um?[0];
    let magnification = width_um * 1e-3 / field_mm?;
    let f_number = match f_number? {
        Aperture::FNumber(number) => number,
        // NA_object = m/(2 N).
        Aperture::HalfAngle(degrees) => 0.5 * magnification / degrees.to_radians().sin(),
    };
    (found.errors.len() == before).then_some(TelecentricLens { magnification, f_number, focus_distance_m: focus_m? })
}

enum Aperture {
    /// Working f-number, on the side of the sensor.
    FNumber(f64),
    /// Half angle of the cone of an object point, degrees.
    HalfAngle(f64),
}

/// One of `f_number` and `aperture_half_angle_deg`.
fn aperture(section: &Section<'_>, sources: &SourceMap, found: &mut Found) -> Option<Aperture> {
    if !section.has("aperture_half_angle_deg") {
        section.optional_number("aperture_half_angle_deg", Range::Positive, sources, found);
        return section.number("f_number", Range::Positive, "8.0", sources, found).map(Aperture::FNumber);
    }
    let degrees = section.optional_number("aperture_half_angle_deg", Range::Positive, sources, found)?;
    let wrong = if section.has("f_number") {
        section.optional_number("f_number", Range::Positive, sources, found);
        "aperture_half_angle_deg and f_number both give the aperture: expected one of them".to_owned()
    } else if degrees >= 90.0 {
        format!("aperture_half_angle_deg is {degrees}, expected less than 90")
    } else {
        return Some(Aperture::HalfAngle(degrees));
    };
    found.errors.push(Diagnostic::error(wrong).at(section.span_of("aperture_half_angle_deg", sources)));
    None
}
