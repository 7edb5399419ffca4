//! Cuts that change smoothly: vertices move to where a split or a merge takes them.
//!
//! Two cuts of one model: the *goal* follows the queries at once, and the *shown* one follows the
//! goal. What the goal splits, the shown cut splits, too, and both children start as the node that
//! they replace. What the goal merges, the shown cut keeps until the children have arrived at the node
//! that replaces them. So the shown cut always contains the goal, and neither a split nor a merge
//! changes its surface.

mod motions;
mod shown_steps;
mod vertex_values;

use std::collections::BTreeMap;
use std::time::Duration;

use meshlod_mesh::{Layer, Mesh};

pub use self::motions::Motion;
use self::motions::Motions;
use self::vertex_values::Blend;
pub use self::vertex_values::VertexValues;
use super::certificate::CertifyError;
use super::front::{Front, SplitOrMerge, VertexState};
use super::{Cut, CutChange, UpdateLimits};
use crate::implicit::Implicit;
use crate::query::{Query, QueryError};
use crate::slot_mesh::{Patch, SlotMesh};

/// A cut that follows a sequence of queries, as a [`Cut`] does, and moves instead of popping.
///
/// [`update`](Self::update) changes what it moves towards, [`advance`](Self::advance) lets time pass.
/// Neither makes the surface jump, even if a vertex is split or merged again on its way: an update
/// changes only triangles without area, and vertices start where they are. Once each vertex has
/// arrived, the mesh is the goal's.
///
/// In between it may be folded, and its error is not bounded.
#[derive(Clone, Debug)]
pub struct Geomorph<'m> {
    goal: Cut<'m>,
    shown: Front<'m>,
    /// Vertices of the shown cut that are not where their node is.
    motions: Motions,
    blend: Blend,
    /// Vertices that the last call has sent elsewhere, or that have come or gone, some of them more than
    /// once, and those that have arrived.
    turned: Vec<u32>,
    arrived: Vec<u32>,
    /// True if the last call may have moved every vertex that is under way.
    has_time_passed: bool,
    /// Scratch memory: updates of the shown cut that it may be time to undo, steps of the goal, the
    /// vertices that they brought, those below one that are still to be sent, states of vertices, and
    /// updates that a split waits for.
    ending: Vec<u32>,
    steps: Vec<SplitOrMerge>,
    new_goals: Vec<u32>,
    stack: Vec<(u32, VertexValues)>,
    spare: Vec<VertexValues>,
    first: Vec<u32>,
}

impl<'m> Geomorph<'m> {
    /// Creates a cut that starts as the base mesh, and in which a vertex moves for `duration`.
    ///
    /// Cost: linear, as the model is certified.
    /// # Errors
    /// The model is unsound, so that its cuts depend on how they are reached.
    pub fn new(mt: &'m Implicit, duration: Duration) -> Result<Self, CertifyError> {
        mt.certify()?;
        let mut goal = Cut::new(mt);
        goal.front.steps = Some(Vec::new());
        Ok(Self {
            goal,
            shown: Front::new(mt),
            motions: Motions::new(duration),
            blend: Blend::new(mt.layers()),
            turned: Vec::new(),
            arrived: Vec::new(),
            has_time_passed: false,
            ending: Vec::new(),
            steps: Vec::new(),
            new_goals: Vec::new(),
            stack: Vec::new(),
            spare: Vec::new(),
            first: Vec::new(),
        })
    }

    /// Sets the goal to the cut that satisfies a query, or towards it up to a limit, as
    /// [`Cut::update`] does. The shown surface stays as it is; vertices whose goal has changed set
    /// out for it from where they are.
    ///
    /// Cost: that of [`Cut::update`], and linear in the vertices whose goal has changed.
    /// # Errors
    /// The query is invalid; nothing has changed.
    pub fn update(
        &mut self,
        query: &Query<'_>,
        limits: &UpdateLimits,
    ) -> Result<CutChange, QueryError> {
        let change = self.goal.update(query, limits)?;
        self.begin();
        let mut steps = std::mem::take(&mut self.steps);
        steps.clear();
        let mut steps = self.goal.front.steps.replace(steps).unwrap_or_default();
        steps.iter().for_each(|&step| self.follow(step));
        self.list_new_goals(&steps);
        let mut new_goals = std::mem::take(&mut self.new_goals);
        new_goals.drain(..).for_each(|node| self.send_below(node));
        self.end_merges();
        steps.clear();
        (self.steps, self.new_goals) = (steps, new_goals);
        Ok(change)
    }

    /// Moves vertices by the time that has passed, and returns whether any is still moving.
    ///
    /// Cost: linear in the vertices that arrive, whatever is on its way.
    pub fn advance(&mut self, elapsed: Duration) -> bool {
        self.begin();
        self.has_time_passed = true;
        let mut arrived = std::mem::take(&mut self.arrived);
        self.motions.advance(elapsed, &mut arrived);
        arrived.iter().for_each(|&node| self.arrive(node));
        self.arrived = arrived;
        self.end_merges();
        !self.motions.is_empty()
    }

    /// Returns the time that has passed in all, where each call of [`advance`](Self::advance) counts
    /// for no more than [`duration`](Self::duration).
    pub fn clock(&self) -> Duration {
        self.motions.clock()
    }

