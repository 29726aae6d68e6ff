//! TIFF pictures: 8 and 16 bits and single precision, grey and RGB; LogLuv can be read as well.
//!
//! The Radiance header is stored as the image description.

use crate::tiff_pixels::{Tiff, TiffPixels};
use crate::{Header, Image, PictureError, log_luv};
use std::io::Cursor;
use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::encoder::{Compression, TiffEncoder, TiffValue, colortype};
use tiff::tags::Tag;

/// Reads the first picture of a file: grey, RGB or RGBA in 8, 16 or 32-bit integers, which are
/// scaled to 0 to 1, or in half, single or double precision.
///
/// # Errors
/// When the bytes are not such a picture, or declare more pixels than they can hold.
pub fn read_tiff(bytes: &[u8]) -> Result<(Image<f32>, Option<Header>), PictureError> {
    let Tiff { width, height, components, pixels, header, .. } = read_tiff_pixels(bytes)?;
    let data = match pixels {
        TiffPixels::Bytes(values) => fractions(values, f64::from(u8::MAX)),
        TiffPixels::Words(values) => fractions(values, f64::from(u16::MAX)),
        TiffPixels::Floats(values) => values,
    };
    Ok((Image::new(width, height, components, data)?, header))
}

/// The compression of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TiffCompression {
    /// No compression.
    None,
    /// Lempel-Ziv-Welch.
    Lzw,
}

/// Number of characters of a date.
const LONGEST_DATE: usize = 19;

/// Reads the first picture of a file, in the variants that [`read_tiff`] supports.
///
/// # Errors
/// As [`read_tiff`].
pub fn read_tiff_pixels(bytes: &[u8]) -> Result<Tiff, PictureError> {
    if let Some(picture) = log_luv::read(bytes) {
        return picture;
    }
    // The largest compression ratio of Deflate and LZW; no valid file needs more memory.
    const LARGEST_RATIO: usize = 1400;
    let memory = bytes.len().saturating_mul(LARGEST_RATIO).saturating_add(1 << 16);
    let mut limits = Limits::default();
    limits.decoding_buffer_size = memory;
    limits.intermediate_buffer_size = memory;
    limits.ifd_value_size = bytes.len();
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(codec)?.with_limits(limits);
    let (width, height) = decoder.dimensions().map_err(codec)?;
    let color = decoder.colortype().map_err(codec)?;
    let components = match color {
        ColorType::Gray(_) => 1,
        ColorType::GrayA(_) => 2,
        ColorType::RGB(_) => 3,
        ColorType::RGBA(_) => 4,
        other => {
            let what = format!("{other:?} pixels");
            return Err(PictureError::Unsupported { format: "tiff", what, expected: "grey or RGB pixels" });
        }
    };
    let pixels = match decoder.read_image().map_err(codec)? {
        DecodingResult::U8(values) => TiffPixels::Bytes(values),
        DecodingResult::U16(values) => TiffPixels::Words(values),
        DecodingResult::U32(values) => TiffPixels::Floats(fractions(values, f64::from(u32::MAX))),
        DecodingResult::F16(values) => TiffPixels::Floats(values.into_iter().map(f32::from).collect()),
        DecodingResult::F32(values) => TiffPixels::Floats(values),
        DecodingResult::F64(values) => TiffPixels::Floats(values.into_iter().map(|value| value as f32).collect()),
        _ => {
            let what = "signed or 64-bit integers".to_owned();
            return Err(PictureError::Unsupported {
                format: "tiff",
                what,
                expected: "floats, or up to 32 unsigned bits",
            });
        }
    };
    let description = decoder.find_tag(Tag::ImageDescription).ok().flatten().and_then(|value| value.into_string().ok());
    let header = description.filter(|text| text.starts_with("#?")).map(|text| Header::read_text(text.as_bytes()));
    let date = decoder.find_tag(Tag::DateTime).ok().flatten().and_then(|value| value.into_string().ok());
    let date = date.map(|date| date.chars().take(LONGEST_DATE).collect());
    Ok(Tiff { width: width as usize, height: height as usize, components, pixels, header, date })
}

fn fractions<T: Into<f64>>(values: Vec<T>, largest: f64) -> Vec<f32> {
    values.into_iter().map(|value| (value.into() / largest) as f32).collect()
}

