//! The hierarchy: four boxes a node, triangles in the order of the leaves.

use glam::Vec4;
use meshlod_mesh::{FaceId, Mesh, MeshError};
use rayon::prelude::*;
use thiserror::Error;

use crate::build::build;
use crate::frame::Frame;
use crate::triangle::Triangle;

/// A bounding volume hierarchy over the faces of a mesh, which it does not keep.
///
/// Size: about 120 bytes a face. The same for any number of threads.
#[derive(Clone, Debug)]
pub struct Bvh {
    pub(crate) frame: Frame,
    pub(crate) nodes: Vec<Node>,
    /// In the order of the leaves, in local coordinates.
    pub(crate) triangles: Vec<Triangle>,
    /// The face of each triangle.
    pub(crate) faces: Vec<FaceId>,
    /// Where each face stands in `triangles`.
    pub(crate) slots: Vec<u32>,
}

/// Why there is no hierarchy.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum BvhError {
    /// There is nothing to be close to.
    #[error("the mesh has no faces")]
    Empty,
    /// The mesh breaks its own rules.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Four children, each an inner node or a run of triangles; two cache lines.
///
/// Boxes are axis by axis, one lane a child, so that one pass looks at all four.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Node {
    /// Least corners, rounded down: x of all four, then y, then z.
    pub(crate) lo: [Vec4; 3],
    /// Greatest corners, rounded up.
    pub(crate) hi: [Vec4; 3],
    /// An inner child's node, a leaf's first triangle.
    pub(crate) first: [u32; 4],
    /// How many triangles a leaf has, or [`INNER`]; a child that is not there has none.
    pub(crate) count: [u8; 4],
}

/// The count that marks a child as an inner node.
pub(crate) const INNER: u8 = u8::MAX;

impl Bvh {
    /// Builds the hierarchy over all faces of `mesh`, degenerate ones included.
    ///
    /// Cost: O(n log n), n = faces; in parallel.
    /// # Errors
    /// No faces; a position that is not finite; an index out of range.
    pub fn new(mesh: &Mesh) -> Result<Self, BvhError> {
        mesh.validate()?;
        if mesh.faces.is_empty() {
            return Err(BvhError::Empty);
        }
        let frame = Frame::of(&mesh.bounds());
        let triangle = |face: FaceId| -> Triangle {
            mesh.faces[face.index()].map(|v| frame.local(mesh.positions[v.index()]))
        };
        let (nodes, faces) = build(mesh.faces.len(), triangle);
        let triangles = faces.par_iter().map(|&face| triangle(face)).collect();
        let mut slots = vec![0; faces.len()];
        for (slot, face) in faces.iter().enumerate() {
            slots[face.index()] = slot as u32;
        }
        Ok(Self { frame, nodes, triangles, faces, slots })
    }

    /// All faces in an order in which neighbours follow one another: the order of the leaves.
    ///
    /// Queries made in such an order find each other's memory warm, and each other's answers are
    /// good hints.
    pub fn faces_in_order(&self) -> &[FaceId] {
        &self.faces
    }
}
