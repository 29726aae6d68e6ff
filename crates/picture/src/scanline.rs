//! The three encodings of a scanline: flat, old and new run-length.
//!
//! - **New**: the bytes 2, 2 and the length (high byte below 128), then each component byte as a
//!   plane (all first mantissas, then all second ones …). A count above 128 repeats the next byte
//!   (count − 128) times; a count up to 128 precedes that many literal bytes.
//! - **Old**: interleaved pixels; (1, 1, 1, n) repeats the previous pixel n times, and n · 256
//!   times directly after another repeat, and so on.
//! - **Flat**: interleaved pixels. It is an old scanline without repeats.
//!
//! Source: G. Ward, "Real Pixels", Graphics Gems II, 1991, and the behaviour of Radiance's
//! programs.

use crate::PictureError;
use crate::rgbe::{decode_rgbe, encode_rgbe};

/// Size of an RGBE or XYZE pixel, bytes.
pub(crate) const PIXEL: usize = 4;
/// Shortest scanline to be run-length encoded.
const SHORTEST_ENCODED: usize = 17;
/// Longest scanline that the new encoding supports.
const LONGEST_ENCODED: usize = 0x7fff;
/// Shortest run that saves space.
const SHORTEST_RUN: usize = 4;
/// Longest run of one count.
const LONGEST_RUN: usize = 127;
/// Longest literal sequence of one count.
const LONGEST_STRETCH: usize = 128;

/// Decodes the scanline at `offset` into `row` (four bytes per pixel); returns the offset after it.
pub(crate) fn read(bytes: &[u8], offset: usize, row: &mut [u8], planes: &mut Vec<u8>) -> Result<usize, PictureError> {
    let Some(first) = bytes.get(offset..offset + PIXEL) else { return Err(truncated(bytes)) };
    if first[0] != 2 || first[1] != 2 || first[2] >= 128 {
        return read_old(bytes, offset, row);
    }
    let (length, width) = (usize::from(first[2]) << 8 | usize::from(first[3]), row.len() / PIXEL);
    if length != width {
        let expected = format!("a scanline of {width} pixels").into();
        return Err(PictureError::Unexpected { offset, expected, found: format!("one of {length}") });
    }
    planes.resize(row.len(), 0);
    let mut at = offset + PIXEL;
    for plane in planes.chunks_exact_mut(width) {
        at = read_plane(bytes, at, plane)?;
    }
    interleave(planes, row);
    Ok(at)
}

fn read_plane(bytes: &[u8], mut at: usize, plane: &mut [u8]) -> Result<usize, PictureError> {
    let mut filled = 0;
    while filled < plane.len() {
        let Some(&count) = bytes.get(at) else { return Err(truncated(bytes)) };
        let length = usize::from(if count > 128 { count & 127 } else { count });
        let left = plane.len() - filled;
        let Some(target) = plane.get_mut(filled..filled + length) else {
            let expected = format!("a count of at most {left} pixels").into();
            return Err(PictureError::Unexpected { offset: at, expected, found: length.to_string() });
        };
        if count > 128 {
            let Some(&value) = bytes.get(at + 1) else { return Err(truncated(bytes)) };
            target.fill(value);
            at += 2;
        } else {
            let Some(source) = bytes.get(at + 1..at + 1 + length) else { return Err(truncated(bytes)) };
            target.copy_from_slice(source);
            at += 1 + length;
        }
        filled += length;
    }
    Ok(at)
}

fn interleave(planes: &[u8], row: &mut [u8]) {
    let width = row.len() / PIXEL;
    let (first, rest) = planes.split_at(width);
    let (second, rest) = rest.split_at(width);
    let (third, fourth) = rest.split_at(width);
    let sources = first.iter().zip(second).zip(third).zip(fourth);
    for (pixel, (((a, b), c), d)) in row.as_chunks_mut::<PIXEL>().0.iter_mut().zip(sources) {
        *pixel = [*a, *b, *c, *d];
    }
}

