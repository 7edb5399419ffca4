//! Arrays from numpy, copied once into the memory of a mesh.

use meshlod::mesh::{Layer, LayerKind, MeshArrays};
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::errors::raised;

/// Points as numpy has them: contiguous rows of three coordinates.
#[derive(FromPyObject)]
pub enum PointArray<'py> {
    /// Double precision, as meshes have it.
    F64(PyReadonlyArray2<'py, f64>),
    /// Single precision.
    F32(PyReadonlyArray2<'py, f32>),
}

/// Faces as numpy has them: contiguous rows of three indices.
#[derive(FromPyObject)]
pub enum FaceArray<'py> {
    /// 64 bits with a sign, the default of numpy.
    I64(PyReadonlyArray2<'py, i64>),
    /// 32 bits with a sign.
    I32(PyReadonlyArray2<'py, i32>),
    /// 32 bits without a sign.
    U32(PyReadonlyArray2<'py, u32>),
}

/// Attribute of points: its name, its kind, and contiguous rows of single-precision values.
pub type AttributeArray<'py> = (String, String, PyReadonlyArray2<'py, f32>);

/// Copies arrays, which may change or go as soon as the GIL is released.
///
/// # Errors
/// An index that is negative or does not fit; an attribute of an unknown kind.
pub fn copied(
    points: &PointArray<'_>,
    faces: &FaceArray<'_>,
    attributes: &[AttributeArray<'_>],
) -> PyResult<MeshArrays> {
    let positions = match points {
        PointArray::F64(points) => rows(points.as_slice()?, |x| x),
        PointArray::F32(points) => rows(points.as_slice()?, f64::from),
    };
    let faces = match faces {
        FaceArray::I64(faces) => indices(faces.as_slice()?, |i| u32::try_from(i).ok()),
        FaceArray::I32(faces) => indices(faces.as_slice()?, |i| u32::try_from(i).ok()),
        FaceArray::U32(faces) => indices(faces.as_slice()?, Some),
    };
    let faces = faces.map_err(|row| {
        let count = positions.len();
        raised(format_args!(
            "faces: row {row} has an index below 0 or above the last of {count} points"
        ))
    })?;
    let layers = attributes.iter().map(layer).collect::<PyResult<_>>()?;
    Ok(MeshArrays { positions, faces, layers })
}

fn rows<T: Copy>(values: &[T], as_f64: impl Fn(T) -> f64) -> Vec<[f64; 3]> {
    values.as_chunks().0.iter().map(|row: &[T; 3]| row.map(&as_f64)).collect()
}

/// Returns the rows of indices, or the first row with an index that does not fit.
fn indices<T: Copy>(
    values: &[T],
    as_u32: impl Fn(T) -> Option<u32>,
) -> Result<Vec<[u32; 3]>, usize> {
    let mut rows = Vec::with_capacity(values.len() / 3);
    for (row, face) in values.as_chunks::<3>().0.iter().enumerate() {
        let [Some(a), Some(b), Some(c)] = face.map(&as_u32) else { return Err(row) };
        rows.push([a, b, c]);
    }
    Ok(rows)
}

fn layer((name, kind, values): &AttributeArray<'_>) -> PyResult<Layer> {
    let kind = match kind.as_str() {
        "normal" => LayerKind::Normal,
        "uv" => LayerKind::Uv(0),
        "color" => LayerKind::Color(0),
        "label" => LayerKind::Label,
        "other" => LayerKind::Other,
        _ => return Err(raised(format_args!("{name}: there is no kind {kind} of attributes"))),
    };
    let width = values.shape()[1];
    Ok(Layer { kind, name: name.clone(), width, values: values.as_slice()?.to_vec() })
}
