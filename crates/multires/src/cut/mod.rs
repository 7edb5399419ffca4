//! A cut that follows a sequence of queries, refined and coarsened only where the query has moved.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `triangles`, `each_triangle` | the triangles |
//! | `split_stars`, `split_wedges`, `coarse_wedges` | what an update changes |
//! | `schedule`, `inspect`, `refine`, `force`, `meter` | following a query |
//! | `locate` | places |
//! | `certificate`, `to_forest`, `unpack_wedges` | proofs, and the way back |

mod certificate;
mod coarse_wedges;
#[cfg(test)]
mod each_triangle;
mod force;
mod front;
mod geomorph;
mod inspect;
mod locate;
mod meter;
mod refine;
mod schedule;
mod split_stars;
mod split_wedges;
mod to_forest;
mod triangles;
mod unpack_wedges;

pub use certificate::{Certificate, CertifyError, Flaw};
pub use geomorph::{Geomorph, Motion, VertexValues};
pub use locate::Located;

use std::collections::VecDeque;
use std::time::Duration;

use self::front::Front;
pub(crate) use self::meter::Meter;
pub(crate) use self::schedule::{Schedule, ScheduleEntry, Span};
pub(crate) use self::split_stars::{SplitStars, StarFace, each_split_star};
use crate::implicit::Implicit;
use crate::level::Level;
use crate::query::{Ball, Criterion, Query, QueryError};
use crate::slot_mesh::{Patch, SlotMesh};

/// A mesh extracted from an [`Implicit`] model, refined and coarsened to follow a sequence of
/// queries such as the views of a moving camera.
///
/// Whenever an update is interrupted, the mesh is one of the MT's: without cracks and as manifold
/// as the input.
#[derive(Clone, Debug)]
pub struct Cut<'m> {
    front: Front<'m>,
    schedule: Schedule,
    /// Nodes whose updates, with all below, are still to be inspected.
    uninspected: VecDeque<u32>,
    /// Updates that the criterion requires.
    to_split: Vec<u32>,
    /// Updates that may be undone.
    to_merge: Vec<u32>,
    hysteresis: Option<f64>,
}

/// Limits on the work that one call of [`Cut::update`] may do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct UpdateLimits {
    /// Largest number of splits and merges of vertices; `None` for any number.
    pub changes: Option<usize>,
    /// Time after which no further split or merge is begun; `None` for no time limit.
    ///
    /// Inspections of updates stop after half of it. A query that does not continue from the last
    /// one first clears the schedule of that one, which takes a few nanoseconds per vertex.
    pub time: Option<Duration>,
}

/// Summary of the changes that one call of [`Cut::update`] made to a cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CutChange {
    /// Number of vertex splits applied.
    pub splits: usize,
    /// Number of vertex splits undone, each of which merges two vertices.
    pub merges: usize,
    /// Number of vertex splits that were checked against the query.
    pub inspected: usize,
    /// True if the cut satisfies the query; false if a limit was reached first.
    pub done: bool,
}

impl<'m> Cut<'m> {
    /// Creates a cut that starts as the base mesh, the coarsest level.
    pub fn new(mt: &'m Implicit) -> Self {
        let mut this = Self {
            front: Front::new(mt),
            schedule: Schedule::default(),
            uninspected: VecDeque::new(),
            to_split: Vec::new(),
            to_merge: Vec::new(),
            hysteresis: None,
        };
        this.front.triangles.mark();
        this
    }

    /// Creates a cut and refines it until it satisfies a query.
    /// # Errors
    /// The query is invalid.
    pub fn at(mt: &'m Implicit, query: &Query<'_>) -> Result<Self, QueryError> {
        let mut cut = Self::new(mt);
        cut.update(query, &UpdateLimits::default())?;
        Ok(cut)
    }

    /// Sets the hysteresis: a split is undone only when the tolerance exceeds its error by this
    /// fraction, so that a jittering query changes nothing.
    ///
    /// With `None`, the default, the answer does not depend on earlier queries.
    ///
    /// # Errors
    /// The fraction is negative or not finite.
    pub fn set_hysteresis(&mut self, part: Option<f64>) -> Result<(), QueryError> {
        if let Some(value) = part.filter(|part| !(*part >= 0.0 && part.is_finite())) {
            return Err(QueryError::BadHysteresis(value));
        }
        self.hysteresis = part;
        self.schedule.forget();
        Ok(())
    }

