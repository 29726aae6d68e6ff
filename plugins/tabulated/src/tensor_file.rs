//! The container of RGL's files: named arrays of numbers.
//!
//! "tensor_file" and a zero byte, version (2 bytes), number of fields (u32), and for each field:
//! length of its name (u16), name, number of dimensions (u16), type (u8), offset (u64), sizes (u64
//! each). All little-endian.

/// One array.
#[derive(Clone, Debug)]
pub(crate) struct Field {
    pub(crate) name: String,
    pub(crate) shape: Vec<usize>,
    pub(crate) numbers: Vec<f32>,
}

const MAGIC: &[u8] = b"tensor_file\0";
const MOST_FIELDS: u32 = 256;
const MOST_DIMENSIONS: u16 = 8;

/// Types of numbers in a file.
const UINT8: u8 = 1;
const FLOAT32: u8 = 10;
const FLOAT64: u8 = 11;

struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let end = self.at.checked_add(count).filter(|&end| end <= self.bytes.len());
        let end = end.ok_or_else(|| format!("it ends in its table of contents, at byte {}", self.bytes.len()))?;
        let part = &self.bytes[self.at..end];
        self.at = end;
        Ok(part)
    }

    fn number(&mut self, bytes: usize) -> Result<u64, String> {
        Ok(self.take(bytes)?.iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte)))
    }
}

/// All arrays of floating-point numbers in a file; others are ignored.
pub(crate) fn read(bytes: &[u8]) -> Result<Vec<Field>, String> {
    let mut cursor = Cursor { bytes, at: 0 };
    if !bytes.starts_with(MAGIC) {
        return Err("it is no RGL file: it does not begin with \"tensor_file\"".to_owned());
    }
    cursor.take(MAGIC.len())?;
    let version = (cursor.number(1)?, cursor.number(1)?);
    if version != (1, 0) {
        return Err(format!("it has version {}.{} of the tensor format, expected 1.0", version.0, version.1));
    }
    let count = cursor.number(4)? as u32;
    if count > MOST_FIELDS {
        return Err(format!("it has {count} fields, expected at most {MOST_FIELDS}"));
    }
    let mut fields = Vec::new();
    for _ in 0..count {
        let name_length = cursor.number(2)? as usize;
        let name = String::from_utf8_lossy(cursor.take(name_length)?).into_owned();
        let dimensions = cursor.number(2)? as u16;
        if dimensions > MOST_DIMENSIONS {
            return Err(format!("field \"{name}\" has {dimensions} dimensions"));
        }
        let kind = cursor.number(1)? as u8;
        let offset = cursor.number(8)?;
        let shape = (0..dimensions).map(|_| cursor.number(8)).collect::<Result<Vec<u64>, String>>()?;
        if kind != UINT8 {
            fields.extend(numbers(bytes, name, kind, offset, &shape)?);
        }
    }
    Ok(fields)
}

fn numbers(bytes: &[u8], name: String, kind: u8, offset: u64, shape: &[u64]) -> Result<Option<Field>, String> {
    let size = match kind {
        FLOAT32 => 4,
        FLOAT64 => 8,
        _ => return Ok(None),
    };
    let count = shape.iter().try_fold(1u64, |count, &size| count.checked_mul(size));
    // Sizes are checked against the file before memory is allocated.
    let range = count
        .and_then(|count| count.checked_mul(size))
        .and_then(|length| Some((usize::try_from(offset).ok()?, usize::try_from(offset.checked_add(length)?).ok()?)))
        .filter(|(_, end)| *end <= bytes.len());
    let Some((start, end)) = range else {
        return Err(format!("field \"{name}\" of sizes {shape:?} does not fit into the file"));
    };
    let numbers: Vec<f32> = if kind == FLOAT32 {
        bytes[start..end].chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
    } else {
        let number = |b: &[u8]| f64::from_le_bytes(b.try_into().unwrap_or_default()) as f32;
        bytes[start..end].chunks_exact(8).map(number).collect()
    };
    Ok(Some(Field { name, shape: shape.iter().map(|&size| size as usize).collect(), numbers }))
}
