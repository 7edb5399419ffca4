//! Positions of the two children of a node, coded as the vector between them and the offset of
//! their midpoint from the parent.

use std::io;

use glam::Vec3;

use super::lattice::Lattice;
use super::normal_predictor::NormalPredictor;
use super::streams::Unpacker;
use crate::length16::Length16;
use crate::pack::radius8;

/// Positions of the two children of a node relative to their parent, in cells of the lattice.
pub(super) struct ChildOffsets {
    /// Vector from the first child to the second.
    pub(super) difference: [i32; 3],
    /// Vector from the parent to the midpoint of the children, without the half cells implied by
    /// the parity of `apart`.
    pub(super) midpoint: [i32; 3],
}

/// Decoded streams of child offsets, and the differences of ball radii from their prediction.
pub(super) struct OffsetStreams {
    difference: [Vec<i32>; 3],
    midpoint: [Vec<i32>; 3],
    pub(super) radii: Vec<i32>,
}

impl OffsetStreams {
    pub(super) fn read(input: &mut Unpacker<'_>, count: usize) -> io::Result<Self> {
        let (mut difference, mut midpoint) = <([Vec<i32>; 3], [Vec<i32>; 3])>::default();
        for k in 0..3 {
            difference[k] = input.signed(count)?;
            midpoint[k] = input.signed(count)?;
        }
        Ok(Self { difference, midpoint, radii: input.signed(count)? })
    }

    pub(super) fn offsets(&self, at: usize) -> ChildOffsets {
        ChildOffsets {
            difference: [0, 1, 2].map(|k| self.difference[k][at]),
            midpoint: [0, 1, 2].map(|k| self.midpoint[k][at]),
        }
    }
}

impl ChildOffsets {
    pub(super) fn of(lattice: Lattice, parent: Vec3, children: [Vec3; 2]) -> Self {
        let parent = lattice.round(parent);
        let [a, b] = children.map(|child| lattice.round(child));
        let difference = [0, 1, 2].map(|k| b[k] - a[k]);
        // The sum of the children's coordinates is odd where their difference is.
        let midpoint = [0, 1, 2].map(|k| (a[k] + b[k] - 2 * parent[k] - (difference[k] & 1)) / 2);
        Self { difference, midpoint }
    }

    pub(super) fn encoded(&self, predictor: &NormalPredictor) -> Self {
        Self {
            difference: predictor.encode(self.difference),
            midpoint: predictor.encode(self.midpoint),
        }
    }

    pub(super) fn decoded(&self, predictor: &NormalPredictor) -> Self {
        Self {
            difference: predictor.decode(self.difference),
            midpoint: predictor.decode(self.midpoint),
        }
    }

    /// Returns the class of the children's distance, from the codes alone: its double logarithm.
    pub(super) fn size_class(&self) -> u8 {
        let squares = self.difference.map(|x| u64::from(x.unsigned_abs()).pow(2) / 4 + 1);
        let sum = squares.iter().fold(0u64, |sum, &square| sum.saturating_add(square));
        (u64::BITS - sum.leading_zeros()) as u8
    }

    /// Returns the positions of both children, or `None` if one lies outside the lattice.
    pub(super) fn children(&self, lattice: Lattice, parent: Vec3) -> Option<[Vec3; 2]> {
        let parent = lattice.round(parent);
        let ends = [-1, 1].map(|side| {
            lattice.checked_position([0, 1, 2].map(|k| {
                let difference = i64::from(self.difference[k]);
                let sum =
                    2 * (i64::from(self.midpoint[k]) + i64::from(parent[k])) + (difference & 1);
                (sum + side * difference) / 2
            }))
        });
        Some([ends[0]?, ends[1]?])
    }

    /// Returns the code of the distance between the children, which predicts the radius of their
    /// parent's ball.
    pub(super) fn predicted_radius8(&self, lattice: Lattice) -> u8 {
        let squared: f64 = self.difference.iter().map(|&x| f64::from(x) * f64::from(x)).sum();
        radius8(Length16::up(squared.sqrt() * lattice.cell()))
    }
}
