//! Meshes as plain arrays, with one row of every attribute for each point.

use thiserror::Error;

use crate::{
    Attributes, Layer, LayerKind, Mesh, MeshError, Point, VertexId, WedgeId, first_near, weld,
};

/// Plain arrays of a mesh, as numpy and GPUs have them: one row of every array for each point.
///
/// A point is what a [`Mesh`] calls a wedge: where a texture has a seam, several points share one
/// position. [`Mesh::from_arrays`] makes one vertex of these, [`Mesh::to_arrays`] splits it again.
///
/// ```
/// use meshlod_mesh::{LayerKind, Mesh, MeshArrays};
///
/// // Two triangles that meet at x = 0, with a seam of the texture between them.
/// let points: [[f32; 3]; 6] =
///     [[-1., 0., 0.], [0., 0., 0.], [0., 1., 0.], [0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];
/// let uvs = vec![0., 0., 1., 0., 1., 1., 0., 0.5, 1., 0.5, 0., 1.];
/// let arrays = MeshArrays::new(&points, &[[0, 1, 2], [3, 4, 5]]).with(LayerKind::Uv(0), uvs);
///
/// let mesh = Mesh::from_arrays(arrays.clone())?;
/// assert_eq!((mesh.positions.len(), mesh.faces.len()), (4, 2));
/// assert_eq!(mesh.to_arrays(), arrays);
/// # Ok::<(), meshlod_mesh::ArraysError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshArrays {
    /// Position of each point, in model units.
    pub positions: Vec<[f64; 3]>,
    /// Points of each face, counter-clockwise seen from outside.
    pub faces: Vec<[u32; 3]>,
    /// Attributes, with [`Layer::width`] values for each point.
    pub layers: Vec<Layer>,
}

/// Reason why arrays are not a mesh.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum ArraysError {
    /// A coordinate of a point is NaN or infinite.
    #[error("points: row {row} is not finite: {position:?}")]
    NotFinite {
        /// Row of the point.
        row: usize,
        /// Position of the point.
        position: [f64; 3],
    },
    /// A face refers to a point that does not exist.
    #[error("faces: row {row} refers to point {point}, but there are only {count} points")]
    BadIndex {
        /// Row of the face.
        row: usize,
        /// Index of the missing point.
        point: u32,
        /// Number of points.
        count: usize,
    },
    /// An attribute has too few or too many values.
    #[error("{name}: {found} values, but each of {count} points needs {}", per_point(*width))]
    BadLength {
        /// Name of the attribute.
        name: String,
        /// Number of values found.
        found: usize,
        /// Number of points.
        count: usize,
        /// Number of values that each point needs; 0 if any number above it will do.
        width: usize,
    },
    /// A value of an attribute is NaN or infinite.
    #[error("{name}: row {row} is not finite: {value}")]
    BadValue {
        /// Name of the attribute.
        name: String,
        /// Row of the point.
        row: usize,
        /// Value that is not finite.
        value: f32,
    },
    /// The arrays have more points than there are ids.
    #[error("points: {count} rows, but at most {} are possible", u32::MAX)]
    TooMany {
        /// Number of points.
        count: usize,
    },
    /// Something else is wrong with an attribute.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl MeshArrays {
    /// Creates arrays from positions of any [`Point`] type and faces, without attributes.
    ///
    /// For a flat list of indices, pass `indices.as_chunks().0`, which drops an incomplete face.
    pub fn new<P: Point>(positions: &[P], faces: &[[u32; 3]]) -> Self {
        let positions = positions.iter().map(|&position| position.to_f64()).collect();
        Self { positions, faces: faces.to_vec(), layers: Vec::new() }
    }

    /// Returns the positions as any [`Point`] type, rounded to its precision.
    pub fn points<P: Point>(&self) -> Vec<P> {
        self.positions.iter().copied().map(P::from_f64).collect()
    }

    /// Adds an attribute of a kind that has a fixed number of values, or else as many as there are
    /// for each point. It is named after its kind.
    pub fn with(mut self, kind: LayerKind, values: Vec<f32>) -> Self {
        let width = kind.width().unwrap_or(values.len() / self.positions.len().max(1));
        self.layers.push(Layer { kind, name: kind.to_string(), width, values });
        self
    }

    /// Returns the vertex that [`Mesh::from_arrays`] makes of each point.
    ///
    /// Cost: O(n), n = points.
    pub fn vertex_of_points(&self) -> Vec<VertexId> {
        if self.layers.is_empty() {
            return (0..self.positions.len()).map(VertexId::new).collect();
        }
        let mut vertices: Vec<VertexId> = Vec::with_capacity(self.positions.len());
        let mut count = 0;
        for (point, first) in first_near(&self.positions, 0.0).into_iter().enumerate() {
            let vertex = if first as usize == point {
                count += 1;
                VertexId::new(count - 1)
            } else {
                vertices[first as usize]
            };
            vertices.push(vertex);
        }
        vertices
    }

    pub(crate) fn validate(&self) -> Result<(), ArraysError> {
        let count = self.positions.len();
        if u32::try_from(count).is_err() {
            return Err(ArraysError::TooMany { count });
        }
        let is_bad = |p: &[f64; 3]| !p.iter().all(|x| x.is_finite());
        if let Some(row) = self.positions.iter().position(is_bad) {
            return Err(ArraysError::NotFinite { row, position: self.positions[row] });
        }
        for (row, face) in self.faces.iter().enumerate() {
            if let Some(&point) = face.iter().find(|&&point| point as usize >= count) {
                return Err(ArraysError::BadIndex { row, point, count });
            }
        }
        self.layers.iter().try_for_each(|layer| validate_layer(layer, count))
    }
}

