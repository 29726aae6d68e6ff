//! TIFF pictures in LogLuv: 32 bits per pixel for all luminances and colours.
//!
//! The upper half holds a sign and the logarithm of the luminance in steps of 2^(1/256). The lower
//! two bytes are the CIE 1976 chromaticities u′ and v′ times 410 (Ward Larson, "LogLuv Encoding for
//! Full-Gamut, High-Dynamic Range Images", Journal of Graphics Tools 3(1), 1998). A row is stored
//! as four planes of bytes, the most significant first, each run-length encoded (TIFF compression
//! 34676).

use crate::PictureError;
use crate::tiff_pixels::{Tiff, TiffColors, TiffPixels, TiffTags};
use crate::tiff_tags::{DESCRIPTION, FoundTag, TagValue, ascii, header, resolution};

/// TIFF codes of the compression and the photometric interpretation.
const COMPRESSION: u32 = 34_676;
const LOG_LUV: u32 = 32_845;

/// Codes of the tags of pixels.
const WIDTH: u16 = 256;
const HEIGHT: u16 = 257;
const BITS: u16 = 258;
const COMPRESSION_TAG: u16 = 259;
const PHOTOMETRIC: u16 = 262;
const STRIP_OFFSETS: u16 = 273;
const SAMPLES: u16 = 277;
const ROWS_A_STRIP: u16 = 278;
const STRIP_BYTES: u16 = 279;
const PLANAR: u16 = 284;

/// Scale of stored chromaticities.
const CHROMATICITY_SCALE: f64 = 410.0;

/// Shorter runs are stored literally.
const LEAST_RUN: usize = 4;

/// The code of a pixel's tristimulus values.
fn encode([x, y, z]: [f64; 3]) -> u32 {
    // Below the darkest code.
    if y.is_nan() || y <= 5.4e-20 {
        return 0;
    }
    let log = (256.0 * (y.min(1.8e19).log2() + 64.0)) as u32 & 0x7fff;
    let sum = x + 15.0 * y + 3.0 * z;
    let part = |value: f64| if sum > 0.0 { (CHROMATICITY_SCALE * value / sum).clamp(0.0, 255.0) as u32 } else { 0 };
    log << 16 | part(4.0 * x) << 8 | part(9.0 * y)
}

fn decode(code: u32) -> [f64; 3] {
    let log = code >> 16 & 0x7fff;
    if log == 0 {
        return [0.0; 3];
    }
    let y = ((f64::from(log) + 0.5) / 256.0 - 64.0).exp2() * if code >> 31 == 1 { -1.0 } else { 1.0 };
    let u = (f64::from(code >> 8 & 0xff) + 0.5) / CHROMATICITY_SCALE;
    let v = (f64::from(code & 0xff) + 0.5) / CHROMATICITY_SCALE;
    // From u′ = 4X/(X + 15Y + 3Z), v′ = 9Y/(X + 15Y + 3Z).
    let x = y * 9.0 * u / (4.0 * v);
    [x, y, (9.0 * y / v - x - 15.0 * y) / 3.0]
}

/// Writes tristimulus values in single precision.
///
/// # Errors
/// [`PictureError::Shape`] unless there are three values per pixel, and less than 4 GB in all.
pub(crate) fn write(picture: &Tiff) -> Result<Vec<u8>, PictureError> {
    const EXPECTED: &str = "three floats per pixel and fewer than 2^28 pixels";
    let (width, height) = (picture.resolution.scanline_length(), picture.resolution.scanlines());
    let TiffPixels::Floats(xyz) = &picture.pixels else { return Err(picture.bad_shape(EXPECTED)) };
    if width == 0 || width.checked_mul(height).is_none_or(|pixels| pixels >= 1 << 28 || 3 * pixels != xyz.len()) {
        return Err(picture.bad_shape(EXPECTED));
    }
    let mut bytes = b"II\x2a\0\0\0\0\0".to_vec();
    let mut strips = Vec::with_capacity(height);
    for row in xyz.chunks_exact(3 * width) {
        let start = bytes.len();
        let codes: Vec<u32> = row.as_chunks::<3>().0.iter().map(|pixel| encode(pixel.map(f64::from))).collect();
        for plane in (0..4).rev() {
            let plane: Vec<u8> = codes.iter().map(|code| (code >> (8 * plane)) as u8).collect();
            pack(&plane, &mut bytes);
        }
        strips.push([start as u32, (bytes.len() - start) as u32]);
    }
    write_directory(picture, &strips, &mut bytes);
    Ok(bytes)
}