/// Decodes an old or flat scanline. The first pixel is never a repeat; a repeat past the end of the
/// scanline is truncated.
fn read_old(bytes: &[u8], offset: usize, row: &mut [u8]) -> Result<usize, PictureError> {
    let pixels = row.as_chunks_mut::<PIXEL>().0;
    let (mut at, mut filled, mut shift) = (offset, 0, 0u32);
    while filled < pixels.len() {
        let Some(&pixel) = bytes[at..].first_chunk::<PIXEL>() else { return Err(truncated(bytes)) };
        at += PIXEL;
        if filled > 0 && pixel[..3] == [1, 1, 1] {
            let count =
                usize::from(pixel[3]).checked_shl(shift).filter(|count| count >> shift == usize::from(pixel[3]));
            let end = count.map_or(pixels.len(), |count| pixels.len().min(filled.saturating_add(count)));
            let repeated = pixels[filled - 1];
            pixels[filled..end].fill(repeated);
            filled = end;
            shift = shift.saturating_add(8).min(56);
        } else {
            pixels[filled] = pixel;
            filled += 1;
            shift = 0;
        }
    }
    Ok(at)
}

fn truncated(bytes: &[u8]) -> PictureError {
    PictureError::Truncated { offset: bytes.len(), expected: "more pixels".into() }
}

/// Writes a scanline in the new encoding if its length allows, otherwise flat. The bytes equal
/// Radiance's, except for flat scanlines whose pixels would be misread.
pub(crate) fn write(row: &[u8], out: &mut Vec<u8>, plane: &mut Vec<u8>) {
    let width = row.len() / PIXEL;
    if !(SHORTEST_ENCODED..=LONGEST_ENCODED).contains(&width) {
        if is_clear_when_flat(row) {
            out.extend_from_slice(row);
            return;
        }
        if width > LONGEST_ENCODED {
            let pixels = row.as_chunks::<PIXEL>().0.iter();
            out.extend(pixels.flat_map(|pixel| encode_rgbe(decode_rgbe(*pixel))));
            return;
        }
    }
    out.extend_from_slice(&[2, 2, (width >> 8) as u8, (width & 0xff) as u8]);
    for component in 0..PIXEL {
        plane.clear();
        plane.extend(row.iter().skip(component).step_by(PIXEL));
        write_plane(plane, out);
    }
}

/// Encodes a scanline of RGB (or XYZ) values and appends it to `out`, for programs that write a
/// picture incrementally.
pub fn write_rgbe_scanline(values: &[[f32; 3]], out: &mut Vec<u8>) {
    let row: Vec<u8> = values.iter().flat_map(|value| encode_rgbe(*value)).collect();
    write(&row, out, &mut Vec::new());
}

/// Whether a flat scanline cannot be misread as a new one, nor its pixels as repeats. This is
/// possible only for unnormalised pixels.
fn is_clear_when_flat(row: &[u8]) -> bool {
    let pixels = row.as_chunks::<PIXEL>().0;
    let is_mark = |pixel: &[u8; PIXEL]| pixel[..2] == [2, 2] && pixel[2] < 128;
    !pixels.first().is_some_and(is_mark) && !pixels.iter().any(|pixel| pixel[..3] == [1, 1, 1])
}

fn write_plane(plane: &[u8], out: &mut Vec<u8>) {
    let mut rest = plane;
    while !rest.is_empty() {
        let run_at = next_run(rest);
        let (stretch, run) = rest.split_at(run_at);
        write_stretch(stretch, out);
        let length = run.iter().take(LONGEST_RUN).take_while(|byte| **byte == run[0]).count();
        if length > 0 {
            out.extend_from_slice(&[128 + length as u8, run[0]]);
        }
        rest = &run[length..];
    }
}

/// Start of the next run that is long enough, or the length if there is none.
fn next_run(bytes: &[u8]) -> usize {
    bytes.windows(SHORTEST_RUN).position(|four| four[1..] == four[..SHORTEST_RUN - 1]).unwrap_or(bytes.len())
}

fn write_stretch(stretch: &[u8], out: &mut Vec<u8>) {
    // Two or three equal bytes take two bytes as a run, but three or four as literals.
    if (2..SHORTEST_RUN).contains(&stretch.len()) && stretch.iter().all(|byte| *byte == stretch[0]) {
        out.extend_from_slice(&[128 + stretch.len() as u8, stretch[0]]);
        return;
    }
    for part in stretch.chunks(LONGEST_STRETCH) {
        out.push(part.len() as u8);
        out.extend_from_slice(part);
    }
}