fn per_point(width: usize) -> String {
    if width == 0 { "at least 1".to_owned() } else { width.to_string() }
}

fn validate_layer(layer: &Layer, count: usize) -> Result<(), ArraysError> {
    let (name, width, found) = (layer.name.clone(), layer.width, layer.values.len());
    if width == 0 || Some(found) != count.checked_mul(width) {
        return Err(ArraysError::BadLength { name, found, count, width });
    }
    match layer.values.iter().position(|value| !value.is_finite()) {
        Some(i) => Err(ArraysError::BadValue { name, row: i / width, value: layer.values[i] }),
        None => Ok(()),
    }
}

impl Mesh {
    /// Makes a mesh of plain arrays, whose memory it takes over.
    ///
    /// Without attributes every point is a vertex. With attributes, points at equal positions become
    /// one vertex ([`weld`]) with a wedge for each distinct set of values, so that seams do not tear
    /// the surface; points that no face uses then lose their attributes.
    ///
    /// Cost: O(n), n = points.
    /// # Errors
    /// The array and the row that is wrong.
    pub fn from_arrays(arrays: MeshArrays) -> Result<Self, ArraysError> {
        arrays.validate()?;
        let MeshArrays { positions, faces, layers } = arrays;
        let wedge_count = positions.len();
        let corners = |faces: &[[u32; 3]]| faces.iter().map(|face| face.map(WedgeId)).collect();
        let attributes = (!layers.is_empty()).then(|| Attributes {
            corners: corners(&faces),
            wedge_count,
            layers,
        });
        let faces = faces.into_iter().map(|face| face.map(VertexId)).collect();
        let mut mesh = Self { attributes, ..Self::new(positions, faces) };
        mesh.validate_attributes()?;
        if mesh.attributes.is_some() {
            weld(&mut mesh, 0.0);
        }
        Ok(mesh)
    }

    /// Returns the mesh as plain arrays: a point for each wedge, in their order, then one for each
    /// vertex that no face uses, whose attributes are 0. Labels of faces are not in them.
    ///
    /// Where [`is_per_vertex`](Self::is_per_vertex), points are the vertices. Arrays made from a mesh
    /// that came from arrays have its points, but equal ones only once.
    ///
    /// Cost: O(n), n = wedges.
    /// # Panics
    /// The mesh is invalid.
    pub fn to_arrays(&self) -> MeshArrays {
        self.clone().into_arrays()
    }

    /// Turns the mesh into plain arrays as [`to_arrays`](Self::to_arrays) does, without copying
    /// positions where [`is_per_vertex`](Self::is_per_vertex).
    ///
    /// # Panics
    /// The mesh is invalid.
    pub fn into_arrays(self) -> MeshArrays {
        let is_per_vertex = self.is_per_vertex();
        let Self { positions, faces, attributes, .. } = self;
        let attributes = match attributes {
            Some(attributes) if !is_per_vertex => attributes,
            attributes => {
                let layers = attributes.map_or(Vec::new(), |attributes| attributes.layers);
                let faces = faces.into_iter().map(|face| face.map(|v| v.0)).collect();
                return MeshArrays { positions, faces, layers };
            }
        };
        split(&positions, &faces, attributes)
    }

    /// Returns the vertex of each point of [`to_arrays`](Self::to_arrays).
    ///
    /// Cost: O(n), n = wedges.
    /// # Panics
    /// The mesh is invalid.
    pub fn vertex_of_points(&self) -> Vec<VertexId> {
        match &self.attributes {
            Some(attributes) if !self.is_per_vertex() => {
                let mut attributes = attributes.clone();
                attributes.compact();
                points_of(self.positions.len(), &self.faces, &attributes)
            }
            _ => (0..self.positions.len()).map(VertexId::new).collect(),
        }
    }

