//! The description of a pinhole camera.

use crate::{CameraMatrix, FilmPlane, TelecentricLens, ThinLens};
use glam::DVec3;
use std::f64::consts::FRAC_PI_4;

/// Maximum number of pixels of a sensor: fits in memory several times over as doubles.
const MAX_PIXELS: u64 = 1 << 28;

/// Smallest sine of the angle between `direction` and `up` with a well-defined right.
const MIN_UP_SINE: f64 = 1e-6;

/// Maximum number of pixels of a convolved picture: its transforms take 430 bytes per pixel.
const MAX_CONVOLVED_PIXELS: u64 = 1 << 23;

/// Maximum number of separate bands of a convolved picture.
const MAX_SEPARATE_BANDS: usize = 3;

/// Maximum relative change of a diffraction pattern over the field that still counts as constant.
const MAX_PATTERN_CHANGE: f64 = 0.01;

/// Maximum ratio of the longest to the shortest wavelength of a scene's bands.
const MAX_BAND_RATIO: f64 = 4.0;

/// How the finite pinhole is modelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PinholeModel {
    /// All rays pass through the centre; the exposure is still that of the given pinhole area.
    Point,
    /// Rays are uniform over the area of the pinhole.
    Finite,
    /// Rays follow the diffraction pattern of the pinhole; needs a wavelength.
    Diffraction,
}

/// The parameters of a camera, checked by [`PinholeCamera::new`].
#[derive(Clone, Debug, PartialEq)]
pub struct CameraDescription {
    /// Centre of the pinhole, scene frame, metres.
    pub position_m: [f64; 3],
    /// Viewing direction, scene frame, any length.
    pub direction: [f64; 3],
    /// Up direction of the picture, scene frame, any length, not parallel to `direction`.
    pub up: [f64; 3],
    /// Columns and rows.
    pub pixels: [u32; 2],
    /// Distance from one pixel to the next, along a row and along a column, metres. Pixels fill the
    /// pitch.
    pub pixel_pitch_m: [f64; 2],
    /// From the pinhole to the sensor along the axis, metres.
    pub focal_distance_m: f64,
    /// Diameter of the round pinhole, metres.
    pub pinhole_diameter_m: f64,
    /// How the pinhole is modelled.
    pub pinhole_model: PinholeModel,
    /// Exposure time, seconds.
    pub exposure_s: f64,
    /// Wavelength of the light, metres, where it is known. Geometry does not need it.
    pub wavelength_m: Option<f64>,
    /// Length of one scene unit, metres. Rays start in scene units.
    pub scene_unit_m: f64,
}

/// An error in a [`CameraDescription`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A quantity that must be positive and finite is not.
    #[error("{quantity} must be positive and finite, not {value}")]
    NotPositive {
        /// Its name.
        quantity: &'static str,
        /// The value found, SI.
        value: f64,
    },
    /// A vector has a component that is NaN or infinite.
    #[error("{quantity} must have finite components")]
    NotFinite {
        /// Its name.
        quantity: &'static str,
    },
    /// A direction of length zero.
    #[error("{quantity} must not be the zero vector")]
    ZeroVector {
        /// Its name.
        quantity: &'static str,
    },
    /// A lens that cannot focus at the given distance.
    #[error(
        "a lens of focal length {focal_length_m} m cannot focus at {focus_distance_m} m: expected a larger distance"
    )]
    NotSharp {
        /// The focus distance, metres.
        focus_distance_m: f64,
        /// The focal length, metres.
        focal_length_m: f64,
    },
    /// A telecentric lens whose cones are too wide.
    #[error("the numerical aperture of the lens is {aperture}: expected less than 1")]
    TooWide {
        /// The larger one of the numerical apertures on both sides.
        aperture: f64,
    },
    /// Bands whose diffraction patterns differ too much to be sampled together.
    #[error("the wavelengths of the bands range from {shortest_m:e} to {longest_m:e} m: expected a ratio of at most 4")]
    BandsApart {
        /// The shortest, metres.
        shortest_m: f64,
        /// The longest, metres.
        longest_m: f64,
    },
    /// A quantity of a pinhole, for a camera with a lens.
    #[error("the camera has a lens, which determines the {quantity}")]
    OfLens {
        /// Its name.
        quantity: &'static str,
    },
    /// A diffraction pattern without a wavelength.
    #[error("pinhole model \"diffraction\" needs the wavelength")]
    NoWavelength,
    /// Up and direction do not define a right.
    #[error("up is parallel to direction")]
    UpParallel,
    /// No pixels, or more than fit in memory.
    #[error("{columns} x {rows} pixels: expected at least 1 and at most {MAX_PIXELS} in all")]
    PixelCount {
        /// Columns.
        columns: u32,
        /// Rows.
        rows: u32,
    },
}

