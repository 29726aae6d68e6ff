//! The interface of reflectance models, the built-in models, and the statistical checks that every
//! model must pass.
//!
//! Conventions: a BRDF `f` is in 1/sr and does **not** include the cosine. A density is per solid
//! angle (1/sr). Both directions are unit vectors that point away from the surface, in a local
//! frame with +z on the shading normal. A direction with z < 0 is on the other side of the surface
//! (transmission).
//!
//! Guarantees: models are pure functions, safe to call from any thread. The crate knows neither
//! scenes nor shared libraries.
//!
//! ```
//! use radsight_brdf::{Brdf, Lambert};
//! use glam::DVec3;
//! let white = Lambert { reflectance: [1.0] };
//! let (mut value, mut density) = ([0.0], [0.0]);
//! white.eval_pdf(DVec3::Z, &[DVec3::Z], &mut value, &mut density);
//! assert_eq!(value[0], std::f64::consts::FRAC_1_PI);
//! ```
#![forbid(unsafe_code)]

mod ashikhmin;
pub mod check;
mod gaussian_transmission;
mod lambert;
mod lobe;
mod minnaert;
pub mod native;
mod native_model;
mod ward;
mod ward_anisotropic;

pub use ashikhmin::AshikhminShirley;
pub use gaussian_transmission::GaussianTransmission;
pub use lambert::Lambert;
pub use ward::WardIsotropic;
pub use ward_anisotropic::WardAnisotropic;

use glam::DVec3;

/// Kinds of scattering of a model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lobes {
    /// Smooth functions of direction, such as Lambert's.
    pub diffuse: bool,
    /// Lobes of finite width.
    pub glossy: bool,
    /// Perfectly specular reflection or refraction, which only `sample` can find.
    pub delta: bool,
    /// Transmission through the surface.
    pub transmission: bool,
}

/// A direction sampled by [`Brdf::sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrdfSample {
    /// Direction towards the light: unit, local frame, away from the surface.
    pub incident: DVec3,
    /// Density of the sample.
    pub density: Density,
}

/// Probability density of a sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// Density by solid angle, 1/sr, over all lobes that `eval_pdf` covers.
    Continuous(f64),
    /// A perfectly specular direction; `eval_pdf` is zero there.
    Delta,
}

/// A reflectance model at one point of a surface.
pub trait Brdf: Send + Sync + std::fmt::Debug {
    /// Kinds of scattering of the model.
    fn lobes(&self) -> Lobes;

    /// BRDF values (1/sr, without the cosine) and sampling densities (1/sr) for one outgoing
    /// direction and a batch of incident ones.
    ///
    /// `values` holds all bands of the first direction, then those of the second, and so on: its
    /// length is the number of directions times the number of bands. `pdfs` has one entry per
    /// direction. Delta lobes contribute to neither.
    fn eval_pdf(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]);

    /// Samples an incident direction. `weights` becomes `f·|cos θ_i|/pdf` in each band, summed over
    /// the lobes of that direction; for a delta lobe, its reflectance over the probability of
    /// choosing it.
    ///
    /// `u` is uniform in [0,1)³: the first two numbers choose the direction, the third the lobe.
    /// `None` means absorption.
    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Option<BrdfSample>;

    /// A mistake of the model in one of the calls so far, which makes a picture invalid. Default
    /// none.
    fn fault(&self) -> Option<String> {
        None
    }
}
