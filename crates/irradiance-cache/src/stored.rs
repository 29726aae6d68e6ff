//! Serialisation of numbers, records and fits.
//!
//! Numbers are little-endian and not padded. Input is untrusted: reading returns `None` at the end
//! of the bytes, and no value is used before `Record::is_usable` and `Fit::is_usable` have checked
//! it.

use glam::DVec3;

/// Bytes that are read from the front.
#[derive(Clone, Copy, Debug)]
pub struct StoredBytes<'b> {
    rest: &'b [u8],
}

impl<'b> StoredBytes<'b> {
    /// Starts at the first byte.
    #[must_use]
    pub fn new(bytes: &'b [u8]) -> Self {
        StoredBytes { rest: bytes }
    }

    /// Number of bytes left.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rest.len()
    }

    /// Whether no bytes are left.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// The next `count` bytes.
    pub fn take(&mut self, count: usize) -> Option<&'b [u8]> {
        let (taken, rest) = self.rest.split_at_checked(count)?;
        self.rest = rest;
        Some(taken)
    }

    fn take_array<const COUNT: usize>(&mut self) -> Option<[u8; COUNT]> {
        self.take(COUNT)?.try_into().ok()
    }
}

/// Values that are written to bytes and restored bit for bit.
pub trait Stored: Sized {
    /// Appends the value to some bytes.
    fn store(&self, bytes: &mut Vec<u8>);

    /// Reads a value from the front; `None` if there are too few bytes.
    fn restore(bytes: &mut StoredBytes<'_>) -> Option<Self>;
}

macro_rules! store_number {
    ($($number:ty),*) => {
        $(impl Stored for $number {
            fn store(&self, bytes: &mut Vec<u8>) {
                bytes.extend_from_slice(&self.to_le_bytes());
            }

            fn restore(bytes: &mut StoredBytes<'_>) -> Option<Self> {
                bytes.take_array().map(<$number>::from_le_bytes)
            }
        })*
    };
}
store_number!(u8, u32, u64, f32, f64);

impl Stored for bool {
    fn store(&self, bytes: &mut Vec<u8>) {
        u8::from(*self).store(bytes);
    }

    fn restore(bytes: &mut StoredBytes<'_>) -> Option<Self> {
        u8::restore(bytes).map(|byte| byte != 0)
    }
}

impl Stored for DVec3 {
    fn store(&self, bytes: &mut Vec<u8>) {
        self.to_array().store(bytes);
    }

    fn restore(bytes: &mut StoredBytes<'_>) -> Option<Self> {
        <[f64; 3]>::restore(bytes).map(DVec3::from_array)
    }
}

impl<T: Stored, const COUNT: usize> Stored for [T; COUNT] {
    fn store(&self, bytes: &mut Vec<u8>) {
        self.iter().for_each(|item| item.store(bytes));
    }

    fn restore(bytes: &mut StoredBytes<'_>) -> Option<Self> {
        let items: Option<Vec<T>> = (0..COUNT).map(|_| T::restore(bytes)).collect();
        items?.try_into().ok()
    }
}

/// Implements [`Stored`] for a struct of bands, field by field.
macro_rules! store_fields {
    ($kind:ident: $($field:ident),*) => {
        impl<const BANDS: usize> $crate::stored::Stored for $kind<BANDS> {
            fn store(&self, bytes: &mut Vec<u8>) {
                $($crate::stored::Stored::store(&self.$field, bytes);)*
            }

            fn restore(bytes: &mut $crate::stored::StoredBytes<'_>) -> Option<Self> {
                Some($kind { $($field: $crate::stored::Stored::restore(bytes)?),* })
            }
        }
    };
}
pub(crate) use store_fields;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_restored_bit_for_bit() {
        let value = [[0.1, -0.0, f64::MIN_POSITIVE], [1e300, 2.0, 3.0]];
        let mut bytes = Vec::new();
        value.store(&mut bytes);
        true.store(&mut bytes);
        let mut stored = StoredBytes::new(&bytes);
        let read = <[[f64; 3]; 2]>::restore(&mut stored).unwrap();
        assert_eq!(read.as_flattened().iter().map(|number| number.to_bits()).collect::<Vec<_>>(), {
            value.as_flattened().iter().map(|number| number.to_bits()).collect::<Vec<_>>()
        });
        assert_eq!((bool::restore(&mut stored), stored.len(), u8::restore(&mut stored)), (Some(true), 0, None));
    }
}
