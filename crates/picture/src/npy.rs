//! NumPy arrays (`.npy`): single and double precision, row by row (C order).
//!
//! Layout: `\x93NUMPY`, two version bytes, the length of the header (two bytes in version 1, four
//! later, least significant first), a Python dictionary with `descr`, `fortran_order` and `shape`,
//! then the values. Source: the NumPy Enhancement Proposal 1.

use crate::error::shown;
use crate::pfm::binary_values;
use crate::{Image, PictureError};

const MAGIC: &[u8] = b"\x93NUMPY";

/// Reads an array of shape (height, width) or (height, width, components); shape (width) is one
/// row. Double precision is rounded to single.
///
/// # Errors
/// When the bytes are not such an array, or end too early.
pub fn read_npy(bytes: &[u8]) -> Result<Image<f32>, PictureError> {
    let Layout { start, shape, value } = layout(bytes)?;
    let values = binary_values(bytes, start, shape, value.size())?;
    let data = match value {
        Value::F32 { big_endian: false } => values.as_chunks().0.iter().map(|v| f32::from_le_bytes(*v)).collect(),
        Value::F32 { big_endian: true } => values.as_chunks().0.iter().map(|v| f32::from_be_bytes(*v)).collect(),
        Value::F64 { big_endian: false } => {
            values.as_chunks().0.iter().map(|v| f64::from_le_bytes(*v) as f32).collect()
        }
        Value::F64 { big_endian: true } => values.as_chunks().0.iter().map(|v| f64::from_be_bytes(*v) as f32).collect(),
    };
    Image::new(shape.0, shape.1, shape.2, data)
}

/// Writes an array of single-precision values of shape (height, width), with one component, or
/// (height, width, components).
///
/// ```
/// let image = radsight_picture::Image::new(1, 1, 1, vec![1.0f32]).unwrap();
/// assert_eq!(radsight_picture::write_npy(&image).len(), 128 + 4);
/// ```
#[must_use]
pub fn write_npy(image: &Image<f32>) -> Vec<u8> {
    let mut out = header("<f4", image.height(), image.width(), image.components());
    out.extend(image.data().iter().flat_map(|value| value.to_le_bytes()));
    out
}

/// Writes an array of double-precision values, shaped as by [`write_npy`].
#[must_use]
pub fn write_npy_f64(image: &Image<f64>) -> Vec<u8> {
    let mut out = header("<f8", image.height(), image.width(), image.components());
    out.extend(image.data().iter().flat_map(|value| value.to_le_bytes()));
    out
}

fn header(description: &str, height: usize, width: usize, components: usize) -> Vec<u8> {
    let depth = if components == 1 { String::new() } else { format!(", {components}") };
    let mut dictionary =
        format!("{{'descr': '{description}', 'fortran_order': False, 'shape': ({height}, {width}{depth}), }}");
    // The values begin at a multiple of 64 bytes, and the dictionary ends with a line end.
    let before = MAGIC.len() + 4;
    while !(before + dictionary.len() + 1).is_multiple_of(64) {
        dictionary.push(' ');
    }
    dictionary.push('\n');
    let length = u16::try_from(dictionary.len()).expect("three numbers and two names take less than 64 KiB");
    let mut out = MAGIC.to_vec();
    out.extend_from_slice(&[1, 0]);
    out.extend_from_slice(&length.to_le_bytes());
    out.extend_from_slice(dictionary.as_bytes());
    out
}

struct Layout {
    start: usize,
    /// Width, height, components.
    shape: (usize, usize, usize),
    value: Value,
}

#[derive(Clone, Copy)]
enum Value {
    F32 { big_endian: bool },
    F64 { big_endian: bool },
}

impl Value {
    fn size(self) -> usize {
        match self {
            Value::F32 { .. } => 4,
            Value::F64 { .. } => 8,
        }
    }
}

fn layout(bytes: &[u8]) -> Result<Layout, PictureError> {
    let truncated = || PictureError::Truncated { offset: bytes.len(), expected: "a whole npy header".into() };
    if !bytes.starts_with(MAGIC) {
        let expected = "\"\\x93NUMPY\"".into();
        return Err(PictureError::Unexpected { offset: 0, expected, found: shown(bytes) });
    }
    let version = *bytes.get(6).ok_or_else(truncated)?;
    let (first, length): (usize, usize) = match version {
        1 => {
            let length = bytes.get(8..10).and_then(|field| field.try_into().ok()).ok_or_else(truncated)?;
            (10, usize::from(u16::from_le_bytes(length)))
        }
        2 | 3 => {
            let length = bytes.get(8..12).and_then(|field| field.try_into().ok()).ok_or_else(truncated)?;
            (12, u32::from_le_bytes(length) as usize)
        }
        other => {
            let found = format!("{other}");
            return Err(PictureError::Unexpected { offset: 6, expected: "npy version 1, 2 or 3".into(), found });
        }
    };
    let dictionary = bytes.get(first..first.saturating_add(length)).ok_or_else(truncated)?;
    let dictionary = String::from_utf8_lossy(dictionary);
    let start = first + length;
    Ok(Layout { start, shape: shape(&dictionary, first)?, value: value(&dictionary, first)? })
}

