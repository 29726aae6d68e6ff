//! Arrays that show numbers of a Python object without a copy.

use crate::errors::RadsightError;
use numpy::ndarray::{ArrayView, Dimension, IntoDimension};
use numpy::{Element, PyArray};
use pyo3::PyClass;
use pyo3::prelude::*;
use pyo3::pyclass::boolean_struct::True;

/// A read-only array of numbers that `owner` holds. The array keeps its owner alive.
pub(crate) fn array_view<'py, O, T, S>(
    owner: &Bound<'py, O>,
    shape: S,
    numbers: impl for<'o> FnOnce(&'o O) -> &'o [T],
) -> PyResult<Bound<'py, PyArray<T, S::Dim>>>
where
    O: PyClass<Frozen = True> + Sync,
    T: Element,
    S: IntoDimension,
{
    let view = ArrayView::from_shape(shape.into_dimension(), numbers(owner.get()));
    let view = view.map_err(|error| RadsightError::new_err(error.to_string()))?;
    let array = borrowed(&view, owner);
    // `PyReadwriteArray` would refuse where another thread reads a view of the same numbers.
    array.call_method1("setflags", (false,))?;
    Ok(array)
}

#[allow(unsafe_code, reason = "NumPy does not know how long borrowed memory lives")]
fn borrowed<'py, O, T, D>(view: &ArrayView<'_, T, D>, owner: &Bound<'py, O>) -> Bound<'py, PyArray<T, D>>
where
    O: PyClass<Frozen = True>,
    T: Element,
    D: Dimension,
{
    // SAFETY: `array_view` borrows the numbers from the owner for any lifetime, so they live as long as it does. It is
    // frozen: nothing moves or changes them, and the array, whose base it becomes, keeps it alive.
    unsafe { PyArray::borrow_from_array(view, owner.clone().into_any()) }
}
