//! A cut that follows its query: refined and coarsened where the query has moved, and nowhere else.

mod certificate;
mod each_triangle;
mod front;
mod inspect;
mod locate;
mod refine;
mod schedule;
mod to_forest;
mod triangles;

pub use certificate::{Certificate, CertifyError, Flaw};
pub use locate::Located;

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use self::front::Front;
use self::schedule::{Schedule, Span};
use crate::implicit::Implicit;
use crate::level::Level;
use crate::query::{Ball, Criterion, QueryKey};
use crate::query::{Query, QueryError};

/// A mesh out of an [`Implicit`] MT, which the next query changes.
///
/// Whatever stops it and whenever, it is one of the MT's meshes: no cracks, as manifold as the input.
#[derive(Clone, Debug)]
pub struct Cut<'m> {
    front: Front<'m>,
    schedule: Schedule,
    /// What was asked last, where it can be told whether it is asked again.
    last_key: Option<QueryKey>,
    /// Nodes whose updates, and all below, are yet to be looked at.
    uninspected: VecDeque<u32>,
    /// Updates that are wanted.
    to_split: Vec<u32>,
    /// Updates that may be taken back.
    to_merge: Vec<u32>,
    hysteresis: Option<f64>,
}

/// The clock is read after so many looks, of some dozen nanoseconds each.
const INSPECTIONS_PER_CLOCK: usize = 256;

/// How much a [`Cut`] may do at once.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UpdateLimits {
    /// At most so many splits and merges; `None`: as many as it takes.
    pub changes: Option<usize>,
    /// Nothing is begun after so long, and nothing is looked at after half of that. A question of
    /// another kind forgets the schedule of the last one first: some nanoseconds a vertex that is there.
    pub time: Option<Duration>,
}

/// What a query did to a [`Cut`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CutChange {
    /// Vertices that were split.
    pub splits: usize,
    /// Vertices that were merged again.
    pub merges: usize,
    /// Updates that were looked at.
    pub inspected: usize,
    /// Whether the cut answers the query now; else there was no time.
    pub done: bool,
}

/// A place in the list of triangles whose content changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patch {
    /// The place.
    pub slot: u32,
    /// The triangle that was there, by its nodes.
    pub old: Option<[u32; 3]>,
    /// The triangle that is there now.
    pub new: Option<[u32; 3]>,
}

impl<'m> Cut<'m> {
    /// The base mesh.
    pub fn new(mt: &'m Implicit) -> Self {
        let mut this = Self {
            front: Front::new(mt),
            schedule: Schedule::default(),
            last_key: None,
            uninspected: VecDeque::new(),
            to_split: Vec::new(),
            to_merge: Vec::new(),
            hysteresis: None,
        };
        this.front.triangles.mark();
        this
    }

    /// The answer to a query, from the base.
    pub fn at(mt: &'m Implicit, query: &Query<'_>) -> Result<Self, QueryError> {
        let mut cut = Self::new(mt);
        cut.update(query, &UpdateLimits::default())?;
        Ok(cut)
    }

    /// Lets what is there stay until the tolerance is larger by this part of it, so that a query that
    /// trembles changes nothing. None to begin with: then the answer does not depend on the way to it.
    ///
    /// # Errors
    /// What is below 0 or not finite.
    pub fn set_hysteresis(&mut self, part: Option<f64>) -> Result<(), QueryError> {
        if let Some(value) = part.filter(|part| !(*part >= 0.0 && part.is_finite())) {
            return Err(QueryError::BadLength { what: "a hysteresis", value });
        }
        self.hysteresis = part;
        self.schedule.forget();
        self.last_key = None;
        Ok(())
    }

