//! The mesh itself.

use glam::DVec3;
use thiserror::Error;

use crate::{Attributes, Bounds, FaceId, Labels, VertexId};

/// A triangle mesh: positions, faces, and what hangs on them.
///
/// Faces index positions; that alone is its topology. [`Mesh::validate`] says what must hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// One point per vertex, in model units.
    pub positions: Vec<[f64; 3]>,
    /// Three vertices per face, counter-clockwise seen from outside.
    pub faces: Vec<[VertexId; 3]>,
    /// Normals, uvs, colours and so on, over wedges.
    pub attributes: Option<Attributes>,
    /// The material of each face.
    pub materials: Option<Labels>,
    /// The named object of each face.
    pub objects: Option<Labels>,
}

/// Why a mesh is not one.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MeshError {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite: {position:?}")]
    NotFinite {
        /// The vertex.
        vertex: VertexId,
        /// Its position.
        position: [f64; 3],
    },
    /// A face names a vertex that is not there.
    #[error("face {face} names vertex {vertex}, but there are only {count} vertices")]
    BadVertex {
        /// The face.
        face: FaceId,
        /// The vertex it names.
        vertex: VertexId,
        /// How many vertices there are.
        count: usize,
    },
    /// A corner names a wedge that is not there.
    #[error("face {face} names wedge {wedge}, but there are only {count} wedges")]
    BadWedge {
        /// The face.
        face: FaceId,
        /// The wedge it names.
        wedge: u32,
        /// How many wedges there are.
        count: usize,
    },
    /// A wedge stands at two vertices.
    #[error("face {face} has wedge w{wedge} at {vertex}, another face has it elsewhere")]
    SharedWedge {
        /// The face.
        face: FaceId,
        /// The wedge.
        wedge: u32,
        /// The vertex it is at there.
        vertex: VertexId,
    },
    /// An array that goes with another has the wrong length.
    #[error("{what} has {found} entries where {expected} are needed")]
    BadLength {
        /// Which array.
        what: String,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// A face is labelled with a name that is not there.
    #[error("face {face} has {what} {label}, but there are only {count}")]
    BadLabel {
        /// The face.
        face: FaceId,
        /// Material or object.
        what: &'static str,
        /// The label.
        label: u32,
        /// How many names there are.
        count: usize,
    },
}

impl Mesh {
    /// A mesh of bare geometry.
    pub fn new(positions: Vec<[f64; 3]>, faces: Vec<[VertexId; 3]>) -> Self {
        Self { positions, faces, ..Self::default() }
    }

    /// The three corner positions of a face.
    #[inline]
    pub fn triangle(&self, [a, b, c]: [VertexId; 3]) -> [DVec3; 3] {
        let at = |v: VertexId| DVec3::from(self.positions[v.index()]);
        [at(a), at(b), at(c)]
    }

    /// The box around the vertices that faces use; unused vertices do not count.
    pub fn bounds(&self) -> Bounds {
        let used = self.used_vertices();
        Bounds::of(self.positions.iter().zip(used).filter(|(_, used)| *used).map(|(p, _)| p))
    }

    /// One flag per vertex: does any face use it?
    pub fn used_vertices(&self) -> Vec<bool> {
        let mut used = vec![false; self.positions.len()];
        for v in self.faces.iter().flatten() {
            used[v.index()] = true;
        }
        used
    }

    /// Checks that every index is in range, every array as long as its partner, every position
    /// finite. What a reader gives back has passed this.
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

    /// The part of [`Mesh::validate`] that is about what hangs on faces: attributes, materials and
    /// objects, whatever the faces are.
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

    /// Every wedge belongs to one vertex.
    fn validate_wedges(&self, attributes: &Attributes) -> Result<(), MeshError> {
        // As many as corners name: nothing else here is as long as the count says.
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

    /// Drops the vertices and wedges that no face uses; the rest keep their order.
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
    /// Drops the wedges that no corner uses; the rest keep their order.
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

/// Old index → new index for the used ones (others keep `u32::MAX`), and the used ones in order.
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
