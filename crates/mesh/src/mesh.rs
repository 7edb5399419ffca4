//! Triangle mesh and the checks of its validity.

use glam::DVec3;
use thiserror::Error;

use crate::{Attributes, Bounds, FaceId, FaceLayer, Labels, VertexId, WedgeId};

/// Triangle mesh: vertex positions, faces, attributes, and material and object labels.
///
/// Faces index positions, and these indices alone define the topology. [`Mesh::validate`] lists
/// what must hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Position of each vertex, in model units.
    pub positions: Vec<[f64; 3]>,
    /// Vertices of each face, counter-clockwise seen from outside.
    pub faces: Vec<[VertexId; 3]>,
    /// Normals, texture coordinates, colours and other vertex attributes, stored per wedge.
    pub attributes: Option<Attributes>,
    /// Material of each face, by name.
    pub materials: Option<Labels>,
    /// Object that each face belongs to, by name.
    pub objects: Option<Labels>,
    /// Numbers of each face, such as smoothing groups and scalars that a file has at faces.
    pub face_layers: Vec<FaceLayer>,
}

/// Reason why a triangle mesh is invalid.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum MeshError {
    /// A vertex coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite: {position:?}")]
    NotFinite {
        /// Vertex with a coordinate that is not finite.
        vertex: VertexId,
        /// Position of the vertex.
        position: [f64; 3],
    },
    /// A face refers to a vertex that does not exist.
    #[error("face {face} names vertex {vertex}, but there are only {count} vertices")]
    BadVertex {
        /// Face that refers to a missing vertex.
        face: FaceId,
        /// Vertex that the face refers to and that does not exist.
        vertex: VertexId,
        /// Number of vertices in the mesh.
        count: usize,
    },
    /// A corner of a face refers to a wedge (set of attribute values) that does not exist.
    #[error("face {face} names wedge {wedge}, but there are only {count} wedges")]
    BadWedge {
        /// Face with the corner that refers to a missing wedge.
        face: FaceId,
        /// Index of the wedge that does not exist.
        wedge: u32,
        /// Number of wedges in the mesh.
        count: usize,
    },
    /// A wedge (set of attribute values) is used at two different vertices.
    #[error("face {face} uses wedge w{wedge} at vertex {vertex}, an earlier face at another")]
    SharedWedge {
        /// Face that uses the wedge at the second vertex.
        face: FaceId,
        /// Index of the wedge that is used at two vertices.
        wedge: u32,
        /// Second vertex at which the wedge is used.
        vertex: VertexId,
    },
    /// The length of an array does not match the rest of the mesh.
    #[error("{what}: {found} entries, but {expected} are needed")]
    BadLength {
        /// Name of the array with the wrong length.
        what: String,
        /// Actual length of the array.
        found: usize,
        /// Length that the array must have.
        expected: usize,
    },
    /// A face has a material or object label beyond the end of the list of names.
    #[error("face {face} has {what} {label}, but there are only {count} {what}s")]
    BadLabel {
        /// Face with the invalid label.
        face: FaceId,
        /// Type of the label: `material` or `object`.
        what: &'static str,
        /// Label of the face, which is not an index into the names.
        label: u32,
        /// Number of material or object names.
        count: usize,
    },
}

impl Mesh {
    /// Creates a mesh from positions and faces, without attributes or labels.
    pub fn new(positions: Vec<[f64; 3]>, faces: Vec<[VertexId; 3]>) -> Self {
        Self { positions, faces, ..Self::default() }
    }

    /// Returns the positions of a face's three vertices.
    #[inline]
    pub fn triangle(&self, [a, b, c]: [VertexId; 3]) -> [DVec3; 3] {
        let at = |v: VertexId| DVec3::from(self.positions[v.index()]);
        [at(a), at(b), at(c)]
    }

    /// Returns the wedges at the corners of a face; without attributes each vertex is one.
    ///
    /// # Panics
    /// There is no such face.
    pub fn corner_wedges(&self, face: usize) -> [WedgeId; 3] {
        match &self.attributes {
            Some(attributes) => attributes.corners[face],
            None => self.faces[face].map(|v| WedgeId(v.0)),
        }
    }

    /// Returns the bounding box of all vertices that faces use; unused vertices do not count.
    pub fn bounds(&self) -> Bounds {
        let used = self.used_vertices();
        Bounds::of(self.positions.iter().zip(used).filter(|(_, used)| *used).map(|(p, _)| p))
    }

    /// Returns whether a face uses the vertex, for each vertex of the mesh.
    pub fn used_vertices(&self) -> Vec<bool> {
        let mut used = vec![false; self.positions.len()];
        for v in self.faces.iter().flatten() {
            used[v.index()] = true;
        }
        used
    }

    /// Checks the mesh: all positions finite, indices in range, array lengths consistent, and every
    /// wedge used at one vertex only.
    ///
    /// Meshes from readers have passed this check.
    /// # Errors
    /// The first violation found.
    pub fn validate(&self) -> Result<(), MeshError> {
        if !self.is_in_range() {
            self.find_out_of_range()?;
        }
        self.validate_attributes()
    }

    /// Returns true if all positions are finite and all indices below their number. Without a branch:
    /// many at a time.
    fn is_in_range(&self) -> bool {
        let coordinates = self.positions.as_flattened().iter();
        let are_finite = coordinates.fold(true, |all, x| all & x.is_finite());
        let last = self.faces.as_flattened().iter().fold(0, |last, v| last.max(v.0));
        are_finite && (self.faces.is_empty() || (last as usize) < self.positions.len())
    }

