//! The adaptive sampler of pictures, captures and derivatives.
//!
//! It keeps the samples of each pixel ([`PixelSamples`]), doubles them where that lowers the error
//! of the picture most ([`doublings`], [`choose`]), and ends when the error is at most a
//! [`NoiseTarget`], or says what stopped it ([`Stop`]). A [`PixelSource`] traces the rays and says
//! what they add up to. How the error follows from the samples is left to the caller, since it
//! differs: a capture has one error over the whole exposure, a picture one in each band, and a
//! derivative has independent randomisations.
//!
//! Guarantees: the result is a function of the source and of the target; threads and pauses do not
//! matter. Knows neither rays nor cameras.
//!
//! ```
//! use radsight_adaptive::{ErrorEstimate, NoiseTarget, PixelError, PixelSource, SamplingState, Selection};
//! use std::ops::Range;
//!
//! /// Pixel number p has the mean 1 and samples that differ from it by up to p.
//! struct Noise;
//! impl PixelSource for Noise {
//!     type Sums = [f64; 3];
//!     type Worker = ();
//!     fn worker(&self) {}
//!     fn sums(&self, (): &mut (), pixel: usize, samples: Range<u32>) -> [f64; 3] {
//!         let u = |sample: u32| (f64::from(sample) * 0.618_033_988_7).fract();
//!         [samples.map(|sample| 1.0 + pixel as f64 * (2.0 * u(sample) - 1.0)).sum(); 3]
//!     }
//! }
//!
//! struct Estimate(Vec<PixelError>);
//! impl ErrorEstimate for Estimate {
//!     fn pixels(&self) -> &[PixelError] {
//!         &self.0
//!     }
//! }
//!
//! let mut state = SamplingState::new(3);
//! radsight_adaptive::begin(&Noise, &mut state);
//! let target = NoiseTarget::new(1e-4, Selection::Every);
//! let (_, stop) = radsight_adaptive::refine(&Noise, &mut state, &target, |pixels| {
//!     let error = |pixel: &radsight_adaptive::PixelSamples<[f64; 3]>| PixelError {
//!         squared: f64::from(pixel.last[0]).powi(2),
//!         gain: 0.5,
//!         samples: pixel.samples,
//!     };
//!     Estimate(pixels.iter().map(error).collect())
//! });
//! assert_eq!(stop, None);
//! assert!(state.pixels[0].samples == 4 && state.pixels[2].samples > 16);
//! ```
#![forbid(unsafe_code)]

mod allocation;
mod counter;
mod pixel_samples;
mod refine;
mod replicas;
mod target;

pub use allocation::{PixelError, doublings};
pub use counter::SampleCounter;
pub use pixel_samples::{FIRST_SAMPLES, MAX_SAMPLES, PixelSamples, SampleSums, pixel_of_ray, ray_number};
pub use refine::{ErrorEstimate, PixelSource, SamplingState, begin, double, refine};
pub use replicas::{Replicas, ReplicatedSource};
pub use target::{Certainty, ErrorTarget, NoiseTarget, Selection, SquaredErrors, Stop, choose, selection_threshold};
