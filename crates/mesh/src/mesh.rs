//! The triangle mesh.

use glam::DVec3;
use thiserror::Error;

use crate::{Attributes, Bounds, FaceId, Labels, VertexId};

/// A triangle mesh: positions, faces, attributes and labels.
///
/// Faces index positions, and these indices alone define the topology. [`Mesh::validate`] lists
/// what must hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Position of each vertex, in model units.
    pub positions: Vec<[f64; 3]>,
    /// Vertices of each face, counter-clockwise seen from outside.
    pub faces: Vec<[VertexId; 3]>,
    /// Normals, texture coordinates, colours and other values over wedges.
    pub attributes: Option<Attributes>,
    /// Material of each face.
    pub materials: Option<Labels>,
    /// Named object of each face.
    pub objects: Option<Labels>,
}

/// Reason why a mesh is invalid.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MeshError {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite: {position:?}")]
    NotFinite {
        /// Vertex with the coordinate.
        vertex: VertexId,
        /// Position of that vertex.
        position: [f64; 3],
    },
    /// A face refers to a vertex that does not exist.
    #[error("face {face} names vertex {vertex}, but there are only {count} vertices")]
    BadVertex {
        /// Face that refers to it.
        face: FaceId,
        /// Vertex that does not exist.
        vertex: VertexId,
        /// Number of vertices.
        count: usize,
    },
    /// A corner refers to a wedge that does not exist.
    #[error("face {face} names wedge {wedge}, but there are only {count} wedges")]
    BadWedge {
        /// Face that refers to it.
        face: FaceId,
        /// Wedge that does not exist.
        wedge: u32,
        /// Number of wedges.
        count: usize,
    },
    /// A wedge is used at two vertices.
    #[error("face {face} uses wedge w{wedge} at vertex {vertex}, an earlier face at another")]
    SharedWedge {
        /// Face that uses the wedge at a second vertex.
        face: FaceId,
        /// Wedge used at two vertices.
        wedge: u32,
        /// Second of the two vertices.
        vertex: VertexId,
    },
    /// An array has another length than the array it belongs to requires.
    #[error("{what}: {found} entries, but {expected} are needed")]
    BadLength {
        /// Name of the array.
        what: String,
        /// Length of the array.
        found: usize,
        /// Length it must have.
        expected: usize,
    },
    /// The label of a face has no name.
    #[error("face {face} has {what} {label}, but there are only {count} {what}s")]
    BadLabel {
        /// Face with the label.
        face: FaceId,
        /// Kind of label: `material` or `object`.
        what: &'static str,
        /// Label without a name.
        label: u32,
        /// Number of names.
        count: usize,
    },
}

impl Mesh {
    /// Creates a mesh without attributes or labels.
    pub fn new(positions: Vec<[f64; 3]>, faces: Vec<[VertexId; 3]>) -> Self {
        Self { positions, faces, ..Self::default() }
    }

    /// Returns the positions of the three corners of a face.
    #[inline]
    pub fn triangle(&self, [a, b, c]: [VertexId; 3]) -> [DVec3; 3] {
        let at = |v: VertexId| DVec3::from(self.positions[v.index()]);
        [at(a), at(b), at(c)]
    }

    /// Returns the box around the vertices that faces use; unused vertices do not count.
    pub fn bounds(&self) -> Bounds {
        let used = self.used_vertices();
        Bounds::of(self.positions.iter().zip(used).filter(|(_, used)| *used).map(|(p, _)| p))
    }

    /// Returns a flag for each vertex: true if a face uses it.
    pub fn used_vertices(&self) -> Vec<bool> {
        let mut used = vec![false; self.positions.len()];
        for v in self.faces.iter().flatten() {
            used[v.index()] = true;
        }
        used
    }

    /// Checks that every position is finite, every index in range, every array of the right length,
    /// and every wedge at one vertex only.
    ///
    /// Meshes from readers have passed this check.
    /// # Errors
    /// The first violation found.
    pub fn validate(&self) -> Result<(), MeshError> {
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
        self.validate_attributes()
    }

    /// Checks attributes, materials and objects as [`Mesh::validate`] does, whatever the faces are.
    /// # Errors
    /// The first violation found.
    pub fn validate_attributes(&self) -> Result<(), MeshError> {
        self.validate_corners()?;
        self.validate_labels("material", self.materials.as_ref())?;
        self.validate_labels("object", self.objects.as_ref())
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

    /// Removes the vertices and wedges that no face uses; the others keep their order.
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
    /// Removes the wedges that no corner uses; the others keep their order.
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
