//! A cut that follows its query: refined and coarsened where the query has moved, and nowhere else.

mod certificate;
mod change;
mod front;
mod look;
mod near;
mod schedule;
mod star;
mod triangles;
mod unpack;

pub use certificate::{Certificate, Flaw, Unsound};
pub use near::Located;

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use self::front::Front;
use self::schedule::{Schedule, Span};
use crate::implicit::Implicit;
use crate::level::Level;
use crate::need::{Asked, Ball, Need};
use crate::query::{Query, QueryError};

/// A mesh out of an [`Implicit`] MT, which the next query changes.
///
/// Whatever stops it and whenever, it is one of the MT's meshes: no cracks, as manifold as the input.
#[derive(Clone, Debug)]
pub struct Cut<'m> {
    front: Front<'m>,
    schedule: Schedule,
    /// What was asked last, where it can be told whether it is asked again.
    asked: Option<Asked>,
    /// Nodes whose updates, and all below, are yet to be looked at.
    unseen: VecDeque<u32>,
    /// Updates that are wanted.
    fresh: Vec<u32>,
    /// Updates that may be taken back.
    loose: Vec<u32>,
    hysteresis: Option<f64>,
}

/// The clock is read after so many looks, of some dozen nanoseconds each.
const LOOKS_AT_ONCE: usize = 256;

/// How much a [`Cut`] may do at once.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effort {
    /// At most so many splits and merges; `None`: as many as it takes.
    pub changes: Option<usize>,
    /// Nothing is begun after so long, and nothing is looked at after half of that. A question of
    /// another kind forgets the schedule of the last one first: some nanoseconds a vertex that is there.
    pub time: Option<Duration>,
}

/// What a query did to a [`Cut`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Change {
    /// Vertices that were split.
    pub splits: usize,
    /// Vertices that were merged again.
    pub merges: usize,
    /// Updates that were looked at.
    pub looks: usize,
    /// Whether the cut answers the query now; else there was no time.
    pub done: bool,
}

/// A place in the list of triangles whose content changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patch {
    /// The place.
    pub place: u32,
    /// The triangle that was there, by its nodes.
    pub out: Option<[u32; 3]>,
    /// The triangle that is there now.
    pub into: Option<[u32; 3]>,
}

impl<'m> Cut<'m> {
    /// The base mesh.
    pub fn new(mt: &'m Implicit) -> Self {
        let mut this = Self {
            front: Front::new(mt),
            schedule: Schedule::default(),
            asked: None,
            unseen: VecDeque::new(),
            fresh: Vec::new(),
            loose: Vec::new(),
            hysteresis: None,
        };
        this.front.triangles.mark();
        this
    }

    /// The answer to a query, from the base.
    pub fn at(mt: &'m Implicit, query: &Query<'_>) -> Result<Self, QueryError> {
        let mut cut = Self::new(mt);
        cut.update(query, &Effort::default())?;
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
        self.asked = None;
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
    pub fn update(&mut self, query: &Query<'_>, effort: &Effort) -> Result<Change, QueryError> {
        let needs = Needed::new(query, self.front.mt, self.hysteresis)?;
        self.front.triangles.mark();
        let mut work = Work::new(effort);
        let asked = needs.least.asked();
        let is_same = asked.is_some() && asked == self.asked;
        self.asked = asked;
        if self.schedule.follow(needs.least.eye()) || is_same {
            self.fresh.retain(|&update| needs.least.wants(&self.front.mt.ball(update)));
        } else {
            self.start_over();
        }
        self.look_around(&needs, &mut work);
        self.refine(&needs, &mut work);
        self.coarsen(&needs, &mut work);
        let waiting = [self.fresh.len(), self.loose.len(), self.unseen.len()];
        work.change.done = waiting == [0; 3] && self.schedule.due.is_empty();
        Ok(work.change)
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
    pub fn places(&self) -> usize {
        self.front.triangles.places()
    }

    /// The triangles by place and nodes.
    pub fn triangles(&self) -> impl Iterator<Item = (u32, [u32; 3])> + '_ {
        self.front.triangles.iter()
    }

    /// What the last update changed, in no order.
    pub fn patches(&self) -> impl Iterator<Item = Patch> + '_ {
        self.front.triangles.changes().map(|(place, out, into)| Patch { place, out, into })
    }

    /// The mesh.
    pub fn level(&self) -> Level {
        self.front.mt.level_of(self.front.triangles.iter().map(|(_, nodes)| nodes).collect())
    }
}

/// A query, and the tighter one by which what is there may stay.
struct Needed<'f> {
    least: Need<'f>,
    most: Option<Need<'f>>,
}

impl<'f> Needed<'f> {
    fn new(query: &Query<'f>, mt: &Implicit, hysteresis: Option<f64>) -> Result<Self, QueryError> {
        let least = Need::new(query, mt.frame())?;
        let tighter = |part| Need::new(query, mt.frame()).map(|need| need.tightened(part));
        let most = hysteresis.map(|part| tighter(1.0 / (1.0 + part))).transpose()?;
        Ok(Self { least, most })
    }

    /// Whether an update is wanted, and whether it may stay.
    #[inline]
    fn wanted(&self, ball: &Ball) -> [bool; 2] {
        let is_wanted = self.least.wants(ball);
        [is_wanted, is_wanted || self.most.as_ref().is_some_and(|most| most.wants(ball))]
    }

    /// From how far away an update is wanted as it is, or not.
    fn span(&self, ball: &Ball, wanted: [bool; 2]) -> Span {
        let reach = |need: &Need<'f>| need.eye().and_then(|eye| eye.reach(ball));
        let Some(least) = reach(&self.least) else { return Span::NEVER_TURNS };
        let most = self.most.as_ref().and_then(reach).unwrap_or(least);
        match wanted {
            [true, _] => Span::below(least),
            [false, true] => Span::above(least).and_below(most),
            [false, false] => Span::above(most),
        }
    }

    /// Whether an update may stay.
    fn may_stay(&self, ball: &Ball) -> bool {
        self.most.as_ref().unwrap_or(&self.least).wants(ball)
    }
}

/// Counts what is done, and says when it is enough.
struct Work {
    change: Change,
    most: usize,
    /// When to stop, and before that when to stop looking.
    until: Option<[Instant; 2]>,
}

impl Work {
    fn new(effort: &Effort) -> Self {
        let now = Instant::now();
        let until = effort.time.map(|time| [time, time / 2].map(|part| now.checked_add(part)));
        Self {
            change: Change::default(),
            most: effort.changes.unwrap_or(usize::MAX),
            until: until.and_then(|[all, looking]| Some([all?, looking?])),
        }
    }

    fn may_go_on(&self) -> bool {
        self.change.splits + self.change.merges < self.most
            && self.until.is_none_or(|[until, _]| Instant::now() < until)
    }

    /// Counts a look; whether there may be another.
    #[inline]
    fn may_look_on(&mut self) -> bool {
        self.change.looks += 1;
        !self.change.looks.is_multiple_of(LOOKS_AT_ONCE)
            || self.until.is_none_or(|[_, until]| Instant::now() < until)
    }
}
