//! `ashik2`: Ashikhmin and Shirley, "An Anisotropic Phong BRDF Model", Journal of Graphics Tools
//! 5(2), 2000, as Radiance implements it.
//!
//! Lambert's diffuse component loses Schlick's term at the incident angle; the highlight gains it
//! at the outgoing angle.

use crate::bsdf::{Bsdf, FresnelCoat, Highlight, schlick};
use crate::context::{BsdfContext, SurfaceScattering};
use crate::frame::Frame;
use crate::specular_threshold::{BelowThreshold, LobeStrength};
use radsight_brdf::AshikhminShirley;
use radsight_cal::Scratch;
use radsight_ir::Rgb;
use radsight_texture::{Function, bands, luminance};

/// Parameters of `ashik2`.
#[derive(Clone, Debug)]
pub struct AshikhminKind {
    /// Function that gives the direction of u.
    pub orientation: Function,
    /// Diffuse reflectance, by colour.
    pub diffuse: Rgb,
    /// Specular reflectance at normal incidence; patterns do not change it.
    pub specular: Rgb,
    /// Phong exponents along u and v.
    pub exponents: [f64; 2],
}

impl AshikhminKind {
    /// Whether the material's own parameters are the same in every band.
    pub fn is_grey(&self) -> bool {
        self.diffuse.is_grey() && self.specular.is_grey()
    }

    /// BSDF of the material at the intersection, and its perfectly specular rays.
    pub fn bsdf_at<'a, const BANDS: usize>(
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
            None => (Frame::new(context.normal), [isotropic_exponent(self.exponents); 2]),
        };
        let highlight = match has_highlight {
            true => Highlight::Ashikhmin(AshikhminShirley { specularity, exponents }),
            false => Highlight::None,
        };
        // `-st` compares the highlight at normal incidence.
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

/// Isotropic exponent for a surface without an orientation: the harmonic mean of both.
fn isotropic_exponent([u, v]: [f64; 2]) -> f64 {
    2.0 / (1.0 / (u + 1e-5) + 1.0 / (v + 1e-5))
}
