//! `[camera]`.

use crate::Found;
use crate::Shutter;
use crate::flicker_section;
use crate::inapplicable::{self, OF_A_LENS, OF_A_PINHOLE, OF_DIFFRACTION, OF_NO_MATRIX};
use crate::matrix_file::{self, MatrixFile};
use crate::parallel_section::{self, PARALLEL};
use crate::section::{Range, Section, load_beside};
use radsight_diag::{Diagnostic, SourceMap, hint_nearest};
use radsight_loader::Loader;
use radsight_pinhole::{
    CameraDescription, CameraError, CameraMatrix, Distortion, FrontStop, PinholeCamera, PinholeModel, ThinLens,
};

/// The most columns or rows that are accepted one way.
const MOST_PIXELS_ACROSS: i64 = 1_000_000;

/// Exposure per radiance of a camera whose pictures can be held in single precision.
const EXPOSURES: std::ops::RangeInclusive<f64> = 1e-30..=1e30;

/// The keys that give the exposure per radiance.
const OF_EXPOSURE: [&str; 10] = [
    "focal_distance_mm",
    "pinhole_diameter_mm",
    "pixel_pitch_um",
    "exposure_ms",
    "lens_focal_length_mm",
    "f_number",
    "focus_distance_m",
    "field_width_mm",
    "aperture_half_angle_deg",
    "wavelength_nm",
];

pub(crate) fn read(
    section: Section<'_>,
    file: &str,
    sources: &mut SourceMap,
    loader: &dyn Loader,
    found: &mut Found,
) -> Option<(PinholeCamera, Shutter)> {
    let camera = read_keys(&section, file, sources, loader, found);
    let shutter = flicker_section::shutter(&section, sources, found);
    section.close(sources, found);
    camera.map(|camera| (camera, shutter))
}

fn read_keys(
    section: &Section<'_>,
    file: &str,
    sources: &mut SourceMap,
    loader: &dyn Loader,
    found: &mut Found,
) -> Option<PinholeCamera> {
    let before = found.errors.len();
    let position_m = section.numbers::<3>("position_m", Range::Finite, "[0.0, 0.0, 0.48]", sources, found);
    let direction = section.numbers::<3>("direction", Range::Finite, "[0.0, 0.0, -1.0]", sources, found);
    let up = section.numbers::<3>("up", Range::Finite, "[0.0, 1.0, 0.0]", sources, found);
    let matrix = matrix(section, file, sources, loader, found);
    let pixels = pixels(section, matrix.as_ref(), sources, found);
    let pitch_um = match section.has("camera_matrix") {
        // The focal distances of the matrix, in pixels, give the pitch.
        true => {
            inapplicable::refuse(section, &OF_NO_MATRIX, "camera_matrix", sources, found);
            Some([1.0; 2])
        }
        false => section.numbers::<2>("pixel_pitch_um", Range::Positive, "[13.75, 16.0]", sources, found),
    };
    let is_parallel = parallel_section::is_parallel(section);
    let projection = projection(section, sources, found);
    let lens = if is_parallel { None } else { lens(section, sources, found) };
    let telecentric = match is_parallel {
        true => parallel_section::read(section, (pixels, pitch_um), sources, found),
        false => {
            parallel_section::refuse(section, sources, found);
            None
        }
    };
    let (focal_mm, diameter_mm, model) = match section.has("lens_focal_length_mm") {
        // Of a pinhole, which the lens replaces.
        _ if is_parallel => (Some(1.0), Some(1.0), Some(PinholeModel::Finite)),
        true => {
            inapplicable::refuse(section, &OF_A_PINHOLE, "lens_focal_length_mm", sources, found);
            let lens = lens.as_ref();
            let distance = lens.map(|lens| lens.image_distance_m() * 1e3);
            (distance, lens.map(|lens| lens.aperture_m * 1e3), Some(PinholeModel::Finite))
        }
        false => (
            section.number("focal_distance_mm", Range::Positive, "6.75", sources, found),
            section.number("pinhole_diameter_mm", Range::Positive, "0.1", sources, found),
            pinhole_model(section, sources, found),
        ),
    };
    let diffracting = diffraction(section, model, sources, found);
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
    if found.errors.len() > before {
        return None;
    }
    warn(&asked, section, sources, found);
    PinholeCamera::new(&asked)
        .and_then(|camera| telecentric.map_or(Ok(camera.clone()), |lens| camera.with_telecentric_lens(lens)))
        .and_then(|camera| lens.map_or(Ok(camera.clone()), |lens| camera.with_lens(lens)))
        .and_then(|camera| matrix.map_or(Ok(camera.clone()), |file| camera.with_matrix(file.matrix)))
        .and_then(|camera| projection.map_or(Ok(camera.clone()), |model| camera.with_matrix(projected(&asked, model))))
        .and_then(|camera| diffracting.apply(camera))
        .map_err(|error| {
            let key = match error {
                CameraError::PixelCount { .. } => "pixels",
                CameraError::ZeroVector { quantity: "direction" } => "direction",
                CameraError::ZeroVector { .. } | CameraError::UpParallel => "up",
                CameraError::NoWavelength => "pinhole_model",
                CameraError::BandsApart { .. } => "band_wavelengths_nm",
                CameraError::TooWide { .. } => "f_number",
                // The remaining case is a quantity that is 0 or infinite in the SI unit.
                _ => section.most_extreme(&OF_EXPOSURE),
            };
            let hint =
                matches!(error, CameraError::NoWavelength).then(|| "for example wavelength_nm = 650.0".to_owned());
            let message = Diagnostic::error(error.to_string()).at(section.span_of(key, sources));
            found.errors.push(message.maybe_hint(hint));
        })
        .ok()
        .filter(|camera| has_exposures(camera, section, sources, found))
}

