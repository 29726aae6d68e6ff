//! Matrices of light, as in the daylight coefficient method: the operations of `rmtxop`, `rcomb`
//! and `dctimestep`.
//!
//! A [`Matrix`] has rows and columns of elements with one or more components: red, green and blue,
//! or spectral bands. Rows may be sensors or pixels, columns directions of a sky, or time steps. A
//! matrix is read from any of Radiance's pictures and float matrices, with exposures undone, and
//! from BSDF files, whose values are multiplied by the projected solid angle of the incident patch.
//!
//! Guarantees: values have single precision, as in Radiance, and sums double precision; no input
//! makes a function panic; a result does not depend on the number of threads. The crate knows no
//! files.
//!
//! ```
//! use radsight_matrix::Matrix;
//! let coefficients = Matrix::read(b"#?RADIANCE\nNROWS=1\nNCOLS=2\nNCOMP=1\nFORMAT=ascii\n\n2 3\n").unwrap();
//! let sky = Matrix::read(b"#?RADIANCE\nNROWS=2\nNCOLS=1\nNCOMP=1\nFORMAT=ascii\n\n10\n1\n").unwrap();
//! assert_eq!(coefficients.times(&sky).unwrap().values(), [23.0]);
//! ```
#![forbid(unsafe_code)]

mod bsdf;
mod chain;
mod combine;
mod components;
mod elements;
mod error;
mod matrix;
mod product;
mod tile;

pub use bsdf::{Wanted, bsdf_matrix};
pub use chain::product_of_chain;
pub use combine::Combination;
pub use components::Transform;
pub use error::MatrixError;
pub use matrix::{Matrix, Stored};
