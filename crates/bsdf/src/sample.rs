//! Results of evaluating and sampling a BSDF.

use glam::DVec3;
use radsight_brdf::Density;

/// Products `f·|cos θ_i|` and densities of both components for one incident direction.
#[derive(Clone, Copy, Debug)]
pub struct BsdfValue<const BANDS: usize> {
    /// Value of the diffuse component by band, 1/sr.
    pub diffuse: [f64; BANDS],
    /// Density with which [`crate::Bsdf::sample_diffuse`] samples the direction, 1/sr.
    pub diffuse_pdf: f64,
    /// Value of the highlight by band, 1/sr.
    pub highlight: [f64; BANDS],
    /// Density with which [`crate::Bsdf::sample_highlight`] samples the direction, 1/sr.
    pub highlight_pdf: f64,
}

/// Whether evaluation needs densities besides values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PdfRequest {
    /// Compute the densities.
    Wanted,
    /// Leave the densities out; they may hold anything.
    Unused,
}

/// A sampled direction with its weight.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample<const BANDS: usize> {
    /// Unit, in the scene.
    pub direction: DVec3,
    /// `f·|cos θ_i|/pdf`, by band.
    pub weight: [f64; BANDS],
    /// Density with which the direction was sampled.
    pub pdf: Density,
    /// Pdf ratio: density of the direction over the density of the lobe alone. It divides the
    /// weight, but not the importance that Russian roulette uses.
    pub pdf_ratio: f64,
}

impl<const BANDS: usize> BsdfSample<BANDS> {
    /// One of `draws` samples that share an estimate: weights are divided by the number, densities
    /// multiplied. A sample taken with a probability below one is that fraction of a sample.
    pub fn split(self, draws: f64) -> Self {
        let pdf = match self.pdf {
            Density::Continuous(pdf) => Density::Continuous(pdf * draws),
            Density::Delta => Density::Delta,
        };
        BsdfSample { weight: self.weight.map(|band| band / draws), pdf, ..self }
    }

    /// One of several branches that count as one sample in multiple importance sampling with light
    /// sampling.
    pub fn branch(self, branches: f64) -> Self {
        BsdfSample { weight: self.weight.map(|band| band / branches), ..self }
    }
}

impl<const BANDS: usize> BsdfValue<BANDS> {
    /// No scattering and no density.
    pub const NONE: Self =
        BsdfValue { diffuse: [0.0; BANDS], diffuse_pdf: 0.0, highlight: [0.0; BANDS], highlight_pdf: 0.0 };

    /// Sets the highlight from a lobe's value (without cosine) and density.
    #[inline]
    pub(crate) fn set_highlight(&mut self, specularity: &[f64; BANDS], (shape, pdf): (f64, f64), cosine: f64) {
        self.highlight_pdf = pdf;
        self.highlight = specularity.map(|band| band * shape * cosine);
    }
}
