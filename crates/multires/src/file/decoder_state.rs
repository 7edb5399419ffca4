//! What is known of a file while it is read or written: nodes, and the updates that make them.

use glam::Vec3;

use super::exact_positions::Deltas;
use super::lattice::Lattice;
use super::normal_predictor::NormalPredictor;
use crate::forest::NONE;
use crate::frame::Frame;
use crate::implicit::{BaseMesh, DetachedUpdate};
use crate::pack::ExactPositions;

/// The base and some runs of updates. Those of a file that was read in part are numbered without gaps.
pub(super) struct DecoderState {
    frame: Frame,
    pub(super) lattice: Lattice,
    pub(super) base: BaseMesh,
    pub(super) updates: Vec<DetachedUpdate>,
    /// Of the finest mesh's vertices, by the numbers here, where they are kept to the bit.
    exact: ExactPositions,
    /// By run of updates: its first in the file, and its first here.
    runs: Vec<[u32; 2]>,
}

impl DecoderState {
    pub(super) fn new(
        frame: Frame,
        lattice: Lattice,
        base: BaseMesh,
        exact: ExactPositions,
    ) -> Self {
        Self { frame, lattice, base, updates: Vec::new(), exact, runs: Vec::new() }
    }

    /// What comes next are the updates of the file from this one on.
    pub(super) fn begin_run(&mut self, update: u32) {
        self.runs.push([update, self.updates.len() as u32]);
    }

    /// The number here of a node of the file; [`NONE`] if it is not here.
    pub(super) fn local_node(&self, node: u32) -> u32 {
        let roots = self.root_count();
        let Some(child) = node.checked_sub(roots) else { return node };
        let next = self.runs.partition_point(|run| run[0] <= child / 2);
        let Some(last) = next.checked_sub(1) else { return NONE };
        let [first, here] = self.runs[last];
        let end = self.runs.get(next).map_or(self.updates.len() as u32, |run| run[1]);
        let update = here + (child / 2 - first);
        if update < end { roots + 2 * update + child % 2 } else { NONE }
    }

    /// The update that makes a node; none for a root.
    pub(super) fn creator(&self, node: u32) -> Option<&DetachedUpdate> {
        let child = node.checked_sub(self.root_count());
        child.map(|child| &self.updates[child as usize / 2])
    }

    /// Where a node is.
    pub(super) fn stored_position(&self, node: u32) -> Vec3 {
        let side = node.wrapping_sub(self.root_count()) as usize % 2;
        self.creator(node).map_or_else(|| self.base.positions[node as usize], |u| u.children[side])
    }

    /// The nodes that an update makes.
    pub(super) fn children(&self, update: usize) -> [u32; 2] {
        let first = self.root_count() + 2 * update as u32;
        [first, first + 1]
    }

    /// Where a node is to the bit, if known.
    pub(super) fn exact_position(&self, node: u32) -> Option<[f64; 3]> {
        self.exact.get(node)
    }

    /// Whether positions of the finest mesh's vertices are kept to the bit.
    pub(super) fn is_lossless(&self) -> bool {
        self.exact.is_lossless()
    }

    /// Adds where a node is to the bit, by the steps from its place, or says why it cannot be; nodes come by
    /// rising numbers.
    pub(super) fn add_exact_position(
        &mut self,
        node: u32,
        steps: &Deltas,
        at: usize,
    ) -> Result<(), &'static str> {
        let position = steps.position(at, self.predicted_position(node));
        let position = position.ok_or("a position of it is no number")?;
        let is_near =
            self.lattice.is_place_of(self.stored_position(node), self.frame.point(position.into()));
        is_near
            .then(|| self.exact.push(node, position))
            .ok_or("a position of it is not at its place")
    }

    /// The model so far: its base, its updates, and the positions to the bit.
    pub(super) fn into_parts(self) -> (BaseMesh, Vec<DetachedUpdate>, ExactPositions) {
        (self.base, self.updates, self.exact)
    }

    /// Whether places are numbers in model units.
    pub(super) fn are_finite(&self, places: &[Vec3]) -> bool {
        places.iter().all(|&place| self.frame.holds(place))
    }

    /// Where a node is by the lattice, in model units.
    pub(super) fn predicted_position(&self, node: u32) -> [f64; 3] {
        self.frame.model(self.stored_position(node).into())
    }

    /// How the surface leans at a node.
    pub(super) fn normal_predictor(&self, node: u32) -> NormalPredictor {
        let mut node = Some(node);
        NormalPredictor::of(std::array::from_fn(|_| {
            let above = self.creator(node?)?;
            node = Some(above.parent);
            Some(above.children)
        }))
    }

    pub(super) fn root_count(&self) -> u32 {
        self.base.positions.len() as u32
    }
}
