//! How a lit point of a surface scatters: its components, evaluated and drawn from.

use crate::shader::{GlossyKind, bands};
use crate::tilt::Peak;
use glam::DVec3;
use radsight_brdf::{Brdf, BrdfSample, Density, WardIsotropic};
use radsight_retro::{Paper1991, observation_angle};
use radsight_sampling::cosine_hemisphere;
use std::f64::consts::FRAC_1_PI;

/// A right-handed frame with +z on a unit normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    x: DVec3,
    y: DVec3,
    pub(crate) z: DVec3,
}

impl Frame {
    #[inline]
    pub(crate) fn new(normal: DVec3) -> Frame {
        let (x, y) = normal.any_orthonormal_pair();
        Frame { x, y, z: normal }
    }

    #[inline]
    pub(crate) fn to_local(self, v: DVec3) -> DVec3 {
        DVec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    #[inline]
    pub(crate) fn to_scene(self, v: DVec3) -> DVec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }
}

/// A peak of finite width.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Highlight<'a, const BANDS: usize> {
    None,
    Ward(WardIsotropic<BANDS>),
    Retro(Paper1991<BANDS>),
    Model(&'a dyn Brdf),
}

/// A point of a surface, ready to be lit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LitPoint<'a, const BANDS: usize> {
    /// Unit, towards where the ray came from.
    pub(crate) outgoing: DVec3,
    /// Unit geometric normal on that side.
    pub(crate) normal: DVec3,
    /// Frame on the shading normal.
    pub(crate) frame: Frame,
    /// Unit normal of the diffuse component: the shading normal, but for the turned texture of a retroreflector.
    diffuse_normal: DVec3,
    /// Diffuse reflectance at normal incidence.
    pub(crate) diffuse: [f64; BANDS],
    /// A smooth surface takes from the diffuse what it reflects at this angle (Radiance's Fresnel estimate).
    fresnel_coupling: bool,
    pub(crate) highlight: Highlight<'a, BANDS>,
    /// Reflectance of the mirror image; zero for rough surfaces.
    pub(crate) mirror: [f64; BANDS],
}

/// Products `f·|cos θ_i|` and densities of the two components for one incident direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Response<const BANDS: usize> {
    pub(crate) diffuse: [f64; BANDS],
    pub(crate) diffuse_density: f64,
    pub(crate) highlight: [f64; BANDS],
    pub(crate) highlight_density: f64,
}

/// Whether densities of drawing are needed beside the values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Densities {
    Wanted,
    Unused,
}

/// A drawn direction with its weight `f·|cos θ_i|/pdf`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drawn<const BANDS: usize> {
    pub(crate) direction: DVec3,
    pub(crate) weight: [f64; BANDS],
    pub(crate) density: Density,
}

impl<const BANDS: usize> Drawn<BANDS> {
    /// One of several draws that share the work: each weighs less, and there is more density of them.
    pub(crate) fn split(self, draws: f64) -> Self {
        let density = match self.density {
            Density::Continuous(density) => Density::Continuous(density * draws),
            Density::Delta => Density::Delta,
        };
        Drawn { weight: self.weight.map(|band| band / draws), density, ..self }
    }
}

/// Radiance's estimate of the Fresnel reflectance of a smooth coat at this cosine (its `normal.c`).
fn fresnel_estimate(cosine: f64) -> f64 {
    (-5.85 * cosine).exp() - 0.002_879_899_16
}

/// Specularities below this get no Fresnel estimate in Radiance.
const FRESNEL_THRESHOLD: f64 = 0.017_999;

impl<'a, const BANDS: usize> LitPoint<'a, BANDS> {
    /// A plastic or metal with this (already patterned) colour and shading normal.
    pub(crate) fn glossy(
        kind: &GlossyKind,
        retro: bool,
        color: [f64; BANDS],
        outgoing: DVec3,
        normal: DVec3,
        shading_normal: DVec3,
    ) -> Self {
        let smooth = kind.is_smooth();
        let cosine = outgoing.dot(shading_normal).max(0.001);
        let coated = smooth && kind.specularity >= FRESNEL_THRESHOLD;
        let fresnel = if coated { fresnel_estimate(cosine) } else { 0.0 };
        let specularity = kind.specularity + fresnel * (1.0 - kind.specularity);
        let specular: [f64; BANDS] = match kind.metallic {
            true => color.map(|band| fresnel + band * kind.specularity * (1.0 - fresnel)),
            false => [specularity; BANDS],
        };
        let highlight = if smooth || kind.specularity <= 0.0 {
            Highlight::None
        } else if retro {
            Highlight::Retro(Paper1991 { reflectance: specular, spread: kind.roughness })
        } else {
            Highlight::Ward(WardIsotropic { specularity: specular, roughness: kind.roughness })
        };
        LitPoint {
            outgoing,
            normal,
            frame: Frame::new(shading_normal),
            diffuse_normal: if retro { outgoing } else { shading_normal },
            diffuse: color.map(|band| band * (1.0 - specularity)),
            fresnel_coupling: coated,
            highlight,
            mirror: if smooth && kind.specularity > 0.0 { specular } else { [0.0; BANDS] },
        }
    }

