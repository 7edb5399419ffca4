//! Meshes in Python: immutable, with views of their arrays.

use std::sync::{Arc, OnceLock};

use meshlod::Mesh;
use meshlod::io::transform;
use meshlod::mesh::{Bounds, Labels, LayerKind, MeshArrays, VertexId};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays::{AttributeArray, FaceArray, PointArray, copied};
use crate::errors::raised;
use crate::numpy_views::{as_i32, given, given_flat, lent};

/// A mesh that never changes, so that numpy can look into its memory.
#[pyclass(frozen, module = "meshlod._native")]
pub struct NativeMesh {
    mesh: Arc<Mesh>,
    /// Points and faces where they are not the vertices and faces of the mesh, made when first
    /// asked for.
    split: OnceLock<Split>,
}

/// Plain arrays of a mesh with seams.
struct Split {
    arrays: MeshArrays,
    faces: Vec<[VertexId; 3]>,
}

/// Labels of faces for Python: names, and an index into them for each face.
pub type FaceLabels<'py> = (Vec<String>, Bound<'py, PyArray1<u32>>);

impl NativeMesh {
    /// Takes over a mesh.
    ///
    /// # Errors
    /// More vertices or wedges than numpy's 32-bit integers can count.
    pub fn new(mesh: Mesh) -> PyResult<Self> {
        let wedges = mesh.attributes.as_ref().map_or(0, |attributes| attributes.wedge_count);
        let most = mesh.positions.len().saturating_add(wedges);
        if i32::try_from(most).is_err() {
            return Err(raised(format_args!("{most} points are too many: at most {}", i32::MAX)));
        }
        Ok(Self { mesh: Arc::new(mesh), split: OnceLock::new() })
    }

    /// Returns the mesh, shared.
    pub fn shared(&self) -> Arc<Mesh> {
        Arc::clone(&self.mesh)
    }

    /// Returns the plain arrays of the mesh if they differ from its own.
    fn split(&self) -> Option<&Split> {
        if self.split.get().is_none() && self.mesh.is_per_vertex() {
            return None;
        }
        Some(self.split.get_or_init(|| {
            let mut arrays = self.mesh.to_arrays();
            let faces = std::mem::take(&mut arrays.faces);
            Split { arrays, faces: faces.into_iter().map(|face| face.map(VertexId)).collect() }
        }))
    }
}

#[pymethods]
#[allow(unsafe_code)]
impl NativeMesh {
    /// Position of each point, as a read-only view.
    #[getter]
    fn vertices<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let this = slf.get();
        let split = this.split().map(|split| &split.arrays.positions);
        let positions = split.unwrap_or(&this.mesh.positions);
        // SAFETY: they belong to the mesh, which never changes.
        unsafe { lent(slf.clone().into_any(), positions.as_flattened(), 3) }
    }

    /// Points of each face, as a read-only view.
    #[getter]
    fn faces<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<i32>>> {
        let this = slf.get();
        let faces = this.split().map_or(&this.mesh.faces, |split| &split.faces);
        // SAFETY: they belong to the mesh, which never changes.
        unsafe { lent(slf.clone().into_any(), as_i32(faces), 3) }
    }

    /// Name and values of each attribute, as read-only views.
    fn attributes<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<Vec<(String, Bound<'py, PyArray2<f32>>)>> {
        let this = slf.get();
        let of_mesh = this.mesh.attributes.as_ref().map_or(&[][..], |all| &all.layers);
        let layers = this.split().map_or(of_mesh, |split| &split.arrays.layers);
        let named = layers.iter().map(|layer| {
            // SAFETY: they belong to the mesh, which never changes.
            let values = unsafe { lent(slf.clone().into_any(), &layer.values, layer.width)? };
            Ok((name_of(layer.kind, &layer.name), values))
        });
        named.collect()
    }

    /// Vertex of each point: points at a seam share one.
    fn vertex_of_points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        let vertices = self.mesh.vertex_of_points();
        PyArray1::from_vec(py, vertices.into_iter().map(|v| v.0).collect())
    }

    /// Names of materials, and the material of each face; `None` if there are none.
    fn materials<'py>(&self, py: Python<'py>) -> Option<FaceLabels<'py>> {
        labels(py, self.mesh.materials.as_ref()?)
    }

    /// Names of objects, and the object of each face; `None` if there are none.
    fn objects<'py>(&self, py: Python<'py>) -> Option<FaceLabels<'py>> {
        labels(py, self.mesh.objects.as_ref()?)
    }

    /// Least and greatest coordinates of the vertices that faces use; `None` if there are none.
    fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        corners(&self.mesh.bounds())
    }

    /// Returns a mesh moved by an affine matrix, given by its columns. Normals turn with it, and a
    /// matrix that mirrors flips the faces.
    fn transformed(&self, py: Python<'_>, columns: [[f64; 4]; 4]) -> PyResult<Self> {
        let moved = py.detach(|| {
            let mut mesh = Mesh::clone(&self.mesh);
            transform(&mut mesh, &columns);
            mesh.validate().map(|()| mesh)
        });
        Self::new(moved.map_err(raised)?)
    }

    /// Points, faces and attributes as arrays of their own, which the caller may change.
    fn to_arrays<'py>(&self, py: Python<'py>) -> PyResult<OwnArrays<'py>> {
        own_arrays(py, py.detach(|| self.mesh.to_arrays()))
    }
}

