//! TIFF pictures in LogLuv: 32 bits per pixel for all luminances and colours.
//!
//! The upper half holds a sign and the logarithm of the luminance in steps of 2^(1/256). The lower
//! two bytes are the CIE 1976 chromaticities u′ and v′ times 410 (Ward Larson, "LogLuv Encoding for
//! Full-Gamut, High-Dynamic Range Images", Journal of Graphics Tools 3(1), 1998). A row is stored
//! as four planes of bytes, the most significant first, each run-length encoded (TIFF compression
//! 34676).

use crate::tiff_pixels::{Tiff, TiffPixels};
use crate::{Header, PictureError, RgbPrimaries, xyz_to_rgb};
use glam::DVec3;

/// TIFF codes of the compression and the photometric interpretation.
const COMPRESSION: u32 = 34_676;
const LOG_LUV: u32 = 32_845;

/// Tags in the order in which they are written.
const WIDTH: u16 = 256;
const HEIGHT: u16 = 257;
const BITS: u16 = 258;
const COMPRESSION_TAG: u16 = 259;
const PHOTOMETRIC: u16 = 262;
const DESCRIPTION: u16 = 270;
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

/// Writes RGB values in Radiance's primaries, row 0 at the top.
///
/// # Errors
/// [`PictureError::Shape`] unless there are three values per pixel, and less than 4 GB in all.
pub fn write_log_luv(
    (width, height): (usize, usize),
    rgb: &[f32],
    header: Option<&Header>,
) -> Result<Vec<u8>, PictureError> {
    let shape = PictureError::Shape {
        width,
        height,
        components: 3,
        values: rgb.len(),
        expected: "three values per pixel and fewer than 2^28 pixels",
    };
    let to_xyz = RgbPrimaries::STANDARD.rgb_to_xyz().ok_or(PictureError::Codec {
        format: "tiff",
        reason: "the primaries are collinear or the white is impossible".to_owned(),
    })?;
    if width == 0 || width.checked_mul(height).is_none_or(|pixels| pixels >= 1 << 28 || 3 * pixels != rgb.len()) {
        return Err(shape);
    }
    let mut bytes = b"II\x2a\0\0\0\0\0".to_vec();
    let mut strips = Vec::with_capacity(height);
    for row in rgb.chunks_exact(3 * width) {
        let start = bytes.len();
        let codes: Vec<u32> = row
            .chunks_exact(3)
            .map(|pixel| encode((to_xyz * DVec3::from_array([0, 1, 2].map(|band| f64::from(pixel[band])))).to_array()))
            .collect();
        for plane in (0..4).rev() {
            let plane: Vec<u8> = codes.iter().map(|code| (code >> (8 * plane)) as u8).collect();
            pack(&plane, &mut bytes);
        }
        strips.push((start as u32, (bytes.len() - start) as u32));
    }
    let directory = Directory { width: width as u32, height: height as u32, strips, header };
    directory.write(&mut bytes);
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

/// The data after the pixels.
struct Directory<'a> {
    width: u32,
    height: u32,
    /// Offset and length of each row.
    strips: Vec<(u32, u32)>,
    header: Option<&'a Header>,
}

impl Directory<'_> {
    fn write(&self, bytes: &mut Vec<u8>) {
        let mut entries: Vec<(u16, u16, Vec<u32>)> = vec![
            (WIDTH, 4, vec![self.width]),
            (HEIGHT, 4, vec![self.height]),
            (COMPRESSION_TAG, 3, vec![COMPRESSION]),
            (PHOTOMETRIC, 3, vec![LOG_LUV]),
            (STRIP_OFFSETS, 4, self.strips.iter().map(|strip| strip.0).collect()),
            (SAMPLES, 3, vec![3]),
            (ROWS_A_STRIP, 4, vec![1]),
            (STRIP_BYTES, 4, self.strips.iter().map(|strip| strip.1).collect()),
            (PLANAR, 3, vec![1]),
        ];
        let text = self.header.map(|header| {
            let text: Vec<u8> = header.to_text().bytes().filter(u8::is_ascii).chain([0]).collect();
            let offset = bytes.len() as u32;
            bytes.extend_from_slice(&text);
            (offset, text.len() as u32)
        });
        let bits = bytes.len() as u32;
        bytes.extend_from_slice(&[16, 0, 16, 0, 16, 0]);
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        let mut directory = Vec::new();
        for (tag, kind, values) in &mut entries {
            let count = values.len() as u32;
            let value = if count == 1 {
                values[0]
            } else {
                let offset = bytes.len() as u32;
                values.iter().for_each(|value| bytes.extend_from_slice(&value.to_le_bytes()));
                offset
            };
            directory.push((*tag, *kind, count, value));
        }
        directory.push((BITS, 3, 3, bits));
        directory.extend(text.map(|(offset, length)| (DESCRIPTION, 2, length, offset)));
        directory.sort_unstable();
        let start = bytes.len() as u32;
        bytes[4..8].copy_from_slice(&start.to_le_bytes());
        bytes.extend_from_slice(&(directory.len() as u16).to_le_bytes());
        for (tag, kind, count, value) in directory {
            bytes.extend_from_slice(&tag.to_le_bytes());
            bytes.extend_from_slice(&kind.to_le_bytes());
            bytes.extend_from_slice(&count.to_le_bytes());
            bytes.extend_from_slice(&value.to_le_bytes());
        }
        bytes.extend_from_slice(&[0; 4]);
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

    /// The values of a tag, and their offset.
    fn tag(&self, tag: u16) -> Option<(Vec<u32>, usize)> {
        let directory = self.number(4, 4)? as usize;
        let entries = self.number(directory, 2)? as usize;
        let entry = (0..entries)
            .map(|index| directory + 2 + 12 * index)
            .find(|entry| self.number(*entry, 2) == Some(u32::from(tag)))?;
        let size = match self.number(entry + 2, 2)? {
            1 | 2 => 1,
            3 => 2,
            4 => 4,
            _ => return None,
        };
        let count = self.number(entry + 4, 4)? as usize;
        let offset = if count.checked_mul(size)? <= 4 { entry + 8 } else { self.number(entry + 8, 4)? as usize };
        // Check the length before allocating memory.
        self.bytes.get(offset..offset.checked_add(count * size)?)?;
        let numbers = (0..count).filter_map(|index| self.number(offset + index * size, size)).collect();
        Some((numbers, offset))
    }

    fn one(&self, tag: u16) -> Option<u32> {
        self.tag(tag)?.0.first().copied()
    }
}

