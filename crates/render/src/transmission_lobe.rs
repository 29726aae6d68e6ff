//! What light from the other side of a surface does: diffuse transmission, and a lobe about the straight way through.

use crate::bands::gathered;
use crate::frame::Frame;
use crate::lobe_weighting::LobePeak;
use glam::DVec3;
use radsight_brdf::GaussianTransmission;
use std::f64::consts::PI;

/// The transmitting part of a lit point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transmission<const BANDS: usize> {
    /// Unit normal of the diffuse part, on the viewer's side.
    pub(crate) normal: DVec3,
    /// Diffuse transmittance.
    pub(crate) diffuse: [f64; BANDS],
    pub(crate) lobe: Option<TransmissionLobe<BANDS>>,
    /// How often a draw from the diffuse component goes to this side.
    pub(crate) diffuse_chance: f64,
    /// How often a draw from the highlight goes to this side.
    pub(crate) lobe_chance: f64,
}

impl<const BANDS: usize> Transmission<BANDS> {
    /// The chances are set when it becomes part of a lit point.
    pub(crate) fn new(
        normal: DVec3,
        diffuse: [f64; BANDS],
        lobe: Option<TransmissionLobe<BANDS>>,
    ) -> Transmission<BANDS> {
        Transmission { normal, diffuse, lobe, diffuse_chance: 0.0, lobe_chance: 0.0 }
    }
}

/// A lobe of transmitted light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TransmissionLobe<const BANDS: usize> {
    pub(crate) shape: GaussianTransmission<BANDS>,
    pub(crate) frame: Frame,
    /// Unit, where light goes straight through, in the frame.
    axis: DVec3,
    /// Of the outgoing direction to the frame's normal.
    cosine: f64,
}

impl<const BANDS: usize> TransmissionLobe<BANDS> {
    /// `straight` is the unit direction, in the scene, about which light goes on.
    pub(crate) fn new(
        shape: GaussianTransmission<BANDS>,
        frame: Frame,
        straight: DVec3,
        outgoing: DVec3,
    ) -> TransmissionLobe<BANDS> {
        TransmissionLobe { shape, frame, axis: frame.to_local(straight), cosine: outgoing.dot(frame.z) }
    }

    /// `f·|cos θ_i|` for a transmittance of one, and the density of [`TransmissionLobe::draw`], both in 1/sr.
    pub(crate) fn eval(&self, incident: DVec3) -> (f64, f64) {
        self.shape.shape(self.axis, self.cosine, self.frame.to_local(incident))
    }

    /// A direction in the scene.
    pub(crate) fn draw(&self, u: [f64; 2]) -> DVec3 {
        self.frame.to_scene(self.shape.draw(self.axis, u))
    }

    /// The lobe as the drawing of places on lights sees it.
    pub(crate) fn peak(&self, floor: f64) -> LobePeak {
        let [x, y] = self.shape.roughness;
        let height = strongest(&self.shape.transmittance) / (PI * x * y);
        LobePeak { axis: self.frame.to_scene(self.axis), width: 1.0 / (x * x).max(y * y), height, floor }
    }
}

/// The largest band.
pub(crate) fn strongest<const BANDS: usize>(bands: &[f64; BANDS]) -> f64 {
    bands.iter().copied().fold(0.0, f64::max)
}

/// The chance of the second of two ways by what they carry; even where neither carries anything.
pub(crate) fn chance_of_second(first: f64, second: f64) -> f64 {
    if first + second > 0.0 { second / (first + second) } else { 0.5 }
}

/// Brightness of a colour, with Radiance's weights of its primaries.
pub(crate) fn luminance<const BANDS: usize>(bands: &[f64; BANDS]) -> f64 {
    let [red, green, blue] = gathered(bands);
    0.265 * red + 0.670 * green + 0.065 * blue
}
