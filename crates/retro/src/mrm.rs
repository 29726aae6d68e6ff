//! `mrm`: the minimal retroreflective microfacet model.
//!
//! Portsmouth, Raab, Belcour and Liu, "The Minimal Retroreflective Microfacet Model", JCGT 15(1),
//! 2026; the model of glTF's `KHR_materials_retroreflection` and of OpenPBR's
//! `specular_retroreflectivity`. A microfacet BRDF is evaluated with the outgoing direction
//! mirrored about the normal ("back vector"), so that its peak is in the retroreflection direction:
//!
//! `f(o, i) = (1 − r) · f_GGX(o, i) + r · f_GGX(o', i)`, `o' = (−o_x, −o_y, o_z)`
//!
//! | parameter | meaning | unit | range |
//! |---|---|---|---|
//! | F₀ | reflectance of a facet at normal incidence (Schlick) | 1 | 0…1 |
//! | α | roughness of the GGX distribution | 1 | 0.0005…1 |
//! | r | fraction of the facets that retroreflect | 1 | 0…1 |
//!
//! Reciprocal, since the distribution is symmetric; conserves energy.

use crate::fresnel::fresnel_schlick;
use crate::ggx::Ggx;
use glam::DVec3;

/// Both lobes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mrm {
    pub(crate) normal_reflectance: f64,
    pub(crate) roughness: f64,
    pub(crate) retro_share: f64,
}

fn mirrored(direction: DVec3) -> DVec3 {
    DVec3::new(-direction.x, -direction.y, direction.z)
}

impl Mrm {
    /// f and the density of [`Mrm::sample`], both in 1/sr.
    pub(crate) fn value_and_pdf(&self, outgoing: DVec3, incident: DVec3) -> (f64, f64) {
        let facets = Ggx { roughness: self.roughness };
        let mut sum = (0.0, 0.0);
        for (share, seen_from) in [(self.retro_share, mirrored(outgoing)), (1.0 - self.retro_share, outgoing)] {
            if share > 0.0 {
                let lobe = facets.reflect(seen_from, incident);
                sum.0 += share * lobe.value * fresnel_schlick(lobe.cosine, self.normal_reflectance);
                sum.1 += share * lobe.pdf;
            }
        }
        sum
    }

    /// Samples an incident direction; `choice` is uniform in [0, 1).
    pub(crate) fn sample(&self, outgoing: DVec3, u: [f64; 2], choice: f64) -> DVec3 {
        let seen_from = if choice < self.retro_share { mirrored(outgoing) } else { outgoing };
        Ggx { roughness: self.roughness }.sample(seen_from, u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_retro_peak_is_as_high_as_the_mirror_peak() {
        let retro = Mrm { normal_reflectance: 0.5, roughness: 0.1, retro_share: 1.0 };
        let mirror = Mrm { retro_share: 0.0, ..retro };
        let outgoing = DVec3::new(0.5, 0.2, 0.8).normalize();
        let (peak, _) = retro.value_and_pdf(outgoing, outgoing);
        assert_eq!(peak, mirror.value_and_pdf(outgoing, mirrored(outgoing)).0);
        assert!(peak > 10.0 * retro.value_and_pdf(outgoing, mirrored(outgoing)).0);
    }
}
