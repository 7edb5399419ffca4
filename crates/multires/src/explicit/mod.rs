//! The explicit MT, with stored triangles and dependencies: the oracle for everything else.
//!
//! Every triangle of every level is stored once, between the update that creates it and the one
//! that replaces it by finer ones; that pair is the arc it lies on. Nothing here is clever, and
//! nothing is fast.

mod build;
mod extract;

use std::sync::Arc;

use meshlod_mesh::Frame;

use crate::pack::ExactPositions;
use crate::query::{Ball, Criterion};
use crate::wedges::Wedges;

pub use extract::ExplicitCut;

/// Explicit multi-triangulation (MT): the triangles of all levels, and the updates that exchange
/// them.
#[derive(Clone, Debug)]
pub struct Explicit {
    frame: Frame,
    positions: Vec<[f32; 3]>,
    /// Exact positions of the input's vertices, if the forest is lossless.
    exact: ExactPositions,
    updates: Vec<ExplicitUpdate>,
    /// Triangles, by their nodes.
    triangles: Vec<ExplicitTriangle>,
    /// Wedges at the corners of each triangle, in the forest's numbers; empty if the mesh has
    /// neither attributes, materials nor objects.
    corners: Vec<[u32; 3]>,
    /// Values, materials and objects of the wedges.
    wedges: Option<Arc<Wedges>>,
    /// Update that splits each node; `None` for leaves.
    splits: Vec<Option<u32>>,
}

/// A local change.
#[derive(Clone, Debug)]
struct ExplicitUpdate {
    /// Triangles that the update removes, the star of one node.
    coarse: Vec<u32>,
    /// Triangles that replace them, with the same boundary.
    fine: Vec<u32>,
    /// Updates that create the coarse triangles and so have to come first.
    needs: Vec<u32>,
    ball: Ball,
}

#[derive(Clone, Copy, Debug)]
struct ExplicitTriangle {
    nodes: [u32; 3],
    /// Update that creates it; `None` in the base mesh.
    creator: Option<u32>,
    /// Update that refines it; `None` in the finest mesh.
    refiner: Option<u32>,
}

impl Explicit {
    /// Returns the number of updates, each of which replaces some triangles by finer ones.
    pub fn update_count(&self) -> usize {
        self.updates.len()
    }

    /// Returns the number of triangles that occur in any level.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Returns the memory used by the model's vectors, in bytes.
    pub fn bytes(&self) -> usize {
        let lists = |u: &ExplicitUpdate| 4 * (u.coarse.len() + u.fine.len() + u.needs.len());
        size_of_val(&self.positions[..])
            + self.exact.bytes()
            + size_of_val(&self.updates[..])
            + self.updates.iter().map(lists).sum::<usize>()
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.corners[..])
            + self.wedges.as_ref().map_or(0, |wedges| wedges.bytes())
            + size_of_val(&self.splits[..])
    }

    /// Returns true if a triangle satisfies the criterion: no update that splits one of its corners
    /// is required. The triangle lies in the ball of one of them, that of the update that refines
    /// it.
    fn is_valid(&self, criterion: &Criterion<'_>, triangle: u32) -> bool {
        let wanted = |&node: &u32| {
            let update = self.splits[node as usize];
            update.is_some_and(|u| criterion.requires(&self.updates[u as usize].ball))
        };
        !self.triangles[triangle as usize].nodes.iter().any(wanted)
    }
}
