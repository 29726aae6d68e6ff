//! Whole numbers that Python code gives. Without this, a number that does not fit is an `OverflowError` that names no argument.

use crate::errors::wrong;
use pyo3::exceptions::PyOverflowError;
use pyo3::prelude::*;

/// A whole number; the error for one that does not fit names the argument and its range.
fn whole<T: TryFrom<u64>>(name: &str, given: &Bound<'_, PyAny>) -> PyResult<T> {
    let largest = u64::MAX >> (u64::BITS as usize - 8 * size_of::<T>());
    let refused = || wrong(name, given, &format!("a whole number of 0 to {largest}"));
    match given.extract::<u64>() {
        Ok(number) => T::try_from(number).map_err(|_| refused()),
        Err(error) if error.is_instance_of::<PyOverflowError>(given.py()) => Err(refused()),
        Err(error) => Err(error),
    }
}

/// Extracts the argument of each name, for `#[pyo3(from_py_with = …)]`.
macro_rules! arguments {
    ($($name:ident: $kind:ty,)*) => {
        $(pub(crate) fn $name(given: &Bound<'_, PyAny>) -> PyResult<$kind> {
            whole(stringify!($name), given)
        })*

        /// The same arguments where they may be `None`.
        pub(crate) mod optional {
            use pyo3::prelude::*;

            $(pub(crate) fn $name(given: &Bound<'_, PyAny>) -> PyResult<Option<$kind>> {
                unless_none(given, super::$name)
            })*

            pub(crate) fn threads(given: &Bound<'_, PyAny>) -> PyResult<Option<usize>> {
                unless_none(given, super::threads)
            }

            fn unless_none<T>(
                given: &Bound<'_, PyAny>,
                read: fn(&Bound<'_, PyAny>) -> PyResult<T>,
            ) -> PyResult<Option<T>> {
                if given.is_none() { Ok(None) } else { read(given).map(Some) }
            }
        }
    };
}

arguments! {
    all: usize,
    ambient_bounces: u32,
    ambient_divisions: u32,
    ambient_super_samples: u32,
    columns: usize,
    first: u64,
    parts: usize,
    rays: usize,
    rows: usize,
    samples: u32,
    seed: u64,
}

/// Largest number of threads, as in the program: to start many more takes minutes, or fails.
const MOST_THREADS: usize = 4096;

/// A number of threads: not 0, which would be as many as there are cores.
fn threads(given: &Bound<'_, PyAny>) -> PyResult<usize> {
    match whole("threads", given)? {
        0 => Err(wrong("threads", 0, "at least 1, or None for all cores")),
        threads if threads > MOST_THREADS => Err(wrong("threads", threads, "at most 4096")),
        threads => Ok(threads),
    }
}

/// Columns and rows, or `None`.
pub(crate) fn size(given: &Bound<'_, PyAny>) -> PyResult<Option<[usize; 2]>> {
    if given.is_none() {
        return Ok(None);
    }
    let (columns, rows): (Bound<'_, PyAny>, Bound<'_, PyAny>) = given.extract()?;
    Ok(Some([whole("columns of size", &columns)?, whole("rows of size", &rows)?]))
}
