//! The positions of a compressed mesh, by whatever scheme.

use crate::blocks::VertexBlocks;
use crate::bytes::{Malformed, Reader};
use crate::lattice::LatticeBlocks;
use crate::parts::PackedParts;

/// By parts, of each node; by the others, of each vertex.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Positions {
    Parts(PackedParts),
    Lattice(LatticeBlocks),
    Blocks(VertexBlocks),
}

impl Positions {
    /// Where all are.
    pub(super) fn all(&self) -> Vec<[f64; 3]> {
        match self {
            Self::Parts(parts) => parts.positions(),
            Self::Lattice(blocks) => blocks.positions(),
            Self::Blocks(blocks) => blocks.positions(),
        }
    }

    /// Where one is, by its number among all.
    pub(super) fn at(&self, number: usize) -> [f64; 3] {
        match self {
            Self::Parts(parts) => parts.position(number),
            Self::Lattice(blocks) => blocks.position(number),
            Self::Blocks(blocks) => blocks.position(number),
        }
    }

    pub(super) fn len(&self) -> usize {
        match self {
            Self::Parts(parts) => parts.rows().nodes(),
            Self::Lattice(blocks) => blocks.len(),
            Self::Blocks(blocks) => blocks.len(),
        }
    }

    /// How many vertices have them.
    pub(super) fn vertices(&self) -> usize {
        match self {
            Self::Parts(parts) => parts.vertices(),
            _ => self.len(),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Parts(parts) => parts.bytes(),
            Self::Lattice(blocks) => blocks.bytes(),
            Self::Blocks(blocks) => blocks.bytes(),
        }
    }

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
            _ => Err(reader.wrong(format!("scheme {tag} is not known"))),
        }
    }
}