/// A checked pinhole camera. All quantities are SI; the frame (right, up, direction) is
/// orthonormal.
#[derive(Clone, Debug, PartialEq)]
pub struct PinholeCamera {
    position_m: DVec3,
    direction: DVec3,
    right: DVec3,
    up: DVec3,
    pixels: [u32; 2],
    pixel_pitch_m: [f64; 2],
    focal_distance_m: f64,
    pinhole_diameter_m: f64,
    pinhole_model: PinholeModel,
    exposure_s: f64,
    wavelength_m: Option<f64>,
    scene_unit_m: f64,
    optics: Optics,
}

/// Everything beyond a pinhole in front of an upright sensor.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Optics {
    /// Distance of the objects for which diffraction is exact, metres; infinite if `None`.
    pub(crate) object_distance_m: Option<f64>,
    /// Wavelengths of the bands, metres; empty if all bands share one.
    pub(crate) band_wavelengths_m: Vec<f64>,
    pub(crate) lens: Option<ThinLens>,
    pub(crate) telecentric: Option<TelecentricLens>,
    pub(crate) matrix: Option<CameraMatrix>,
    pub(crate) film: Option<FilmPlane>,
    /// Whether rays always sample the whole diffraction pattern.
    pub(crate) whole_pattern: bool,
}

impl PinholeCamera {
    /// Checks a description.
    ///
    /// # Errors
    /// The first quantity that is out of its range.
    pub fn new(description: &CameraDescription) -> Result<Self, CameraError> {
        positive("focal distance", description.focal_distance_m)?;
        positive("pinhole diameter", description.pinhole_diameter_m)?;
        positive("exposure time", description.exposure_s)?;
        positive("pixel pitch", description.pixel_pitch_m[0])?;
        positive("pixel pitch", description.pixel_pitch_m[1])?;
        positive("wavelength", description.wavelength_m.unwrap_or(1.0))?;
        positive("scene unit", description.scene_unit_m)?;
        let [columns, rows] = description.pixels;
        if !(1..=MAX_PIXELS).contains(&(u64::from(columns) * u64::from(rows))) {
            return Err(CameraError::PixelCount { columns, rows });
        }
        let position_m = DVec3::from(description.position_m);
        if !position_m.is_finite() {
            return Err(CameraError::NotFinite { quantity: "position" });
        }
        let direction = unit("direction", description.direction)?;
        let across = direction.cross(unit("up", description.up)?);
        if across.length() < MIN_UP_SINE {
            return Err(CameraError::UpParallel);
        }
        let right = across.normalize();
        Ok(PinholeCamera {
            position_m,
            direction,
            right,
            up: right.cross(direction),
            pixels: description.pixels,
            pixel_pitch_m: description.pixel_pitch_m,
            focal_distance_m: description.focal_distance_m,
            pinhole_diameter_m: description.pinhole_diameter_m,
            pinhole_model: description.pinhole_model,
            exposure_s: description.exposure_s,
            wavelength_m: description.wavelength_m,
            scene_unit_m: description.scene_unit_m,
            optics: Optics::default(),
        })
        .and_then(|camera: PinholeCamera| match (camera.pinhole_model, camera.wavelength_m) {
            (PinholeModel::Diffraction, None) => Err(CameraError::NoWavelength),
            _ => Ok(camera),
        })
    }

    /// The same camera with the diffraction pattern for objects at this distance, metres. Default:
    /// infinite.
    ///
    /// # Errors
    /// If it is not positive.
    pub fn with_object_distance(mut self, distance_m: f64) -> Result<Self, CameraError> {
        self.optics.object_distance_m = Some(distance_m);
        positive("object distance", distance_m).map(|()| self)
    }