/// Whether pictures of the camera can be held in single precision.
fn has_exposures(camera: &PinholeCamera, section: &Section<'_>, sources: &SourceMap, found: &mut Found) -> bool {
    let per_radiance = camera.exposure_per_radiance();
    let holds = EXPOSURES.contains(&per_radiance);
    if !holds {
        let key = section.most_extreme(&OF_EXPOSURE);
        let message =
            format!("{key} is out of range: a radiance of 1 W/sr/m2 would expose a pixel by {per_radiance:.1e} J/m2");
        found.errors.push(Diagnostic::error(message).at(section.span_of(key, sources)));
    }
    holds
}

/// The calibrated camera, if one is named.
fn matrix(
    section: &Section<'_>,
    file: &str,
    sources: &mut SourceMap,
    loader: &dyn Loader,
    found: &mut Found,
) -> Option<MatrixFile> {
    let name = section.optional_string("camera_matrix", sources, found)?;
    let source = load_beside(&name, file, sources, loader, found)?;
    matrix_file::read(source, sources).map_err(|error| found.errors.push(error)).ok()
}

/// The projection of a camera without a calibration; none for a perspective one.
fn projection(section: &Section<'_>, sources: &SourceMap, found: &mut Found) -> Option<Distortion> {
    const NAMES: [&str; 6] = ["perspective", "equidistant", "orthographic", "stereographic", "cylindrical", PARALLEL];
    if section.has("camera_matrix") {
        return None;
    }
    let name = section.optional_string("projection", sources, found)?;
    match name.value {
        "perspective" | PARALLEL => None,
        "equidistant" => Some(Distortion::Fisheye([0.0; 4])),
        "orthographic" => Some(Distortion::Orthographic),
        "stereographic" => Some(Distortion::Stereographic),
        "cylindrical" => Some(Distortion::Cylindrical),
        other => {
            let shown = crate::section::shorten(other);
            let message = format!("unknown projection \"{shown}\", expected one of {}", NAMES.join(", "));
            found.errors.push(Diagnostic::error(message).at(name.span).maybe_hint(hint_nearest(other, NAMES)));
            None
        }
    }
}

/// The camera matrix of a projection: the focal distance in pixels, centred.
fn projected(camera: &CameraDescription, distortion: Distortion) -> CameraMatrix {
    CameraMatrix {
        focal: camera.pixel_pitch_m.map(|pitch| camera.focal_distance_m / pitch),
        center: camera.pixels.map(|count| 0.5 * (f64::from(count) - 1.0)),
        distortion,
    }
}

/// Columns and rows; those of a calibrated camera where the file gives none.
fn pixels(
    section: &Section<'_>,
    matrix: Option<&MatrixFile>,
    sources: &SourceMap,
    found: &mut Found,
) -> Option<[i64; 2]> {
    let calibrated = matrix.and_then(|file| file.pixels).map(|pixels| pixels.map(i64::from));
    if calibrated.is_some() && !section.has("pixels") {
        return calibrated;
    }
    let own = section.whole_pair("pixels", [1, MOST_PIXELS_ACROSS], "[192, 165]", sources, found)?;
    if let Some([columns, rows]) = calibrated.filter(|calibrated| *calibrated != own) {
        let message = format!("the camera matrix is that of a picture of {columns} x {rows} pixels");
        found.warnings.push(Diagnostic::warning(message).at(section.span_of("pixels", sources)));
    }
    Some(own)
}

