//! Float matrices: a Radiance header, then plain numbers. The lossless form of a picture.
//!
//! The header has `FORMAT=` `ascii` (the default), `float` or `double`, `NCOMP=` (default 3), and
//! either `NROWS=` and `NCOLS=` or, after the header, a resolution line. Rows start at the top, as
//! `pvalue` writes them in standard orientation; other orientations are converted. `BigEndian=1`
//! declares big-endian binary values. A matrix with `NCOLS=` but without `NROWS=` extends to the
//! end of the file.

use crate::error::shown;
use crate::pfm::binary_values;
use crate::{Header, Image, PictureError, Resolution};
use radsight_units::number::{is_space, leading_number, put_scientific};

/// How the numbers of a matrix are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MatrixFormat {
    /// Decimal text, eight digits when written.
    Ascii,
    /// Single precision.
    Float,
    /// Double precision.
    Double,
}

impl MatrixFormat {
    /// The value of the `FORMAT=` line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            MatrixFormat::Ascii => "ascii",
            MatrixFormat::Float => "float",
            MatrixFormat::Double => "double",
        }
    }

    fn from_header(header: &Header) -> Result<MatrixFormat, PictureError> {
        let Some(assignment) = header.assignments("FORMAT").last() else { return Ok(MatrixFormat::Ascii) };
        match assignment.value.as_ref() {
            "ascii" => Ok(MatrixFormat::Ascii),
            "float" => Ok(MatrixFormat::Float),
            "double" => Ok(MatrixFormat::Double),
            other => Err(PictureError::HeaderValue {
                line: assignment.line,
                name: "FORMAT",
                value: other.chars().take(60).collect(),
                expected: "ascii, float or double for a matrix",
            }),
        }
    }
}

/// The numbers of a matrix in the precision of the file; text is read in double precision.
#[derive(Clone, Debug, PartialEq)]
pub enum MatrixValues {
    /// Single precision.
    F32(Image<f32>),
    /// Double precision.
    F64(Image<f64>),
}

/// A float matrix, as stored: multiply by [`Header::radiance_scale`] to undo EXPOSURE and
/// COLORCORR.
///
/// ```
/// use radsight_picture::{FloatMatrix, Header, Image, MatrixFormat};
/// let image = Image::new(2, 1, 1, vec![0.1f32, 7e-9]).unwrap();
/// let bytes = FloatMatrix::write_f32(&Header::new("RADIANCE"), &image, MatrixFormat::Float);
/// assert_eq!(FloatMatrix::read(&bytes).unwrap().into_f32(), image);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FloatMatrix {
    /// All lines of the header, including those that describe the storage.
    pub header: Header,
    /// How the numbers were stored.
    pub format: MatrixFormat,
    /// The numbers.
    pub values: MatrixValues,
}

impl FloatMatrix {
    /// Reads a matrix; bytes after it are ignored, as in Radiance.
    ///
    /// # Errors
    /// When the header does not describe a matrix, or the numbers end too early.
    pub fn read(bytes: &[u8]) -> Result<FloatMatrix, PictureError> {
        Ok(FloatMatrix::read_first(bytes)?.0)
    }

    /// Reads the matrix at the start of the bytes. Also returns its length in bytes.
    ///
    /// # Errors
    /// As [`FloatMatrix::read`].
    pub fn read_first(bytes: &[u8]) -> Result<(FloatMatrix, usize), PictureError> {
        let (header, start) = Header::read(bytes)?;
        let format = MatrixFormat::from_header(&header)?;
        let components = header.components()?.unwrap_or(3);
        let big_endian = header.is_big_endian().unwrap_or(false);
        let (resolution, start) = resolution(&header, bytes, start, components, format)?;
        let size = (resolution.width, resolution.height, components);
        let (values, used) = match format {
            MatrixFormat::Ascii => {
                let (numbers, used) = ascii_values(bytes, start, size)?;
                (MatrixValues::F64(resolution.upright(components, numbers)?), used)
            }
            MatrixFormat::Float => {
                let stored = binary_values(bytes, start, size, 4)?;
                let decode = if big_endian { f32::from_be_bytes } else { f32::from_le_bytes };
                let numbers = stored.as_chunks().0.iter().map(|value| decode(*value)).collect();
                (MatrixValues::F32(resolution.upright(components, numbers)?), start + stored.len())
            }
            MatrixFormat::Double => {
                let stored = binary_values(bytes, start, size, 8)?;
                let decode = if big_endian { f64::from_be_bytes } else { f64::from_le_bytes };
                let numbers = stored.as_chunks().0.iter().map(|value| decode(*value)).collect();
                (MatrixValues::F64(resolution.upright(components, numbers)?), start + stored.len())
            }
        };
        Ok((FloatMatrix { header, format, values }, used))
    }

