//! Views as they are typed.

use super::ViewError;
use glam::DVec3;

/// The projection of a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ViewKind {
    /// `v`: perspective; sizes are full angles below 180°.
    Perspective,
    /// `l`: parallel; sizes are lengths in scene units.
    Parallel,
    /// `c`: cylindrical panorama; the horizontal size is an angle up to 360°, the vertical one as
    /// in perspective.
    Cylindrical,
    /// `h`: hemispherical fisheye (image radius proportional to the sine of the angle), angles up
    /// to 180°.
    Hemispherical,
    /// `a`: angular fisheye (image radius proportional to the angle), angles up to 360°.
    Angular,
    /// `s`: planispheric (stereographic) fisheye, angles below 360°.
    Planispheric,
}

impl ViewKind {
    /// The letter after `-vt`.
    #[must_use]
    pub fn letter(self) -> char {
        match self {
            ViewKind::Perspective => 'v',
            ViewKind::Parallel => 'l',
            ViewKind::Cylindrical => 'c',
            ViewKind::Hemispherical => 'h',
            ViewKind::Angular => 'a',
            ViewKind::Planispheric => 's',
        }
    }

    /// The view type of a letter.
    ///
    /// # Errors
    /// [`ViewError::UnknownKind`] for any other letter.
    pub fn from_letter(letter: char) -> Result<ViewKind, ViewError> {
        match letter {
            'v' => Ok(ViewKind::Perspective),
            'l' => Ok(ViewKind::Parallel),
            'c' => Ok(ViewKind::Cylindrical),
            'h' => Ok(ViewKind::Hemispherical),
            'a' => Ok(ViewKind::Angular),
            's' => Ok(ViewKind::Planispheric),
            other => Err(ViewError::UnknownKind(other)),
        }
    }
}

/// A view as typed. The default is Radiance's: perspective, from the origin along +y, up +z, 45° by
/// 45°.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewOptions {
    /// `-vt`.
    pub kind: ViewKind,
    /// `-vp`: the eye, in scene units.
    pub point: DVec3,
    /// `-vd`: the direction of view. Its length, in scene units, is the focus distance of a lens
    /// with an aperture.
    pub direction: DVec3,
    /// `-vu`: the up direction in the picture; need be neither perpendicular to the direction nor
    /// of unit length.
    pub up: DVec3,
    /// `-vh`: horizontal size, in degrees, or scene units for a parallel view.
    pub horizontal: f64,
    /// `-vv`: vertical size, in degrees, or scene units for a parallel view.
    pub vertical: f64,
    /// `-vo`: distance of the fore clipping plane, in scene units.
    pub fore: f64,
    /// `-va`: distance of the aft clipping plane, in scene units; 0 for none.
    pub aft: f64,
    /// `-vs`: offset of the picture to the right, in picture widths.
    pub shift: f64,
    /// `-vl`: offset of the picture upwards, in picture heights.
    pub lift: f64,
}

impl Default for ViewOptions {
    fn default() -> Self {
        ViewOptions {
            kind: ViewKind::Perspective,
            point: DVec3::ZERO,
            direction: DVec3::Y,
            up: DVec3::Z,
            horizontal: 45.0,
            vertical: 45.0,
            fore: 0.0,
            aft: 0.0,
            shift: 0.0,
            lift: 0.0,
        }
    }
}
