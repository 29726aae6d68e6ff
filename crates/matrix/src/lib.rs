//! Matrices of light: what the daylight method multiplies, and `rmtxop`, `rcomb` and `dctimestep` compute.
//!
//! A [`Matrix`] has rows and columns of values with one or more components: red, green and blue, or bands of wavelength. Rows may be sensors or pixels,
//! columns directions of a sky, or time. It is read from any of Radiance's pictures and float matrices, with exposures undone, and from BSDF files, whose
//! values are multiplied by the projected solid angle of what comes in.
//!
//! Guarantees: values are kept in single precision, as Radiance keeps them, and sums are made in double precision; no input makes anything panic; a
//! result does not depend on the number of threads. Knows no files.
//!
//! ```
//! use radsight_matrix::Matrix;
//! let coefficients = Matrix::read(b"#?RADIANCE\nNROWS=1\nNCOLS=2\nNCOMP=1\nFORMAT=ascii\n\n2 3\n").unwrap();
//! let sky = Matrix::read(b"#?RADIANCE\nNROWS=2\nNCOLS=1\nNCOMP=1\nFORMAT=ascii\n\n10\n1\n").unwrap();
//! assert_eq!(coefficients.times(&sky).unwrap().values(), [23.0]);
//! ```
#![forbid(unsafe_code)]

mod bsdf;
mod combine;
mod components;
mod elements;
mod error;
mod matrix;
mod product;

pub use bsdf::{Wanted, bsdf_matrix};
pub use combine::Combination;
pub use components::Transform;
pub use error::MatrixError;
pub use matrix::{Matrix, Stored};
