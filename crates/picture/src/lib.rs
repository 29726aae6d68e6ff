//! Radiance pictures, float matrices, headers and views; portable float maps, NumPy arrays and PNG.
//!
//! Bytes go in and bytes come out. Guarantees: no input panics or takes memory beyond what its own bytes can justify;
//! row 0 of every [`Image`] is the top, whatever the file's order. Knows no scenes and does no input or output.
#![forbid(unsafe_code)]

mod color;
mod error;
#[cfg(feature = "exr")]
mod exr;
mod file_format;
mod header;
mod image;
mod matrix;
mod npy;
mod number;
mod pfm;
mod picture;
mod png;
mod resolution;
mod rgbe;
mod scanline;
#[cfg(feature = "tiff")]
mod tiff;
mod view;

pub use color::{RgbPrimaries, WHITE_EFFICACY, xyz_to_rgb};
pub use error::PictureError;
#[cfg(feature = "exr")]
pub use exr::{read_exr, write_exr};
pub use file_format::{FileFormat, ReadImage, read_image, write_image};
pub use header::{Assignment, Header};
pub use image::Image;
pub use matrix::{FloatMatrix, MatrixFormat, MatrixValues};
pub use npy::{read_npy, write_npy, write_npy_f64};
pub use pfm::{read_pfm, write_pfm};
pub use picture::{Encoding, PartialPicture, Picture};
pub use png::{Png, read_png, write_png_grey8, write_png_grey16, write_png_rgb8, write_png_rgb16};
pub use resolution::{Orientation, Resolution};
pub use rgbe::{decode_rgbe, encode_rgbe, mantissa_step};
#[cfg(feature = "tiff")]
pub use tiff::{read_tiff, write_tiff};
pub use view::{View, ViewError, ViewKind, ViewLocation, ViewOptions, ViewRay};
