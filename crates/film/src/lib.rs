//! Renders the picture of a view: what `rpict` computes, and the rays that `vwrays` sends.
//!
//! A [`ViewCamera`] turns places in pixels into rays, with Radiance's pixel jitter, aperture and motion. A [`Film`] traces as many of
//! them as each pixel needs and gives rows of pixels, top row first.
//!
//! Guarantees: with an asked error or number of samples a pixel is the unbiased mean of rays over its area; only
//! [`SamplingBudget::Interpolated`] interpolates. A pixel is a function of the plan, the camera, the budget and the seed, so neither
//! threads nor an interruption that is resumed at a row change it. Knows neither files nor picture headers.
#![forbid(unsafe_code)]

mod adaptive;
mod interpolated;
mod residual;
mod single;
mod view_camera;

pub use adaptive::{Estimate, Film, MAX_SAMPLES, SamplingBudget, Stop, TimeLeft};
pub use interpolated::Interpolation;
pub use single::average;
pub use view_camera::{CameraRay, ViewCamera};