    fn find_out_of_range(&self) -> Result<(), MeshError> {
        for (i, &position) in self.positions.iter().enumerate() {
            if !position.iter().all(|x| x.is_finite()) {
                return Err(MeshError::NotFinite { vertex: VertexId::new(i), position });
            }
        }
        let count = self.positions.len();
        for (i, face) in self.faces.iter().enumerate() {
            if let Some(&vertex) = face.iter().find(|v| v.index() >= count) {
                return Err(MeshError::BadVertex { face: FaceId::new(i), vertex, count });
            }
        }
        Ok(())
    }

    /// Checks only attributes, labels and layers of faces as [`Mesh::validate`] does, not positions and
    /// faces.
    /// # Errors
    /// The first violation found.
    pub fn validate_attributes(&self) -> Result<(), MeshError> {
        self.validate_corners()?;
        self.validate_labels("material", self.materials.as_ref())?;
        self.validate_labels("object", self.objects.as_ref())?;
        self.face_layers.iter().try_for_each(|layer| {
            let what = format!("face layer \"{}\"", layer.name);
            same_length(&what, layer.values.len(), self.faces.len())
        })
    }

    fn validate_corners(&self) -> Result<(), MeshError> {
        let Some(attributes) = &self.attributes else { return Ok(()) };
        let count = attributes.wedge_count;
        same_length("attribute corners", attributes.corners.len(), self.faces.len())?;
        for (i, corners) in attributes.corners.iter().enumerate() {
            if let Some(wedge) = corners.iter().find(|w| w.index() >= count) {
                return Err(MeshError::BadWedge { face: FaceId::new(i), wedge: wedge.0, count });
            }
        }
        self.validate_wedges(attributes)?;
        for layer in &attributes.layers {
            let what = format!("attribute layer \"{}\"", layer.name);
            same_length(&what, layer.values.len(), count.saturating_mul(layer.width))?;
            if let Some(width) = layer.kind.width() {
                same_length(&format!("a wedge of {what}"), layer.width, width)?;
            }
        }
        Ok(())
    }

    /// Checks that every wedge is used at one vertex only.
    fn validate_wedges(&self, attributes: &Attributes) -> Result<(), MeshError> {
        // Sized by the highest wedge in use: `wedge_count` may be far beyond the length of any
        // array.
        let named = attributes.corners.iter().flatten().max().map_or(0, |w| w.index() + 1);
        let mut home = vec![None; named];
        for (i, (face, corners)) in self.faces.iter().zip(&attributes.corners).enumerate() {
            for (&vertex, wedge) in face.iter().zip(corners) {
                if *home[wedge.index()].get_or_insert(vertex) != vertex {
                    return Err(MeshError::SharedWedge {
                        face: FaceId::new(i),
                        wedge: wedge.0,
                        vertex,
                    });
                }
            }
        }
        Ok(())
    }

    fn validate_labels(
        &self,
        what: &'static str,
        labels: Option<&Labels>,
    ) -> Result<(), MeshError> {
        let Some(labels) = labels else { return Ok(()) };
        same_length(&format!("{what} labels"), labels.of_face.len(), self.faces.len())?;
        let count = labels.names.len();
        match labels.of_face.iter().position(|&label| label as usize >= count) {
            None => Ok(()),
            Some(i) => {
                let label = labels.of_face[i];
                Err(MeshError::BadLabel { face: FaceId::new(i), what, label, count })
            }
        }
    }

    /// Removes the vertices and wedges that no face uses. The others keep their order.
    pub fn compact(&mut self) {
        let (map, kept) = dense_map(self.positions.len(), self.faces.iter().flatten().map(|v| v.0));
        self.positions = kept.iter().map(|&v| self.positions[v as usize]).collect();
        for v in self.faces.iter_mut().flatten() {
            v.0 = map[v.index()];
        }
        if let Some(attributes) = &mut self.attributes {
            attributes.compact();
        }
    }
}

impl Attributes {
    /// Removes the wedges that no face corner uses, with their attribute values. The others keep
    /// their order.
    pub fn compact(&mut self) {
        let (map, kept) = dense_map(self.wedge_count, self.corners.iter().flatten().map(|w| w.0));
        for layer in &mut self.layers {
            let width = layer.width;
            layer.values = kept
                .iter()
                .flat_map(|&w| &layer.values[w as usize * width..][..width])
                .copied()
                .collect();
        }
        for w in self.corners.iter_mut().flatten() {
            w.0 = map[w.index()];
        }
        self.wedge_count = kept.len();
    }
}

/// Returns the new index of each old one (`u32::MAX` if it is unused), and the used indices in
/// order.
fn dense_map(count: usize, used: impl Iterator<Item = u32>) -> (Vec<u32>, Vec<u32>) {
    let mut map = vec![u32::MAX; count];
    for i in used {
        map[i as usize] = 0;
    }
    let mut kept = Vec::new();
    for (i, slot) in map.iter_mut().enumerate() {
        if *slot == 0 {
            *slot = kept.len() as u32;
            kept.push(i as u32);
        }
    }
    (map, kept)
}

fn same_length(what: &str, found: usize, expected: usize) -> Result<(), MeshError> {
    if found == expected {
        return Ok(());
    }
    Err(MeshError::BadLength { what: what.to_owned(), found, expected })
}
