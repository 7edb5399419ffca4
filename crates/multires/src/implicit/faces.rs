//! The face list: each face of the finest mesh as three leaves, filed under the update that creates
//! it.
//!
//! A face of a cut is a face of the finest mesh with each corner moved up to the active node above
//! it. So a cut is written in two loops without any neighbourhood: one descends the forest and
//! notes for each run of leaves the vertex that shows it, the other looks up three leaves for each
//! face of each applied update.

use std::ops::Range;

use super::Order;
use crate::forest::{Forest, NONE};

/// Faces of the finest mesh, in 16 bytes per update up to two million vertices and 24 beyond.
///
/// If the model has wedges, the leaves here are those of the forest of wedges.
#[derive(Clone, Debug)]
pub(crate) struct Faces {
    leaves: u32,
    /// Leaves below each wedge, as one range, if the model has wedges.
    below: Vec<Range<u32>>,
    /// Faces of the base mesh.
    base: Vec<[u32; 3]>,
    created: CreatedFaces,
}

/// Up to two faces per update.
#[derive(Clone, Debug)]
enum CreatedFaces {
    /// Three indices of 21 bits.
    Small(Vec<[u64; 2]>),
    Large(Vec<[[u32; 3]; 2]>),
}

const BITS: u32 = 21;
const SMALL: u32 = 1 << BITS;
/// Marks a missing face, with a bit that no face sets.
const NO_FACE: u64 = 1 << 63;

impl Faces {
    /// Collects the faces of a forest, in the order of the model.
    pub(crate) fn in_order(forest: &Forest, order: &Order) -> Self {
        let Some(wedges) = &forest.wedges else {
            let mut leaf_of = vec![NONE; forest.vertices];
            (0..).zip(&order.leaves).for_each(|(number, &leaf)| leaf_of[leaf as usize] = number);
            let faces = forest.faces.iter().map(|face| face.map(|leaf| leaf_of[leaf as usize]));
            return Self::new(forest, order, faces, order.leaves.len() as u32);
        };
        let below = wedges.leaves_below(forest.vertices, order);
        let first = |wedge: u32| below[wedge as usize].start;
        let faces = wedges.corners.iter().map(|face| face.map(first));
        let leaves = below.iter().map(|leaves| leaves.end).max().unwrap_or(0);
        let in_order = order.nodes.iter().flat_map(|&node| wedges.of(node));
        let below_packed = in_order.map(|wedge| below[wedge as usize].clone()).collect();
        Self { below: below_packed, ..Self::new(forest, order, faces, leaves) }
    }

    fn new(
        forest: &Forest,
        order: &Order,
        faces: impl Iterator<Item = [u32; 3]>,
        leaves: u32,
    ) -> Self {
        let mut base = Vec::new();
        let mut created = vec![[[NONE; 3]; 2]; order.updates.len()];
        for (face, &by) in faces.zip(&forest.created_by) {
            if by == NONE {
                base.push(face);
                continue;
            }
            let places = &mut created[order.index_of_update[by as usize] as usize];
            let free = places.iter_mut().find(|place| place[0] == NONE);
            *free.expect("no edge that is contracted has more than two faces") = face;
        }
        let created = if leaves <= SMALL {
            CreatedFaces::Small(created.iter().map(|faces| faces.map(pack)).collect())
        } else {
            CreatedFaces::Large(created)
        };
        Self { leaves, below: Vec::new(), base, created }
    }

    /// Returns the memory used.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.base[..])
            + size_of_val(&self.below[..])
            + match &self.created {
                CreatedFaces::Small(faces) => size_of_val(&faces[..]),
                CreatedFaces::Large(faces) => size_of_val(&faces[..]),
            }
    }

    /// Returns the number of faces of the base mesh.
    pub(crate) fn base_faces(&self) -> usize {
        self.base.len()
    }

    /// Returns the number of faces that an update creates.
    #[inline]
    pub(crate) fn created_count(&self, update: u32) -> usize {
        match &self.created {
            CreatedFaces::Small(faces) => {
                faces[update as usize].iter().filter(|&&face| face != NO_FACE).count()
            }
            CreatedFaces::Large(faces) => {
                faces[update as usize].iter().filter(|face| face[0] != NONE).count()
            }
        }
    }

    /// Appends the faces of the base mesh and of the given updates, with the vertex that shows each
    /// leaf.
    pub(super) fn write(&self, made: &[u32], above: &[u32], to: &mut Vec<[u32; 3]>) {
        let shown = |face: [u32; 3]| face.map(|leaf| above[leaf as usize]);
        to.extend(self.base.iter().map(|&face| shown(face)));
        match &self.created {
            CreatedFaces::Small(faces) => {
                for &update in made {
                    for &face in faces[update as usize].iter().filter(|&&face| face != NO_FACE) {
                        to.push(shown(unpack(face)));
                    }
                }
            }
            CreatedFaces::Large(faces) => {
                for &update in made {
                    for &face in faces[update as usize].iter().filter(|face| face[0] != NONE) {
                        to.push(shown(face));
                    }
                }
            }
        }
    }

    /// Returns the leaves below a wedge of a model that has wedges.
    #[inline]
    pub(super) fn below(&self, wedge: u32) -> Range<usize> {
        let Range { start, end } = self.below[wedge as usize];
        start as usize..end as usize
    }

    /// Returns the number of leaves.
    pub(super) fn leaves(&self) -> usize {
        self.leaves as usize
    }
}

fn pack(face: [u32; 3]) -> u64 {
    if face[0] == NONE {
        return NO_FACE;
    }
    let [a, b, c] = face.map(u64::from);
    a | b << BITS | c << (2 * BITS)
}

fn unpack(face: u64) -> [u32; 3] {
    [0, 1, 2].map(|k| (face >> (k * BITS)) as u32 & (SMALL - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_come_back_unchanged() {
        for face in [[0, 1, 2], [SMALL - 1, 0, SMALL - 1], [7, SMALL - 1, 12345]] {
            assert_eq!(unpack(pack(face)), face);
            assert_ne!(pack(face), NO_FACE);
        }
        assert_eq!(pack([NONE; 3]), NO_FACE);
    }
}