    /// The values in single precision.
    #[must_use]
    pub fn into_f32(self) -> Image<f32> {
        match self.values {
            MatrixValues::F32(image) => image,
            MatrixValues::F64(image) => image.map(|value| value as f32),
        }
    }

    /// The values in double precision.
    #[must_use]
    pub fn into_f64(self) -> Image<f64> {
        match self.values {
            MatrixValues::F32(image) => image.map(f64::from),
            MatrixValues::F64(image) => image,
        }
    }

    /// Writes single-precision values. Lines of `header` that describe the storage are replaced.
    #[must_use]
    pub fn write_f32(header: &Header, image: &Image<f32>, format: MatrixFormat) -> Vec<u8> {
        let mut out = begin(header, (image.width(), image.height(), image.components()), format);
        match format {
            MatrixFormat::Ascii => write_ascii(&mut out, image.rows(), image.components(), |value| f64::from(*value)),
            MatrixFormat::Float => out.extend(image.data().iter().flat_map(|value| value.to_le_bytes())),
            MatrixFormat::Double => out.extend(image.data().iter().flat_map(|value| f64::from(*value).to_le_bytes())),
        }
        out
    }

    /// Writes double-precision values. Lines of `header` that describe the storage are replaced.
    #[must_use]
    pub fn write_f64(header: &Header, image: &Image<f64>, format: MatrixFormat) -> Vec<u8> {
        let mut out = begin(header, (image.width(), image.height(), image.components()), format);
        match format {
            MatrixFormat::Ascii => write_ascii(&mut out, image.rows(), image.components(), |value| *value),
            MatrixFormat::Float => out.extend(image.data().iter().flat_map(|value| (*value as f32).to_le_bytes())),
            MatrixFormat::Double => out.extend(image.data().iter().flat_map(|value| value.to_le_bytes())),
        }
        out
    }
}

fn resolution(
    header: &Header,
    bytes: &[u8],
    start: usize,
    components: usize,
    format: MatrixFormat,
) -> Result<(Resolution, usize), PictureError> {
    match (header.count("NCOLS")?, header.count("NROWS")?) {
        (Some(columns), Some(rows)) => Ok((Resolution::standard(columns, rows), start)),
        (Some(columns), None) => {
            let rest = &bytes[start..];
            let values = match format {
                MatrixFormat::Ascii => words(rest).count(),
                MatrixFormat::Float => rest.len() / 4,
                MatrixFormat::Double => rest.len() / 8,
            };
            match values.checked_div(columns.saturating_mul(components)) {
                Some(rows) if rows > 0 => Ok((Resolution::standard(columns, rows), start)),
                _ => Err(PictureError::Truncated { offset: bytes.len(), expected: "at least one whole row".into() }),
            }
        }
        (None, _) => Resolution::read(bytes, start),
    }
}

fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(|byte| is_space(*byte)).filter(|word| !word.is_empty())
}

fn ascii_values(
    bytes: &[u8],
    start: usize,
    (width, height, components): (usize, usize, usize),
) -> Result<(Vec<f64>, usize), PictureError> {
    let rest = &bytes[start..];
    // A number takes at least a digit and a space, except the last.
    let count = width.checked_mul(height).and_then(|pixels| pixels.checked_mul(components));
    let Some(count) = count.filter(|count| *count <= rest.len() / 2 + 1) else {
        let (width, height, components) = (width as u64, height as u64, components as u64);
        return Err(PictureError::TooLarge { offset: start, width, height, components, available: rest.len() });
    };
    let mut numbers = Vec::with_capacity(count);
    let mut at = start;
    while numbers.len() < count {
        at += bytes[at..].iter().take_while(|byte| is_space(**byte)).count();
        let word = words(&bytes[at..]).next().unwrap_or(&[]);
        let (number, used) = leading_number(word);
        if used == 0 || used != word.len() {
            let expected = format!("number {} of {count}", numbers.len() + 1).into();
            return Err(PictureError::Unexpected { offset: at, expected, found: shown(word) });
        }
        numbers.push(number);
        at += used;
    }
    Ok((numbers, at))
}

