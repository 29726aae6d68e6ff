//! `trans`, `plastic2`, `metal2` and `trans2`: a coloured sheet that reflects and transmits, diffusely and about the mirror and
//! straight-through directions.
//!
//! Ward, "Measuring and Modeling Anisotropic Reflection", SIGGRAPH 1992, in the form of Radiance's reference manual: of what is not
//! reflected specularly a share goes through, and of that a share is not scattered diffusely.

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

/// The parameters.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Of the material, before patterns.
    pub color: Rgb,
    /// Share of what is reflected that is specular, 0…1.
    pub specularity: f64,
    /// Along u and v.
    pub roughness: [f64; 2],
    /// Highlights take the material's colour.
    pub metallic: bool,
    /// Share of what is not reflected specularly that goes through.
    pub transmissivity: f64,
    /// Share of that which is not scattered diffusely.
    pub transmitted_specularity: f64,
    /// Where u points; none for `trans`.
    pub orientation: Option<Function>,
}

/// How the light divides at one angle.
struct Division<const BANDS: usize> {
    /// Specularly reflected.
    specular: [f64; BANDS],
    diffuse: [f64; BANDS],
    transmitted_diffuse: [f64; BANDS],
    /// Transmitted about the straight way.
    through: [f64; BANDS],
    coat: FresnelCoat,
    /// What is too weak to be drawn from where it is rough.
    below_threshold: BelowThreshold<BANDS>,
}

impl Sheet {
    /// Whether its specular parts are a mirror image and a clear view. With two roughnesses they never are.
    fn is_smooth(&self) -> bool {
        self.orientation.is_none() && self.roughness[0] <= SMOOTH_ROUGHNESS
    }

    /// Whether a shadow ray can go straight through.
    pub fn lets_through(&self) -> bool {
        self.is_smooth() && self.transmissivity * self.transmitted_specularity > 0.0
    }

    /// Whether every band is the same, as far as the material itself goes.
    pub fn is_grey(&self) -> bool {
        self.color.is_grey()
    }

    /// What the material makes of a ray: its BSDF there, and the perfectly specular rays.
    pub fn bsdf_at<'a, const BANDS: usize>(
        &self,
        context: &BsdfContext<'a, BANDS>,
        scratch: &mut Scratch,
    ) -> SurfaceScattering<'a, BANDS> {
        let outgoing = context.outgoing();
        let division =
            self.division(context.colored(bands(self.color)), outgoing.dot(context.normal), context.threshold);
        let (frame, roughness) = self.frame(context, scratch);
        let smooth = self.is_smooth();
        let straight = context.straight();
        let highlight = match self.orientation {
            _ if smooth || self.specularity <= 0.0 => Highlight::None,
            None => Highlight::Ward(WardIsotropic { specularity: division.specular, roughness: roughness[0] }),
            Some(_) => Highlight::WardAnisotropic(WardAnisotropic { specularity: division.specular, roughness }),
        };
        let lobe = (!smooth && self.transmitted_specularity > 0.0).then(|| {
            let shape = GaussianTransmission { transmittance: division.through, roughness };
            TransmissionLobe::new(shape, frame, straight, outgoing)
        });
        let transmission = Transmission::new(context.normal, division.transmitted_diffuse, lobe);
        let point = Bsdf {
            diffuse: division.diffuse,
            coat: division.coat,
            highlight,
            below_threshold: division.below_threshold,
            ..Bsdf::new(outgoing, context.interaction.normal, frame)
        };
        let (mirror, straight) = match smooth {
            true => {
                let has_mirror = self.specularity > 0.0;
                let mirror =
                    has_mirror.then(|| SpecularBounce::new(point.mirror_direction(), division.specular)).flatten();
                (mirror, SpecularBounce::new(straight, division.through))
            }
            false => (None, None),
        };
        SurfaceScattering { point: point.with_transmission(transmission), mirror, straight }
    }

    fn division<const BANDS: usize>(&self, color: [f64; BANDS], cosine: f64, threshold: f64) -> Division<BANDS> {
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
        Division {
            specular,
            diffuse: share(diffuse),
            transmitted_diffuse: share(transmitted_diffuse),
            through: share(through),
            coat: if coated { FresnelCoat::Coat } else { FresnelCoat::None },
            below_threshold,
        }
    }

    /// Without a usable orientation the two roughnesses become one (Radiance's root mean square).
    fn frame<const BANDS: usize>(&self, context: &BsdfContext<'_, BANDS>, scratch: &mut Scratch) -> (Frame, [f64; 2]) {
        let Some(orientation) = &self.orientation else { return (Frame::new(context.normal), self.roughness) };
        match context.oriented(orientation, scratch) {
            Some(frame) => (frame, self.roughness),
            None => (Frame::new(context.normal), [round_roughness(self.roughness); 2]),
        }
    }
}

/// One roughness for two, where nothing says which is which.
pub(crate) fn round_roughness([u, v]: [f64; 2]) -> f64 {
    (0.5 * (u * u + v * v)).sqrt()
}