    /// The same camera with a diffraction pattern for each band of a coloured scene, by its
    /// wavelength in metres.
    ///
    /// # Errors
    /// If one is not positive, or the longest is over four times the shortest: their patterns have
    /// too little in common.
    pub fn with_band_wavelengths(mut self, wavelengths_m: Vec<f64>) -> Result<Self, CameraError> {
        wavelengths_m.iter().try_for_each(|wavelength| positive("wavelength", *wavelength))?;
        let shortest = wavelengths_m.iter().copied().fold(f64::INFINITY, f64::min);
        let longest = wavelengths_m.iter().copied().fold(0.0, f64::max);
        if longest > MAX_BAND_RATIO * shortest {
            return Err(CameraError::BandsApart { shortest_m: shortest, longest_m: longest });
        }
        self.optics.band_wavelengths_m = wavelengths_m;
        Ok(self)
    }

    /// The same camera with a lens instead of the pinhole, at the distance from the sensor given by
    /// its focus distance.
    ///
    /// # Errors
    /// If the lens is not possible.
    pub fn with_lens(mut self, lens: ThinLens) -> Result<Self, CameraError> {
        let lens = lens.checked()?;
        self.focal_distance_m = lens.image_distance_m();
        self.pinhole_diameter_m = lens.aperture_m;
        self.pinhole_model = PinholeModel::Finite;
        self.optics.lens = Some(lens);
        Ok(self)
    }

    /// The same camera with a telecentric lens. It has no distance from the pinhole to the sensor:
    /// the focal distance becomes that of a pinhole of the same diameter with the same exposure.
    ///
    /// # Errors
    /// If the lens is not possible.
    pub fn with_telecentric_lens(mut self, lens: TelecentricLens) -> Result<Self, CameraError> {
        let lens = lens.checked()?;
        self.focal_distance_m = 0.5 * self.pinhole_diameter_m / lens.image_aperture();
        self.pinhole_model = PinholeModel::Finite;
        self.optics.telecentric = Some(lens);
        Ok(self)
    }

    /// The telecentric lens, if there is one.
    #[must_use]
    pub fn telecentric_lens(&self) -> Option<&TelecentricLens> {
        self.optics.telecentric.as_ref()
    }

    /// The same camera with the chief rays of a calibrated camera. Its focal lengths determine the
    /// pixel pitch.
    ///
    /// # Errors
    /// If a number of the matrix is out of its range.
    pub fn with_matrix(mut self, matrix: CameraMatrix) -> Result<Self, CameraError> {
        let matrix = matrix.checked()?;
        self.pixel_pitch_m = matrix.focal.map(|focal| self.focal_distance_m / focal);
        positive("pixel pitch", self.pixel_pitch_m[0])?;
        positive("pixel pitch", self.pixel_pitch_m[1])?;
        self.optics.matrix = Some(matrix);
        Ok(self)
    }

    /// The same camera with a shifted or tilted sensor.
    #[must_use]
    pub fn with_film_plane(mut self, film: FilmPlane) -> Self {
        self.optics.film = (film != FilmPlane::default()).then_some(film);
        self
    }

    /// The same camera moved by `shift_m` along its own right, up and direction, then rotated about
    /// them by small angles in radians.
    ///
    /// # Errors
    /// If the position is not finite.
    pub fn moved(mut self, shift_m: [f64; 3], turn: [f64; 3]) -> Result<Self, CameraError> {
        let shift = self.right * shift_m[0] + self.up * shift_m[1] + self.direction * shift_m[2];
        let axes = [self.right, self.up, self.direction];
        let turned = glam::DQuat::from_scaled_axis(axes[0] * turn[0] + axes[1] * turn[1] + axes[2] * turn[2]);
        self.position_m += shift;
        if !self.position_m.is_finite() || !turned.is_finite() {
            return Err(CameraError::NotFinite { quantity: "position" });
        }
        self.direction = (turned * self.direction).normalize();
        self.right = (turned * self.right).reject_from_normalized(self.direction).normalize();
        self.up = self.right.cross(self.direction);
        Ok(self)
    }

    /// The same camera with rays that sample the whole diffraction pattern, for pictures whose rows
    /// are not exposed at the same time.
    #[must_use]
    pub fn with_whole_pattern(mut self) -> Self {
        self.optics.whole_pattern = true;
        self
    }

