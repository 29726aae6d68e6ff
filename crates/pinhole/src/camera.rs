//! What a pinhole camera is.

use crate::{CameraMatrix, FilmPlane, ThinLens};
use glam::DVec3;
use std::f64::consts::FRAC_PI_4;

/// The most pixels of a sensor: what fits in memory several times over as doubles.
const MOST_PIXELS: u64 = 1 << 28;

/// The smallest sine of the angle between `direction` and `up` at which the picture's right is still well defined.
const SMALLEST_UP_SINE: f64 = 1e-6;

/// The most pixels of a picture that is convolved: its transforms take 430 bytes a pixel.
const MOST_CONVOLVED: u64 = 1 << 23;

/// The most bands of it that are kept apart.
const MOST_BANDS_APART: usize = 3;

/// The largest share by which a pattern may change over the field and still be taken as the same.
const MOST_PATTERN_CHANGE: f64 = 0.01;

/// The longest wavelength of a scene's bands over the shortest.
const LARGEST_BAND_RATIO: f64 = 4.0;

/// How the finite hole is treated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PinholeModel {
    /// All rays pass through the centre; the exposure is still that of the stated hole, by its area.
    Point,
    /// Rays cover the hole uniformly by area.
    Finite,
    /// Rays follow the diffraction pattern of the hole; needs a wavelength.
    Diffraction,
}

/// A camera as it was asked for; [`PinholeCamera::new`] checks it.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraDescription {
    /// Centre of the pinhole, scene frame, metres.
    pub position_m: [f64; 3],
    /// Where the camera looks, scene frame, any length.
    pub direction: [f64; 3],
    /// Which way the picture is up, scene frame, any length, not along `direction`.
    pub up: [f64; 3],
    /// Columns and rows.
    pub pixels: [u32; 2],
    /// Distance from one pixel to the next, along a row and along a column, metres. Pixels fill the pitch.
    pub pixel_pitch_m: [f64; 2],
    /// From the pinhole to the sensor along the axis, metres.
    pub focal_distance_m: f64,
    /// Diameter of the round hole, metres.
    pub pinhole_diameter_m: f64,
    /// How the hole is treated.
    pub pinhole_model: PinholeModel,
    /// Exposure time, seconds.
    pub exposure_s: f64,
    /// Wavelength of the light, metres, where it is known. Geometry does not need it.
    pub wavelength_m: Option<f64>,
    /// Length of one scene unit, metres. Rays start in scene units.
    pub scene_unit_m: f64,
}

/// What is wrong with a [`CameraDescription`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A quantity that must be positive and finite is not.
    #[error("{quantity} must be positive and finite, not {value}")]
    NotPositive {
        /// Which, in words.
        quantity: &'static str,
        /// The value found, SI.
        value: f64,
    },
    /// A vector has a component that is NaN or infinite.
    #[error("{quantity} must have finite components")]
    NotFinite {
        /// Which, in words.
        quantity: &'static str,
    },
    /// A direction of length zero.
    #[error("{quantity} must not be the zero vector")]
    ZeroVector {
        /// Which, in words.
        quantity: &'static str,
    },
    /// A lens cannot make that sharp.
    #[error("a lens of focal length {focal_length_m} m has nothing sharp at {focus_distance_m} m: expected more")]
    NotSharp {
        /// What was to be sharp, metres.
        focus_distance_m: f64,
        /// The focal length, metres.
        focal_length_m: f64,
    },
    /// Bands whose diffraction patterns cannot be drawn together.
    #[error("the wavelengths of the bands reach from {shortest_m:e} to {longest_m:e} m: expected a ratio of at most 4")]
    BandsApart {
        /// The shortest, metres.
        shortest_m: f64,
        /// The longest, metres.
        longest_m: f64,
    },
    /// A diffraction pattern without a wavelength.
    #[error("pinhole model \"diffraction\" needs the wavelength")]
    NoWavelength,
    /// The picture would have no right.
    #[error("up is parallel to direction")]
    UpParallel,
    /// No pixels, or more than can be held.
    #[error("{columns} x {rows} pixels: expected at least 1 and at most {MOST_PIXELS} in all")]
    PixelCount {
        /// Pixels in a row.
        columns: u32,
        /// Rows.
        rows: u32,
    },
}

