//! TIFF pictures: 8 and 16 bits and single precision, grey and RGB; LogLuv can be read as well.
//!
//! The Radiance header is stored as the image description. Exposure, shape of pixels, primaries,
//! date and owner have tags, as in Radiance.

use crate::tiff_pixels::{Tiff, TiffColors, TiffPixels, TiffTags};
use crate::tiff_tags::{FoundTag, TagValue, ascii, header, resolution};
use crate::{Header, Image, PictureError, Resolution, RgbPrimaries, log_luv, xyz_to_rgb};
use std::io::{Cursor, Seek, Write};
use tiff::ColorType;
use tiff::decoder::ifd::Value;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::encoder::{Compression, DirectoryEncoder, Rational, TiffEncoder, TiffKind, TiffValue, colortype};
use tiff::tags::{PlanarConfiguration, Tag};

/// Reads the first picture of a file: grey, RGB or RGBA in 8, 16 or 32-bit integers, which are
/// scaled to 0 to 1, or in half, single or double precision.
///
/// # Errors
/// When the bytes are not such a picture, or declare more pixels than they can hold.
pub fn read_tiff(bytes: &[u8]) -> Result<(Image<f32>, Option<Header>), PictureError> {
    let Tiff { resolution, components, pixels, colors, header, .. } = read_tiff_pixels(bytes)?;
    let mut data = match pixels {
        TiffPixels::Bytes(values) => fractions(values, f64::from(u8::MAX)),
        TiffPixels::Words(values) => fractions(values, f64::from(u16::MAX)),
        TiffPixels::Floats(values) => values,
    };
    if let (TiffColors::Xyz, Some(matrix)) = (colors, RgbPrimaries::STANDARD.xyz_to_rgb()) {
        data.as_chunks_mut::<3>().0.iter_mut().for_each(|value| *value = xyz_to_rgb(&matrix, *value));
    }
    Ok((resolution.upright(components, data)?, header))
}

/// The compression of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TiffCompression {
    /// No compression.
    None,
    /// Lempel-Ziv-Welch.
    Lzw,
}

/// The order of bits within bytes, from the highest, and its tag.
const FILL_ORDER: u16 = 266;
const FROM_HIGHEST: u64 = 1;

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
    let (length, rows) = decoder.dimensions().map_err(codec)?;
    let (length, rows) = (length as usize, rows as usize);
    let components = components_of(&mut decoder)?;
    let pixels = read_pixels(&mut decoder, length.saturating_mul(rows), components)?;
    let mut tag = |code| found(&mut decoder, code);
    let header = header(&mut tag);
    let resolution = resolution(length, rows, &mut tag);
    let tags = TiffTags::find(&resolution, tag);
    Ok(Tiff { resolution, components, pixels, colors: TiffColors::Rgb, tags, header })
}

/// Number of values of a pixel. Pixels that cannot be read are an error.
fn components_of(decoder: &mut Decoder<Cursor<&[u8]>>) -> Result<usize, PictureError> {
    let color = decoder.colortype().map_err(codec)?;
    let (components, bits) = match color {
        ColorType::Gray(bits) => (1, bits),
        ColorType::RGB(bits) => (3, bits),
        ColorType::RGBA(bits) => (4, bits),
        ColorType::Multiband { num_samples, .. } => {
            return Err(unsupported(format!("{num_samples} values of a grey pixel"), "one value, or RGB pixels"));
        }
        other => return Err(unsupported(format!("{other:?} pixels"), "grey or RGB pixels")),
    };
    if !matches!(bits, 8 | 16 | 32 | 64) {
        return Err(unsupported(format!("{bits} bits per value"), "8, 16 or 32 bits"));
    }
    let order = decoder.find_tag_unsigned::<u64>(Tag::Unknown(FILL_ORDER)).map_err(codec)?;
    if order.is_some_and(|order| order != FROM_HIGHEST) {
        return Err(unsupported("reversed bits (FillOrder 2)".to_owned(), "FillOrder 1"));
    }
    Ok(components)
}

