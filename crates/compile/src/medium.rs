//! What fills the space that a ray crosses: absorbing bodies, mist, and the medium around everything.
//!
//! A ray is dimmed by `exp(−σd)` over the distance d, σ its medium's extinction (Beer and Lambert). Mist scatters the light of the sources
//! that it names into the ray: at each place `σ·a·p(θ)·L`, with a the albedo, L the source's radiance as it arrives, and Henyey and
//! Greenstein's phase function `p(θ) = (1 − g²)/(4π(1 + g² − 2g·cos θ)^1.5)` (Astrophysical Journal 93, 1941), θ between the direction
//! in which the light travels and that towards the viewer. As in Radiance a shadow ray loses only what is absorbed, `exp(−(1 − a)σd)`,
//! and light that is scattered twice is a constant, the ambient value.

use glam::DVec3;
use radsight_ir::{Mist, Rgb};
use radsight_texture::bands;
use std::f64::consts::PI;

/// Extinction where a transmissivity is zero: nothing comes through a hundredth of a scene unit.
const OPAQUE: f64 = 100.0;

/// Transmissivities below this count as zero.
const LEAST_TRANSMISSIVITY: f64 = 1e-40;

/// What fills the space along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium<const BANDS: usize> {
    /// 1/scene unit.
    pub extinction: [f64; BANDS],
    /// Share of the extinction that is scattering.
    pub albedo: [f64; BANDS],
    /// Henyey and Greenstein's g.
    pub eccentricity: f64,
    /// Which lights it scatters, as bits of the plan's list.
    pub lights: u64,
}

/// The `mist` material.
#[derive(Clone, Debug)]
pub struct MistKind {
    extinction: Rgb,
    albedo: Option<Rgb>,
    eccentricity: Option<f64>,
    /// The lights that it names.
    pub names: Vec<String>,
    /// The same as bits of the plan's list.
    pub lights: u64,
}

impl<const BANDS: usize> Medium<BANDS> {
    /// A body that absorbs.
    pub fn absorbing(transmissivity: Rgb, pattern: [f64; BANDS], lights: u64) -> Self {
        let own: [f64; BANDS] = bands(transmissivity);
        let extinction = std::array::from_fn(|band| extinction(own[band] * pattern[band]));
        Medium { extinction, albedo: [0.0; BANDS], eccentricity: 0.0, lights }
    }

    /// What is left of light over a distance.
    pub fn transmission(&self, distance: f64) -> [f64; BANDS] {
        self.extinction.map(|extinction| passage(extinction, distance))
    }

    /// What is left of light on its way from a source, which Radiance does not dim by what is scattered.
    pub fn shadow_transmission(&self, distance: f64) -> [f64; BANDS] {
        std::array::from_fn(|band| passage(self.extinction[band] * (1.0 - self.albedo[band]), distance))
    }

    /// Whether light of some source is scattered into a ray.
    pub fn scatters_lights(&self) -> bool {
        self.lights != 0 && self.scatters() && self.eccentricity < 1.0 - 1e-6
    }

    /// Whether it scatters at all.
    pub fn scatters(&self) -> bool {
        (0..BANDS).any(|band| self.extinction[band] * self.albedo[band] > 0.0)
    }

    /// The phase function for light that travels along `-to_light` and leaves along `-along_ray`, 1/sr.
    pub fn phase(&self, along_ray: DVec3, to_light: DVec3) -> f64 {
        let g = self.eccentricity;
        let base = 1.0 + g * g - 2.0 * g * along_ray.dot(to_light);
        (1.0 - g * g) / (4.0 * PI * base * base.sqrt())
    }
}

fn passage(extinction: f64, distance: f64) -> f64 {
    // Nothing times an infinite distance is nothing.
    if extinction <= 0.0 { 1.0 } else { (-extinction * distance).exp() }
}

fn extinction(transmissivity: f64) -> f64 {
    if transmissivity < LEAST_TRANSMISSIVITY { OPAQUE } else { (-transmissivity.ln()).max(0.0) }
}

impl MistKind {
    /// The material, without its lights.
    pub fn new(mist: &Mist) -> MistKind {
        MistKind {
            extinction: mist.extinction,
            albedo: mist.albedo,
            eccentricity: mist.eccentricity,
            names: mist.sources.clone(),
            lights: 0,
        }
    }

    /// Whether every band is the same.
    pub fn is_grey(&self) -> bool {
        self.extinction.is_grey() && self.albedo.is_none_or(Rgb::is_grey)
    }

    /// Whether it scatters any light itself.
    pub fn scatters(&self) -> bool {
        self.albedo.is_some_and(|albedo| !albedo.is_black())
    }

    /// The medium behind the surface for a ray that enters: mist adds to what is there.
    pub fn entered<const BANDS: usize>(&self, outside: Medium<BANDS>, pattern: [f64; BANDS]) -> Medium<BANDS> {
        let own: [f64; BANDS] = bands(self.extinction);
        Medium {
            extinction: std::array::from_fn(|band| outside.extinction[band] + own[band] * pattern[band]),
            albedo: self.albedo.map_or(outside.albedo, bands),
            eccentricity: self.eccentricity.unwrap_or(outside.eccentricity),
            lights: outside.lights | self.lights,
        }
    }

    /// The medium that a leaving ray has crossed: that in which it started, unless it started inside of the mist without knowing.
    pub fn crossed<const BANDS: usize>(&self, ray: Medium<BANDS>, pattern: [f64; BANDS]) -> Medium<BANDS> {
        if ray.lights & self.lights == self.lights { ray } else { self.entered(ray, pattern) }
    }

    /// The medium beyond the surface for a ray that leaves.
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
    fn a_positive_eccentricity_sends_light_on_the_way_it_goes() {
        let forward = medium(0.7).phase(DVec3::Z, DVec3::Z);
        let backward = medium(0.7).phase(DVec3::Z, -DVec3::Z);
        assert!(forward > 10.0 * backward);
    }

    #[test]
    fn mist_that_is_entered_and_left_leaves_nothing() {
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
        // A ray that starts inside knows nothing of it until it leaves.
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
