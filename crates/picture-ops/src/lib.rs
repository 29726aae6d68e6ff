//! The algorithms of Radiance's picture programs: filtering, combining, composing, tone mapping.
//!
//! - [`filter`] is `pfilt`: exposure, size, star patterns.
//! - [`combine`] is `pcomb`: pictures combined by functions of their pixels.
//! - [`compose`] is `pcompos`: pictures side by side and on top of each other; [`sign`] is `psign`,
//!   text as a picture.
//! - [`condition`](mod@condition) is `pcond`: tone mapping that reproduces what an observer would
//!   see.
//! - [`falsecolor`](mod@falsecolor) is `falsecolor`: brightness as colour, contours and bands.
//! - [`interpolate`] is `pinterp`: views synthesised from other views and their distances.
//! - [`extrema`](mod@extrema) is `pextrem`; [`turn`] is `pflip` and `protate`.
//! - [`tone_map`](mod@tone_map) is `ra_bmp -e`: tone mapping for a display, without glare and
//!   acuity.
//! - [`values`] is `pvalue`: pixels as numbers, and back.
//!
//! Guarantees: the output equals that of Radiance's programs byte for byte where theirs is defined.
//! Processing is by scanline where the algorithm allows, so that memory does not grow with the
//! height of a picture. The number of threads does not change the result. The crate opens and
//! prints nothing: the caller provides readers and writers.
//!
//! ```
//! use radsight_picture::{Header, Image, Picture, PictureReader};
//! use radsight_picture_ops::filter::{FilterOptions, filter_one_pass};
//! let four = Image::new(2, 2, 1, vec![1.0f32, 2.0, 3.0, 4.0]).unwrap();
//! let bytes = Picture::from_rgb(Header::new("RADIANCE"), &four).unwrap().to_bytes();
//! let mut halved = Vec::new();
//! let mut options = FilterOptions::default();
//! options.columns = radsight_picture_ops::filter::Size::Scale(0.5);
//! options.rows = options.columns;
//! filter_one_pass(PictureReader::new(&bytes[..]).unwrap(), &options, &["pfilt"], &mut halved).unwrap();
//! let picture = Picture::read(&halved).unwrap();
//! assert_eq!((picture.width(), picture.values().pixel(0, 0)[0]), (1, 2.5078125));
//! ```
#![forbid(unsafe_code)]

pub mod brightness;
pub mod combine;
pub mod compose;
pub mod condition;
mod cumulative;
mod drand48;
mod error;
pub mod extrema;
pub mod falsecolor;
pub mod filter;
pub mod gamma;
pub mod gamut;
pub mod interpolate;
pub mod sign;
pub mod tone_map;
pub mod turn;
pub mod values;

pub use error::ToolError;
