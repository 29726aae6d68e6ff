//! What evaluating and sampling a BSDF give.

use glam::DVec3;
use radsight_brdf::Density;

/// Products `f·|cos θ_i|` and densities of the two components for one incident direction.
#[derive(Clone, Copy, Debug)]
pub struct BsdfValue<const BANDS: usize> {
    /// Of the diffuse component, by band, 1/sr.
    pub diffuse: [f64; BANDS],
    /// Density with which [`crate::Bsdf::sample_diffuse`] draws the direction, 1/sr.
    pub diffuse_pdf: f64,
    /// Of the highlight, by band, 1/sr.
    pub highlight: [f64; BANDS],
    /// Density with which [`crate::Bsdf::sample_highlight`] draws the direction, 1/sr.
    pub highlight_pdf: f64,
}

/// Whether densities of drawing are needed beside the values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PdfRequest {
    /// They are.
    Wanted,
    /// They are not, and may be anything.
    Unused,
}

/// A drawn direction with its weight `f·|cos θ_i|/pdf`.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample<const BANDS: usize> {
    /// Unit, in the scene.
    pub direction: DVec3,
    /// `f·|cos θ_i|/pdf`, by band.
    pub weight: [f64; BANDS],
    /// Density with which the direction is drawn.
    pub pdf: Density,
    /// How many times as often it is drawn as by the lobe alone, which makes it weigh less and not matter less.
    pub pdf_ratio: f64,
}

impl<const BANDS: usize> BsdfSample<BANDS> {
    /// One of several draws that share the work: each weighs less, and there is more density of them. A draw that is made with some
    /// chance only is that fraction of one.
    pub fn split(self, draws: f64) -> Self {
        let pdf = match self.pdf {
            Density::Continuous(pdf) => Density::Continuous(pdf * draws),
            Density::Delta => Density::Delta,
        };
        BsdfSample { weight: self.weight.map(|band| band / draws), pdf, ..self }
    }

    /// One of several branches, which count as one where they share the work with light sampling.
    pub fn branch(self, branches: f64) -> Self {
        BsdfSample { weight: self.weight.map(|band| band / branches), ..self }
    }
}

impl<const BANDS: usize> BsdfValue<BANDS> {
    /// Nothing is scattered, nothing is drawn.
    pub const NONE: Self =
        BsdfValue { diffuse: [0.0; BANDS], diffuse_pdf: 0.0, highlight: [0.0; BANDS], highlight_pdf: 0.0 };

    /// Sets the highlight from a lobe's value without cosine and density.
    #[inline]
    pub(crate) fn set_highlight(&mut self, specularity: &[f64; BANDS], (shape, pdf): (f64, f64), cosine: f64) {
        self.highlight_pdf = pdf;
        self.highlight = specularity.map(|band| band * shape * cosine);
    }
}