/// Reads a LogLuv picture as RGB in Radiance's primaries; `None` for any other file.
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
    let (offsets, lengths) = (file.tag(STRIP_OFFSETS)?.0, file.tag(STRIP_BYTES)?.0);
    // A row of four planes takes at least eight bytes per 127 pixels.
    let least = height.checked_mul(8 * width.div_ceil(129))?;
    if width == 0
        || least > file.bytes.len()
        || offsets.len() != height.div_ceil(rows)
        || lengths.len() != offsets.len()
    {
        return None;
    }
    let to_rgb = RgbPrimaries::STANDARD.xyz_to_rgb()?;
    let mut values = Vec::with_capacity(3 * width * height);
    for (strip, (offset, length)) in offsets.iter().zip(&lengths).enumerate() {
        let mut packed = file.bytes.get(*offset as usize..(*offset as usize).checked_add(*length as usize)?)?;
        for _ in 0..rows.min(height - strip * rows) {
            let mut codes = vec![0u32; width];
            for plane in (0..4).rev() {
                packed = unpack(packed, 8 * plane, &mut codes)?;
            }
            for code in codes {
                values.extend_from_slice(&xyz_to_rgb(&to_rgb, decode(code).map(|value| value as f32)));
            }
        }
    }
    let header = file.tag(DESCRIPTION).map(|(numbers, offset)| {
        let text = &file.bytes[offset..offset + numbers.len()];
        text.split(|byte| *byte == 0).next().unwrap_or_default().to_vec()
    });
    let header = header.filter(|text| text.starts_with(b"#?")).map(|text| Header::read_text(&text));
    Some(Tiff { width, height, components: 3, pixels: TiffPixels::Floats(values), header, date: None })
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
    use crate::read_tiff_pixels;

    fn values() -> Vec<f32> {
        (0..3 * 200 * 5).map(|index| 10f32.powf((index % 37) as f32 / 6.0 - 3.0) + (index / 600) as f32).collect()
    }

    #[test]
    fn colours_survive_within_the_steps_of_the_code() {
        let values = values();
        let bytes = write_log_luv((200, 5), &values, Some(&Header::new("RADIANCE"))).unwrap();
        let picture = read_tiff_pixels(&bytes).unwrap();
        assert_eq!((picture.width, picture.height, picture.components), (200, 5, 3));
        assert!(picture.header.is_some());
        let TiffPixels::Floats(found) = picture.pixels else { panic!("floats") };
        for (found, value) in found.chunks(3).zip(values.chunks(3)) {
            let largest = value.iter().copied().fold(0.0, f32::max);
            for band in 0..3 {
                assert!((found[band] - value[band]).abs() < 0.04 * largest, "{found:?} for {value:?}");
            }
        }
    }

    #[test]
    fn broken_files_are_refused() {
        let bytes = write_log_luv((200, 5), &values(), None).unwrap();
        // The data at the very end are not needed to read the pixels.
        for length in (8..bytes.len() - 64).step_by(7) {
            assert!(read_tiff_pixels(&bytes[..length]).is_err(), "{length}");
        }
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 0x55;
            let _ = read_tiff_pixels(&changed);
        }
    }
}