/// Appends one run-length encoded plane of a row. A count of at least 128 repeats the next byte; a
/// smaller count precedes that many literal bytes.
fn pack(plane: &[u8], out: &mut Vec<u8>) {
    let run_at = |at: usize| plane[at..].iter().take(127).take_while(|byte| **byte == plane[at]).count();
    let mut at = 0;
    while at < plane.len() {
        let mut literal = at;
        while literal < plane.len() && run_at(literal) < LEAST_RUN && literal - at < 127 {
            literal += 1;
        }
        if literal > at {
            out.push((literal - at) as u8);
            out.extend_from_slice(&plane[at..literal]);
            at = literal;
            continue;
        }
        let run = run_at(at);
        out.extend_from_slice(&[(128 + run - 2) as u8, plane[at]]);
        at += run;
    }
}

/// Writes the data after the pixels; `strips` are the offset and length of each row.
fn write_directory(picture: &Tiff, strips: &[[u32; 2]], bytes: &mut Vec<u8>) {
    let (width, height) = (picture.resolution.scanline_length(), picture.resolution.scanlines());
    let longs = |numbers: &[u32]| numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>();
    let column = |column: usize| longs(&strips.iter().map(|strip| strip[column]).collect::<Vec<u32>>());
    let short = |number: u16| (SHORT, number.to_le_bytes().to_vec());
    let mut entries = vec![
        (WIDTH, (LONG, longs(&[width as u32]))),
        (HEIGHT, (LONG, longs(&[height as u32]))),
        (BITS, (SHORT, [16, 0].repeat(3))),
        (COMPRESSION_TAG, short(COMPRESSION as u16)),
        (PHOTOMETRIC, short(LOG_LUV as u16)),
        (STRIP_OFFSETS, (LONG, column(0))),
        (SAMPLES, short(3)),
        (ROWS_A_STRIP, (LONG, longs(&[1]))),
        (STRIP_BYTES, (LONG, column(1))),
        (PLANAR, short(1)),
    ];
    let header = picture.header.as_ref().map(|header| TagValue::Text(ascii(&header.to_text())));
    entries.extend(header.map(|text| (DESCRIPTION, stored(&text))));
    // Tristimulus values have no primaries.
    let tags = TiffTags { primaries: None, ..picture.tags.clone() };
    entries.extend(tags.values(&picture.resolution).iter().map(|(code, value)| (*code, stored(value))));
    entries.sort_unstable();
    let mut directory = (entries.len() as u16).to_le_bytes().to_vec();
    for (tag, (kind, mut value)) in entries {
        let count = value.len() / size_of_kind(kind).unwrap_or(1);
        if value.len() > 4 {
            bytes.resize(bytes.len().next_multiple_of(4), 0);
            let offset = bytes.len() as u32;
            bytes.append(&mut value);
            value.extend(offset.to_le_bytes());
        }
        value.resize(4, 0);
        directory.extend([tag, kind].map(u16::to_le_bytes).concat());
        directory.extend((count as u32).to_le_bytes());
        directory.append(&mut value);
    }
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let start = bytes.len() as u32;
    bytes[4..8].copy_from_slice(&start.to_le_bytes());
    bytes.append(&mut directory);
    bytes.extend_from_slice(&[0; 4]);
}

/// Codes of the types of values.
const ASCII: u16 = 2;
const SHORT: u16 = 3;
const LONG: u16 = 4;
const RATIONAL: u16 = 5;
const FLOAT: u16 = 11;
const DOUBLE: u16 = 12;

/// Size of a value, bytes; `None` for types that no tag here has.
fn size_of_kind(kind: u16) -> Option<usize> {
    match kind {
        1 | ASCII => Some(1),
        SHORT => Some(2),
        LONG | FLOAT => Some(4),
        RATIONAL | DOUBLE => Some(8),
        _ => None,
    }
}

/// The type and the bytes of a value.
fn stored(value: &TagValue) -> (u16, Vec<u8>) {
    match value {
        TagValue::Text(text) => (ASCII, text.bytes().chain([0]).collect()),
        TagValue::Short(number) => (SHORT, number.to_le_bytes().to_vec()),
        TagValue::Floats(numbers) => (FLOAT, numbers.iter().flat_map(|number| number.to_le_bytes()).collect()),
        TagValue::Double(number) => (DOUBLE, number.to_le_bytes().to_vec()),
        TagValue::Rationals(numbers) => {
            (RATIONAL, numbers.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect())
        }
    }
}

