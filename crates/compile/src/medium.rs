//! Participating media: absorbing volumes, mist, and the medium around the scene.
//!
//! A ray is attenuated by `exp(−σd)` over the distance d, with σ the medium's extinction (Beer and
//! Lambert). Mist scatters light of the sources that it names into the ray: at each point
//! `σ·a·p(θ)·L`, with the albedo a, the incident radiance L of the source, and the phase function
//! of Henyey and Greenstein `p(θ) = (1 − g²)/(4π(1 + g² − 2g·cos θ)^1.5)` (Astrophysical Journal
//! 93, 1941). θ is the angle between the light's propagation direction and the direction towards
//! the viewer. As in Radiance, a shadow ray loses only what is absorbed, `exp(−(1 − a)σd)`, and
//! multiply scattered light is a constant, the ambient value.

use glam::DVec3;
use radsight_ir::{Mist, Rgb};
use radsight_texture::bands;
use std::f64::consts::PI;

/// Extinction of a transmissivity of zero, 1/scene unit.
const OPAQUE: f64 = 100.0;

/// Transmissivities below this count as zero.
const LEAST_TRANSMISSIVITY: f64 = 1e-40;

/// The medium along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium<const BANDS: usize> {
    /// Extinction coefficient, 1/scene unit.
    pub extinction: [f64; BANDS],
    /// Scattering albedo: fraction of the extinction that is scattering.
    pub albedo: [f64; BANDS],
    /// Eccentricity g of Henyey and Greenstein's phase function.
    pub eccentricity: f64,
    /// Lights that it scatters, as bits of the plan's list.
    pub lights: u64,
}

/// Parameters of `mist`.
#[derive(Clone, Debug)]
pub struct MistKind {
    extinction: Rgb,
    albedo: Option<Rgb>,
    eccentricity: Option<f64>,
    /// Names of the lights that it scatters.
    pub names: Vec<String>,
    /// The same lights, as bits of the plan's list.
    pub lights: u64,
}

impl<const BANDS: usize> Medium<BANDS> {
    /// An absorbing volume.
    pub fn absorbing(transmissivity: Rgb, pattern: [f64; BANDS], lights: u64) -> Self {
        let own: [f64; BANDS] = bands(transmissivity);
        let extinction = std::array::from_fn(|band| extinction(own[band] * pattern[band]));
        Medium { extinction, albedo: [0.0; BANDS], eccentricity: 0.0, lights }
    }

    /// Transmittance over a distance.
    pub fn transmission(&self, distance: f64) -> [f64; BANDS] {
        self.extinction.map(|extinction| passage(extinction, distance))
    }

    /// Transmittance over a distance for a shadow ray, which Radiance does not attenuate by
    /// scattering.
    pub fn shadow_transmission(&self, distance: f64) -> [f64; BANDS] {
        std::array::from_fn(|band| passage(self.extinction[band] * (1.0 - self.albedo[band]), distance))
    }

    /// Whether it scatters light of any source into a ray.
    pub fn scatters_lights(&self) -> bool {
        self.lights != 0 && self.scatters() && self.eccentricity < 1.0 - 1e-6
    }

    /// Whether it scatters light.
    pub fn scatters(&self) -> bool {
        (0..BANDS).any(|band| self.extinction[band] * self.albedo[band] > 0.0)
    }

    /// Phase function for light that travels along `-to_light` and leaves along `-along_ray`, 1/sr.
    pub fn phase(&self, along_ray: DVec3, to_light: DVec3) -> f64 {
        let g = self.eccentricity;
        let base = 1.0 + g * g - 2.0 * g * along_ray.dot(to_light);
        (1.0 - g * g) / (4.0 * PI * base * base.sqrt())
    }
}

fn passage(extinction: f64, distance: f64) -> f64 {
    // Zero extinction over an infinite distance attenuates nothing.
    if extinction <= 0.0 { 1.0 } else { (-extinction * distance).exp() }
}

fn extinction(transmissivity: f64) -> f64 {
    if transmissivity < LEAST_TRANSMISSIVITY { OPAQUE } else { (-transmissivity.ln()).max(0.0) }
}

impl MistKind {
    /// The material; its lights are resolved later.
    pub fn new(mist: &Mist) -> MistKind {
        MistKind {
            extinction: mist.extinction,
            albedo: mist.albedo,
            eccentricity: mist.eccentricity,
            names: mist.sources.clone(),
            lights: 0,
        }
    }