/// Whether this many bytes can hold this many scanlines in any encoding. `pixels` holds the
/// encoded pixels.
pub(crate) fn can_hold(width: usize, scanlines: usize, pixels: &[u8]) -> bool {
    // Only a scanline of one pixel can be as short as one pixel; a longer old one needs at least
    // one repeat.
    let shortest = if width == 1 { PIXEL } else { 2 * PIXEL };
    scanlines.checked_mul(shortest).is_some_and(|least| least <= pixels.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(bytes: &[u8], width: usize) -> Result<Vec<u8>, PictureError> {
        let mut row = vec![0; width * PIXEL];
        let used = read(bytes, 0, &mut row, &mut Vec::new())?;
        assert_eq!(used, bytes.len());
        Ok(row)
    }

    #[test]
    fn old_repeats_grow_by_bytes() {
        let pixel = [9, 8, 7, 6];
        let repeats = [&pixel[..], &[1, 1, 1, 3], &[1, 1, 1, 1], &[5, 5, 5, 5]].concat();
        let row = decoded(&repeats, 1 + 3 + 256 + 1).unwrap();
        assert!(row.chunks(4).take(260).all(|p| p == pixel));
        assert_eq!(row[260 * 4..], [5, 5, 5, 5]);
        // The excess of a repeat past the end is dropped, and so is a repeat whose count overflows.
        assert_eq!(decoded(&[&pixel[..], &[1, 1, 1, 200]].concat(), 3).unwrap(), pixel.repeat(3));
        let endless = [&pixel[..], &[1, 1, 1, 0].repeat(12), &[1, 1, 1, 1]].concat();
        assert_eq!(decoded(&endless, 3).unwrap(), pixel.repeat(3));
    }

    #[test]
    fn the_first_pixel_is_never_a_repeat() {
        assert_eq!(decoded(&[1, 1, 1, 7, 1, 1, 1, 1], 2).unwrap(), [1, 1, 1, 7].repeat(2));
    }

    #[test]
    fn overruns_and_ends_are_errors() {
        assert!(decoded(&[2, 2, 0, 3, 131, 9], 3).is_err());
        let error = decoded(&[2, 2, 0, 3, 132, 9], 3).unwrap_err();
        assert_eq!(error.to_string(), "byte 4: expected a count of at most 3 pixels, found 4");
        let error = decoded(&[2, 2, 0, 4, 132, 9], 3).unwrap_err();
        assert_eq!(error.to_string(), "byte 0: expected a scanline of 3 pixels, found one of 4");
        assert!(decoded(&[2, 2, 0, 3, 3, 9, 9], 3).is_err());
        assert!(decoded(&[2, 2], 3).is_err());
    }

    #[test]
    fn pixels_that_resemble_marks_survive_in_short_scanlines() {
        for row in
            [vec![2, 2, 0, 3, 9, 9, 9, 9, 8, 8, 8, 8], vec![200, 0, 0, 9, 1, 1, 1, 7, 1, 1, 1, 7], vec![2, 2, 0, 1]]
        {
            let mut out = Vec::new();
            write(&row, &mut out, &mut Vec::new());
            assert_eq!(decoded(&out, row.len() / PIXEL).unwrap(), row);
        }
        let wide = [1, 1, 1, 140].repeat(LONGEST_ENCODED + 1);
        let mut out = Vec::new();
        write(&wide, &mut out, &mut Vec::new());
        assert_eq!(decoded(&out, LONGEST_ENCODED + 1).unwrap(), [192, 192, 192, 133].repeat(LONGEST_ENCODED + 1));
    }

    #[test]
    fn stretches_and_runs_are_written_as_radiance_writes_them() {
        let encoded = |plane: &[u8]| {
            let mut out = Vec::new();
            write_plane(plane, &mut out);
            out
        };
        assert_eq!(encoded(&[7, 7, 5, 5, 5, 5]), [130, 7, 132, 5]);
        assert_eq!(encoded(&[7, 8, 5, 5, 5, 5]), [2, 7, 8, 132, 5]);
        assert_eq!(encoded(&[7, 5, 5, 5, 5, 9]), [1, 7, 132, 5, 1, 9]);
        assert_eq!(encoded(&[3; 130]), [255, 3, 131, 3]);
        let long: Vec<u8> = (0..130).collect();
        assert_eq!(encoded(&long), [&[128][..], &long[..128], &[2, 128, 129]].concat());
    }
}
