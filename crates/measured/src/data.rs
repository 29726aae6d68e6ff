//! Content of a BSDF file.

use crate::resolution::Resolution;
use crate::scattering::Scattering;
use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, PI};

/// A side of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Side of the normal: in a window, the room.
    Front,
    /// Opposite side.
    Back,
}

impl Side {
    /// Side of a direction that points away from the surface.
    #[must_use]
    pub fn of(direction: DVec3) -> Side {
        if direction.z > 0.0 { Side::Front } else { Side::Back }
    }

    /// The opposite side.
    #[must_use]
    pub fn opposite(self) -> Side {
        match self {
            Side::Front => Side::Back,
            Side::Back => Side::Front,
        }
    }

    fn index(self) -> usize {
        match self {
            Side::Front => 0,
            Side::Back => 1,
        }
    }
}

/// Scattering data, with the file's description of the sample.
#[derive(Debug, Default)]
pub struct MeasuredBsdf {
    /// Name of the material; may be empty.
    pub material: String,
    /// Name of its maker; may be empty.
    pub maker: String,
    /// Width, height and thickness of the sample, metres; zero if not given.
    pub size_m: [f64; 3],
    /// Geometry of the sample in the Materials and Geometry Format, in metres.
    pub geometry: Option<String>,
    /// By side: red, green, blue.
    pub(crate) diffuse_reflectance: [[f64; 3]; 2],
    /// By incident side.
    pub(crate) diffuse_transmittance: [[f64; 3]; 2],
    pub(crate) reflection: [Option<Scattering>; 2],
    pub(crate) transmission: [Option<Scattering>; 2],
}

impl MeasuredBsdf {
    /// Lambertian part of the reflection from a side, 0…1: red, green, blue.
    #[must_use]
    pub fn diffuse_reflectance(&self, side: Side) -> [f64; 3] {
        self.diffuse_reflectance[side.index()]
    }

    /// Lambertian part of the transmission of light incident on a side, 0…1: red, green, blue.
    #[must_use]
    pub fn diffuse_transmittance(&self, side: Side) -> [f64; 3] {
        self.diffuse_transmittance[side.index()]
    }

    /// Reflection from a side, without the Lambertian part.
    #[must_use]
    pub fn reflection(&self, side: Side) -> Option<&Scattering> {
        self.reflection[side.index()].as_ref()
    }

    /// Transmission of light incident on a side, without the Lambertian part; by reciprocity that
    /// of the other side, if the file has only that.
    #[must_use]
    pub fn transmission(&self, side: Side) -> Option<&Scattering> {
        let own = self.transmission[side.index()].as_ref();
        own.or(self.transmission[side.opposite().index()].as_ref())
    }

    /// Whether red, green and blue are equal for all directions.
    #[must_use]
    pub fn is_grey(&self) -> bool {
        let mut diffuse = self.diffuse_reflectance.iter().chain(&self.diffuse_transmittance);
        let mut scattering = self.reflection.iter().chain(&self.transmission).flatten();
        diffuse.all(|[red, green, blue]| red == green && green == blue) && scattering.all(Scattering::is_grey)
    }

    /// Value for two directions with the Lambertian part, 1/sr: red, green, blue.
    #[must_use]
    pub fn value(&self, given: DVec3, other: DVec3) -> [f64; 3] {
        let side = Side::of(given);
        let (diffuse, scattering) = if side == Side::of(other) {
            (self.diffuse_reflectance(side), self.reflection(side))
        } else {
            (self.diffuse_transmittance(side), self.transmission(side))
        };
        match scattering {
            Some(scattering) => scattering.whole(given, other),
            None => diffuse.map(|band| band * FRAC_1_PI),
        }
    }

    /// Projected solid angle of the cell of a pair of directions, sr; π if all is Lambertian.
    #[must_use]
    pub fn projected_solid_angle(&self, given: DVec3, other: DVec3) -> f64 {
        let side = Side::of(given);
        let scattering = if side == Side::of(other) { self.reflection(side) } else { self.transmission(side) };
        scattering.and_then(|scattering| scattering.projected_solid_angle(given, other)).unwrap_or(PI)
    }

    /// Angular resolution near a direction, in reflection and transmission; π if all is Lambertian.
    #[must_use]
    pub fn resolution(&self, given: DVec3) -> Resolution {
        let side = Side::of(given);
        let each = [self.reflection(side), self.transmission(side)];
        let known = each.into_iter().flatten().filter_map(|scattering| scattering.resolution(given));
        known.reduce(Resolution::with).unwrap_or(Resolution { least: PI, largest: PI })
    }
}
