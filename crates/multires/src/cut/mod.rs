//! A cut that follows its query: refined and coarsened where the query has moved, and nowhere else.

mod certificate;
mod front;
mod schedule;
mod star;

pub use certificate::{Certificate, Unsound};

use std::time::{Duration, Instant};

use self::front::{Front, Standing};
use self::schedule::{Entry, Schedule};
use crate::implicit::Implicit;
use crate::level::Level;
use crate::need::{Ball, Need};
use crate::query::{Query, QueryError};

/// A mesh out of an [`Implicit`] MT, which the next query changes.
///
/// Whatever stops it and whenever, it is one of the MT's meshes: no cracks, as manifold as the input.
#[derive(Clone, Debug)]
pub struct Cut<'m> {
    front: Front<'m>,
    schedule: Schedule,
    /// Updates whose vertices are to be looked at.
    fresh: Vec<u32>,
    /// Updates that may be taken back.
    loose: Vec<u32>,
    hysteresis: f64,
}

/// How much a [`Cut`] may do at once.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effort {
    /// At most so many splits and merges; `None`: as many as it takes.
    pub changes: Option<usize>,
    /// Nothing is begun after so long.
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
            fresh: Vec::new(),
            loose: Vec::new(),
            hysteresis: 0.0,
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
    /// trembles changes nothing. 0 to begin with: then the answer does not depend on the way to it.
    ///
    /// # Errors
    /// What is below 0 or not finite.
    pub fn set_hysteresis(&mut self, part: f64) -> Result<(), QueryError> {
        if !(part >= 0.0 && part.is_finite()) {
            return Err(QueryError::BadLength { what: "a hysteresis", value: part });
        }
        self.hysteresis = part;
        self.schedule.forget();
        Ok(())
    }

    /// Goes from the answer of the last query to that of this one.
    ///
    /// The result is the smallest cut that meets the query, or one on the way there if there was not
    /// enough time; the next call goes on.
    ///
    /// Cost: of what changes, where only the eye has moved of a camera that looks at everything; else
    /// of a look at every vertex besides.
    /// # Errors
    /// A query that is none; the cut is as it was.
    pub fn update(&mut self, query: &Query<'_>, effort: &Effort) -> Result<Change, QueryError> {
        let needs = Needed::new(query, self.front.mt, self.hysteresis)?;
        self.front.triangles.mark();
        let mut work = Work::new(effort);
        self.fresh.retain(|&update| needs.least.wants(&self.front.mt.ball(update)));
        work.change.looks = if self.schedule.follow(needs.least.eye()) {
            self.look_at_due(&needs)
        } else {
            self.look_at_all(&needs)
        };
        self.refine(&needs, &mut work);
        self.coarsen(&needs, &mut work);
        work.change.done = self.fresh.is_empty() && self.loose.is_empty();
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
        let mt = self.front.mt;
        Level::of_nodes(
            *mt.frame(),
            mt.positions(),
            self.front.triangles.iter().map(|(_, nodes)| nodes).collect(),
        )
    }

    /// Looks at the updates that are due; how many those are.
    fn look_at_due(&mut self, needs: &Needed<'_>) -> usize {
        let mut due = std::mem::take(&mut self.schedule.due);
        let looks = due.len();
        for entry in due.drain(..) {
            let ball = entry.ball.unpack();
            if needs.wanted(&ball) == entry.wanted {
                let is_entered = self.schedule.add(entry, &ball, self.hysteresis);
                self.front.set_scheduled(entry.node, is_entered);
            } else {
                self.front.set_scheduled(entry.node, false);
                self.look(entry.update, entry.node, needs);
            }
        }
        self.schedule.due = due;
        looks
    }

    /// Looks at every update whose vertex is there, or was and has been split; how many those are.
    fn look_at_all(&mut self, needs: &Needed<'_>) -> usize {
        // Also what is not there: it may come back.
        self.schedule.clear(|node| self.front.set_scheduled(node, false));
        self.fresh.clear();
        self.loose.clear();
        let mt = self.front.mt;
        let mut looks = 0;
        let mut stack: Vec<u32> = mt.roots().map(|(root, _)| root).collect();
        while let Some(node) = stack.pop() {
            let Some(update) = mt.update_of(node) else { continue };
            if self.front.standing(node) == Standing::Split {
                stack.extend(mt.children(update));
            }
            if !mt.is_inner(update) {
                self.look(update, node, needs);
                looks += 1;
            }
        }
        looks
    }

    /// Puts an update on the list that its need asks for; and looks again when that may have turned.
    #[inline]
    fn look(&mut self, update: u32, node: u32, needs: &Needed<'_>) {
        let packed = self.front.mt.packed_ball(update, node);
        let ball = packed.unpack();
        let wanted = needs.wanted(&ball);
        match (self.front.standing(node), wanted) {
            (Standing::Split, [_, false]) => self.loose.push(update),
            (Standing::Active, [true, _]) => self.fresh.push(update),
            (Standing::Split | Standing::Active, _) => {}
            (Standing::Absent, _) => return,
        }
        let entry = Entry { update, node, ball: packed, wanted };
        let is_entered = self.schedule.add(entry, &ball, self.hysteresis);
        self.front.set_scheduled(node, is_entered);
    }

    /// Splits what is wanted, and what must be split for it.
    fn refine(&mut self, needs: &Needed<'_>, work: &mut Work) {
        let mut stack = Vec::new();
        while let Some(update) = self.fresh.pop() {
            // It may have been forced, or merged with all around it.
            if self.front.standing(self.front.mt.parent(update)) != Standing::Active {
                continue;
            }
            stack.push(update);
            while let Some(&next) = stack.last() {
                if !work.may_go_on() {
                    self.fresh.push(update);
                    return;
                }
                self.advance(next, needs, &mut stack, work);
            }
        }
    }

    /// Splits the last update of a chain, or finds what must come before it.
    fn advance(&mut self, next: u32, needs: &Needed<'_>, stack: &mut Vec<u32>, work: &mut Work) {
        let mt = self.front.mt;
        let node = mt.parent(next);
        match self.front.standing(node) {
            Standing::Absent => {
                stack.push(mt.family(node).expect("roots are there until they are split"));
                return;
            }
            Standing::Split => {
                stack.pop();
                return;
            }
            Standing::Active => {}
        }
        if !self.front.split(next, stack) {
            return;
        }
        stack.pop();
        work.change.splits += 1;
        let is_forced = !stack.is_empty();
        if is_forced && !needs.most.wants(&mt.ball_at(next, node)) {
            // It may go as soon as nothing holds it.
            self.loose.push(next);
        }
        if mt.is_glued(next) {
            let is_split = self.front.split(next + 1, stack);
            assert!(is_split, "what is around the whole is around its part");
            self.arrive(next + 1, needs);
        }
        self.arrive(next, needs);
    }

    /// Looks at the children of a split for the first time.
    fn arrive(&mut self, update: u32, needs: &Needed<'_>) {
        let mt = self.front.mt;
        let first_is_gone = usize::from(mt.is_glued(update));
        for node in mt.children(update).into_iter().skip(first_is_gone) {
            let Some(update) = mt.update_of(node) else { continue };
            if !self.front.is_scheduled(node) {
                self.look(update, node, needs);
            } else if needs.least.wants(&mt.ball_at(update, node)) {
                self.fresh.push(update);
            }
        }
    }

    /// Merges what is not wanted and not needed, and what that frees.
    fn coarsen(&mut self, needs: &Needed<'_>, work: &mut Work) {
        while work.may_go_on() {
            let Some(update) = self.loose.pop() else { return };
            let mt = self.front.mt;
            let node = mt.parent(update);
            if self.front.standing(node) != Standing::Split
                || needs.most.wants(&mt.ball_at(update, node))
                || !self.front.merge(update)
            {
                continue;
            }
            work.change.merges += 1;
            let Self { front, loose, .. } = self;
            loose.extend(mt.family(node).map(|up| outer(mt, up)));
            let around = front.around(node).iter().filter_map(|&other| mt.family(other));
            loose.extend(around.map(|up| outer(mt, up)));
        }
    }
}

