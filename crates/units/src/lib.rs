//! Constants of photometry and colour as in Radiance, and the number format of its files.
//!
//! - [`photometry`]: luminous efficacies.
//! - [`color`]: Radiance's primaries, and the matrices from and to CIE tristimulus values.
//! - [`number`]: numbers as C's `atof` reads them and `printf` writes them, which define Radiance's
//!   files.
//!
//! Guarantees: no input makes a function panic. The crate depends on no other crate of radsight.
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
