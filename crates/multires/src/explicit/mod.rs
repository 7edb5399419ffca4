//! The explicit MT: triangles stored, dependencies stored. The oracle for everything else.
//!
//! Every triangle of every level is there once, between two updates: the one that makes it and the one
//! that takes it away for finer ones. That pair is the arc that it lies on. Nothing is clever here, and
//! nothing is fast.

mod build;
mod extract;

use crate::frame::Frame;
use crate::pack::ExactPositions;
use crate::query::{Ball, Criterion};

pub use extract::ExplicitCut;

/// All triangles of all levels, and the updates between them.
#[derive(Clone, Debug)]
pub struct Explicit {
    frame: Frame,
    positions: Vec<[f32; 3]>,
    /// Of the input's vertices, where they are kept as they were.
    exact: ExactPositions,
    updates: Vec<ExplicitUpdate>,
    /// By their nodes.
    triangles: Vec<ExplicitTriangle>,
    /// The update that splits each node; `None` for leaves.
    splits: Vec<Option<u32>>,
}

/// A local change.
#[derive(Clone, Debug)]
struct ExplicitUpdate {
    /// The triangles it takes away, all around one node.
    coarse: Vec<u32>,
    /// The triangles it makes instead, with the same boundary.
    fine: Vec<u32>,
    /// The updates that make its coarse triangles: they must come first.
    needs: Vec<u32>,
    ball: Ball,
}

#[derive(Clone, Copy, Debug)]
struct ExplicitTriangle {
    nodes: [u32; 3],
    /// The update that makes it; `None` for those of the base.
    maker: Option<u32>,
    /// The update that refines it; `None` for the finest.
    refiner: Option<u32>,
}

impl Explicit {
    /// How many updates there are.
    pub fn update_count(&self) -> usize {
        self.updates.len()
    }

    /// How many triangles all levels have together.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// What it takes in memory: its vectors, as they are.
    pub fn bytes(&self) -> usize {
        let lists = |u: &ExplicitUpdate| 4 * (u.coarse.len() + u.fine.len() + u.needs.len());
        size_of_val(&self.positions[..])
            + self.exact.bytes()
            + size_of_val(&self.updates[..])
            + self.updates.iter().map(lists).sum::<usize>()
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.splits[..])
    }

    /// Whether a triangle is good enough for a query: no corner's own update is wanted. The triangle
    /// lies in the ball of one of them, that of the update that refines it.
    fn is_valid(&self, criterion: &Criterion<'_>, triangle: u32) -> bool {
        let wanted = |&node: &u32| {
            let update = self.splits[node as usize];
            update.is_some_and(|u| criterion.refines(&self.updates[u as usize].ball))
        };
        !self.triangles[triangle as usize].nodes.iter().any(wanted)
    }
}