    /// A reflectance model from elsewhere.
    pub(crate) fn model(model: &'a dyn Brdf, outgoing: DVec3, normal: DVec3, shading_normal: DVec3) -> Self {
        LitPoint {
            outgoing,
            normal,
            frame: Frame::new(shading_normal),
            diffuse_normal: shading_normal,
            diffuse: [0.0; BANDS],
            fresnel_coupling: false,
            highlight: Highlight::Model(model),
            mirror: [0.0; BANDS],
        }
    }

    /// The highlight as the drawing of places on lights sees it.
    pub(crate) fn peak(&self) -> Peak {
        let strongest = |bands: &[f64; BANDS]| bands.iter().copied().fold(0.0, f64::max);
        let floor = strongest(&self.diffuse) * FRAC_1_PI;
        match &self.highlight {
            Highlight::Retro(retro) => {
                let height = strongest(&retro.reflectance) * retro.reflected_density(0.0);
                Peak { axis: self.outgoing, width: 0.25 / (retro.spread * retro.spread), height, floor }
            }
            Highlight::Ward(ward) => {
                // About the mirror direction the half vector turns half as fast as the incident one.
                let width = 0.25 / (ward.roughness * ward.roughness);
                let height = strongest(&ward.specularity) * width * FRAC_1_PI;
                Peak { axis: self.mirror_direction(), width, height, floor }
            }
            Highlight::None | Highlight::Model(_) => Peak::NONE,
        }
    }

    /// Whether the highlight can only be found by drawing from it.
    pub(crate) fn has_highlight(&self) -> bool {
        !matches!(self.highlight, Highlight::None)
    }

    /// Whether its highlight sends light back to where it comes from.
    pub(crate) fn is_retroreflector(&self) -> bool {
        matches!(self.highlight, Highlight::Retro(_))
    }

    /// Whether there is a diffuse component.
    pub(crate) fn has_diffuse(&self) -> bool {
        self.diffuse.iter().any(|band| *band > 0.0)
    }

    /// Both components for light from `incident`. The highlight's density is left at zero where nobody asks for it.
    #[inline]
    pub(crate) fn respond(&self, incident: DVec3, densities: Densities) -> Response<BANDS> {
        let mut response =
            Response { diffuse: [0.0; BANDS], diffuse_density: 0.0, highlight: [0.0; BANDS], highlight_density: 0.0 };
        let cosine = self.diffuse_normal.dot(incident);
        if cosine > 0.0 {
            let coupling = if self.fresnel_coupling { 1.0 - fresnel_estimate(cosine) } else { 1.0 };
            response.diffuse_density = cosine * FRAC_1_PI;
            response.diffuse = self.diffuse.map(|band| band * cosine * FRAC_1_PI * coupling);
        }
        match &self.highlight {
            Highlight::None => {}
            Highlight::Ward(ward) => {
                let local = self.frame.to_local(incident);
                let (shape, density) = ward.shape(self.frame.to_local(self.outgoing), local);
                response.highlight_density = density;
                response.highlight = ward.specularity.map(|band| band * shape * local.z);
            }
            Highlight::Retro(retro) => {
                if self.normal.dot(incident) > 0.0 {
                    let angle = observation_angle(self.outgoing, incident);
                    let shape = retro.reflected_density(angle);
                    if densities == Densities::Wanted {
                        response.highlight_density = retro_density(retro, angle);
                    }
                    response.highlight = retro.reflectance.map(|band| band * shape);
                }
            }
            Highlight::Model(model) => {
                let local = self.frame.to_local(incident);
                let mut density = [0.0];
                model.eval_pdf(self.frame.to_local(self.outgoing), &[local], &mut response.highlight, &mut density);
                response.highlight_density = density[0];
                response.highlight = response.highlight.map(|band| band * local.z.abs());
            }
        }
        response
    }