/// A checked pinhole camera. All quantities are SI; the frame (right, up, direction) is orthonormal.
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

/// What goes beyond a hole before an upright sensor.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Optics {
    /// Where diffraction is exact, metres; far away where nothing is said.
    pub(crate) object_distance_m: Option<f64>,
    /// Wavelengths of the bands, metres, where they differ.
    pub(crate) band_wavelengths_m: Vec<f64>,
    pub(crate) lens: Option<ThinLens>,
    pub(crate) matrix: Option<CameraMatrix>,
    pub(crate) film: Option<FilmPlane>,
    /// Whether rays draw all of a diffraction pattern whatever else holds.
    pub(crate) whole_pattern: bool,
}

impl PinholeCamera {
    /// Checks a description.
    ///
    /// # Errors
    /// The first quantity that is out of its range.
    pub fn new(asked: &CameraDescription) -> Result<Self, CameraError> {
        positive("focal distance", asked.focal_distance_m)?;
        positive("pinhole diameter", asked.pinhole_diameter_m)?;
        positive("exposure time", asked.exposure_s)?;
        positive("pixel pitch", asked.pixel_pitch_m[0])?;
        positive("pixel pitch", asked.pixel_pitch_m[1])?;
        positive("wavelength", asked.wavelength_m.unwrap_or(1.0))?;
        positive("scene unit", asked.scene_unit_m)?;
        let [columns, rows] = asked.pixels;
        if !(1..=MOST_PIXELS).contains(&(u64::from(columns) * u64::from(rows))) {
            return Err(CameraError::PixelCount { columns, rows });
        }
        let position_m = DVec3::from(asked.position_m);
        if !position_m.is_finite() {
            return Err(CameraError::NotFinite { quantity: "position" });
        }
        let direction = unit("direction", asked.direction)?;
        let across = direction.cross(unit("up", asked.up)?);
        if across.length() < SMALLEST_UP_SINE {
            return Err(CameraError::UpParallel);
        }
        let right = across.normalize();
        Ok(PinholeCamera {
            position_m,
            direction,
            right,
            up: right.cross(direction),
            pixels: asked.pixels,
            pixel_pitch_m: asked.pixel_pitch_m,
            focal_distance_m: asked.focal_distance_m,
            pinhole_diameter_m: asked.pinhole_diameter_m,
            pinhole_model: asked.pinhole_model,
            exposure_s: asked.exposure_s,
            wavelength_m: asked.wavelength_m,
            scene_unit_m: asked.scene_unit_m,
            optics: Optics::default(),
        })
        .and_then(|camera: PinholeCamera| match (camera.pinhole_model, camera.wavelength_m) {
            (PinholeModel::Diffraction, None) => Err(CameraError::NoWavelength),
            _ => Ok(camera),
        })
    }

    /// The same camera with the diffraction pattern of objects at this distance, metres. Default: far away.
    ///
    /// # Errors
    /// When it is not positive.
    pub fn with_object_distance(mut self, distance_m: f64) -> Result<Self, CameraError> {
        self.optics.object_distance_m = Some(distance_m);
        positive("object distance", distance_m).map(|()| self)
    }

    /// The same camera with a diffraction pattern for each band of a coloured scene, by its wavelength in metres.
    ///
    /// # Errors
    /// When one is not positive, or the longest is over four times the shortest: their patterns have too little in common.
    pub fn with_band_wavelengths(mut self, wavelengths_m: Vec<f64>) -> Result<Self, CameraError> {
        wavelengths_m.iter().try_for_each(|wavelength| positive("wavelength", *wavelength))?;
        let shortest = wavelengths_m.iter().copied().fold(f64::INFINITY, f64::min);
        let longest = wavelengths_m.iter().copied().fold(0.0, f64::max);
        if longest > LARGEST_BAND_RATIO * shortest {
            return Err(CameraError::BandsApart { shortest_m: shortest, longest_m: longest });
        }
        self.optics.band_wavelengths_m = wavelengths_m;
        Ok(self)
    }

