//! Derivatives of the exposure with respect to a parameter of scene or camera.
//!
//! The exposure of a pixel is an integral over pixel and pinhole, E(θ) = ∫ g(u, θ) du. Where the
//! integrand is continuous, its derivative is the mean of central differences of the same rays
//! (common random numbers). At the outline of a part it jumps: few samples change sides between
//! θ − h and θ + h, and each of them weighs 1/2h. In pixels that see an outline the samples
//! therefore move with it, at a velocity V(u) (a [`flow::Flow`]). By the transport theorem
//!
//! dE/dθ = ∫ (Dg/Dθ + g·div V) du − ∮ g·V·n ds,
//!
//! where Dg/Dθ is the derivative along the moving samples, and the last integral is over the sides of
//! the pixel and the rim of the pinhole (Bangaru, Li, Durand: "Unbiased warped-area sampling for
//! differentiable rendering", ACM Trans. Graph. 39(6), 2020). Any V gives the same expected value, to
//! second order in h; the closer it follows the outline, the less noise. Of the velocities that do so
//! in the four dimensions of pixel and pinhole ([`place::Place`]), V is the least: it moves the
//! samples on the pixel where the outline is sharp, and on the pinhole where it is blurred over many
//! pixels.
//!
//! Pixels behind a finite pinhole share the samples of a film, which then need no boundary terms
//! ([`film`]).
//!
//! Independent randomisations of the sample sequence give the standard error. The error of the finite
//! step follows from steps of h and 2h: a central difference errs by c·h², a third of their
//! difference.

mod derivative_picture;
mod film;
mod flow;
mod outline;
mod pixel_derivative;
mod place;
mod ray_index;
mod refine;

pub use derivative_picture::Derivative;
pub use outline::{Motion, PartMotion};

use crate::{Exposer, Progress};

/// A scene and camera on both sides of a parameter's value.
#[derive(Clone, Copy, Debug)]
pub struct ParameterStep<'a> {
    /// At the parameter's value.
    pub center: Exposer<'a>,
    /// One step below it.
    pub below: Exposer<'a>,
    /// One step above it.
    pub above: Exposer<'a>,
    /// Two steps below and above it; `None` if the exposure is linear in the parameter.
    pub far: Option<[Exposer<'a>; 2]>,
    /// The step, in the parameter's unit.
    pub step: f64,
    /// How the parameter moves the scene before the camera.
    pub motion: &'a Motion,
    /// Derivatives with different streams use independent samples. Below 2²⁰.
    pub stream: u32,
}

/// How far derivatives are computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DerivativeSamples {
    /// Until the rms of the standard errors is this fraction of the rms of the derivative, over the
    /// picture.
    ToError(f64),
    /// This number of samples of each term of a pixel, a multiple of [`RANDOMISATIONS`] times a power
    /// of two, at most 2¹⁷.
    PerPixel(u32),
}

/// Number of independent randomisations of the samples of each pixel.
pub const RANDOMISATIONS: u32 = 8;

impl<'a> ParameterStep<'a> {
    /// The same with twice the step.
    fn doubled(&self) -> Option<ParameterStep<'a>> {
        let [below, above] = self.far?;
        Some(ParameterStep { below, above, step: 2.0 * self.step, ..*self })
    }

    /// The derivative of the exposure of each pixel. Cameras with a diffraction pattern have none:
    /// `None`; nor is there one if the work was stopped.
    #[must_use]
    pub fn derivative(&self, samples: DerivativeSamples, progress: &dyn Progress) -> Option<Derivative> {
        if !self.center.rays.hole().has_points() {
            return None;
        }
        if let DerivativeSamples::ToError(error) = samples {
            let known = refine::zero_without_change(self, progress).or_else(|| film::derivative(self, error, progress));
            if known.is_some() || progress.stops() {
                return known;
            }
        }
        refine::derivative(self, samples, progress)
    }
}