/// The text after `'name':` in the dictionary.
fn entry<'a>(dictionary: &'a str, offset: usize, name: &'static str) -> Result<&'a str, PictureError> {
    let quoted = [format!("'{name}'"), format!("\"{name}\"")];
    let at = quoted.iter().find_map(|name| Some(dictionary.find(name.as_str())? + name.len()));
    match at.and_then(|at| dictionary[at..].trim_start().strip_prefix(':')) {
        Some(value) => Ok(value.trim_start()),
        None => {
            let expected = format!("an npy header with '{name}'").into();
            Err(PictureError::Unexpected { offset, expected, found: shown(dictionary.as_bytes()) })
        }
    }
}

fn value(dictionary: &str, offset: usize) -> Result<Value, PictureError> {
    let description = entry(dictionary, offset, "descr")?;
    let name = description.trim_start_matches(['\'', '"']);
    match name.get(..3) {
        Some("<f4") => Ok(Value::F32 { big_endian: false }),
        Some(">f4") => Ok(Value::F32 { big_endian: true }),
        Some("<f8") => Ok(Value::F64 { big_endian: false }),
        Some(">f8") => Ok(Value::F64 { big_endian: true }),
        _ => Err(PictureError::Unsupported {
            format: "npy",
            what: format!("values of type {}", shown(description.split(',').next().unwrap_or("").as_bytes())),
            expected: "f4 or f8",
        }),
    }
}

fn shape(dictionary: &str, offset: usize) -> Result<(usize, usize, usize), PictureError> {
    if !entry(dictionary, offset, "fortran_order")?.starts_with("False") {
        let what = "columns first (Fortran order)".to_owned();
        return Err(PictureError::Unsupported { format: "npy", what, expected: "rows first (C order)" });
    }
    let text = entry(dictionary, offset, "shape")?;
    let inner = text.strip_prefix('(').and_then(|text| text.split_once(')')).map_or("", |(inner, _)| inner);
    let sizes: Option<Vec<usize>> =
        inner.split(',').map(str::trim).filter(|size| !size.is_empty()).map(|size| size.parse().ok()).collect();
    match sizes.as_deref() {
        Some(&[width]) if width > 0 => Ok((width, 1, 1)),
        Some(&[height, width]) if height > 0 && width > 0 => Ok((width, height, 1)),
        Some(&[height, width, depth]) if height > 0 && width > 0 && depth > 0 => Ok((width, height, depth)),
        _ => Err(PictureError::Unsupported {
            format: "npy",
            what: format!("shape {}", shown(text.as_bytes())),
            expected: "(height, width) or (height, width, components), none of them 0",
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_survive_a_round_trip() {
        let image = Image::new(3, 2, 2, (0..12).map(|i| i as f32 * 0.1).collect()).unwrap();
        let bytes = write_npy(&image);
        assert_eq!((bytes.len() - 48) % 64, 0);
        assert_eq!(read_npy(&bytes).unwrap(), image);
        assert_eq!(read_npy(&write_npy_f64(&image.clone().map(f64::from))).unwrap(), image);
    }

    #[test]
    fn unsupported_arrays_are_named() {
        let swap = |from: &str, to: &str| {
            let image = Image::new(1, 1, 1, vec![0f32]).unwrap();
            String::from_utf8_lossy(&write_npy(&image)[10..]).replace(from, to)
        };
        let rebuilt = |dictionary: String| {
            [MAGIC, &[2, 0], &(dictionary.len() as u32).to_le_bytes(), dictionary.as_bytes()].concat()
        };
        let error = |from: &str, to: &str| read_npy(&rebuilt(swap(from, to))).unwrap_err().to_string();
        assert_eq!(error("<f4", "<i4"), "npy with values of type \"'<i4'\" is not supported, expected f4 or f8");
        assert_eq!(
            error("False", "True"),
            "npy with columns first (Fortran order) is not supported, expected rows first (C order)"
        );
        assert!(error("(1, 1)", "(0, 1)").contains("shape"));
        assert!(error("(1, 1)", "(99999999, 99999999999)").contains("declared"));
        assert!(read_npy(MAGIC).is_err() && read_npy(b"").is_err());
    }
}
