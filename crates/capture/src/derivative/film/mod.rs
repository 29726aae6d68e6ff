//! Derivatives of a capture whose pixels share rays.
//!
//! Behind a finite pinhole that sees all surfaces at nearly one depth, the exposure of a pixel B is
//!
//! E_B(θ) = ∫ L(q, θ) K_B(q) dq
//!
//! with the radiance L that leaves the scene's point at q on the film of a point pinhole (see
//! [`crate::film`]), and the fraction K_B of the pinhole that sees it from the pixel. All pixels share
//! the samples of q. Where they see a moving part they move with it, at a velocity V(q) that falls to 0
//! beside it. K_B is continuous and 0 at its end, so no boundary terms remain:
//!
//! dE_B/dθ = d/dh ∫ L(q + hV, θ + h) K_B(q + hV) det(1 + h∇V) dq.
//!
//! Samples are drawn in passes. Each is an estimate of its own, and learns where the next one puts its
//! samples ([`Strata`]): the radiance of a strip along a wall that is a hundredth of a pixel wide may
//! change a thousand times as much as that of all other places. Passes weigh by their numbers of
//! samples, never by what they find.

mod kernel;
mod passes;
mod strata;
mod velocity;

use super::derivative_picture::Derivative;
use super::{Motion, ParameterStep};
use crate::Progress;
use crate::film::UnblurredFilm;
use kernel::PixelKernel;
use passes::Passes;
use velocity::FilmVelocity;

/// The derivative, until it has its error; `None` where pixels do not share rays, and if the work was
/// stopped.
pub(super) fn derivative(step: &ParameterStep<'_>, error: f64, progress: &dyn Progress) -> Option<Derivative> {
    let exposers = [&step.center, &step.below, &step.above];
    // A camera that moves changes all pixels: samples that they share would have more noise than rays of
    // their own.
    if *step.motion == Motion::Camera {
        return None;
    }
    if exposers.iter().any(|side| side.weights.has_mosaic() || !side.by_row.is_empty()) {
        return None;
    }
    let film = UnblurredFilm::new(&step.center)?;
    let velocity = FilmVelocity::new(step, &film, progress);
    let kernel = PixelKernel::new(film.shift());
    Passes { step, film: &film, velocity: &velocity, kernel: &kernel, progress, traced: 0 }.until_error(error)
}
