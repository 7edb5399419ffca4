//! Positions of a compressed mesh: the one place that tells the three schemes apart.

use crate::blocks::VertexBlocks;
use crate::bytes::{Malformed, Reader};
use crate::kd::BLOCK;
use crate::lattice::LatticeBlocks;
use crate::parts::PackedParts;

/// Stored positions: of each node with parts, of each vertex with the two block schemes.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Positions {
    Parts(PackedParts),
    Lattice(LatticeBlocks),
    Blocks(VertexBlocks),
}

impl Positions {
    /// Decodes all positions.
    pub(super) fn all(&self) -> Vec<[f64; 3]> {
        match self {
            Self::Parts(parts) => parts.positions(),
            Self::Lattice(blocks) => blocks.positions(),
            Self::Blocks(blocks) => blocks.positions(),
        }
    }

    /// Decodes one position by its index.
    pub(super) fn at(&self, index: usize) -> [f64; 3] {
        match self {
            Self::Parts(parts) => parts.position(index),
            Self::Lattice(blocks) => blocks.position(index),
            Self::Blocks(blocks) => blocks.position(index),
        }
    }

    /// Returns the number of stored positions.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Parts(parts) => parts.rows().nodes(),
            Self::Lattice(blocks) => blocks.len(),
            Self::Blocks(blocks) => blocks.len(),
        }
    }

    /// Returns the number of vertices of the mesh, which parts store more than once.
    pub(super) fn vertices(&self) -> usize {
        self.parts().map_or_else(|| self.len(), PackedParts::vertices)
    }

    /// Returns the number of parts or of vertex blocks.
    pub(super) fn blocks(&self) -> usize {
        self.parts().map_or_else(|| self.len().div_ceil(BLOCK), |parts| parts.rows().len())
    }

    /// Returns the parts, if positions are stored in parts.
    pub(super) fn parts(&self) -> Option<&PackedParts> {
        if let Self::Parts(parts) = self { Some(parts) } else { None }
    }

    /// Returns the stored size in bytes.
    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Parts(parts) => parts.bytes(),
            Self::Lattice(blocks) => blocks.bytes(),
            Self::Blocks(blocks) => blocks.bytes(),
        }
    }

    /// Returns the number that the file header has for the scheme.
    pub(super) fn tag(&self) -> u8 {
        match self {
            Self::Parts(_) => 0,
            Self::Lattice(_) => 1,
            Self::Blocks(_) => 2,
        }
    }

    pub(super) fn store(&self, out: &mut Vec<u8>) {
        match self {
            Self::Parts(parts) => parts.store(out),
            Self::Lattice(blocks) => blocks.store(out),
            Self::Blocks(blocks) => blocks.store(out),
        }
    }

    pub(super) fn restore(tag: u8, reader: &mut Reader) -> Result<Self, Malformed> {
        match tag {
            0 => PackedParts::restore(reader).map(Self::Parts),
            1 => LatticeBlocks::restore(reader).map(Self::Lattice),
            2 => VertexBlocks::restore(reader).map(Self::Blocks),
            _ => Err(reader.wrong(format!("unknown scheme {tag}"))),
        }
    }
}