    /// Goes from the answer of the last query to that of this one.
    ///
    /// The result is the smallest cut that meets the query, or one on the way there if there was not
    /// enough time; the next call goes on.
    ///
    /// Cost: of what changes, where only the eye has moved of a camera that looks at everything, or
    /// where the query is the last one; else of a look at every vertex besides.
    /// # Errors
    /// A query that is none; the cut is as it was.
    pub fn update(
        &mut self,
        query: &Query<'_>,
        effort: &UpdateLimits,
    ) -> Result<CutChange, QueryError> {
        let criteria = Criteria::new(query, self.front.mt, self.hysteresis)?;
        self.front.triangles.mark();
        let mut meter = Meter::new(effort);
        let last_key = criteria.refine.key();
        let is_same = last_key.is_some() && last_key == self.last_key;
        self.last_key = last_key;
        if self.schedule.follow(criteria.refine.viewpoint()) || is_same {
            self.to_split.retain(|&update| criteria.refine.refines(&self.front.mt.ball(update)));
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

    /// How many faces there are.
    pub fn face_count(&self) -> usize {
        self.front.triangles.len()
    }

    /// How many vertices there are.
    pub fn vertex_count(&self) -> usize {
        self.front.vertex_count()
    }

    /// How long a list of triangles by [`Patch::place`] has to be.
    pub fn slots(&self) -> usize {
        self.front.triangles.slots()
    }

    /// The triangles by place and nodes.
    pub fn triangles(&self) -> impl Iterator<Item = (u32, [u32; 3])> + '_ {
        self.front.triangles.iter()
    }

    /// What the last update changed, in no order.
    pub fn patches(&self) -> impl Iterator<Item = Patch> + '_ {
        self.front.triangles.changes().map(|(slot, old, new)| Patch { slot, old, new })
    }

    /// The mesh.
    pub fn level(&self) -> Level {
        self.front
            .mt
            .level_from_faces(self.front.triangles.iter().map(|(_, nodes)| nodes).collect())
    }
}

/// A query, and the tighter one by which what is there may stay.
struct Criteria<'f> {
    refine: Criterion<'f>,
    keep: Option<Criterion<'f>>,
}

impl<'f> Criteria<'f> {
    fn new(query: &Query<'f>, mt: &Implicit, hysteresis: Option<f64>) -> Result<Self, QueryError> {
        let refine = Criterion::new(query, mt.frame())?;
        let tighter = |part| Criterion::new(query, mt.frame()).map(|need| need.scaled(part));
        let keep = hysteresis.map(|part| tighter(1.0 / (1.0 + part))).transpose()?;
        Ok(Self { refine, keep })
    }

    /// Whether an update is wanted, and whether it may stay.
    #[inline]
    fn wanted(&self, ball: &Ball) -> [bool; 2] {
        let is_wanted = self.refine.refines(ball);
        [is_wanted, is_wanted || self.keep.as_ref().is_some_and(|keep| keep.refines(ball))]
    }

    /// From how far away an update is wanted as it is, or not.
    fn span(&self, ball: &Ball, wanted: [bool; 2]) -> Span {
        let reach = |need: &Criterion<'f>| need.viewpoint().and_then(|eye| eye.reach(ball));
        let Some(least) = reach(&self.refine) else { return Span::NEVER_TURNS };
        let most = self.keep.as_ref().and_then(reach).unwrap_or(least);
        match wanted {
            [true, _] => Span::below(least),
            [false, true] => Span::above(least).and_below(most),
            [false, false] => Span::above(most),
        }
    }

    /// Whether an update may stay.
    fn may_stay(&self, ball: &Ball) -> bool {
        self.keep.as_ref().unwrap_or(&self.refine).refines(ball)
    }
}

/// Counts what is done, and says when it is enough.
struct Meter {
    change: CutChange,
    most: usize,
    /// When to stop, and before that when to stop looking.
    until: Option<[Instant; 2]>,
}

impl Meter {
    fn new(effort: &UpdateLimits) -> Self {
        let now = Instant::now();
        let until = effort.time.map(|time| [time, time / 2].map(|part| now.checked_add(part)));
        Self {
            change: CutChange::default(),
            most: effort.changes.unwrap_or(usize::MAX),
            until: until.and_then(|[all, inspecting]| Some([all?, inspecting?])),
        }
    }

    fn may_change_more(&self) -> bool {
        self.change.splits + self.change.merges < self.most
            && self.until.is_none_or(|[until, _]| Instant::now() < until)
    }

    /// Counts a look; whether there may be another.
    #[inline]
    fn may_inspect_more(&mut self) -> bool {
        self.change.inspected += 1;
        !self.change.inspected.is_multiple_of(INSPECTIONS_PER_CLOCK)
            || self.until.is_none_or(|[_, until]| Instant::now() < until)
    }
}