    /// Returns the time that a vertex moves.
    pub fn duration(&self) -> Duration {
        self.motions.duration()
    }

    /// Returns the cut that is moved towards: the answer to the last query.
    pub fn goal(&self) -> &Cut<'m> {
        &self.goal
    }

    /// Returns true if a node of the model is a vertex of the mesh that is shown.
    pub fn shows(&self, node: u32) -> bool {
        self.shown.is_active(node)
    }

    /// Iterates over the vertices that the last call of [`update`](Self::update) or
    /// [`advance`](Self::advance) has sent elsewhere, and those that have come or gone, in no particular
    /// order and some more than once; [`motion`](Self::motion) tells where each goes.
    ///
    /// That is all a renderer has to hear that blends vertices itself, by the [`clock`](Self::clock):
    /// it costs what has turned, however many vertices are on their way. One that arrives is not
    /// listed: by the clock it is there.
    pub fn turned(&self) -> impl Iterator<Item = u32> + '_ {
        self.turned.iter().copied()
    }

    /// Returns where a vertex comes from and goes to; `None` if it is where the model has it, or not in
    /// the cut.
    pub fn motion(&self, node: u32) -> Option<Motion<'_>> {
        self.motions.get(node)
    }

    /// Iterates over the vertices whose position or values the last call of
    /// [`update`](Self::update) or [`advance`](Self::advance) may have changed, in no particular order
    /// and some more than once; [`values`](Self::values) tells what they are.
    ///
    /// Time moves all that are on their way. An update moves none, but vertices that it brings are not
    /// where the model has them. Some that are listed may have left the cut again.
    pub fn moved(&self) -> impl Iterator<Item = u32> + '_ {
        let under_way = self.has_time_passed.then(|| self.motions.nodes());
        self.turned.iter().chain(&self.arrived).copied().chain(under_way.into_iter().flatten())
    }

    /// Sets `to` to what a vertex is now, and reuses its memory. Blended normals are not unit vectors.
    ///
    /// # Panics
    /// `node` is not below [`Implicit::node_count`].
    pub fn values(&self, node: u32, to: &mut VertexValues) {
        if !self.motions.now(node, &self.blend, to) {
            to.set_to(self.shown.mt, node);
        }
    }

    /// Returns the mesh that is shown, in model units, with its attributes.
    ///
    /// Triangles without area are left out: those with two corners of one position.
    pub fn mesh(&self) -> Mesh {
        let mut now = BTreeMap::new();
        for node in self.motions.nodes() {
            let mut values = VertexValues::default();
            self.values(node, &mut values);
            now.insert(node, values);
        }
        let place = |node: u32| now.get(&node).map(|values| values.position);
        let place = |node: u32| place(node).unwrap_or_else(|| self.shown.mt.position(node));
        let has_area = |nodes: [u32; 3]| {
            let [a, b, c] = nodes.map(place);
            a != b && b != c && c != a
        };
        let kept = self.shown.triangles.iter().filter(|&(_, nodes)| has_area(nodes));
        let slots: Vec<u32> = kept.map(|(slot, _)| slot).collect();
        let level = self.shown.level_of(&slots);
        let mut mesh = level.mesh();
        for (place, values) in mesh.positions.iter_mut().zip(level.nodes.iter().map(|n| now.get(n)))
        {
            values.inspect(|values| *place = values.position);
        }
        self.set_values(&mut mesh, &slots, &now);
        mesh
    }

    /// Sets the attributes of a mesh of the triangles in the given slots to what they are now.
    fn set_values(&self, mesh: &mut Mesh, slots: &[u32], now: &BTreeMap<u32, VertexValues>) {
        let (mt, Some(attributes)) = (self.shown.mt, &mut mesh.attributes) else { return };
        for (&slot, corners) in slots.iter().zip(&attributes.corners) {
            let Some(wedges) = self.shown.triangles.wedges(slot) else { return };
            let nodes = self.shown.triangles.nodes(slot);
            for ((&node, wedge), &corner) in nodes.iter().zip(wedges).zip(corners) {
                let Some(values) = now.get(&node) else { continue };
                let mut rest = values.values_of(mt, node, wedge);
                for layer in &mut attributes.layers {
                    let (of_layer, others) = rest.split_at(Layer::of(layer, corner).len());
                    layer.of_mut(corner).copy_from_slice(of_layer);
                    rest = others;
                }
            }
        }
    }
}

/// The mesh that is shown. Its patches are those of the last call of [`Geomorph::update`] or
/// [`Geomorph::advance`].
impl SlotMesh for Geomorph<'_> {
    fn face_count(&self) -> usize {
        self.shown.triangles.len()
    }

    fn vertex_count(&self) -> usize {
        self.shown.vertex_count()
    }

    fn slots(&self) -> usize {
        self.shown.triangles.slots()
    }

    fn triangle(&self, slot: u32) -> Option<[u32; 3]> {
        self.shown.triangles.real(slot)
    }

    fn wedges(&self, slot: u32) -> Option<[u32; 3]> {
        self.shown.triangles.real_wedges(slot)
    }

    fn patches(&self) -> Box<dyn Iterator<Item = Patch> + '_> {
        Box::new(self.shown.triangles.changes())
    }

    fn touched_slots(&self) -> Box<dyn Iterator<Item = u32> + '_> {
        Box::new(self.shown.triangles.touched())
    }
}