/// Writes single-precision values.
///
/// # Errors
/// [`PictureError::Shape`] unless there are one or three components.
pub fn write_tiff(image: &Image<f32>, header: Option<&Header>) -> Result<Vec<u8>, PictureError> {
    let (width, height, components) = (image.width(), image.height(), image.components());
    let pixels = TiffPixels::Floats(image.data().to_vec());
    write_tiff_pixels(
        &Tiff { width, height, components, pixels, header: header.cloned(), date: None },
        TiffCompression::None,
    )
}

/// Writes pixels.
///
/// # Errors
/// [`PictureError::Shape`] unless there are one or three components, and as many values as the size
/// requires.
pub fn write_tiff_pixels(picture: &Tiff, compression: TiffCompression) -> Result<Vec<u8>, PictureError> {
    match (&picture.pixels, picture.components) {
        (TiffPixels::Bytes(values), 1) => encode::<colortype::Gray8>(picture, values, compression),
        (TiffPixels::Bytes(values), 3) => encode::<colortype::RGB8>(picture, values, compression),
        (TiffPixels::Words(values), 1) => encode::<colortype::Gray16>(picture, values, compression),
        (TiffPixels::Words(values), 3) => encode::<colortype::RGB16>(picture, values, compression),
        (TiffPixels::Floats(values), 1) => encode::<colortype::Gray32Float>(picture, values, compression),
        (TiffPixels::Floats(values), 3) => encode::<colortype::RGB32Float>(picture, values, compression),
        _ => Err(bad_shape(picture, "1 or 3 components for tiff")),
    }
}

fn encode<C: colortype::ColorType>(
    picture: &Tiff,
    values: &[C::Inner],
    compression: TiffCompression,
) -> Result<Vec<u8>, PictureError>
where
    [C::Inner]: TiffValue,
{
    let (Ok(width), Ok(height)) = (u32::try_from(picture.width), u32::try_from(picture.height)) else {
        return Err(bad_shape(picture, "width and height of at most 2^32 - 1 pixels for tiff"));
    };
    if Some(values.len()) != picture.width.checked_mul(picture.height).and_then(|n| n.checked_mul(picture.components)) {
        return Err(bad_shape(picture, "width * height * components values"));
    }
    let mut out = Cursor::new(Vec::new());
    let compression = match compression {
        TiffCompression::None => Compression::Uncompressed,
        TiffCompression::Lzw => Compression::Lzw,
    };
    let mut encoder = TiffEncoder::new(&mut out).map_err(codec)?.with_compression(compression);
    let mut writer = encoder.new_image::<C>(width, height).map_err(codec)?;
    if let Some(header) = &picture.header {
        // The description is ASCII and ends at a zero byte.
        let text: String = header.to_text().chars().map(|c| if c.is_ascii() && c != '\0' { c } else { '?' }).collect();
        writer.encoder().write_tag(Tag::ImageDescription, text.as_str()).map_err(codec)?;
        let date = header.variable("CAPDATE").map(|date| date.trim().to_owned()).filter(|date| date.is_ascii());
        if let Some(date) = date.as_deref().and_then(|date| date.get(..LONGEST_DATE)) {
            writer.encoder().write_tag(Tag::DateTime, date).map_err(codec)?;
        }
    }
    writer.write_data(values).map_err(codec)?;
    Ok(out.into_inner())
}

fn bad_shape(picture: &Tiff, expected: &'static str) -> PictureError {
    let values = match &picture.pixels {
        TiffPixels::Bytes(values) => values.len(),
        TiffPixels::Words(values) => values.len(),
        TiffPixels::Floats(values) => values.len(),
    };
    let Tiff { width, height, components, .. } = *picture;
    PictureError::Shape { width, height, components, values, expected }
}

fn codec(error: tiff::TiffError) -> PictureError {
    PictureError::Codec { format: "tiff", reason: error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_and_history_survive_a_round_trip() {
        let mut header = Header::new("RADIANCE");
        header.push_command(["pinhole", "average"]);
        for components in [1, 3] {
            let image =
                Image::new(5, 3, components, (0..15 * components).map(|i| i as f32 * 1e-7 - 1e-6).collect()).unwrap();
            let (read, history) = read_tiff(&write_tiff(&image, Some(&header)).unwrap()).unwrap();
            assert_eq!((read, history), (image, Some(header.clone())));
        }
    }

    #[test]
    fn other_shapes_are_refused() {
        assert!(write_tiff(&Image::filled(2, 2, 2, 0.0).unwrap(), None).is_err());
        assert!(read_tiff(b"II*\0").is_err());
    }
}
