//! Where the two children of a node are: told by how far apart they are, and by how far their middle is from
//! their parent.

use std::io;

use glam::Vec3;

use super::lattice::Lattice;
use super::normal_predictor::NormalPredictor;
use super::streams::Unpacker;
use crate::frame::Length16;
use crate::pack::radius8;

/// Where the two children of a node are.
pub(super) struct ChildOffsets {
    /// From the first to the second.
    pub(super) apart: [i32; 3],
    /// From the parent to their middle, without what `apart` tells.
    pub(super) middle: [i32; 3],
}

/// Many of them, and how much larger their balls are than they have to be, by codes.
pub(super) struct OffsetStreams {
    apart: [Vec<i32>; 3],
    middle: [Vec<i32>; 3],
    pub(super) radii: Vec<i32>,
}

impl OffsetStreams {
    pub(super) fn read(input: &mut Unpacker<'_>, count: usize) -> io::Result<Self> {
        let (mut apart, mut middle) = <([Vec<i32>; 3], [Vec<i32>; 3])>::default();
        for k in 0..3 {
            apart[k] = input.signed(count)?;
            middle[k] = input.signed(count)?;
        }
        Ok(Self { apart, middle, radii: input.signed(count)? })
    }

    pub(super) fn offsets(&self, at: usize) -> ChildOffsets {
        ChildOffsets {
            apart: [0, 1, 2].map(|k| self.apart[k][at]),
            middle: [0, 1, 2].map(|k| self.middle[k][at]),
        }
    }
}

impl ChildOffsets {
    pub(super) fn of(lattice: Lattice, parent: Vec3, children: [Vec3; 2]) -> Self {
        let parent = lattice.round(parent);
        let [a, b] = children.map(|child| lattice.round(child));
        let apart = [0, 1, 2].map(|k| b[k] - a[k]);
        // Their sum is odd where their difference is.
        let middle = [0, 1, 2].map(|k| (a[k] + b[k] - 2 * parent[k] - (apart[k] & 1)) / 2);
        Self { apart, middle }
    }

    pub(super) fn encoded(&self, predictor: &NormalPredictor) -> Self {
        Self { apart: predictor.encode(self.apart), middle: predictor.encode(self.middle) }
    }

    pub(super) fn decoded(&self, predictor: &NormalPredictor) -> Self {
        Self { apart: predictor.decode(self.apart), middle: predictor.decode(self.middle) }
    }

    /// None where they would be out of reach.
    pub(super) fn children(&self, lattice: Lattice, parent: Vec3) -> Option<[Vec3; 2]> {
        let parent = lattice.round(parent);
        let ends = [-1, 1].map(|side| {
            lattice.place([0, 1, 2].map(|k| {
                let apart = i64::from(self.apart[k]);
                let sum = 2 * (i64::from(self.middle[k]) + i64::from(parent[k])) + (apart & 1);
                (sum + side * apart) / 2
            }))
        });
        Some([ends[0]?, ends[1]?])
    }

    /// What a ball around them would take at least, about.
    pub(super) fn predicted_radius8(&self, lattice: Lattice) -> u8 {
        let squared: f64 = self.apart.iter().map(|&x| f64::from(x) * f64::from(x)).sum();
        radius8(Length16::up(squared.sqrt() * lattice.cell()))
    }
}
