//! Cuts that change smoothly: vertices move to where a split or a merge takes them.
//!
//! Two cuts of one model: the *goal* follows the queries at once, and the *shown* one follows the
//! goal. What the goal splits, the shown cut splits, too, and both children start as the node that
//! they replace. What the goal merges, the shown cut keeps until the children have arrived at the node
//! that replaces them. So the shown cut always contains the goal, and neither a split nor a merge
//! changes its surface.

mod motion;
mod vertex_values;

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use meshlod_mesh::{Layer, Mesh};

use self::motion::Motion;
pub use self::vertex_values::VertexValues;
use super::certificate::CertifyError;
use super::front::{Front, SplitOrMerge, VertexState};
use super::{Cut, CutChange, Patch, UpdateLimits};
use crate::implicit::Implicit;
use crate::query::{Query, QueryError};

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
    /// Updates of the shown cut that are not in the goal, with their levels.
    ending: BTreeSet<(u16, u32)>,
    /// Vertices of the shown cut that are not where their node is.
    moving: BTreeMap<u32, Motion>,
    /// Vertices that came to where their node is since the last call.
    arrived: Vec<u32>,
    duration: Duration,
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
        let (shown, ending, moving) = (Front::new(mt), BTreeSet::new(), BTreeMap::new());
        Ok(Self { goal, shown, ending, moving, arrived: Vec::new(), duration })
    }

    /// Sets the goal to the cut that satisfies a query, or towards it up to a limit, as
    /// [`Cut::update`] does. The shown surface stays as it is; vertices whose goal has changed set
    /// out for it from where they are.
    ///
    /// Cost: that of [`Cut::update`], and O(n log n), n = vertices whose goal has changed and
    /// updates that wait to be undone.
    /// # Errors
    /// The query is invalid; nothing has changed.
    pub fn update(
        &mut self,
        query: &Query<'_>,
        limits: &UpdateLimits,
    ) -> Result<CutChange, QueryError> {
        let change = self.goal.update(query, limits)?;
        self.begin();
        let steps = self.goal.front.steps.replace(Vec::new()).unwrap_or_default();
        steps.iter().for_each(|&step| self.follow(step));
        for node in self.new_goals(&steps) {
            self.send_below(node);
        }
        self.end_merges();
        Ok(change)
    }

    /// Moves vertices by the time that has passed, and returns whether any is still moving.
    pub fn advance(&mut self, elapsed: Duration) -> bool {
        self.begin();
        self.moving.values_mut().for_each(|motion| motion.advance(elapsed));
        let Self { moving, goal, arrived, duration, .. } = self;
        moving.retain(|&node, motion| {
            let stays = !motion.is_over(*duration) || !goal.front.is_active(node);
            if !stays {
                arrived.push(node);
            }
            stays
        });
        self.end_merges();
        !self.moving.is_empty()
    }

    /// Returns the cut that is moved towards: the answer to the last query.
    pub fn goal(&self) -> &Cut<'m> {
        &self.goal
    }

    /// Returns the number of triangle slots, see [`Cut::slots`].
    pub fn slots(&self) -> usize {
        self.shown.triangles.slots()
    }

    /// Returns the number of faces that are shown, those without area included.
    pub fn face_count(&self) -> usize {
        self.shown.triangles.len()
    }

    /// Returns the three nodes of the triangle in a slot, or `None` if the slot is empty.
    pub fn triangle(&self, slot: u32) -> Option<[u32; 3]> {
        self.shown.triangles.real(slot)
    }

    /// Iterates over the triangles that are shown, each by its slot and its three nodes.
    pub fn triangles(&self) -> impl Iterator<Item = (u32, [u32; 3])> + '_ {
        self.shown.triangles.iter()
    }

    /// Returns the wedges at the corners of the triangle in a slot, see [`Cut::wedges`].
    pub fn wedges(&self, slot: u32) -> Option<[u32; 3]> {
        self.triangle(slot).and_then(|_| self.shown.triangles.wedges(slot))
    }

    /// Iterates over the triangle slots that the last call of [`update`](Self::update) or
    /// [`advance`](Self::advance) changed, in no particular order.
    pub fn patches(&self) -> impl Iterator<Item = Patch> + '_ {
        self.shown.triangles.changes().map(|(slot, old, new)| Patch { slot, old, new })
    }

    /// Iterates over the triangle slots that the last call of
    /// [`update`](Self::update) or [`advance`](Self::advance) wrote, in no particular order.
    ///
    /// Beside those of [`patches`](Self::patches) these may be slots that hold the same nodes as
    /// before, though at other wedges: two faces may have the same three vertices.
    pub fn touched_slots(&self) -> impl Iterator<Item = u32> + '_ {
        self.shown.triangles.touched()
    }

    /// Iterates over the vertices whose position or values the last call of
    /// [`update`](Self::update) or [`advance`](Self::advance) may have changed, with what they are
    /// now: all that move, and those that have arrived.
    ///
    /// All other vertices are where the model has them. Blended normals are not unit vectors.
    pub fn moved(&self) -> impl Iterator<Item = (u32, VertexValues)> + '_ {
        let arrived = self.arrived.iter().filter(|node| !self.moving.contains_key(node));
        self.moving.keys().chain(arrived).map(|&node| (node, self.values(node)))
    }

    /// Returns what a vertex of the shown cut is now.
    fn values(&self, node: u32) -> VertexValues {
        let mt = self.shown.mt;
        let moving = self.moving.get(&node).map(|motion| motion.values(mt, self.duration));
        moving.unwrap_or_else(|| VertexValues::of(mt, node))
    }

    /// Returns the mesh that is shown, in model units, with its attributes.
    ///
    /// Triangles without area are left out: those with two corners of one position.
    pub fn mesh(&self) -> Mesh {
        let now: BTreeMap<u32, VertexValues> =
            self.moving.keys().map(|&node| (node, self.values(node))).collect();
        let place = |node: u32| now.get(&node).map(|values| values.position);
        let place = |node: u32| place(node).unwrap_or_else(|| self.shown.mt.position(node));
        let has_area = |nodes: [u32; 3]| {
            let [a, b, c] = nodes.map(place);
            a != b && b != c && c != a
        };
        let kept = self.triangles().filter(|&(_, nodes)| has_area(nodes));
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
