//! `trans`, `plastic2`, `metal2` and `trans2`: a coloured sheet that reflects and transmits,
//! diffusely and about the mirror and straight-through directions.
//!
//! Ward, "Measuring and Modeling Anisotropic Reflection", SIGGRAPH 1992, with the parameters of
//! Radiance's reference manual: a fraction of what is not reflected specularly is transmitted, and
//! a fraction of that is not scattered diffusely.

use crate::bsdf::{Bsdf, FRESNEL_THRESHOLD, FresnelCoat, Highlight, fresnel_estimate};
use crate::context::{BsdfContext, SpecularBounce, SurfaceScattering};
use crate::frame::Frame;
use crate::glossy::SMOOTH_ROUGHNESS;
use crate::specular_threshold::{BelowThreshold, LobeStrength};
use crate::transmission_lobe::{Transmission, TransmissionLobe};
use radsight_brdf::{GaussianTransmission, WardAnisotropic, WardIsotropic};
use radsight_cal::Scratch;
use radsight_ir::Rgb;
use radsight_texture::{Function, bands};

/// Parameters of the sheet.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Colour of the material, before patterns.
    pub color: Rgb,
    /// Fraction of the reflected light that is specular, 0…1.
    pub specularity: f64,
    /// Root mean square slopes along u and v.
    pub roughness: [f64; 2],
    /// Whether highlights take the material's colour.
    pub metallic: bool,
    /// Fraction of the light not reflected specularly that is transmitted, 0…1.
    pub transmissivity: f64,
    /// Fraction of the transmitted light that is not scattered diffusely, 0…1.
    pub transmitted_specularity: f64,
    /// Function that gives the direction of u; none for `trans`.
    pub orientation: Option<Function>,
}

/// Fractions of the light that each component scatters at one angle.
struct LobeAlbedos<const BANDS: usize> {
    /// Reflected specularly.
    specular: [f64; BANDS],
    diffuse: [f64; BANDS],
    transmitted_diffuse: [f64; BANDS],
    /// Transmitted about the straight-through direction.
    through: [f64; BANDS],
    coat: FresnelCoat,
    /// Rough highlights below the specular threshold.
    below_threshold: BelowThreshold<BANDS>,
}

impl Sheet {
    /// Whether the specular parts are a mirror reflection and a clear view. With two roughnesses
    /// they never are.
    fn is_smooth(&self) -> bool {
        self.orientation.is_none() && self.roughness[0] <= SMOOTH_ROUGHNESS
    }

    /// Whether there may be a mirror reflection or a clear view.
    pub fn may_be_specular(&self) -> bool {
        self.is_smooth() && self.specularity > 0.0 || self.lets_through()
    }

    /// Whether shadow rays can pass straight through.
    pub fn lets_through(&self) -> bool {
        self.is_smooth() && self.transmissivity * self.transmitted_specularity > 0.0
    }

    /// Whether the material's own parameters are the same in every band.
    pub fn is_grey(&self) -> bool {
        self.color.is_grey()
    }

    /// BSDF of the material at the intersection, and its perfectly specular rays.
    pub fn bsdf_at<'a, const BANDS: usize>(
        &self,
        context: &BsdfContext<'a, BANDS>,
        scratch: &mut Scratch,
    ) -> SurfaceScattering<'a, BANDS> {
        let outgoing = context.outgoing();
        let albedos =
            self.lobe_albedos(context.colored(bands(self.color)), outgoing.dot(context.normal), context.threshold);
        let (frame, roughness) = self.frame(context, scratch);
        let smooth = self.is_smooth();
        let straight = context.straight();
        let highlight = match self.orientation {
            _ if smooth || self.specularity <= 0.0 => Highlight::None,
            None => Highlight::Ward(WardIsotropic { specularity: albedos.specular, roughness: roughness[0] }),
            Some(_) => Highlight::WardAnisotropic(WardAnisotropic { specularity: albedos.specular, roughness }),
        };
        let lobe = (!smooth && self.transmitted_specularity > 0.0).then(|| {
            let shape = GaussianTransmission { transmittance: albedos.through, roughness };
            TransmissionLobe::new(shape, frame, straight, outgoing)
        });
        let transmission = Transmission::new(context.normal, albedos.transmitted_diffuse, lobe);
        let point = Bsdf {
            diffuse: albedos.diffuse,
            coat: albedos.coat,
            highlight,
            below_threshold: albedos.below_threshold,
            ..Bsdf::new(outgoing, context.interaction.normal, frame)
        };
        let (mirror, straight) = match smooth {
            true => {
                let has_mirror = self.specularity > 0.0;
                let mirror =
                    has_mirror.then(|| SpecularBounce::new(point.mirror_direction(), albedos.specular)).flatten();
                (mirror, SpecularBounce::new(straight, albedos.through))
            }
            false => (None, None),
        };
        SurfaceScattering { point: point.with_transmission(transmission), mirror, straight }
    }

    fn lobe_albedos<const BANDS: usize>(&self, color: [f64; BANDS], cosine: f64, threshold: f64) -> LobeAlbedos<BANDS> {
        let coated = self.is_smooth() && self.specularity >= FRESNEL_THRESHOLD;
        let fresnel = if coated { fresnel_estimate(cosine.max(0.001)) } else { 0.0 };
        let specularity = self.specularity + fresnel * (1.0 - self.specularity);
        let transmitted = self.transmissivity * (1.0 - specularity);
        let through = transmitted * self.transmitted_specularity;
        let specular = match self.metallic {
            true => color.map(|band| fresnel + band * self.specularity * (1.0 - fresnel)),
            false => [specularity; BANDS],
        };
        let share = |share: f64| color.map(|band| band * share.max(0.0));
        let [diffuse, transmitted_diffuse] = [1.0 - transmitted - specularity, transmitted - through];
        let below_threshold = match self.is_smooth() {
            true => BelowThreshold::NOTHING,
            false => BelowThreshold::new(
                threshold,
                [
                    LobeStrength { share: specularity, color: specular, diffuse },
                    LobeStrength { share: through, color: share(through), diffuse: transmitted_diffuse },
                ],
            ),
        };
        LobeAlbedos {
            specular,
            diffuse: share(diffuse),
            transmitted_diffuse: share(transmitted_diffuse),
            through: share(through),
            coat: if coated { FresnelCoat::Coat } else { FresnelCoat::None },
            below_threshold,
        }
    }

    /// Frame along the orientation, and the roughnesses in it. Without a usable orientation both
    /// roughnesses become one (Radiance's root mean square).
    fn frame<const BANDS: usize>(&self, context: &BsdfContext<'_, BANDS>, scratch: &mut Scratch) -> (Frame, [f64; 2]) {
        let Some(orientation) = &self.orientation else { return (Frame::new(context.normal), self.roughness) };
        match context.oriented(orientation, scratch) {
            Some(frame) => (frame, self.roughness),
            None => (Frame::new(context.normal), [isotropic_roughness(self.roughness); 2]),
        }
    }
}

/// Isotropic roughness for a surface without an orientation.
pub(crate) fn isotropic_roughness([u, v]: [f64; 2]) -> f64 {
    (0.5 * (u * u + v * v)).sqrt()
}
