//! PNG pictures of 8 and 16 bits, grey and RGB: output of the sensor and pictures for display.
//!
//! Values are stored without a transfer curve. The Radiance header is stored in an international
//! text chunk with the keyword `Radiance header`, so that a grey picture keeps its history.

use crate::{Header, Image, PictureError};
use std::io::Cursor;

const KEYWORD: &str = "Radiance header";

/// The content of a PNG file.
#[derive(Clone, Debug, PartialEq)]
pub struct Png {
    /// One (grey), two (grey, alpha), three (RGB) or four (RGB, alpha) components, from 0 to
    /// 2^bits - 1.
    pub values: Image<u16>,
    /// Bits per value, 8 or 16. Files with fewer bits or a palette are expanded to 8.
    pub bits: u8,
    /// The Radiance header, if radsight wrote the file.
    pub header: Option<Header>,
}

/// Writes an 8 bit grey picture.
///
/// # Errors
/// [`PictureError::Shape`] unless there is one component.
pub fn write_png_grey8(image: &Image<u8>, header: Option<&Header>) -> Result<Vec<u8>, PictureError> {
    check_components(image, 1)?;
    encode(image, image.data(), (png::ColorType::Grayscale, png::BitDepth::Eight), header)
}

/// Writes a 16 bit grey picture.
///
/// # Errors
/// [`PictureError::Shape`] unless there is one component.
pub fn write_png_grey16(image: &Image<u16>, header: Option<&Header>) -> Result<Vec<u8>, PictureError> {
    check_components(image, 1)?;
    encode(image, &big_endian(image), (png::ColorType::Grayscale, png::BitDepth::Sixteen), header)
}

/// Writes an 8 bit RGB picture.
///
/// # Errors
/// [`PictureError::Shape`] unless there are three components.
pub fn write_png_rgb8(image: &Image<u8>, header: Option<&Header>) -> Result<Vec<u8>, PictureError> {
    check_components(image, 3)?;
    encode(image, image.data(), (png::ColorType::Rgb, png::BitDepth::Eight), header)
}

/// Writes a 16 bit RGB picture.
///
/// # Errors
/// [`PictureError::Shape`] unless there are three components.
pub fn write_png_rgb16(image: &Image<u16>, header: Option<&Header>) -> Result<Vec<u8>, PictureError> {
    check_components(image, 3)?;
    encode(image, &big_endian(image), (png::ColorType::Rgb, png::BitDepth::Sixteen), header)
}

/// Reads a PNG picture.
///
/// # Errors
/// When the bytes are not a PNG picture, or declare more pixels than they can hold.
pub fn read_png(bytes: &[u8]) -> Result<Png, PictureError> {
    // The largest compression ratio of Deflate; no valid file needs more memory.
    const LARGEST_RATIO: usize = 1032;
    let memory = bytes.len().saturating_mul(LARGEST_RATIO).saturating_add(1 << 16);
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), png::Limits { bytes: memory });
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(codec)?;
    let (width, height) = reader.info().size();
    let (color, depth) = reader.output_color_type();
    let Some(size) = reader.output_buffer_size().filter(|size| *size <= memory) else {
        let (width, height, components) = (u64::from(width), u64::from(height), color.samples() as u64);
        return Err(PictureError::TooLarge { offset: 8, width, height, components, available: bytes.len() });
    };
    let mut buffer = vec![0; size];
    let frame = reader.next_frame(&mut buffer).map_err(codec)?;
    buffer.truncate(frame.buffer_size());
    reader.finish().map_err(codec)?;
    let header = header_in(reader.info());
    let wide = depth == png::BitDepth::Sixteen;
    let data: Vec<u16> = if wide {
        buffer.as_chunks::<2>().0.iter().map(|value| u16::from_be_bytes(*value)).collect()
    } else {
        buffer.into_iter().map(u16::from).collect()
    };
    let values = Image::new(frame.width as usize, frame.height as usize, color.samples(), data)?;
    Ok(Png { values, bits: if wide { 16 } else { 8 }, header })
}

fn header_in(info: &png::Info<'_>) -> Option<Header> {
    let chunk = info.utf8_text.iter().find(|chunk| chunk.keyword == KEYWORD)?;
    Some(Header::read_text(chunk.get_text().ok()?.as_bytes()))
}

fn check_components<T>(image: &Image<T>, expected: usize) -> Result<(), PictureError> {
    if image.components() == expected {
        return Ok(());
    }
    Err(PictureError::Shape {
        width: image.width(),
        height: image.height(),
        components: image.components(),
        values: image.data().len(),
        expected: if expected == 1 { "1 component for a grey png" } else { "3 components for a colour png" },
    })
}

fn encode<T>(
    image: &Image<T>,
    data: &[u8],
    (color, depth): (png::ColorType, png::BitDepth),
    header: Option<&Header>,
) -> Result<Vec<u8>, PictureError> {
    let (Ok(width), Ok(height)) = (u32::try_from(image.width()), u32::try_from(image.height())) else {
        return Err(PictureError::Shape {
            width: image.width(),
            height: image.height(),
            components: image.components(),
            values: image.data().len(),
            expected: "width and height of at most 2^31 - 1 pixels for png",
        });
    };
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if let Some(header) = header {
        // A text chunk cannot contain a zero byte.
        let text = header.to_text().replace('\0', " ");
        encoder.add_itxt_chunk(KEYWORD.to_owned(), text).map_err(codec)?;
    }
    let mut writer = encoder.write_header().map_err(codec)?;
    writer.write_image_data(data).map_err(codec)?;
    writer.finish().map_err(codec)?;
    Ok(out)
}

fn big_endian(image: &Image<u16>) -> Vec<u8> {
    image.data().iter().flat_map(|value| value.to_be_bytes()).collect()
}

fn codec(error: impl std::fmt::Display) -> PictureError {
    PictureError::Codec { format: "png", reason: error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_values_and_history_survive_a_round_trip() {
        let mut header = Header::new("RADIANCE");
        header.push_command(["radsight", "sensor", "camera é.toml"]);
        let image = Image::new(3, 2, 1, vec![0u16, 1, 255, 256, 65534, 65535]).unwrap();
        let png = read_png(&write_png_grey16(&image, Some(&header)).unwrap()).unwrap();
        assert_eq!(png, Png { values: image.clone(), bits: 16, header: Some(header) });
        let narrow = image.map(|value| value as u8);
        let png = read_png(&write_png_grey8(&narrow, None).unwrap()).unwrap();
        assert_eq!(png, Png { values: narrow.map(u16::from), bits: 8, header: None });
    }

    #[test]
    fn colour_needs_three_components() {
        let image = Image::new(1, 2, 3, vec![1u8, 2, 3, 4, 5, 6]).unwrap();
        assert_eq!(read_png(&write_png_rgb8(&image, None).unwrap()).unwrap().values, image.clone().map(u16::from));
        assert!(matches!(write_png_grey8(&image, None), Err(PictureError::Shape { .. })));
    }

    #[test]
    fn a_cut_file_is_an_error() {
        let image = Image::new(20, 20, 1, (0..400).map(|i| (i * 7) as u8).collect()).unwrap();
        let bytes = write_png_grey8(&image, None).unwrap();
        for length in 0..bytes.len() - 12 {
            assert!(read_png(&bytes[..length]).is_err(), "{length} of {}", bytes.len());
        }
    }
}
