//! Radiance pictures, float matrices, headers and views; also float maps, NumPy arrays, PNG, TIFF
//! and EXR.
//!
//! Stages of radsight exchange one of these files, or its [`Image`] in memory.
//!
//! - A [`Picture`] is RGBE, XYZE or spectral, in any orientation and coding; [`Picture::radiance`]
//!   undoes exposures.
//! - A [`PictureReader`] and a [`PictureWriter`] process one scanline at a time, for pictures of
//!   any size.
//! - A [`FloatMatrix`] is lossless, as are `pfm`, `npy`, `tif` and `exr`; [`read_image`] reads all
//!   formats.
//! - A [`Header`] carries the history: a program copies it ([`Header::history`]) and adds its own
//!   command line.
//! - [`ViewOptions`] is a view as typed; a [`View`] generates its rays.
//!
//! Guarantees: no input makes a reader panic or allocate more memory than the input's length
//! justifies. Row 0 of every [`Image`] is the top, whatever the order in the file. Written pictures
//! equal those of Radiance byte for byte. The crate converts bytes, opens no files and knows no
//! scenes.
//!
//! ```
//! use radsight_picture::{FloatMatrix, Header, Image, MatrixFormat, read_image};
//! let mut header = Header::new("RADIANCE");
//! header.push_command(["radsight", "pinhole", "average", "my camera.toml"]);
//! let exposure = Image::new(2, 1, 1, vec![1.25e-3f32, 0.0]).unwrap();
//! let bytes = FloatMatrix::write_f32(&header, &exposure, MatrixFormat::Float);
//!
//! let read = read_image(&bytes).unwrap();
//! assert_eq!(read.image, exposure);
//! let mut history = read.header.unwrap().history();
//! history.push_command(["radsight", "sensor", "my camera.toml"]);
//! assert_eq!(
//!     history.to_text(),
//!     "#?RADIANCE\nradsight pinhole average \"my camera.toml\"\nradsight sensor \"my camera.toml\""
//! );
//! ```
#![forbid(unsafe_code)]

mod color;
mod error;
#[cfg(feature = "exr")]
mod exr;
mod file_format;
mod foreign_format;
mod header;
mod image;
#[cfg(feature = "tiff")]
mod log_luv;
mod matrix;
mod npy;
mod pfm;
mod picture;
mod png;
mod resolution;
mod rgbe;
mod scanline;
mod stream;
#[cfg(feature = "tiff")]
mod tiff;
#[cfg(feature = "tiff")]
mod tiff_pixels;
#[cfg(feature = "tiff")]
mod tiff_tags;
mod unfinished;
mod view;

pub use color::{RgbPrimaries, xyz_to_rgb};
pub use error::PictureError;
#[cfg(feature = "exr")]
pub use exr::{read_exr, write_exr};
pub use file_format::{FileFormat, ReadImage, read_image, write_image};
pub use foreign_format::ForeignFormat;
pub use header::{Assignment, Header};
pub use image::Image;
pub use matrix::{FloatMatrix, MatrixFormat, MatrixValues};
pub use npy::{read_npy, write_npy, write_npy_f64};
pub use pfm::{read_pfm, write_pfm};
pub use picture::{Encoding, PartialPicture, Picture, mean_of_spectrum};
pub use png::{Png, read_png, write_png_grey8, write_png_grey16, write_png_rgb8, write_png_rgb16};
pub use radsight_units::number::{general, leading_number, put_scientific, scientific};
pub use radsight_units::photometry::WHITE_EFFICACY;
pub use resolution::{Orientation, Resolution};
pub use rgbe::{decode_rgbe, decode_spectrum, encode_rgbe, encode_spectrum, mantissa_step};
pub use scanline::write_rgbe_scanline;
pub use stream::{PictureReader, PictureWriter};
#[cfg(feature = "tiff")]
pub use tiff::{TiffCompression, read_tiff, read_tiff_pixels, write_tiff, write_tiff_pixels};
#[cfg(feature = "tiff")]
pub use tiff_pixels::{Tiff, TiffColors, TiffPixels, TiffTags};
pub use unfinished::Unfinished;
pub use view::{View, ViewError, ViewKind, ViewLocation, ViewOptions, ViewRay};
