//! State shared by decoder and encoder: the nodes decoded so far and the updates that create them.

use glam::Vec3;
use meshlod_mesh::Frame;

use super::FileError;
use super::exact_coding::Deltas;
use super::lattice::Lattice;
use super::normal_predictor::NormalPredictor;
use super::wedge_state::WedgeState;
use crate::forest::NONE;
use crate::implicit::{BaseMesh, DetachedUpdate, Implicit, ModelInfo};
use crate::pack::ExactPositions;

/// Base mesh and runs of consecutive updates. If only some chunks are loaded, their updates are
/// renumbered without gaps.
pub(super) struct DecoderState {
    frame: Frame,
    pub(super) lattice: Lattice,
    pub(super) base: BaseMesh,
    pub(super) updates: Vec<DetachedUpdate>,
    /// Exact positions of vertices of the finest mesh, by local node.
    exact: ExactPositions,
    /// Wedges, if the file has any.
    pub(super) wedges: Option<WedgeState>,
    /// True if updates have stages.
    pub(super) has_stages: bool,
    /// First update of each run, by its number in the file and by its local number.
    runs: Vec<[u32; 2]>,
}

impl DecoderState {
    pub(super) fn new(
        frame: Frame,
        lattice: Lattice,
        base: BaseMesh,
        exact: ExactPositions,
    ) -> Self {
        Self {
            frame,
            lattice,
            base,
            updates: Vec::new(),
            exact,
            wedges: None,
            has_stages: false,
            runs: Vec::new(),
        }
    }

    /// Starts a run: the updates pushed next have consecutive numbers in the file from `update` on.
    pub(super) fn begin_run(&mut self, update: u32) {
        self.runs.push([update, self.updates.len() as u32]);
    }

    /// Returns the local number of a node of the file, or [`NONE`] if its update is not loaded.
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

    /// Returns the update that creates a node, or `None` for a root.
    pub(super) fn creator(&self, node: u32) -> Option<&DetachedUpdate> {
        let child = node.checked_sub(self.root_count());
        child.map(|child| &self.updates[child as usize / 2])
    }

    /// Returns the position of a node on the lattice, in stored units.
    pub(super) fn stored_position(&self, node: u32) -> Vec3 {
        let side = node.wrapping_sub(self.root_count()) as usize % 2;
        self.creator(node).map_or_else(|| self.base.positions[node as usize], |u| u.children[side])
    }

    /// Returns the two nodes that an update creates.
    pub(super) fn children(&self, update: usize) -> [u32; 2] {
        let first = self.root_count() + 2 * update as u32;
        [first, first + 1]
    }

    /// Returns the exact position of a node, if it has one.
    pub(super) fn exact_position(&self, node: u32) -> Option<[f64; 3]> {
        self.exact.get(node)
    }

    /// Returns true if the vertices of the finest mesh have exact positions.
    pub(super) fn is_lossless(&self) -> bool {
        self.exact.is_lossless()
    }

    /// Corrects the predicted position of a node by the delta at index `at` and records the result.
    /// Nodes must come in ascending order.
    pub(super) fn add_exact_position(
        &mut self,
        node: u32,
        deltas: &Deltas,
        at: usize,
    ) -> Result<(), &'static str> {
        let position = deltas.position(at, self.predicted_position(node));
        let position = position.ok_or("one of its exact positions is not finite")?;
        let is_near =
            self.lattice.rounds_to(self.stored_position(node), self.frame.local(position));
        is_near
            .then(|| self.exact.push(node, position))
            .ok_or("one of its exact positions is outside the lattice cell of its vertex")
    }

    /// Builds the model of what has been decoded.
    pub(super) fn assemble(self, about: ModelInfo) -> Result<Implicit, FileError> {
        // Without a gap before it, each update has all that it depends on.
        let has_all = self.runs.iter().all(|[in_file, here]| in_file == here);
        let (wedges, values) = self.wedges.map(WedgeState::detach).unzip();
        let (updates, exact) = (&self.updates, &self.exact);
        let (mut model, nodes) =
            Implicit::assemble(about, self.base, updates, exact, wedges.as_ref());
        if let (Some(wedges), Some(values), Some(all)) = (wedges, values, model.wedges().cloned()) {
            let in_file = nodes.into_iter().flat_map(|node| wedges.of(node));
            let values = values.restored((&model, &all), in_file, has_all);
            drop(all);
            let values = values.map_err(|why| FileError::Section {
                section: "the attributes".into(),
                why: why.into(),
            })?;
            model.set_values(values);
        }
        Ok(model)
    }

    /// Returns true if stored positions are finite in model units.
    pub(super) fn are_finite(&self, positions: &[Vec3]) -> bool {
        positions.iter().all(|&position| is_finite(&self.frame, position))
    }

    /// Returns the lattice position of a node in model units, the prediction of its exact position.
    pub(super) fn predicted_position(&self, node: u32) -> [f64; 3] {
        self.frame.model(self.stored_position(node))
    }

    /// Returns the surface-normal predictor at a node, from the children of the updates above it.
    pub(super) fn normal_predictor(&self, node: u32) -> NormalPredictor {
        let mut node = Some(node);
        NormalPredictor::from_ancestors(std::array::from_fn(|_| {
            let creator = self.creator(node?)?;
            node = Some(creator.parent);
            Some(creator.children)
        }))
    }

    pub(super) fn root_count(&self) -> u32 {
        self.base.positions.len() as u32
    }
}

/// Returns true if a stored position has finite coordinates in model units.
pub(super) fn is_finite(frame: &Frame, position: Vec3) -> bool {
    frame.model(position).iter().all(|x| x.is_finite())
}
