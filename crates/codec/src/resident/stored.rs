//! A compressed mesh as it is stored, for renderers that decode positions on the GPU.

use std::ops::Range;

use meshlod_mesh::{Layer, LayerKind};

use super::{Compressed, Positions};
use crate::attributes::PackedLayer;
use crate::blocks::StoredBlocks;
use crate::bytes::Malformed;
use crate::lattice::StoredLattice;
use crate::parts::StoredParts;

/// Compressed mesh as an `.mlq` file stores it: positions in their bits, faces as indices.
///
/// Corners of faces are nodes: vertices, or wedges where there are attributes.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredMesh<'a> {
    /// Positions in one of the three schemes.
    pub positions: StoredPositions<'a>,
    /// Position of each node, as an index into the stored ones.
    pub position_of: Vec<u32>,
    /// Faces as nodes, patch by patch, in the order of [`Compressed::decode`].
    pub faces: Vec<[u32; 3]>,
    /// Faces of each patch.
    pub patches: Vec<Range<u32>>,
}

/// Stored positions in one of the three schemes.
#[derive(Clone, Debug, PartialEq)]
pub enum StoredPositions<'a> {
    /// 8 bits per axis, in parts that share a grid.
    Parts(StoredParts<'a>),
    /// Blocks of 32 vertices on a lattice.
    Lattice(StoredLattice<'a>),
    /// Blocks of 32 vertices, each with a matrix.
    Blocks(StoredBlocks<'a>),
}

impl Compressed {
    /// Returns the stored form of the mesh: its positions undecoded, its faces as indices.
    ///
    /// Cost: O(n) for the faces and headers.
    /// # Errors
    /// Damaged data that the checksums did not catch.
    pub fn stored(&self) -> Result<StoredMesh<'_>, Malformed> {
        let (mut faces, mut patches) = (Vec::new(), Vec::with_capacity(self.patches.len()));
        for patch in 0..self.patches.len() {
            let start = faces.len() as u32;
            faces.extend(self.patches.faces(patch)?);
            patches.push(start..faces.len() as u32);
        }
        let positions = match &self.positions {
            Positions::Parts(parts) => StoredPositions::Parts(parts.stored()),
            Positions::Lattice(blocks) => StoredPositions::Lattice(blocks.stored()),
            Positions::Blocks(blocks) => StoredPositions::Blocks(blocks.stored()),
        };
        let position_of = self.wedge_vertices.position_of(self.patches.rows());
        Ok(StoredMesh { positions, position_of, faces, patches })
    }

    /// Decodes the values that nodes have in the first layer of a kind; `None` if there is none.
    pub fn node_values(&self, kind: LayerKind) -> Option<Layer> {
        self.layers.iter().find(|layer| layer.kind() == kind).map(PackedLayer::decode)
    }
}