/// The bytes of a TIFF file and its byte order.
struct File<'a> {
    bytes: &'a [u8],
    little: bool,
}

impl File<'_> {
    fn number(&self, at: usize, length: usize) -> Option<u32> {
        let bytes = self.bytes.get(at..at.checked_add(length)?)?;
        let fold = |sum: u32, byte: &u8| sum << 8 | u32::from(*byte);
        Some(if self.little { bytes.iter().rev().fold(0, fold) } else { bytes.iter().fold(0, fold) })
    }

    /// The type and the bytes of a tag, and their offset.
    fn value(&self, tag: u16) -> Option<(u16, &[u8], usize)> {
        let directory = self.number(4, 4)? as usize;
        let entries = self.number(directory, 2)? as usize;
        let entry = (0..entries)
            .map(|index| directory + 2 + 12 * index)
            .find(|entry| self.number(*entry, 2) == Some(u32::from(tag)))?;
        let kind = self.number(entry + 2, 2)? as u16;
        let length = (self.number(entry + 4, 4)? as usize).checked_mul(size_of_kind(kind)?)?;
        let offset = if length <= 4 { entry + 8 } else { self.number(entry + 8, 4)? as usize };
        Some((kind, self.bytes.get(offset..offset.checked_add(length)?)?, offset))
    }

    /// The integers of a tag.
    fn tag(&self, tag: u16) -> Option<Vec<u32>> {
        let (kind, value, offset) = self.value(tag)?;
        let size = size_of_kind(kind).filter(|size| *size <= 4 && kind != FLOAT)?;
        (offset..offset + value.len()).step_by(size).map(|at| self.number(at, size)).collect()
    }

    /// The content of a tag.
    fn found(&self, tag: u16) -> Option<FoundTag> {
        let (kind, value, offset) = self.value(tag)?;
        let long = |at: usize| self.number(at, 4).map(f64::from);
        let eights = (offset..offset + value.len()).step_by(8);
        let numbers = match kind {
            ASCII => {
                let text = value.split(|byte| *byte == 0).next().unwrap_or_default();
                return Some(FoundTag::Text(String::from_utf8_lossy(text).into_owned()));
            }
            RATIONAL => eights.map(|at| Some(long(at)? / long(at + 4)?)).collect::<Option<_>>()?,
            DOUBLE => {
                let read = if self.little { f64::from_le_bytes } else { f64::from_be_bytes };
                value.as_chunks::<8>().0.iter().map(|bytes| read(*bytes)).collect()
            }
            FLOAT => {
                let read = if self.little { f32::from_le_bytes } else { f32::from_be_bytes };
                value.as_chunks::<4>().0.iter().map(|bytes| f64::from(read(*bytes))).collect()
            }
            _ => self.tag(tag)?.into_iter().map(f64::from).collect(),
        };
        Some(FoundTag::Numbers(numbers))
    }

    fn one(&self, tag: u16) -> Option<u32> {
        self.tag(tag)?.first().copied()
    }
}

/// Reads a LogLuv picture as tristimulus values; `None` for any other file.
pub(crate) fn read(bytes: &[u8]) -> Option<Result<Tiff, PictureError>> {
    let little = match bytes.get(..4)? {
        b"II\x2a\0" => true,
        b"MM\0\x2a" => false,
        _ => return None,
    };
    let file = File { bytes, little };
    if file.one(COMPRESSION_TAG)? != COMPRESSION || file.one(PHOTOMETRIC)? != LOG_LUV {
        return None;
    }
    let broken =
        || PictureError::Codec { format: "tiff", reason: "its LogLuv pixels are broken or missing".to_owned() };
    Some(read_pixels(&file).ok_or_else(broken))
}