/// The update that is glued to this one and goes first, or itself.
fn outer(mt: &Implicit, update: u32) -> u32 {
    if mt.is_inner(update) { update - 1 } else { update }
}

/// A query and the looser one by which what is there may stay.
struct Needed<'f> {
    least: Need<'f>,
    most: Need<'f>,
}

impl<'f> Needed<'f> {
    fn new(query: &Query<'f>, mt: &Implicit, hysteresis: f64) -> Result<Self, QueryError> {
        let least = Need::new(query, mt.frame())?;
        let most = Need::new(query, mt.frame())?.tightened(1.0 / (1.0 + hysteresis));
        Ok(Self { least, most })
    }

    /// Whether an update is wanted, and whether it may stay.
    #[inline]
    fn wanted(&self, ball: &Ball) -> [bool; 2] {
        [self.least.wants(ball), self.most.wants(ball)]
    }
}

/// Counts what is done, and says when it is enough.
struct Work {
    change: Change,
    most: usize,
    until: Option<Instant>,
}

impl Work {
    fn new(effort: &Effort) -> Self {
        Self {
            change: Change::default(),
            most: effort.changes.unwrap_or(usize::MAX),
            until: effort.time.and_then(|time| Instant::now().checked_add(time)),
        }
    }

    fn may_go_on(&self) -> bool {
        self.change.splits + self.change.merges < self.most
            && self.until.is_none_or(|until| Instant::now() < until)
    }
}