/// A lens, if the file gives its focal length.
fn lens(section: &Section<'_>, sources: &SourceMap, found: &mut Found) -> Option<ThinLens> {
    if !section.has("lens_focal_length_mm") {
        section.optional_number("lens_focal_length_mm", Range::Positive, sources, found);
        inapplicable::refuse(section, &OF_A_LENS, "a pinhole", sources, found);
        return None;
    }
    let focal_mm = section.number("lens_focal_length_mm", Range::Positive, "8.0", sources, found);
    let f_number = section.number("f_number", Range::Positive, "2.8", sources, found);
    let focus_m = section.optional_number("focus_distance_m", Range::Positive, sources, found);
    let stop = section.optional_numbers("front_stop_mm", Some(2), Range::Positive, sources, found);
    let lens = ThinLens {
        focal_length_m: focal_mm? * 1e-3,
        aperture_m: focal_mm? * 1e-3 / f_number?,
        focus_distance_m: focus_m.unwrap_or(f64::INFINITY),
        front_stop: stop.map(|stop| FrontStop { distance_m: stop[0] * 1e-3, diameter_m: stop[1] * 1e-3 }),
    };
    let refuse = |error: CameraError| {
        let key = if matches!(error, CameraError::NotSharp { .. }) { "focus_distance_m" } else { "f_number" };
        found.errors.push(Diagnostic::error(error.to_string()).at(section.span_of(key, sources)));
    };
    lens.checked().map_err(refuse).ok()
}

/// The keys of diffraction, without the wavelength.
#[derive(Default)]
struct Diffracting {
    object_distance_m: Option<f64>,
    band_wavelengths_m: Option<Vec<f64>>,
}

impl Diffracting {
    fn apply(self, camera: PinholeCamera) -> Result<PinholeCamera, CameraError> {
        let camera =
            self.object_distance_m.map_or(Ok(camera.clone()), |distance| camera.with_object_distance(distance))?;
        self.band_wavelengths_m.map_or(Ok(camera.clone()), |bands| camera.with_band_wavelengths(bands))
    }
}

/// Refused where it does not matter. Nothing tells this for an unknown model.
fn diffraction(
    section: &Section<'_>,
    model: Option<PinholeModel>,
    sources: &SourceMap,
    found: &mut Found,
) -> Diffracting {
    let other = match model {
        Some(PinholeModel::Diffraction) | None => None,
        Some(_) if section.has("lens_focal_length_mm") => Some("lens_focal_length_mm"),
        Some(_) if parallel_section::is_parallel(section) => Some("projection = \"parallel\""),
        Some(PinholeModel::Point) => Some("pinhole_model = \"point\""),
        Some(_) => Some("pinhole_model = \"finite\""),
    };
    if let Some(other) = other {
        inapplicable::refuse(section, &OF_DIFFRACTION, other, sources, found);
        return Diffracting::default();
    }
    let bands = section.optional_numbers("band_wavelengths_nm", None, Range::Positive, sources, found);
    Diffracting {
        object_distance_m: section.optional_number("object_distance_m", Range::Positive, sources, found),
        band_wavelengths_m: bands.map(|bands| bands.into_iter().map(|wavelength| wavelength * 1e-9).collect()),
    }
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
        "diffraction" => return Some(PinholeModel::Diffraction),
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

/// Warns of values that are possible, but more likely have a wrong unit.
fn warn(asked: &CameraDescription, section: &Section<'_>, sources: &SourceMap, found: &mut Found) {
    let mut warn = |key, message: String| {
        found.warnings.push(Diagnostic::warning(message).at(section.span_of(key, sources)));
    };
    if section.has("pinhole_diameter_mm") && asked.pinhole_diameter_m > 0.5 * asked.focal_distance_m {
        let message = "the pinhole is more than half as wide as its distance from the sensor: is the unit right?";
        warn("pinhole_diameter_mm", message.to_owned());
    }
    if !section.has("camera_matrix") && asked.pixel_pitch_m.iter().any(|pitch| !(0.1e-6..=1e-3).contains(pitch)) {
        warn("pixel_pitch_um", "pixels are usually 0.1 to 1000 um apart: is the unit right?".to_owned());
    }
    if asked.wavelength_m.is_some_and(|wavelength| !(100e-9..=20e-6).contains(&wavelength)) {
        warn("wavelength_nm", "light is usually between 100 and 20000 nm: is the unit right?".to_owned());
    }
}