/// Points, faces and attributes, handed over to numpy.
pub type OwnArrays<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<i32>>,
    Vec<(String, Bound<'py, PyArray2<f32>>)>,
);

/// Hands plain arrays over to numpy, without copying them.
pub fn own_arrays(py: Python<'_>, arrays: MeshArrays) -> PyResult<OwnArrays<'_>> {
    let MeshArrays { positions, faces, layers } = arrays;
    // `NativeMesh::new` has refused more points than there are integers.
    let faces = faces.into_iter().map(|face| face.map(|point| point as i32)).collect();
    let layers = layers.into_iter().map(|layer| {
        let name = name_of(layer.kind, &layer.name);
        Ok((name, given_flat(py, layer.values, layer.width)?))
    });
    Ok((given(py, positions)?, given(py, faces)?, layers.collect::<PyResult<_>>()?))
}

/// Makes a mesh of arrays; with `numbered`, returns the vertex of each point where that may be
/// another one than its own.
///
/// # Errors
/// The array and the row that is wrong.
#[pyfunction]
pub fn from_arrays<'py>(
    py: Python<'py>,
    points: PointArray<'py>,
    faces: FaceArray<'py>,
    attributes: Vec<AttributeArray<'py>>,
    numbered: bool,
) -> PyResult<(NativeMesh, Option<Bound<'py, PyArray1<u32>>>)> {
    let arrays = copied(&points, &faces, &attributes)?;
    let is_numbered = numbered && !attributes.is_empty();
    let (vertices, mesh) = py.detach(move || {
        let vertices = is_numbered.then(|| arrays.vertex_of_points());
        (vertices, Mesh::from_arrays(arrays))
    });
    let vertices = vertices.map(|vertices| vertices.into_iter().map(|v| v.0).collect());
    let vertices = vertices.map(|vertices| PyArray1::from_vec(py, vertices));
    Ok((NativeMesh::new(mesh.map_err(raised)?)?, vertices))
}

/// Returns the least and greatest coordinates of bounds; `None` if they are empty.
pub fn corners(bounds: &Bounds) -> Option<[[f64; 3]; 2]> {
    let all = [bounds.min, bounds.max];
    all.as_flattened().iter().all(|x| x.is_finite()).then_some(all)
}

/// Returns labels of faces for Python.
pub fn labels<'py>(py: Python<'py>, labels: &Labels) -> Option<FaceLabels<'py>> {
    Some((labels.names.clone(), PyArray1::from_slice(py, &labels.of_face)))
}

/// Returns the name of an attribute in Python.
pub fn name_of(kind: LayerKind, name: &str) -> String {
    match kind {
        LayerKind::Normal => "normals".into(),
        LayerKind::Uv(0) => "uvs".into(),
        LayerKind::Color(0) => "colors".into(),
        LayerKind::Other | LayerKind::Label if !name.is_empty() => name.into(),
        kind => kind.to_string(),
    }
}
