//! Renders the picture of a view: the computation of `rpict`, and the rays of `vwrays`.
//!
//! A [`ViewCamera`] maps points of pixels to rays, with Radiance's pixel jitter, aperture and
//! motion. A [`Film`] traces as many of them as each pixel needs and returns rows of pixels, top
//! row first.
//!
//! Guarantees: with a fixed number of samples a pixel is the mean of rays over its area, unbiased
//! except for cached irradiance. With a requested error the bias is corrected as far as the error
//! requires. Only [`SamplingBudget::Interpolated`] interpolates. A pixel is a function of the plan,
//! the camera, the budget and the seed, so neither threads nor a resumed interruption change it,
//! unless the time is limited. Knows neither files nor picture headers.
#![forbid(unsafe_code)]

mod adaptive;
mod drawn_lights;
mod glint_lights;
mod glints;
mod grid;
mod interpolated;
mod light_strata;
mod noise;
mod noise_filter;
mod part;
mod pixel_sample;
mod projection;
mod residual;
mod section;
mod single;
mod smoothness;
mod spare_rays;
mod view_camera;

pub use adaptive::{Film, SamplingBudget, TimeLeft};
pub use interpolated::Interpolation;
pub use noise::{Estimate, FilmState, PixelNoise, RemainingNoise};
pub use part::{SampledPixel, sampled_tile};
pub use radsight_adaptive::{ErrorTarget, MAX_SAMPLES, Stop};
pub use single::average;
pub use view_camera::{CameraRay, ViewCamera};
