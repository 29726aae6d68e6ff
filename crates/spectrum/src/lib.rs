//! Spectra in equal bands of wavelength, and their colours.
//!
//! A [`Sampling`] defines the bands of a rendering: red, green and blue, or up to 24 equal bands. A
//! [`Conversion`] converts spectra of another sampling to it.
//!
//! Guarantees: the values equal Radiance's to the precision of its observer table. The crate knows
//! nothing of scenes, rays and files.
//!
//! ```
//! use radsight_spectrum::{Conversion, Sampling};
//!
//! let green = Conversion::new(&Sampling::RGB, 4, [380.0, 780.0]);
//! let mut rgb = [0.0; 3];
//! green.apply([0.0, 1.0, 0.0, 0.0], &mut rgb);
//! assert!(rgb[1] > rgb[0] && rgb[1] > rgb[2]);
//! ```
#![forbid(unsafe_code)]

mod conversion;
mod observer;
mod response;
mod rgb;
mod sampling;

pub use conversion::Conversion;
pub use response::Response;
pub use rgb::{MELANOPIC_OF_RGB, SCOTOPIC_OF_RGB, xyz_of_bands, xyz_of_whole_bands, xyz_to_rgb};
pub use sampling::Sampling;