    /// Why rays sample the whole diffraction pattern, which takes many more of them. `None` if the
    /// wings of the pattern are added to the whole picture, for which the pattern must be the same
    /// all over the field.
    #[must_use]
    pub fn whole_pattern_reason(&self) -> Option<&'static str> {
        let optics = &self.optics;
        if self.pinhole_model != PinholeModel::Diffraction || optics.lens.is_some() {
            return None;
        }
        let reasons = [
            (optics.whole_pattern, "lamps flicker from row to row"),
            (optics.matrix.is_some(), "a camera_matrix distorts the picture"),
            (self.pattern_change() > MAX_PATTERN_CHANGE, "the sensor is tilted too much"),
            (optics.band_wavelengths_m.len() > MAX_SEPARATE_BANDS, "there are more than 3 band_wavelengths_nm"),
            (self.pixel_count() > MAX_CONVOLVED_PIXELS, "there are more than 8 million pixels"),
        ];
        reasons.into_iter().find_map(|(holds, reason)| holds.then_some(reason))
    }

    /// Relative change of the diffraction pattern's width at the farthest corner of a tilted
    /// sensor, due to the larger distance from the pinhole.
    fn pattern_change(&self) -> f64 {
        let film = self.optics.film.unwrap_or_default();
        let [across, down] = [0, 1].map(|axis| 0.5 * f64::from(self.pixels[axis]) * self.pixel_pitch_m[axis]);
        let reach = across.hypot(down) + film.shift_m[0].hypot(film.shift_m[1]);
        film.tilt[0].hypot(film.tilt[1]) * reach / self.focal_distance_m
    }

    /// Whether the wings of the diffraction pattern are added to the whole picture.
    pub(crate) fn convolves(&self) -> bool {
        let is_diffracted = self.pinhole_model == PinholeModel::Diffraction && self.optics.lens.is_none();
        is_diffracted && self.whole_pattern_reason().is_none()
    }

    /// Wavelengths of the bands for diffraction, metres.
    #[must_use]
    pub fn band_wavelengths_m(&self) -> &[f64] {
        &self.optics.band_wavelengths_m
    }

    /// Whether this is a pinhole in front of an upright, centred sensor, without diffraction.
    #[must_use]
    pub fn is_plain_pinhole(&self) -> bool {
        let optics = &self.optics;
        let is_geometric = self.pinhole_model != PinholeModel::Diffraction;
        is_geometric
            && optics.telecentric.is_none()
            && optics.lens.is_none()
            && optics.matrix.is_none()
            && optics.film.is_none()
    }

    /// The lens, if there is one.
    #[must_use]
    pub fn lens(&self) -> Option<&ThinLens> {
        self.optics.lens.as_ref()
    }

    /// The calibrated camera, if there is one.
    #[must_use]
    pub fn matrix(&self) -> Option<&CameraMatrix> {
        self.optics.matrix.as_ref()
    }

    pub(crate) fn optics(&self) -> &Optics {
        &self.optics
    }

    /// Centre of the pinhole, scene frame, metres.
    #[must_use]
    pub fn position_m(&self) -> DVec3 {
        self.position_m
    }

    /// Viewing direction; unit.
    #[must_use]
    pub fn direction(&self) -> DVec3 {
        self.direction
    }

    /// The picture's right; unit.
    #[must_use]
    pub fn right(&self) -> DVec3 {
        self.right
    }

    /// The picture's up; unit.
    #[must_use]
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// Columns.
    #[must_use]
    pub fn columns(&self) -> u32 {
        self.pixels[0]
    }

    /// Rows.
    #[must_use]
    pub fn rows(&self) -> u32 {
        self.pixels[1]
    }

    /// Columns times rows.
    #[must_use]
    pub fn pixel_count(&self) -> u64 {
        u64::from(self.pixels[0]) * u64::from(self.pixels[1])
    }

    /// Distance between pixels along a row and along a column, metres.
    #[must_use]
    pub fn pixel_pitch_m(&self) -> [f64; 2] {
        self.pixel_pitch_m
    }

    /// From pinhole to sensor, metres.
    #[must_use]
    pub fn focal_distance_m(&self) -> f64 {
        self.focal_distance_m
    }

    /// Diameter of the pinhole, metres.
    #[must_use]
    pub fn pinhole_diameter_m(&self) -> f64 {
        self.pinhole_diameter_m
    }

    /// Area of the pinhole, m².
    #[must_use]
    pub fn pinhole_area_m2(&self) -> f64 {
        FRAC_PI_4 * self.pinhole_diameter_m * self.pinhole_diameter_m
    }

    /// Area of a pixel, m².
    #[must_use]
    pub fn pixel_area_m2(&self) -> f64 {
        self.pixel_pitch_m[0] * self.pixel_pitch_m[1]
    }

    /// How the pinhole is modelled.
    #[must_use]
    pub fn pinhole_model(&self) -> PinholeModel {
        self.pinhole_model
    }

    /// The same camera with another pinhole model.
    #[must_use]
    pub fn with_pinhole_model(mut self, model: PinholeModel) -> Self {
        self.pinhole_model = model;
        self
    }

    /// The same camera with another exposure time in seconds.
    ///
    /// # Errors
    /// If it is not positive.
    pub fn with_exposure(mut self, exposure_s: f64) -> Result<Self, CameraError> {
        self.exposure_s = exposure_s;
        positive("exposure time", exposure_s).map(|()| self)
    }

    /// The same camera with another diameter of the pinhole, metres.
    ///
    /// # Errors
    /// If it is not positive, or the camera has a lens, whose aperture is not a pinhole.
    pub fn with_pinhole_diameter(mut self, diameter_m: f64) -> Result<Self, CameraError> {
        self.without_lens("pinhole diameter")?.pinhole_diameter_m = diameter_m;
        positive("pinhole diameter", diameter_m).map(|()| self)
    }

    /// The same camera with another distance from the pinhole to the same sensor, metres. A
    /// projection or a calibrated camera keeps its distortion, and its picture grows with the
    /// distance.
    ///
    /// # Errors
    /// If it is not positive, or the camera has a lens, which determines it.
    pub fn with_focal_distance(mut self, distance_m: f64) -> Result<Self, CameraError> {
        positive("focal distance", distance_m)?;
        let former = std::mem::replace(&mut self.without_lens("focal distance")?.focal_distance_m, distance_m);
        if let Some(matrix) = &mut self.optics.matrix {
            matrix.focal = matrix.focal.map(|pixels| pixels * (distance_m / former));
        }
        Ok(self)
    }

    fn without_lens(&mut self, quantity: &'static str) -> Result<&mut Self, CameraError> {
        match self.optics.lens.is_some() || self.optics.telecentric.is_some() {
            true => Err(CameraError::OfLens { quantity }),
            false => Ok(self),
        }
    }

    /// Exposure time, seconds.
    #[must_use]
    pub fn exposure_s(&self) -> f64 {
        self.exposure_s
    }

    /// Wavelength, metres, where it is known.
    #[must_use]
    pub fn wavelength_m(&self) -> Option<f64> {
        self.wavelength_m
    }

    /// Length of one scene unit, metres.
    #[must_use]
    pub fn scene_unit_m(&self) -> f64 {
        self.scene_unit_m
    }

    /// `τ·A_pinhole/f²` in s·sr: the exposure for a mean L·cos⁴θ of 1, Eqs. 4 and 8 of the paper.
    #[must_use]
    pub fn exposure_per_radiance(&self) -> f64 {
        self.exposure_s * self.pinhole_area_m2() / (self.focal_distance_m * self.focal_distance_m)
    }

    /// cos⁴θ of the line from the centre of a pixel through the centre of the pinhole; 1 for a
    /// telecentric lens.
    #[must_use]
    pub fn central_cos4(&self, pixel: u64) -> f64 {
        if self.optics.telecentric.is_some() {
            return 1.0;
        }
        let [x, y] = self.on_image(pixel, 0.5, 0.5);
        let f2 = self.focal_distance_m * self.focal_distance_m;
        let cos2 = f2 / (f2 + x * x + y * y);
        cos2 * cos2
    }

    /// Number of pixels per solid angle of rays in a unit direction.
    #[must_use]
    pub fn pixels_per_solid_angle(&self, direction: DVec3) -> f64 {
        let [x, y] = self.pixel_pitch_m;
        let focal_distance = self.focal_distance_m();
        focal_distance * focal_distance / (direction.dot(self.direction()).powi(3) * x * y)
    }

    /// The position of a point of a pixel on the upright image, metres right of and above the axis,
    /// one focal distance in front of the pinhole. The sensor point itself is behind the pinhole,
    /// at the negative position. `u` runs from the left edge of the pixel, `v` from its top.
    #[inline]
    pub(crate) fn on_image(&self, pixel: u64, u: f64, v: f64) -> [f64; 2] {
        let columns = u64::from(self.pixels[0]);
        let (column, row) = ((pixel % columns) as f64, (pixel / columns) as f64);
        self.on_plane(column + u, row + v)
    }

    /// The same for a point of the sensor's plane, in pixels from the picture's left and top.
    #[inline]
    pub(crate) fn on_plane(&self, column: f64, row: f64) -> [f64; 2] {
        [
            (column - 0.5 * f64::from(self.pixels[0])) * self.pixel_pitch_m[0],
            (0.5 * f64::from(self.pixels[1]) - row) * self.pixel_pitch_m[1],
        ]
    }

    /// The point of the sensor's plane at a position on the upright image: the inverse of
    /// [`PinholeCamera::on_plane`].
    #[inline]
    pub(crate) fn in_pixels(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            0.5 * f64::from(self.pixels[0]) + x / self.pixel_pitch_m[0],
            0.5 * f64::from(self.pixels[1]) - y / self.pixel_pitch_m[1],
        ]
    }
}

