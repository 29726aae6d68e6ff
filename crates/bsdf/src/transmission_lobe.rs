//! What light from the other side of a surface does: diffuse transmission, and a lobe about the straight way through.

use crate::frame::Frame;
use glam::DVec3;
use radsight_brdf::GaussianTransmission;
use radsight_light::LobePeak;
use radsight_texture::strongest;
use std::f64::consts::PI;

/// The transmitting part of a lit point.
#[derive(Clone, Copy, Debug)]
pub struct Transmission<const BANDS: usize> {
    /// Unit normal of the diffuse part, on the viewer's side.
    pub normal: DVec3,
    /// Diffuse transmittance.
    pub diffuse: [f64; BANDS],
    /// The part about the straight way.
    pub lobe: Option<TransmissionLobe<BANDS>>,
    /// How often a draw from the diffuse component goes to this side.
    pub diffuse_chance: f64,
    /// How often a draw from the highlight goes to this side.
    pub lobe_chance: f64,
}

impl<const BANDS: usize> Transmission<BANDS> {
    /// The chances are set when it becomes part of a lit point.
    pub fn new(normal: DVec3, diffuse: [f64; BANDS], lobe: Option<TransmissionLobe<BANDS>>) -> Transmission<BANDS> {
        Transmission { normal, diffuse, lobe, diffuse_chance: 0.0, lobe_chance: 0.0 }
    }
}

/// A lobe of transmitted light.
#[derive(Clone, Copy, Debug)]
pub struct TransmissionLobe<const BANDS: usize> {
    /// Its value and density.
    pub shape: GaussianTransmission<BANDS>,
    /// The frame in which the lobe stands.
    pub frame: Frame,
    /// Unit, where light goes straight through, in the frame.
    axis: DVec3,
    /// Of the outgoing direction to the frame's normal.
    cosine: f64,
}

impl<const BANDS: usize> TransmissionLobe<BANDS> {
    /// `straight` is the unit direction, in the scene, about which light goes on.
    pub fn new(
        shape: GaussianTransmission<BANDS>,
        frame: Frame,
        straight: DVec3,
        outgoing: DVec3,
    ) -> TransmissionLobe<BANDS> {
        TransmissionLobe { shape, frame, axis: frame.to_local(straight), cosine: outgoing.dot(frame.z) }
    }

    /// `f·|cos θ_i|` for a transmittance of one, and the density of [`TransmissionLobe::draw`], both in 1/sr.
    pub fn eval(&self, incident: DVec3) -> (f64, f64) {
        self.shape.shape(self.axis, self.cosine, self.frame.to_local(incident))
    }

    /// A direction in the scene.
    pub fn draw(&self, u: [f64; 2]) -> DVec3 {
        self.frame.to_scene(self.shape.draw(self.axis, u))
    }

    /// The lobe as the drawing of places on lights sees it.
    pub fn peak(&self, floor: f64) -> LobePeak {
        let [x, y] = self.shape.roughness;
        let height = strongest(&self.shape.transmittance) / (PI * x * y);
        LobePeak { axis: self.frame.to_scene(self.axis), width: 1.0 / (x * x).max(y * y), height, floor }
    }
}

/// The chance of the second of two ways by what they carry; even where neither carries anything.
pub(crate) fn chance_of_second(first: f64, second: f64) -> f64 {
    if first + second > 0.0 { second / (first + second) } else { 0.5 }
}
