//! Transmission: a diffuse component, and a lobe about the straight-through direction.

use crate::frame::Frame;
use glam::DVec3;
use radsight_brdf::GaussianTransmission;
use radsight_light::LobePeak;
use radsight_texture::strongest;
use std::f64::consts::PI;

/// The transmission of a shading point.
#[derive(Clone, Copy, Debug)]
pub struct Transmission<const BANDS: usize> {
    /// Unit normal of the diffuse component, on the viewer's side.
    pub normal: DVec3,
    /// Diffuse transmittance.
    pub diffuse: [f64; BANDS],
    /// Lobe about the straight-through direction.
    pub lobe: Option<TransmissionLobe<BANDS>>,
    /// Probability that a sample of the diffuse component is transmitted.
    pub diffuse_chance: f64,
    /// Probability that a sample of the highlight is transmitted.
    pub lobe_chance: f64,
}

impl<const BANDS: usize> Transmission<BANDS> {
    /// Transmission without probabilities; [`crate::Bsdf::with_transmission`] sets them.
    pub fn new(normal: DVec3, diffuse: [f64; BANDS], lobe: Option<TransmissionLobe<BANDS>>) -> Transmission<BANDS> {
        Transmission { normal, diffuse, lobe, diffuse_chance: 0.0, lobe_chance: 0.0 }
    }
}

/// A lobe of transmitted light.
#[derive(Clone, Copy, Debug)]
pub struct TransmissionLobe<const BANDS: usize> {
    /// Value and density of the lobe.
    pub shape: GaussianTransmission<BANDS>,
    /// Frame of the lobe.
    pub frame: Frame,
    /// Unit straight-through direction, in the frame.
    axis: DVec3,
    /// Cosine between the outgoing direction and the frame's normal.
    cosine: f64,
}

impl<const BANDS: usize> TransmissionLobe<BANDS> {
    /// `straight` is the unit direction of straight-through transmission, in the scene.
    pub fn new(
        shape: GaussianTransmission<BANDS>,
        frame: Frame,
        straight: DVec3,
        outgoing: DVec3,
    ) -> TransmissionLobe<BANDS> {
        TransmissionLobe { shape, frame, axis: frame.to_local(straight), cosine: outgoing.dot(frame.z) }
    }

    /// `f·|cos θ_i|` for a transmittance of one, and the density of [`TransmissionLobe::sample`],
    /// both in 1/sr.
    pub fn eval(&self, incident: DVec3) -> (f64, f64) {
        self.shape.shape(self.axis, self.cosine, self.frame.to_local(incident))
    }

    /// Samples a direction, returned in the scene.
    pub fn sample(&self, u: [f64; 2]) -> DVec3 {
        self.frame.to_scene(self.shape.sample_about(self.axis, u))
    }

    /// Shape of the lobe, for sampling points on lights.
    pub fn peak(&self, floor: f64) -> LobePeak {
        let [x, y] = self.shape.roughness;
        let height = strongest(&self.shape.transmittance) / (PI * x * y);
        let width = 1.0 / (x * x).max(y * y);
        LobePeak { axis: self.frame.to_scene(self.axis), width, height, floor, ..LobePeak::NONE }
    }
}

/// Probability of the second of two components, by their albedos; one half if both are zero.
pub(crate) fn chance_of_second(first: f64, second: f64) -> f64 {
    if first + second > 0.0 { second / (first + second) } else { 0.5 }
}