fn positive(quantity: &'static str, value: f64) -> Result<(), CameraError> {
    if value.is_finite() && value > 0.0 { Ok(()) } else { Err(CameraError::NotPositive { quantity, value }) }
}

fn unit(quantity: &'static str, components: [f64; 3]) -> Result<DVec3, CameraError> {
    let vector = DVec3::from(components);
    if !vector.is_finite() {
        return Err(CameraError::NotFinite { quantity });
    }
    // Scaling by the largest component first avoids overflow and underflow.
    let largest = vector.abs().max_element();
    if largest == 0.0 { Err(CameraError::ZeroVector { quantity }) } else { Ok((vector / largest).normalize()) }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The camera of the paper's experiment.
    pub(crate) fn paper_description() -> CameraDescription {
        CameraDescription {
            position_m: [0.0, 0.0, 0.48],
            direction: [0.0, 0.0, -1.0],
            up: [0.0, 1.0, 0.0],
            pixels: [192, 165],
            pixel_pitch_m: [13.75e-6, 16e-6],
            focal_distance_m: 6.75e-3,
            pinhole_diameter_m: 0.1e-3,
            pinhole_model: PinholeModel::Finite,
            exposure_s: 0.01,
            wavelength_m: Some(650e-9),
            scene_unit_m: 1.0,
        }
    }

    pub(crate) fn paper_camera() -> PinholeCamera {
        PinholeCamera::new(&paper_description()).unwrap()
    }

    #[test]
    fn the_frame_is_that_of_a_viewer_who_looks_along_direction() {
        let camera = paper_camera();
        assert_eq!(camera.right(), DVec3::X);
        assert_eq!(camera.up(), DVec3::Y);
    }

    #[test]
    fn a_slanted_up_is_made_perpendicular() {
        let description =
            CameraDescription { direction: [1.0, 2.0, -3e200], up: [0.1, 5.0, 1.0], ..paper_description() };
        let camera = PinholeCamera::new(&description).unwrap();
        for (a, b) in [(camera.right(), camera.up()), (camera.up(), camera.direction())] {
            assert!(a.dot(b).abs() < 1e-15 && (a.length() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn each_bad_quantity_is_named() {
        let message = |description: CameraDescription| PinholeCamera::new(&description).unwrap_err().to_string();
        let good = paper_description;
        assert_eq!(
            message(CameraDescription { pinhole_diameter_m: -1e-4, ..good() }),
            "pinhole diameter must be positive and finite, not -0.0001"
        );
        assert_eq!(
            message(CameraDescription { exposure_s: f64::NAN, ..good() }),
            "exposure time must be positive and finite, not NaN"
        );
        assert_eq!(message(CameraDescription { up: [0.0, 0.0, 2.0], ..good() }), "up is parallel to direction");
        assert_eq!(message(CameraDescription { up: [0.0; 3], ..good() }), "up must not be the zero vector");
        assert_eq!(
            message(CameraDescription { direction: [0.0, f64::INFINITY, 0.0], ..good() }),
            "direction must have finite components"
        );
        assert_eq!(
            message(CameraDescription { pixels: [u32::MAX, u32::MAX], ..good() }),
            "4294967295 x 4294967295 pixels: expected at least 1 and at most 268435456 in all"
        );
        assert!(message(CameraDescription { pixels: [0, 5], ..good() }).starts_with("0 x 5 pixels"));
    }
}
