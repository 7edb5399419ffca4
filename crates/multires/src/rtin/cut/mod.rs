//! A cut of right triangles that follows a sequence of queries, changed diamond by diamond.
//!
//! Vertices are inspected as far down as their nested balls are required: below that, no ball is. A
//! vertex that its own ball requires is inserted, after those it depends on; one that is neither
//! required nor depended on is removed. So the vertices of a cut are those of the smallest level.

mod front;
mod inspect;
mod locate;
mod refine;
mod slots;

use std::collections::VecDeque;

use self::front::FieldFront;
use self::inspect::Inspected;
use super::Rtin;
use crate::cut::{CutChange, Meter, Schedule, UpdateLimits};
use crate::level::Level;
use crate::query::{Criterion, Query, QueryError};
use crate::slot_mesh::{Patch, SlotMesh};

/// A level of an [`Rtin`], refined and coarsened to follow a sequence of queries such as the views
/// of a moving camera.
///
/// Whenever an update is interrupted, the level covers the field without cracks. It answers as a
/// [`Cut`](crate::Cut) of contractions does.
#[derive(Clone, Debug)]
pub struct RtinCut<'m> {
    front: FieldFront<'m>,
    schedule: Schedule,
    /// State of each vertex's inspection.
    inspected: Vec<Inspected>,
    /// Vertices that are still to be inspected, some of them more than once.
    uninspected: VecDeque<u32>,
    /// Vertices that the criterion requires.
    to_insert: Vec<u32>,
    /// Vertices that may be removed.
    to_remove: Vec<u32>,
}

impl<'m> RtinCut<'m> {
    /// Creates a cut that starts as the coarsest level.
    ///
    /// Cost: O(n), n = vertices of the field; it keeps six bytes for each.
    pub fn new(model: &'m Rtin) -> Self {
        let mut front = FieldFront::new(model);
        front.triangles.mark();
        Self {
            inspected: vec![Inspected::default(); model.vertices.len()],
            front,
            schedule: Schedule::default(),
            uninspected: VecDeque::new(),
            to_insert: Vec::new(),
            to_remove: Vec::new(),
        }
    }

    /// Creates a cut and refines it until it satisfies a query.
    /// # Errors
    /// The query is invalid.
    pub fn at(model: &'m Rtin, query: &Query<'_>) -> Result<Self, QueryError> {
        let mut cut = Self::new(model);
        cut.update(query, &UpdateLimits::default())?;
        Ok(cut)
    }

    /// Refines and coarsens the cut until it satisfies a query or a limit is reached.
    ///
    /// The result is the smallest level that satisfies the query, that of
    /// [`RtinExtractor::exact`](crate::RtinExtractor::exact), or an intermediate one if a limit was
    /// reached; the next call continues from there. A split inserts one vertex, a merge removes
    /// one.
    ///
    /// Cost: proportional to the changes if the query is the last one again, or if only the eye of
    /// a camera that looks at everything has moved. Otherwise every vertex whose nested ball is
    /// required is inspected as well.
    /// # Errors
    /// The query is invalid; the cut is unchanged.
    pub fn update(
        &mut self,
        query: &Query<'_>,
        limits: &UpdateLimits,
    ) -> Result<CutChange, QueryError> {
        let criterion = Criterion::new(query, self.model().frame())?;
        self.front.triangles.mark();
        let mut meter = Meter::new(limits);
        if self.schedule.goes_on(&criterion) {
            let Self { front, to_insert, .. } = self;
            to_insert.retain(|&index| front.requires(&criterion, index));
        } else {
            self.restart();
        }
        self.inspect_pending(&criterion, &mut meter);
        self.refine(&criterion, &mut meter);
        self.coarsen(&criterion, &mut meter);
        let waiting = [self.to_insert.len(), self.to_remove.len(), self.uninspected.len()];
        meter.change.done = waiting == [0; 3] && self.schedule.due.is_empty();
        Ok(meter.change)
    }

    /// Returns the model that the cut is a level of.
    pub fn model(&self) -> &'m Rtin {
        self.front.model
    }

    /// Returns a copy of the current level.
    pub fn level(&self) -> Level {
        self.level_of(self.front.triangles.iter().map(|(_, nodes)| nodes).collect())
    }

    /// Returns triangles as a level.
    fn level_of(&self, faces: Vec<[u32; 3]>) -> Level {
        let model = self.model();
        let place = |node: u32| model.stored_position(node);
        Level::from_nodes(model.frame, model.vertices.len(), place, faces)
    }
}

impl SlotMesh for RtinCut<'_> {
    fn face_count(&self) -> usize {
        self.front.triangles.len()
    }

    fn vertex_count(&self) -> usize {
        self.front.vertex_count()
    }

    fn slots(&self) -> usize {
        self.front.triangles.slots()
    }

    fn triangle(&self, slot: u32) -> Option<[u32; 3]> {
        self.front.triangles.get(slot)
    }

    fn wedges(&self, _: u32) -> Option<[u32; 3]> {
        None
    }

    fn patches(&self) -> Box<dyn Iterator<Item = Patch> + '_> {
        Box::new(self.front.triangles.changes())
    }

    fn touched_slots(&self) -> Box<dyn Iterator<Item = u32> + '_> {
        Box::new(self.patches().map(|patch| patch.slot))
    }
}