/// The header with the description of the storage at its end, padded so that binary values are
/// aligned.
fn begin(header: &Header, (width, height, components): (usize, usize, usize), format: MatrixFormat) -> Vec<u8> {
    let mut described = header.history();
    if described.is_empty() {
        described = Header::new("RADIANCE");
    }
    described.push_variable("NROWS", &height.to_string());
    described.push_variable("NCOLS", &width.to_string());
    described.push_variable("NCOMP", &components.to_string());
    if let (true, Some(splits)) = (components > 3, header.variable("WAVELENGTH_SPLITS")) {
        described.push_variable("WAVELENGTH_SPLITS", &splits);
    }
    if format != MatrixFormat::Ascii {
        described.push_variable("BigEndian", "0");
    }
    let mut out = described.to_bytes();
    // The empty line comes after FORMAT.
    out.pop();
    out.extend_from_slice(b"FORMAT=");
    out.extend_from_slice(format.name().as_bytes());
    let alignment = match format {
        MatrixFormat::Ascii => 1,
        MatrixFormat::Float => 4,
        MatrixFormat::Double => 8,
    };
    while !(out.len() + 2).is_multiple_of(alignment) {
        out.push(b' ');
    }
    out.extend_from_slice(b"\n\n");
    out
}

fn write_ascii<'a, T: 'a>(
    out: &mut Vec<u8>,
    rows: impl Iterator<Item = &'a [T]>,
    components: usize,
    number: impl Fn(&T) -> f64,
) {
    const DIGITS: usize = 7;
    for row in rows {
        for pixel in row.chunks_exact(components) {
            for value in pixel {
                out.push(b' ');
                put_scientific(number(value), DIGITS, out);
            }
            out.push(b'\t');
        }
        out.push(b'\n');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_survives_a_round_trip() {
        let image = Image::new(3, 2, 2, (0..12).map(|i| f64::from(i) * 0.1 - 0.3).collect()).unwrap();
        let header = Header::new("RADIANCE");
        let double = FloatMatrix::write_f64(&header, &image, MatrixFormat::Double);
        assert_eq!(FloatMatrix::read(&double).unwrap().into_f64(), image);
        assert!((double.len() - 12 * 8).is_multiple_of(8), "values are aligned");
        let single = image.clone().map(|value| value as f32);
        let float = FloatMatrix::write_f64(&header, &image, MatrixFormat::Float);
        assert_eq!(FloatMatrix::read(&float).unwrap().into_f32(), single);
        let ascii =
            FloatMatrix::read(&FloatMatrix::write_f32(&header, &single, MatrixFormat::Ascii)).unwrap().into_f32();
        assert!(ascii.data().iter().zip(single.data()).all(|(a, b)| (a - b).abs() <= 1e-7 * b.abs()));
    }

    #[test]
    fn big_endian_and_a_resolution_line_are_honoured() {
        let bytes = b"#?RADIANCE\nNCOMP=1\nBigEndian=1\nFORMAT=float   \n\n+Y 2 +X 1\n\x3f\x80\0\0\x40\0\0\0";
        assert_eq!(FloatMatrix::read(bytes).unwrap().into_f32().data(), [2.0, 1.0]);
    }

    #[test]
    fn rows_without_a_count_go_on_to_the_end() {
        let bytes = b"#?RADIANCE\nNCOLS=2\nNCOMP=1\nFORMAT=ascii\n\n1 2\n3 4\n5 6\n";
        let (matrix, used) = FloatMatrix::read_first(bytes).unwrap();
        assert_eq!((matrix.into_f64().height(), used), (3, bytes.len() - 1));
    }

    #[test]
    fn hostile_sizes_fail_at_once() {
        for format in ["ascii", "float", "double"] {
            let text = format!("#?RADIANCE\nNROWS=1000000000\nNCOLS=1000000000\nFORMAT={format}\n\n1 2 3");
            assert!(matches!(FloatMatrix::read(text.as_bytes()), Err(PictureError::TooLarge { .. })));
        }
        let error = FloatMatrix::read(b"#?RADIANCE\nNROWS=1\nNCOLS=1\n\n1 x 3").unwrap_err();
        assert_eq!(error.to_string(), "byte 30: expected number 2 of 3, found \"x\"");
    }
}