fn read_pixels(file: &File<'_>) -> Option<Tiff> {
    let (width, height) = (file.one(WIDTH)? as usize, file.one(HEIGHT)? as usize);
    let rows = (file.one(ROWS_A_STRIP).unwrap_or(u32::MAX) as usize).min(height).max(1);
    let (offsets, lengths) = (file.tag(STRIP_OFFSETS)?, file.tag(STRIP_BYTES)?);
    // A row of four planes takes at least eight bytes per 127 pixels.
    let least = height.checked_mul(8 * width.div_ceil(129))?;
    if width == 0
        || least > file.bytes.len()
        || offsets.len() != height.div_ceil(rows)
        || lengths.len() != offsets.len()
    {
        return None;
    }
    let mut values = Vec::with_capacity(3 * width * height);
    for (strip, (offset, length)) in offsets.iter().zip(&lengths).enumerate() {
        let mut packed = file.bytes.get(*offset as usize..(*offset as usize).checked_add(*length as usize)?)?;
        for _ in 0..rows.min(height - strip * rows) {
            let mut codes = vec![0u32; width];
            for plane in (0..4).rev() {
                packed = unpack(packed, 8 * plane, &mut codes)?;
            }
            for code in codes {
                values.extend_from_slice(&decode(code).map(|value| value as f32));
            }
        }
    }
    let header = header(|code| file.found(code));
    let resolution = resolution(width, height, |code| file.found(code));
    let tags = TiffTags::find(&resolution, |code| file.found(code));
    let (pixels, colors) = (TiffPixels::Floats(values), TiffColors::Xyz);
    Some(Tiff { resolution, components: 3, pixels, colors, tags, header })
}

/// Unpacks one plane into the bits from `shift` on and returns the rest of the input.
fn unpack<'a>(mut packed: &'a [u8], shift: u32, codes: &mut [u32]) -> Option<&'a [u8]> {
    let mut at = 0;
    while at < codes.len() {
        let count = usize::from(*packed.first()?);
        let (length, repeats) = if count >= 128 { (count - 126, true) } else { (count, false) };
        let codes = codes.get_mut(at..at + length)?;
        for (index, code) in codes.iter_mut().enumerate() {
            *code |= u32::from(*packed.get(1 + if repeats { 0 } else { index })?) << shift;
        }
        packed = packed.get(1 + if repeats { 1 } else { length }..)?;
        at += length;
    }
    Some(packed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Header, Resolution, RgbPrimaries, read_tiff, read_tiff_pixels};
    use glam::DVec3;

    fn values() -> Vec<f32> {
        (0..3 * 200 * 5).map(|index| 10f32.powf((index % 37) as f32 / 6.0 - 3.0) + (index / 600) as f32).collect()
    }

    /// A picture of these red, green and blue values.
    fn picture(values: &[f32], header: Option<Header>) -> Tiff {
        let to_xyz = RgbPrimaries::STANDARD.rgb_to_xyz().unwrap();
        let xyz = values.chunks(3).flat_map(|rgb| {
            (to_xyz * DVec3::from([0, 1, 2].map(|i| f64::from(rgb[i])))).to_array().map(|value| value as f32)
        });
        Tiff {
            resolution: Resolution::standard(200, 5),
            components: 3,
            pixels: TiffPixels::Floats(xyz.collect()),
            colors: TiffColors::Xyz,
            tags: TiffTags { nits: Some(71.6), ..TiffTags::default() },
            header,
        }
    }

    #[test]
    fn colours_survive_within_the_steps_of_the_code() {
        let values = values();
        let bytes = write(&picture(&values, Some(Header::new("RADIANCE")))).unwrap();
        let read = read_tiff_pixels(&bytes).unwrap();
        assert_eq!((read.resolution, read.components, read.colors), (Resolution::standard(200, 5), 3, TiffColors::Xyz));
        assert_eq!(read.tags.nits, Some(71.6));
        let (image, header) = read_tiff(&bytes).unwrap();
        assert!(header.is_some());
        for (found, value) in image.pixels().zip(values.chunks(3)) {
            let largest = value.iter().copied().fold(0.0, f32::max);
            for band in 0..3 {
                assert!((found[band] - value[band]).abs() < 0.04 * largest, "{found:?} for {value:?}");
            }
        }
    }

    #[test]
    fn colours_outside_the_gamut_keep_their_tristimulus_values() {
        let xyz = [0.1f32, 0.5, 0.05];
        let mut picture = picture(&values(), None);
        picture.pixels = TiffPixels::Floats(xyz.repeat(1000));
        let TiffPixels::Floats(read) = read_tiff_pixels(&write(&picture).unwrap()).unwrap().pixels else {
            panic!("floats")
        };
        assert!(read.iter().zip(xyz.iter().cycle()).all(|(a, b)| (a - b).abs() < 0.01), "{:?}", &read[..3]);
    }

    #[test]
    fn broken_files_are_refused() {
        let bytes = write(&picture(&values(), None)).unwrap();
        // The data at the very end are not needed to read the pixels.
        for length in (8..bytes.len() - 112).step_by(7) {
            assert!(read_tiff_pixels(&bytes[..length]).is_err(), "{length}");
        }
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 0x55;
            let _ = read_tiff_pixels(&changed);
        }
    }
}