    /// The same camera with a lens in the place of the hole, at the distance from the sensor that makes sharp what shall be.
    ///
    /// # Errors
    /// When the lens cannot be.
    pub fn with_lens(mut self, lens: ThinLens) -> Result<Self, CameraError> {
        let lens = lens.checked()?;
        self.focal_distance_m = lens.image_distance_m();
        self.pinhole_diameter_m = lens.aperture_m;
        self.pinhole_model = PinholeModel::Finite;
        self.optics.lens = Some(lens);
        Ok(self)
    }

    /// The same camera with the chief rays of a calibrated one. The pitch of the pixels follows from its focal distances.
    ///
    /// # Errors
    /// When a number of the matrix is out of its range.
    pub fn with_matrix(mut self, matrix: CameraMatrix) -> Result<Self, CameraError> {
        let matrix = matrix.checked()?;
        self.pixel_pitch_m = matrix.focal.map(|focal| self.focal_distance_m / focal);
        positive("pixel pitch", self.pixel_pitch_m[0])?;
        positive("pixel pitch", self.pixel_pitch_m[1])?;
        self.optics.matrix = Some(matrix);
        Ok(self)
    }

    /// The same camera with its sensor elsewhere.
    #[must_use]
    pub fn with_film_plane(mut self, film: FilmPlane) -> Self {
        self.optics.film = (film != FilmPlane::default()).then_some(film);
        self
    }

    /// The same camera moved by `shift_m` along its own right, up and direction, then turned about them by small angles in radians.
    ///
    /// # Errors
    /// When the place is not finite.
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

    /// The same camera with every ray drawn from the whole of a diffraction pattern, for pictures whose rows are not exposed at the same time.
    #[must_use]
    pub fn with_whole_pattern(mut self) -> Self {
        self.optics.whole_pattern = true;
        self
    }

