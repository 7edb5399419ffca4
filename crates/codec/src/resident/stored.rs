//! A compressed mesh as it is stored, for renderers that decode positions on the GPU.

use std::ops::Range;

use meshlod_mesh::{Layer, LayerKind};

use super::{Compressed, Positions, StoredStrips};
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
    /// Triangle strips that draw the faces, if the file has them in their place.
    pub strips: Option<StoredStrips<'a>>,
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
        let (mut faces, mut patches) = (Vec::new(), Vec::with_capacity(self.faces.len()));
        for patch in 0..self.faces.len() {
            let start = faces.len() as u32;
            faces.extend(self.faces.of_patch(patch)?);
            patches.push(start..faces.len() as u32);
        }
        let positions = match &self.positions {
            Positions::Parts(parts) => StoredPositions::Parts(parts.stored()),
            Positions::Lattice(blocks) => StoredPositions::Lattice(blocks.stored()),
            Positions::Blocks(blocks) => StoredPositions::Blocks(blocks.stored()),
        };
        let position_of = self.wedge_vertices.position_of(self.faces.rows());
        let strips = self.faces.strips().map(StoredStrips::new);
        Ok(StoredMesh { positions, position_of, faces, patches, strips })
    }

    /// Decodes the values that nodes have in the first layer of a kind; `None` if there is none.
    pub fn node_values(&self, kind: LayerKind) -> Option<Layer> {
        self.layers.iter().find(|layer| layer.kind() == kind).map(PackedLayer::decode)
    }
}

#[cfg(test)]
mod tests {
    use meshlod_samples as samples;

    use super::*;
    use crate::lattice::StoredShear;
    use crate::{CompressionTarget, Reconstruction, Scheme, compress};
    use meshlod_mesh::AttributeBounds;

    fn number(words: &[u64], at: u64, width: u32) -> u128 {
        let bit = |bit: u64| u128::from(words[(bit / 64) as usize] >> (bit % 64) & 1);
        (0..u64::from(width)).map(|k| bit(at + k) << k).sum()
    }

    /// Decodes the stored position with an index as the documentation says.
    fn place(positions: &StoredPositions<'_>, at: usize) -> [f64; 3] {
        match positions {
            StoredPositions::Parts(parts) => {
                let part = parts.parts.iter().find(|part| part.nodes.contains(&(at as u32)));
                let offset = part.unwrap().offset;
                [0, 1, 2].map(|k| {
                    let cell = offset[k] + i32::from(parts.positions[at][k]);
                    f64::from(parts.cell[k]) * (f64::from(cell) + parts.within)
                })
            }
            StoredPositions::Blocks(stored) => {
                let block = &stored.blocks[at / 32];
                let pair = block.widths.iter().map(|&width| u64::from(width)).sum::<u64>();
                let mut start = block.start + (at % 32 / 2) as u64 * pair;
                let mut place = [0, 1, 2].map(|k| stored.centre[k] + block.first[k]);
                for axis in 0..3 {
                    let both = number(stored.words, start, block.widths[axis].into()) as u64;
                    let cells = block.cells(axis);
                    let own = if at.is_multiple_of(2) { both % cells } else { both / cells };
                    (0..3).for_each(|k| place[k] += block.sides[axis][k] * own as f64);
                    start += u64::from(block.widths[axis]);
                }
                place
            }
            StoredPositions::Lattice(stored) => {
                let cell = cell(&stored.blocks[at / 32], stored.words, at % 32);
                let side = f64::from(stored.exponent).exp2();
                [0, 1, 2].map(|k| (stored.first[k] + cell[k]) as f64 * side)
            }
        }
    }

    fn cell(block: &StoredShear, words: &[u64], at: usize) -> [i64; 3] {
        let (tuple, width) = (usize::from(block.tuple), u32::from(block.width));
        let mut digits = number(words, block.start + (at / tuple) as u64 * u64::from(width), width);
        let spans = block.spans().map(u128::from);
        (0..at % tuple).for_each(|_| digits /= spans[0] * spans[1] * spans[2]);
        let mut next = |span: u128| {
            let digit = (digits % span) as i64 - span as i64 / 2;
            digits /= span;
            digit
        };
        let [mut u, mut v, mut w] = spans.map(&mut next);
        let [a, b, c, d] = block.slopes.map(i64::from);
        let [e, f, g] = block.bends.map(i64::from);
        let [across_u, across_v, _] = spans.map(|span| 64 * span as i64);
        v += (b * u).div_euclid(64);
        u += (a * v).div_euclid(64);
        w += (c * u).div_euclid(64) + (d * v).div_euclid(64);
        w += (u * (e * u + f * v)).div_euclid(across_u) + (g * v * v).div_euclid(across_v);
        let mut cell = [0; 3];
        for (k, x) in [u, v, w].into_iter().enumerate() {
            let axis = (usize::from(block.axis) + 1 + k) % 3;
            cell[axis] = i64::from(block.middle[k]) + x;
        }
        cell
    }

    #[test]
    fn stored_bits_are_what_the_documentation_says() {
        for mesh in [samples::gyroid(3000), samples::fish(2000), samples::sphere(300)] {
            for scheme in [Scheme::Parts(Reconstruction::Centred), Scheme::Blocks, Scheme::Lattice]
            {
                for bits in [7, 11, 16] {
                    let target = CompressionTarget::Bits(bits);
                    let done = compress(&mesh, scheme, target, &AttributeBounds::default());
                    let compressed = done.unwrap().compressed;
                    let (stored, decoded) =
                        (compressed.stored().unwrap(), compressed.decode().unwrap());
                    assert_eq!(stored.faces.len(), decoded.faces.len());
                    let diagonal = decoded.bounds().diagonal();
                    for (face, is) in stored.faces.iter().zip(&decoded.faces) {
                        for (&node, vertex) in face.iter().zip(is) {
                            let at = stored.position_of[node as usize] as usize;
                            let (place, is) =
                                (place(&stored.positions, at), decoded.positions[vertex.index()]);
                            let away = (0..3).map(|k| (place[k] - is[k]).abs()).fold(0.0, f64::max);
                            assert!(away <= 1e-14 * diagonal, "{scheme:?} {bits}: {away}");
                        }
                    }
                }
            }
        }
    }
}