    /// Draws from the highlight.
    pub(crate) fn draw_highlight(&self, u: [f64; 3]) -> Option<Drawn<BANDS>> {
        // The retroreflecting lobe lives on the geometric normal: its texture is what turns the other one.
        let frame = if matches!(self.highlight, Highlight::Retro(_)) { Frame::new(self.normal) } else { self.frame };
        let outgoing = frame.to_local(self.outgoing);
        let mut weight = [0.0; BANDS];
        let sample = match &self.highlight {
            Highlight::None => None,
            Highlight::Ward(ward) => ward.sample(outgoing, u, &mut weight),
            Highlight::Retro(retro) => draw_retro(retro, outgoing, u, &mut weight),
            Highlight::Model(model) => model.sample(outgoing, u, &mut weight),
        }?;
        Some(Drawn { direction: frame.to_scene(sample.incident), weight, density: sample.density })
    }

    /// Draws from the diffuse component.
    pub(crate) fn draw_diffuse(&self, u: f64, v: f64) -> Option<Drawn<BANDS>> {
        let local = DVec3::from_array(cosine_hemisphere(u, v));
        let direction = Frame::new(self.diffuse_normal).to_scene(local);
        if local.z <= 0.0 || self.normal.dot(direction) <= 0.0 {
            return None;
        }
        let coupling = if self.fresnel_coupling { 1.0 - fresnel_estimate(local.z) } else { 1.0 };
        let weight = self.diffuse.map(|band| band * coupling);
        Some(Drawn { direction, weight, density: Density::Continuous(local.z * FRAC_1_PI) })
    }

    /// The mirror direction; a texture that would send it through the surface is not used.
    pub(crate) fn mirror_direction(&self) -> DVec3 {
        let reflect = |normal: DVec3| normal * (2.0 * normal.dot(self.outgoing)) - self.outgoing;
        let direction = reflect(self.frame.z);
        if direction.dot(self.normal) > 0.0 { direction } else { reflect(self.normal) }
    }
}

/// Rays that look for light by way of mirrors are drawn from the lobe and, as often, from one this many times as wide: a
/// camera's lights stand beside it, in the lobe's tail, where the lobe itself would send one ray in fifty.
const TAIL: f64 = 2.2;

fn tail<const BANDS: usize>(retro: &Paper1991<BANDS>) -> Paper1991<BANDS> {
    Paper1991 { spread: TAIL * retro.spread, ..*retro }
}

/// The density of [`draw_retro`] at an observation angle, 1/sr.
fn retro_density<const BANDS: usize>(retro: &Paper1991<BANDS>, angle: f64) -> f64 {
    0.5 * (retro.sampling_density(angle) + tail(retro).sampling_density(angle))
}

fn draw_retro<const BANDS: usize>(
    retro: &Paper1991<BANDS>,
    outgoing: DVec3,
    u: [f64; 3],
    weight: &mut [f64; BANDS],
) -> Option<BrdfSample> {
    let drawn_from = if u[2] < 0.5 { *retro } else { tail(retro) };
    let sample = drawn_from.sample(outgoing, u, weight)?;
    let angle = observation_angle(outgoing, sample.incident);
    let density = retro_density(retro, angle);
    let value = retro.reflected_density(angle) / density;
    *weight = retro.reflectance.map(|band| band * value);
    Some(BrdfSample { density: Density::Continuous(density), ..sample })
}

/// Reflectance and transmittance of a thin pane with multiple internal reflections, both polarisations averaged (Radiance's
/// `glass`).
pub(crate) fn pane<const BANDS: usize>(transmissivity: [f64; BANDS], index: f64, cosine: f64) -> [[f64; BANDS]; 2] {
    let inside = ((1.0 - 1.0 / (index * index)) + cosine * cosine / (index * index)).sqrt();
    let perpendicular = ((cosine - index * inside) / (cosine + index * inside)).powi(2);
    let parallel = ((1.0 / cosine - index / inside) / (1.0 / cosine + index / inside)).powi(2);
    let mut reflected = [0.0; BANDS];
    let mut transmitted = [0.0; BANDS];
    for band in 0..BANDS {
        let passage = transmissivity[band].max(1e-15).powf(1.0 / inside);
        for r in [perpendicular, parallel] {
            let twice = passage * passage;
            let echo = 1.0 - r * r * twice;
            transmitted[band] += 0.5 * (1.0 - r) * (1.0 - r) * passage / echo;
            reflected[band] += 0.5 * r * (1.0 + (1.0 - 2.0 * r) * twice) / echo;
        }
    }
    [reflected, transmitted]
}

/// The colour of a material with a colour of its own.
pub(crate) fn colored<const BANDS: usize>(kind: &GlossyKind, pattern: [f64; BANDS]) -> [f64; BANDS] {
    let own: [f64; BANDS] = bands(kind.color);
    std::array::from_fn(|band| own[band] * pattern[band])
}