    /// Returns true if every vertex has one set of attributes, with its index, or there are none:
    /// then positions, faces and attributes are plain arrays already.
    pub fn is_per_vertex(&self) -> bool {
        let Some(attributes) = &self.attributes else { return true };
        let mut corners = self.faces.as_flattened().iter().zip(attributes.corners.as_flattened());
        attributes.wedge_count == self.positions.len() && corners.all(|(v, w)| v.0 == w.0)
    }
}

/// Returns arrays with a point for each wedge in use, then for each unused vertex.
fn split(
    positions: &[[f64; 3]],
    faces: &[[VertexId; 3]],
    mut attributes: Attributes,
) -> MeshArrays {
    attributes.compact();
    let vertex_of = points_of(positions.len(), faces, &attributes);
    let mut layers = attributes.layers;
    layers.iter_mut().for_each(|layer| layer.values.resize(vertex_of.len() * layer.width, 0.0));
    MeshArrays {
        positions: vertex_of.iter().map(|v| positions[v.index()]).collect(),
        faces: attributes.corners.iter().map(|corners| corners.map(|w| w.0)).collect(),
        layers,
    }
}

/// Returns the vertex of each wedge, all of which are used, and then the unused vertices.
fn points_of(vertices: usize, faces: &[[VertexId; 3]], attributes: &Attributes) -> Vec<VertexId> {
    let mut vertex_of = vec![VertexId(0); attributes.wedge_count];
    let mut is_unused = vec![true; vertices];
    for (&v, w) in faces.as_flattened().iter().zip(attributes.corners.as_flattened()) {
        vertex_of[w.index()] = v;
        is_unused[v.index()] = false;
    }
    vertex_of.extend((0..vertices).filter(|&v| is_unused[v]).map(VertexId::new));
    vertex_of
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [[f64; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];

    fn square() -> MeshArrays {
        MeshArrays::new(&SQUARE, &[[0, 1, 2], [2, 3, 0]])
    }

    #[test]
    fn without_attributes_points_are_vertices() {
        let mut arrays = square();
        arrays.positions.push([0.0; 3]);
        let mesh = Mesh::from_arrays(arrays.clone()).unwrap();
        assert_eq!(mesh.positions.len(), 5, "equal positions stay apart, unused ones stay");
        assert_eq!(mesh.into_arrays(), arrays);
    }

    #[test]
    fn equal_points_are_one_wedge_and_unused_ones_stay() {
        let mut arrays = square();
        arrays.positions.extend([[1.0, -0.0, 0.0], [9.0; 3]]);
        arrays.faces[1] = [2, 3, 4];
        let arrays = arrays.with(LayerKind::Color(0), [0.5_f32; 18].to_vec());
        let vertices = arrays.vertex_of_points();
        assert_eq!(vertices, [0, 1, 2, 3, 1, 4].map(VertexId));
        let mesh = Mesh::from_arrays(arrays).unwrap();
        assert_eq!(mesh.validate(), Ok(()));
        assert_eq!(mesh.vertex_of_points(), [0, 1, 2, 3, 4].map(VertexId));
        assert_eq!(mesh.positions.len(), 5);
        assert!(!mesh.is_per_vertex(), "the unused vertex has no wedge");
        let back = mesh.to_arrays();
        assert_eq!(back.faces, [[0, 1, 2], [2, 3, 1]]);
        assert_eq!(back.positions[4], [9.0; 3]);
        assert_eq!(back.layers[0].values[..12], [0.5; 12]);
        assert_eq!(back.layers[0].values[12..], [0.0; 3]);
    }

    #[test]
    fn errors_name_the_array_and_the_row() {
        let error = |arrays| Mesh::from_arrays(arrays).unwrap_err().to_string();
        let mut arrays = square();
        arrays.positions[2][1] = f64::NAN;
        assert_eq!(error(arrays), "points: row 2 is not finite: [1.0, NaN, 0.0]");
        let mut arrays = square();
        arrays.faces[1][2] = 4;
        let expected = "faces: row 1 refers to point 4, but there are only 4 points";
        assert_eq!(error(arrays), expected);
        let arrays = square().with(LayerKind::Uv(0), vec![0.0; 7]);
        assert_eq!(error(arrays), "uv0: 7 values, but each of 4 points needs 2");
        let mut values = vec![0.0; 8];
        values[5] = f32::INFINITY;
        let arrays = square().with(LayerKind::Uv(0), values);
        assert_eq!(error(arrays), "uv0: row 2 is not finite: inf");
        let arrays = square().with(LayerKind::Other, Vec::new());
        assert_eq!(error(arrays), "other: 0 values, but each of 4 points needs at least 1");
    }
}
