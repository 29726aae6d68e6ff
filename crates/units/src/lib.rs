//! What numbers mean: constants of photometry and colour as Radiance has them, and the form of numbers in its files.
//!
//! - [`photometry`]: lumens a watt.
//! - [`color`]: Radiance's primaries, and the matrices from and to CIE tristimulus values.
//! - [`number`]: numbers as C's `atof` reads them and `printf` writes them, since Radiance's files are defined by both.
//!
//! Guarantees: no input makes a function here panic. Knows no other crate of radsight.
//!
//! ```
//! use radsight_units::{number, photometry};
//! let luminance = 2.0 * photometry::WHITE_EFFICACY; // cd/m² of 2 W/(sr·m²)
//! assert_eq!(number::general(luminance, 6), "358");
//! ```
#![forbid(unsafe_code)]

pub mod color;
pub mod number;
pub mod photometry;