/// The values in the order of the pixels.
fn read_pixels(
    decoder: &mut Decoder<Cursor<&[u8]>>,
    count: usize,
    components: usize,
) -> Result<TiffPixels, PictureError> {
    let planar = decoder.find_tag_unsigned::<u16>(Tag::PlanarConfiguration).map_err(codec)?;
    let planes = if planar == Some(PlanarConfiguration::Planar.to_u16()) { components } else { 1 };
    check_lengths(decoder, count)?;
    let mut read = DecodingResult::U8(Vec::new());
    decoder.read_image_to_buffer(&mut read).map_err(codec)?;
    let pixels = match read {
        DecodingResult::U8(values) => TiffPixels::Bytes(interleaved(values, planes)),
        DecodingResult::U16(values) => TiffPixels::Words(interleaved(values, planes)),
        DecodingResult::U32(values) => TiffPixels::Floats(interleaved(fractions(values, f64::from(u32::MAX)), planes)),
        DecodingResult::F16(values) => {
            TiffPixels::Floats(interleaved(values.into_iter().map(f32::from).collect(), planes))
        }
        DecodingResult::F32(values) => TiffPixels::Floats(interleaved(values, planes)),
        DecodingResult::F64(values) => {
            TiffPixels::Floats(interleaved(values.into_iter().map(|value| value as f32).collect(), planes))
        }
        _ => return Err(unsupported("signed or 64-bit integers".to_owned(), "floats, or up to 32 unsigned bits")),
    };
    let expected = count.saturating_mul(components);
    if pixels.len() != expected {
        let reason = format!("{} values of pixels, expected {expected}", pixels.len());
        return Err(PictureError::Codec { format: "tiff", reason });
    }
    Ok(pixels)
}

/// Checks that uncompressed strips or tiles are as long as their pixels; the library reads on in
/// the bytes after them. Some files leave the lengths at 0.
fn check_lengths(decoder: &mut Decoder<Cursor<&[u8]>>, count: usize) -> Result<(), PictureError> {
    const UNCOMPRESSED: u16 = 1;
    let one = |tag, decoder: &mut Decoder<Cursor<&[u8]>>| decoder.find_tag_unsigned::<u16>(tag).map_err(codec);
    if one(Tag::Compression, decoder)?.is_some_and(|method| method != UNCOMPRESSED) {
        return Ok(());
    }
    let samples = one(Tag::SamplesPerPixel, decoder)?.unwrap_or(1);
    let bits = decoder.colortype().map_err(codec)?.bit_depth();
    let mut length = 0u64;
    for tag in [Tag::StripByteCounts, Tag::TileByteCounts] {
        let lengths = decoder.find_tag_unsigned_vec::<u64>(tag).map_err(codec)?;
        length = lengths.into_iter().flatten().fold(length, u64::saturating_add);
    }
    let expected = (count as u64).saturating_mul(u64::from(samples)).saturating_mul(u64::from(bits / 8));
    if length == 0 || length >= expected {
        return Ok(());
    }
    let reason = format!("{length} bytes of pixels, expected {expected}");
    Err(PictureError::Codec { format: "tiff", reason })
}

/// The values of planes in the order of the pixels.
fn interleaved<T: Copy>(values: Vec<T>, planes: usize) -> Vec<T> {
    if planes < 2 || !values.len().is_multiple_of(planes) {
        return values;
    }
    let size = values.len() / planes;
    (0..size).flat_map(|pixel| values[pixel..].iter().step_by(size)).copied().collect()
}

/// The content of a tag; none that cannot be read.
fn found(decoder: &mut Decoder<Cursor<&[u8]>>, code: u16) -> Option<FoundTag> {
    match decoder.find_tag(Tag::from_u16_exhaustive(code)).ok().flatten()? {
        Value::Ascii(text) => Some(FoundTag::Text(text)),
        Value::List(values) => values.into_iter().map(number).collect::<Option<_>>().map(FoundTag::Numbers),
        value => number(value).map(|number| FoundTag::Numbers(vec![number])),
    }
}

