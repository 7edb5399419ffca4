//! Arrays for numpy: memory that is handed over, or read-only views of memory that stays.
//!
//! The only unsafe code of the package. A view keeps its owner alive, and what an owner has lent is
//! never changed: meshes in Python are immutable.
#![allow(unsafe_code)]

use meshlod::mesh::VertexId;
use numpy::ndarray::ArrayView2;
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

/// Hands rows over to numpy, without copying them.
pub fn given<'py, T: Element, const N: usize>(
    py: Python<'py>,
    rows: Vec<[T; N]>,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let count = rows.len();
    PyArray1::from_vec(py, rows.into_flattened()).reshape([count, N])
}

/// Hands rows of `width` values over to numpy, without copying them.
pub fn given_flat<T: Element>(
    py: Python<'_>,
    values: Vec<T>,
    width: usize,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = values.len() / width.max(1);
    PyArray1::from_vec(py, values).reshape([count, width])
}

/// Lends rows of `width` values to numpy, as a read-only view.
///
/// # Safety
/// `values` must belong to `owner`, stay where they are for as long as it lives, and never change.
pub unsafe fn lent<'py, T: Element>(
    owner: Bound<'py, PyAny>,
    values: &[T],
    width: usize,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let rows = values.len() / width.max(1);
    let view = ArrayView2::from_shape((rows, width), values).map_err(crate::errors::raised)?;
    // SAFETY: the caller's promise; the array holds a reference to the owner.
    let array = unsafe { PyArray2::borrow_from_array(&view, owner) };
    array.call_method1("setflags", (false,))?;
    Ok(array)
}

/// Returns indices as numpy's 32-bit integers.
pub fn as_i32(faces: &[[VertexId; 3]]) -> &[i32] {
    let flat = faces.as_flattened();
    // SAFETY: a vertex id is a transparent u32, which has the size and alignment of an i32; every
    // pattern of bits is one. Ids beyond its range are refused before: see `NativeMesh::new`.
    unsafe { std::slice::from_raw_parts(flat.as_ptr().cast(), flat.len()) }
}