    /// Why rays draw the whole of a diffraction pattern, which takes many more of them; `None` where its wings are added to the whole
    /// picture. For that the pattern must be the same all over the field.
    #[must_use]
    pub fn whole_pattern_reason(&self) -> Option<&'static str> {
        let optics = &self.optics;
        if self.pinhole_model != PinholeModel::Diffraction || optics.lens.is_some() {
            return None;
        }
        let reasons = [
            (optics.whole_pattern, "lamps flicker from row to row"),
            (optics.matrix.is_some(), "a camera_matrix distorts the picture"),
            (self.pattern_change() > MOST_PATTERN_CHANGE, "the sensor is tilted too much"),
            (optics.band_wavelengths_m.len() > MOST_BANDS_APART, "there are more than 3 band_wavelengths_nm"),
            (self.pixel_count() > MOST_CONVOLVED, "there are more than 8 million pixels"),
        ];
        reasons.into_iter().find_map(|(holds, reason)| holds.then_some(reason))
    }

    /// By which share a tilt of the sensor makes a pattern wider or narrower at the farthest corner: there the sensor is so much farther
    /// from the hole.
    fn pattern_change(&self) -> f64 {
        let film = self.optics.film.unwrap_or_default();
        let [across, down] = [0, 1].map(|axis| 0.5 * f64::from(self.pixels[axis]) * self.pixel_pitch_m[axis]);
        let reach = across.hypot(down) + film.shift_m[0].hypot(film.shift_m[1]);
        film.tilt[0].hypot(film.tilt[1]) * reach / self.focal_distance_m
    }

    /// Whether the wings of a diffraction pattern are added to the whole picture.
    pub(crate) fn convolves(&self) -> bool {
        let is_diffracted = self.pinhole_model == PinholeModel::Diffraction && self.optics.lens.is_none();
        is_diffracted && self.whole_pattern_reason().is_none()
    }

    /// Wavelengths of the bands, metres, where diffraction has them.
    #[must_use]
    pub fn band_wavelengths_m(&self) -> &[f64] {
        &self.optics.band_wavelengths_m
    }

    /// Whether this is a hole before an upright, centred sensor, without diffraction.
    #[must_use]
    pub fn is_plain_pinhole(&self) -> bool {
        let optics = &self.optics;
        let is_geometric = self.pinhole_model != PinholeModel::Diffraction;
        is_geometric && optics.lens.is_none() && optics.matrix.is_none() && optics.film.is_none()
    }

    /// The lens, where there is one.
    #[must_use]
    pub fn lens(&self) -> Option<&ThinLens> {
        self.optics.lens.as_ref()
    }

    /// The calibrated camera, where there is one.
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

    /// Where the camera looks; unit.
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

    /// Diameter of the hole, metres.
    #[must_use]
    pub fn pinhole_diameter_m(&self) -> f64 {
        self.pinhole_diameter_m
    }

    /// Area of the hole, m².
    #[must_use]
    pub fn pinhole_area_m2(&self) -> f64 {
        FRAC_PI_4 * self.pinhole_diameter_m * self.pinhole_diameter_m
    }

    /// Area of a pixel, m².
    #[must_use]
    pub fn pixel_area_m2(&self) -> f64 {
        self.pixel_pitch_m[0] * self.pixel_pitch_m[1]
    }

    /// How the hole is treated.
    #[must_use]
    pub fn pinhole_model(&self) -> PinholeModel {
        self.pinhole_model
    }

    /// The same camera with the hole treated in another way.
    #[must_use]
    pub fn with_pinhole_model(mut self, model: PinholeModel) -> Self {
        self.pinhole_model = model;
        self
    }

    /// The same camera with another exposure time in seconds.
    ///
    /// # Errors
    /// When it is not positive.
    pub fn with_exposure(mut self, exposure_s: f64) -> Result<Self, CameraError> {
        self.exposure_s = exposure_s;
        positive("exposure time", exposure_s).map(|()| self)
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

    /// `τ·A_pinhole/f²` in s·sr: what turns the mean of L·cos⁴θ into exposure, Eqs. 4 and 8 of the paper.
    #[must_use]
    pub fn exposure_per_radiance(&self) -> f64 {
        self.exposure_s * self.pinhole_area_m2() / (self.focal_distance_m * self.focal_distance_m)
    }

    /// cos⁴θ of the line from the middle of a pixel through the middle of the hole.
    #[must_use]
    pub fn central_cos4(&self, pixel: u64) -> f64 {
        let [x, y] = self.on_image(pixel, 0.5, 0.5);
        let f2 = self.focal_distance_m * self.focal_distance_m;
        let cos2 = f2 / (f2 + x * x + y * y);
        cos2 * cos2
    }

    /// Where a point of a pixel appears on the upright image, metres right of and above the axis, one focal distance before
    /// the hole: the sensor point itself is behind the hole, at minus this. `u` runs from the pixel's left, `v` from its top.
    #[inline]
    pub(crate) fn on_image(&self, pixel: u64, u: f64, v: f64) -> [f64; 2] {
        let columns = u64::from(self.pixels[0]);
        let (column, row) = ((pixel % columns) as f64, (pixel / columns) as f64);
        self.on_plane(column + u, row + v)
    }

    /// The same for a place of the sensor's plane, in pixels from the picture's left and top.
    #[inline]
    pub(crate) fn on_plane(&self, column: f64, row: f64) -> [f64; 2] {
        [
            (column - 0.5 * f64::from(self.pixels[0])) * self.pixel_pitch_m[0],
            (0.5 * f64::from(self.pixels[1]) - row) * self.pixel_pitch_m[1],
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
    // Scaling by the largest component first keeps very long and very short vectors from overflowing.
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
        let asked = CameraDescription { direction: [1.0, 2.0, -3e200], up: [0.1, 5.0, 1.0], ..paper_description() };
        let camera = PinholeCamera::new(&asked).unwrap();
        for (a, b) in [(camera.right(), camera.up()), (camera.up(), camera.direction())] {
            assert!(a.dot(b).abs() < 1e-15 && (a.length() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn each_bad_quantity_is_named() {
        let message = |asked: CameraDescription| PinholeCamera::new(&asked).unwrap_err().to_string();
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