fn number(value: Value) -> Option<f64> {
    match value {
        Value::Rational(above, below) => Some(f64::from(above) / f64::from(below)),
        Value::SRational(above, below) => Some(f64::from(above) / f64::from(below)),
        Value::Float(number) => Some(f64::from(number)),
        Value::Double(number) => Some(number),
        value => value.into_u32().ok().map(f64::from),
    }
}

fn fractions<T: Into<f64>>(values: Vec<T>, largest: f64) -> Vec<f32> {
    values.into_iter().map(|value| (value.into() / largest) as f32).collect()
}

/// Writes single-precision values.
///
/// # Errors
/// [`PictureError::Shape`] unless there are one or three components.
pub fn write_tiff(image: &Image<f32>, header: Option<&Header>) -> Result<Vec<u8>, PictureError> {
    let resolution = Resolution::standard(image.width(), image.height());
    let pixels = TiffPixels::Floats(image.data().to_vec());
    // A header with a wrong line is still the image description.
    let tags = header.and_then(|header| TiffTags::from_header(header).ok()).unwrap_or_default();
    let (components, colors, header) = (image.components(), TiffColors::Rgb, header.cloned());
    write_tiff_pixels(&Tiff { resolution, components, pixels, colors, tags, header }, TiffCompression::None)
}

