//! Renders the picture of a view: what `rpict` computes, and the rays that `vwrays` sends.
//!
//! A [`ViewCamera`] turns places in pixels into rays, with Radiance's pixel jitter, aperture and motion. A [`Film`] traces as many of
//! them as each pixel needs and gives rows of pixels, top row first.
//!
//! Guarantees: with a number of samples a pixel is the mean of rays over its area, without bias but for that of cached irradiance; with
//! an asked error that is corrected as far as the error needs. Only [`SamplingBudget::Interpolated`] interpolates. A pixel
//! is a function of the plan, the camera, the budget and the seed, so neither threads nor an interruption that is resumed at a row
//! change it, unless the time is limited. Knows neither files nor picture headers.
#![forbid(unsafe_code)]

mod adaptive;
mod interpolated;
mod part;
mod residual;
mod sequence;
mod single;
mod view_camera;

pub use adaptive::{Estimate, Film, SamplingBudget, Stop, TimeLeft};
pub use interpolated::Interpolation;
pub use part::{SampledPixel, sampled_tile};
pub use sequence::MAX_SAMPLES;
pub use single::average;
pub use view_camera::{CameraRay, ViewCamera};