    /// Whether every band has the same parameters.
    pub fn is_grey(&self) -> bool {
        self.extinction.is_grey() && self.albedo.is_none_or(Rgb::is_grey)
    }

    /// Whether it adds scattering to its surroundings.
    pub fn scatters(&self) -> bool {
        self.albedo.is_some_and(|albedo| !albedo.is_black())
    }

    /// Medium behind the surface for a ray that enters: mist adds to the surrounding medium.
    pub fn entered<const BANDS: usize>(&self, outside: Medium<BANDS>, pattern: [f64; BANDS]) -> Medium<BANDS> {
        let own: [f64; BANDS] = bands(self.extinction);
        Medium {
            extinction: std::array::from_fn(|band| outside.extinction[band] + own[band] * pattern[band]),
            albedo: self.albedo.map_or(outside.albedo, bands),
            eccentricity: self.eccentricity.unwrap_or(outside.eccentricity),
            lights: outside.lights | self.lights,
        }
    }

    /// Medium that a leaving ray has crossed: the one where it started, unless it started inside
    /// the mist unknowingly.
    pub fn crossed<const BANDS: usize>(&self, ray: Medium<BANDS>, pattern: [f64; BANDS]) -> Medium<BANDS> {
        if ray.lights & self.lights == self.lights { ray } else { self.entered(ray, pattern) }
    }

    /// Medium beyond the surface for a ray that leaves.
    pub fn left<const BANDS: usize>(
        &self,
        inside: Medium<BANDS>,
        pattern: [f64; BANDS],
        global: &Medium<BANDS>,
    ) -> Medium<BANDS> {
        let own: [f64; BANDS] = bands(self.extinction);
        let rest = |band: usize| (inside.extinction[band] - own[band] * pattern[band]).max(global.extinction[band]);
        Medium {
            extinction: std::array::from_fn(rest),
            albedo: if self.albedo.is_some() { global.albedo } else { inside.albedo },
            eccentricity: if self.eccentricity.is_some() { global.eccentricity } else { inside.eccentricity },
            lights: inside.lights & !self.lights,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn medium(eccentricity: f64) -> Medium<1> {
        Medium { extinction: [2.0], albedo: [0.5], eccentricity, lights: 0 }
    }

    #[test]
    fn the_phase_function_integrates_to_one() {
        for eccentricity in [0.0, 0.3, 0.8, -0.5] {
            let steps = 200_000;
            let sum: f64 = (0..steps)
                .map(|step| {
                    let cosine = -1.0 + 2.0 * (f64::from(step) + 0.5) / f64::from(steps);
                    let towards = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
                    medium(eccentricity).phase(DVec3::Z, towards)
                })
                .sum();
            let integral = sum * 4.0 * PI / f64::from(steps);
            assert!((integral - 1.0).abs() < 1e-6, "{eccentricity}: {integral}");
        }
    }

    #[test]
    fn a_positive_eccentricity_scatters_light_forward() {
        let forward = medium(0.7).phase(DVec3::Z, DVec3::Z);
        let backward = medium(0.7).phase(DVec3::Z, -DVec3::Z);
        assert!(forward > 10.0 * backward);
    }

    #[test]
    fn entering_and_leaving_mist_restores_the_medium() {
        let nothing = Medium { extinction: [0.0], albedo: [0.0], eccentricity: 0.0, lights: 0 };
        let mist = MistKind {
            extinction: Rgb([3.0; 3]),
            albedo: Some(Rgb([0.4; 3])),
            eccentricity: Some(0.2),
            names: Vec::new(),
            lights: 5,
        };
        let inside = mist.entered(nothing, [0.5]);
        assert_eq!(inside.extinction, [1.5]);
        assert_eq!(mist.left(inside, [0.5], &nothing), nothing);
        // A ray that starts inside mist does not know it until it leaves.
        assert_eq!(mist.crossed(nothing, [0.5]), inside);
    }

    #[test]
    fn a_shadow_ray_loses_what_is_absorbed() {
        assert_eq!(medium(0.0).transmission(1.5), [(-3.0f64).exp()]);
        assert_eq!(medium(0.0).shadow_transmission(1.5), [(-1.5f64).exp()]);
        let empty = Medium { extinction: [0.0], albedo: [0.0], eccentricity: 0.0, lights: 0 };
        assert_eq!(empty.transmission(f64::INFINITY), [1.0]);
    }
}