    /// Refines and coarsens the cut until it satisfies a query or a limit is reached.
    ///
    /// The result is the smallest cut that satisfies the query, or an intermediate one if a limit
    /// was reached; the next call continues from there.
    ///
    /// Cost: proportional to the changes if the query is the last one again, or if only the eye of
    /// a camera that looks at everything has moved. Otherwise every vertex is inspected as well.
    /// # Errors
    /// The query is invalid; the cut is unchanged.
    pub fn update(
        &mut self,
        query: &Query<'_>,
        limits: &UpdateLimits,
    ) -> Result<CutChange, QueryError> {
        let criteria = Criteria::new(query, self.front.mt, self.hysteresis)?;
        self.front.triangles.mark();
        let mut meter = Meter::new(limits);
        if self.schedule.goes_on(&criteria.refine) {
            self.to_split.retain(|&update| criteria.refine.requires(&self.front.mt.ball(update)));
        } else {
            self.restart();
        }
        self.inspect_pending(&criteria, &mut meter);
        self.refine(&criteria, &mut meter);
        self.coarsen(&criteria, &mut meter);
        let waiting = [self.to_split.len(), self.to_merge.len(), self.uninspected.len()];
        meter.change.done = waiting == [0; 3] && self.schedule.due.is_empty();
        Ok(meter.change)
    }

    /// Returns true if a node of the model is a vertex of the current mesh.
    pub fn shows(&self, node: u32) -> bool {
        self.front.is_active(node)
    }

    /// Returns a copy of the current mesh.
    pub fn level(&self) -> Level {
        let slots = self.front.triangles.iter().map(|(slot, _)| slot);
        self.front.level_of(&slots.collect::<Vec<_>>())
    }
}

impl SlotMesh for Cut<'_> {
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
        self.front.triangles.real(slot)
    }

    fn wedges(&self, slot: u32) -> Option<[u32; 3]> {
        self.front.triangles.real_wedges(slot)
    }

    fn patches(&self) -> Box<dyn Iterator<Item = Patch> + '_> {
        Box::new(self.front.triangles.changes())
    }

    fn touched_slots(&self) -> Box<dyn Iterator<Item = u32> + '_> {
        Box::new(self.front.triangles.touched())
    }
}

/// The criterion of a query, and a tighter one that applied updates have to fail before they are
/// undone.
struct Criteria<'f> {
    refine: Criterion<'f>,
    keep: Option<Criterion<'f>>,
}

impl<'f> Criteria<'f> {
    fn new(query: &Query<'f>, mt: &Implicit, hysteresis: Option<f64>) -> Result<Self, QueryError> {
        let refine = Criterion::new(query, mt.frame())?;
        let tighter =
            |part| Criterion::new(query, mt.frame()).map(|criterion| criterion.scaled(part));
        let keep = hysteresis.map(|part| tighter(1.0 / (1.0 + part))).transpose()?;
        Ok(Self { refine, keep })
    }

    /// Returns whether an update is required, and whether it may stay.
    #[inline]
    fn required(&self, ball: &Ball) -> [bool; 2] {
        let is_required = self.refine.requires(ball);
        [is_required, is_required || self.keep.as_ref().is_some_and(|keep| keep.requires(ball))]
    }

    /// Returns the distances of the viewpoint between which a decision holds.
    fn span(&self, ball: &Ball, required: [bool; 2]) -> Span {
        let reach = |criterion: &Criterion<'f>| {
            criterion.viewpoint().and_then(|viewpoint| viewpoint.reach(ball))
        };
        let Some(least) = reach(&self.refine) else { return Span::NEVER_TURNS };
        let most = self.keep.as_ref().and_then(reach).unwrap_or(least);
        match required {
            [true, _] => Span::below(least),
            [false, true] => Span::above(least).and_below(most),
            [false, false] => Span::above(most),
        }
    }

    /// Returns true if an applied update may stay.
    fn may_stay(&self, ball: &Ball) -> bool {
        self.keep.as_ref().unwrap_or(&self.refine).requires(ball)
    }
}
