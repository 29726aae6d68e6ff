//! What a BSDF file holds.

use crate::mistake::Mistake;
use crate::read::{Reading, read};
use crate::scattering::{Resolution, Scattering};
use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, PI};

/// A side of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Where the normal points: in a window, the room.
    Front,
    /// The other.
    Back,
}

impl Side {
    /// On which side a direction away from the surface lies.
    #[must_use]
    pub fn of(direction: DVec3) -> Side {
        if direction.z > 0.0 { Side::Front } else { Side::Back }
    }

    /// The other one.
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

/// Scattering data, and what the file says about the sample.
#[derive(Debug, Default)]
pub struct MeasuredBsdf {
    /// Name of the material; may be empty.
    pub material: String,
    /// Name of its maker; may be empty.
    pub maker: String,
    /// Width, height and thickness of the sample, metres; zero where the file does not say.
    pub size_m: [f64; 3],
    /// The sample's form in the Materials and Geometry Format, in metres.
    pub geometry: Option<String>,
    /// By side: red, green, blue.
    pub(crate) diffuse_reflectance: [[f64; 3]; 2],
    /// By the side on which light arrives.
    pub(crate) diffuse_transmittance: [[f64; 3]; 2],
    pub(crate) reflection: [Option<Scattering>; 2],
    pub(crate) transmission: [Option<Scattering>; 2],
}

impl MeasuredBsdf {
    /// Reads a file.
    ///
    /// # Errors
    /// The first mistake that keeps the data from being used, with its place.
    pub fn read(bytes: &[u8]) -> Result<Reading, Mistake> {
        read(bytes)
    }

    /// The Lambertian part of the reflection from a side, 0…1: red, green, blue.
    #[must_use]
    pub fn diffuse_reflectance(&self, side: Side) -> [f64; 3] {
        self.diffuse_reflectance[side.index()]
    }

    /// The Lambertian part of the transmission of what arrives on a side, 0…1: red, green, blue.
    #[must_use]
    pub fn diffuse_transmittance(&self, side: Side) -> [f64; 3] {
        self.diffuse_transmittance[side.index()]
    }

    /// Reflection from a side beyond the Lambertian part.
    #[must_use]
    pub fn reflection(&self, side: Side) -> Option<&Scattering> {
        self.reflection[side.index()].as_ref()
    }

    /// Transmission of what arrives on a side, beyond the Lambertian part; by reciprocity that of the other side, if the file has only that.
    #[must_use]
    pub fn transmission(&self, side: Side) -> Option<&Scattering> {
        let own = self.transmission[side.index()].as_ref();
        own.or(self.transmission[side.opposite().index()].as_ref())
    }

    /// Whether red, green and blue are the same for all directions.
    #[must_use]
    pub fn is_grey(&self) -> bool {
        let mut diffuse = self.diffuse_reflectance.iter().chain(&self.diffuse_transmittance);
        let mut beyond = self.reflection.iter().chain(&self.transmission).flatten();
        diffuse.all(|[red, green, blue]| red == green && green == blue) && beyond.all(Scattering::is_grey)
    }

    /// The value for two directions, 1/sr: red, green, blue; with the Lambertian part.
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

    /// The projected solid angle of the cell that a pair of directions falls into, sr; π where all is Lambertian.
    #[must_use]
    pub fn projected_solid_angle(&self, given: DVec3, other: DVec3) -> f64 {
        let side = Side::of(given);
        let scattering = if side == Side::of(other) { self.reflection(side) } else { self.transmission(side) };
        scattering.and_then(|scattering| scattering.projected_solid_angle(given, other)).unwrap_or(PI)
    }

    /// How finely directions near a given one are told apart, in reflection and transmission; π where all is Lambertian.
    #[must_use]
    pub fn resolution(&self, given: DVec3) -> Resolution {
        let side = Side::of(given);
        let each = [self.reflection(side), self.transmission(side)];
        let known = each.into_iter().flatten().filter_map(|scattering| scattering.resolution(given));
        known.reduce(Resolution::with).unwrap_or(Resolution { least: PI, largest: PI })
    }
}
