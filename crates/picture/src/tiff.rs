//! TIFF pictures: single precision, grey and RGB, uncompressed when written.
//!
//! The Radiance header travels along as the image description.

use crate::{Header, Image, PictureError};
use std::io::Cursor;
use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::encoder::{TiffEncoder, colortype};
use tiff::tags::Tag;

/// Reads the first picture of a file: grey, RGB or RGBA of 8, 16 or 32 bit whole numbers, which become 0 to 1, or of
/// half, single or double precision.
///
/// # Errors
/// When the bytes are not such a picture, or claim more pixels than they can hold.
pub fn read_tiff(bytes: &[u8]) -> Result<(Image<f32>, Option<Header>), PictureError> {
    // Deflate and LZW cannot shrink by more than this factor, so no honest file needs more memory.
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
    let data = match decoder.read_image().map_err(codec)? {
        DecodingResult::U8(values) => fractions(values, f64::from(u8::MAX)),
        DecodingResult::U16(values) => fractions(values, f64::from(u16::MAX)),
        DecodingResult::U32(values) => fractions(values, f64::from(u32::MAX)),
        DecodingResult::F16(values) => values.into_iter().map(f32::from).collect(),
        DecodingResult::F32(values) => values,
        DecodingResult::F64(values) => values.into_iter().map(|value| value as f32).collect(),
        _ => {
            let what = "signed or 64 bit whole numbers".to_owned();
            return Err(PictureError::Unsupported {
                format: "tiff",
                what,
                expected: "floats, or up to 32 unsigned bits",
            });
        }
    };
    let description = decoder.find_tag(Tag::ImageDescription).ok().flatten().and_then(|value| value.into_string().ok());
    let header = description.filter(|text| text.starts_with("#?")).map(|text| Header::read_text(text.as_bytes()));
    Ok((Image::new(width as usize, height as usize, components, data)?, header))
}

fn fractions<T: Into<f64>>(values: Vec<T>, largest: f64) -> Vec<f32> {
    values.into_iter().map(|value| (value.into() / largest) as f32).collect()
}

/// Writes single-precision values.
///
/// # Errors
/// [`PictureError::Shape`] unless there are one or three components.
pub fn write_tiff(image: &Image<f32>, header: Option<&Header>) -> Result<Vec<u8>, PictureError> {
    match image.components() {
        1 => encode::<colortype::Gray32Float>(image, header),
        3 => encode::<colortype::RGB32Float>(image, header),
        _ => Err(bad_shape(image, "1 or 3 components for tiff")),
    }
}

fn encode<C: colortype::ColorType<Inner = f32>>(
    image: &Image<f32>,
    header: Option<&Header>,
) -> Result<Vec<u8>, PictureError> {
    let (Ok(width), Ok(height)) = (u32::try_from(image.width()), u32::try_from(image.height())) else {
        return Err(bad_shape(image, "at most 2^32 - 1 pixels a side for tiff"));
    };
    let mut out = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut out).map_err(codec)?;
    let mut writer = encoder.new_image::<C>(width, height).map_err(codec)?;
    if let Some(header) = header {
        // The description is ASCII and ends at a zero byte.
        let text: String = header.to_text().chars().map(|c| if c.is_ascii() && c != '\0' { c } else { '?' }).collect();
        writer.encoder().write_tag(Tag::ImageDescription, text.as_str()).map_err(codec)?;
    }
    writer.write_data(image.data()).map_err(codec)?;
    Ok(out.into_inner())
}

fn bad_shape(image: &Image<f32>, expected: &'static str) -> PictureError {
    let (width, height, components) = (image.width(), image.height(), image.components());
    PictureError::Shape { width, height, components, values: image.data().len(), expected }
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