/// Writes pixels.
///
/// # Errors
/// [`PictureError::Shape`] unless there are one or three components, and as many values as the size
/// requires.
pub fn write_tiff_pixels(picture: &Tiff, compression: TiffCompression) -> Result<Vec<u8>, PictureError> {
    if picture.colors == TiffColors::Xyz {
        return log_luv::write(picture);
    }
    match (&picture.pixels, picture.components) {
        (TiffPixels::Bytes(values), 1) => encode::<colortype::Gray8>(picture, values, compression),
        (TiffPixels::Bytes(values), 3) => encode::<colortype::RGB8>(picture, values, compression),
        (TiffPixels::Words(values), 1) => encode::<colortype::Gray16>(picture, values, compression),
        (TiffPixels::Words(values), 3) => encode::<colortype::RGB16>(picture, values, compression),
        (TiffPixels::Floats(values), 1) => encode::<colortype::Gray32Float>(picture, values, compression),
        (TiffPixels::Floats(values), 3) => encode::<colortype::RGB32Float>(picture, values, compression),
        _ => Err(picture.bad_shape("1 or 3 components for tiff")),
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
    let (length, rows) = (picture.resolution.scanline_length(), picture.resolution.scanlines());
    let (Ok(width), Ok(height)) = (u32::try_from(length), u32::try_from(rows)) else {
        return Err(picture.bad_shape("width and height of at most 2^32 - 1 pixels for tiff"));
    };
    if Some(values.len()) != length.checked_mul(rows).and_then(|n| n.checked_mul(picture.components)) {
        return Err(picture.bad_shape("width * height * components values"));
    }
    let mut out = Cursor::new(Vec::new());
    let compression = match compression {
        TiffCompression::None => Compression::Uncompressed,
        TiffCompression::Lzw => Compression::Lzw,
    };
    let mut encoder = TiffEncoder::new(&mut out).map_err(codec)?.with_compression(compression);
    let mut writer = encoder.new_image::<C>(width, height).map_err(codec)?;
    if let Some(header) = &picture.header {
        let text = ascii(&header.to_text());
        writer.encoder().write_tag(Tag::ImageDescription, text.as_str()).map_err(codec)?;
    }
    let mut tags = picture.tags.clone();
    // Grey has no primaries.
    tags.primaries = tags.primaries.filter(|_| picture.components == 3);
    for (code, value) in tags.values(&picture.resolution) {
        put_tag(writer.encoder(), code, &value).map_err(codec)?;
    }
    writer.write_data(values).map_err(codec)?;
    Ok(out.into_inner())
}

fn put_tag<W: Write + Seek, K: TiffKind>(
    directory: &mut DirectoryEncoder<'_, W, K>,
    code: u16,
    value: &TagValue,
) -> tiff::TiffResult<()> {
    let tag = Tag::from_u16_exhaustive(code);
    match value {
        TagValue::Text(text) => directory.write_tag(tag, text.as_str()),
        TagValue::Short(number) => directory.write_tag(tag, *number),
        TagValue::Floats(numbers) => directory.write_tag(tag, numbers.as_slice()),
        TagValue::Double(number) => directory.write_tag(tag, *number),
        TagValue::Rationals(numbers) => {
            let numbers: Vec<Rational> = numbers.iter().map(|[n, d]| Rational { n: *n, d: *d }).collect();
            directory.write_tag(tag, numbers.as_slice())
        }
    }
}

fn unsupported(what: String, expected: &'static str) -> PictureError {
    PictureError::Unsupported { format: "tiff", what, expected }
}

fn codec(error: tiff::TiffError) -> PictureError {
    PictureError::Codec { format: "tiff", reason: error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Orientation;

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

    #[test]
    fn orientation_and_tags_survive_a_round_trip() {
        let tags = TiffTags {
            nits: Some(71.6),
            pixel_aspect: Some(1.25),
            primaries: Some(RgbPrimaries::from_array([0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329])),
            date: Some("2026:11:21 11:14:09".to_owned()),
            owner: Some("Ada".to_owned()),
        };
        let orientations = (0..8).map(|bits| Orientation {
            scanlines_are_rows: bits & 4 != 0,
            x_falls: bits & 1 != 0,
            y_falls: bits & 2 != 0,
        });
        for (orientation, colors) in orientations.flat_map(|found| [(found, TiffColors::Rgb), (found, TiffColors::Xyz)])
        {
            let mut tags = tags.clone();
            tags.primaries = tags.primaries.filter(|_| colors == TiffColors::Rgb);
            let resolution = Resolution { width: 5, height: 3, orientation };
            let pixels = TiffPixels::Floats(vec![0.5; 45]);
            let picture = Tiff { resolution, components: 3, pixels, colors, tags, header: None };
            let read = read_tiff_pixels(&write_tiff_pixels(&picture, TiffCompression::Lzw).unwrap()).unwrap();
            assert_eq!((read.resolution, &read.tags), (resolution, &picture.tags));
        }
    }

    #[test]
    fn a_turned_picture_is_read_upright() {
        let image = Image::new(3, 2, 1, (0..6).map(|i| i as f32).collect()).unwrap();
        let (resolution, _) = Resolution::read(b"+X 3 +Y 2\n", 0).unwrap();
        let (pixels, tags) = (TiffPixels::Floats(resolution.stored(&image).into_owned()), TiffTags::default());
        let picture = Tiff { resolution, components: 1, pixels, colors: TiffColors::Rgb, tags, header: None };
        let bytes = write_tiff_pixels(&picture, TiffCompression::None).unwrap();
        assert_eq!(read_tiff(&bytes).unwrap().0, image);
    }

    #[test]
    fn imaginary_primaries_keep_their_sign() {
        let wide = RgbPrimaries::from_array([0.75, 0.25, 0.0, 1.0, 0.0625, -0.125, 0.3125, 0.34375]);
        let tags = TiffTags { primaries: Some(wide), ..TiffTags::default() };
        let (resolution, pixels) = (Resolution::standard(1, 1), TiffPixels::Bytes(vec![1, 2, 3]));
        let picture = Tiff { resolution, components: 3, pixels, colors: TiffColors::Rgb, tags, header: None };
        let bytes = write_tiff_pixels(&picture, TiffCompression::None).unwrap();
        assert_eq!(read_tiff_pixels(&bytes).unwrap().tags.primaries, Some(wide));
    }
}
