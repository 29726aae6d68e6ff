//! `ashik2`: Ashikhmin and Shirley, "An Anisotropic Phong BRDF Model", Journal of Graphics Tools 5(2), 2000, as Radiance has it:
//! Lambert's diffuse component less Schlick's term at the incident angle, and a highlight that grows by it at the outgoing one.

use super::{BsdfContext, SurfaceScattering};
use crate::bsdf::{Bsdf, FresnelCoat, Highlight, schlick};
use crate::frame::Frame;
use crate::shader::{Function, bands};
use crate::specular_threshold::{BelowThreshold, LobeStrength};
use crate::transmission_lobe::luminance;
use radsight_brdf::AshikhminShirley;
use radsight_cal::Scratch;
use radsight_ir::Rgb;

/// The parameters.
#[derive(Clone, Debug)]
pub(crate) struct AshikhminKind {
    /// Where u points.
    pub(crate) orientation: Function,
    pub(crate) diffuse: Rgb,
    /// At normal incidence; patterns leave it alone.
    pub(crate) specular: Rgb,
    /// Along u and v.
    pub(crate) exponents: [f64; 2],
}

impl AshikhminKind {
    pub(super) fn is_grey(&self) -> bool {
        self.diffuse.is_grey() && self.specular.is_grey()
    }

    pub(super) fn bsdf_at<'a, const BANDS: usize>(
        &self,
        context: &BsdfContext<'a, BANDS>,
        scratch: &mut Scratch,
    ) -> SurfaceScattering<'a, BANDS> {
        let outgoing = context.outgoing();
        let fresnel = schlick(outgoing.dot(context.normal).max(0.001));
        let specular: [f64; BANDS] = bands(self.specular);
        let has_highlight = specular.iter().any(|band| *band > 0.0);
        let specularity = specular.map(|band| band + (1.0 - band) * fresnel);
        let (frame, exponents) = match context.oriented(&self.orientation, scratch) {
            Some(frame) => (frame, self.exponents),
            None => (Frame::new(context.normal), [round_exponent(self.exponents); 2]),
        };
        let highlight = match has_highlight {
            true => Highlight::Ashikhmin(AshikhminShirley { specularity, exponents }),
            false => Highlight::None,
        };
        // What is compared is the highlight at normal incidence.
        let diffuse = context.colored(bands(self.diffuse));
        let candidate = LobeStrength { share: luminance(&specular), color: specularity, diffuse: luminance(&diffuse) };
        let point = Bsdf {
            diffuse,
            below_threshold: BelowThreshold::new(context.threshold, [candidate, LobeStrength::NONE]),
            coat: FresnelCoat::Schlick,
            highlight,
            ..Bsdf::new(outgoing, context.interaction.normal, frame)
        };
        SurfaceScattering { point, mirror: None, straight: None }
    }
}

/// One exponent for two, where nothing says which is which: the harmonic mean.
fn round_exponent([u, v]: [f64; 2]) -> f64 {
    2.0 / (1.0 / (u + 1e-5) + 1.0 / (v + 1e-5))
}
