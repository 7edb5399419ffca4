//! The thread of a follower: a cut that answers its requests.

use std::sync::mpsc::{Receiver, SyncSender};
use std::time::{Duration, Instant};

use meshlod::multires::{
    Focus, Geomorph, Query, QueryError, Tolerance, UpdateLimits, VertexValues,
};

use super::fields::{MovedVertex, VertexFields};
use super::followed::Followed;
use super::model::CutModel;
use super::query::{CutQuery, CutStep, CutTolerance, FollowOptions};
use super::slots::GroupSlots;

/// Request of a follower to its thread.
#[derive(Debug)]
pub(super) enum Request {
    /// A query, with its number.
    Ask(u64, CutQuery),
    /// Time that has passed, with the number of the request.
    Advance(u64, Duration),
}

/// Answer of the thread to its follower.
#[derive(Debug)]
pub(super) struct Answer {
    /// Number of the query that the step is towards.
    pub(super) asked: u64,
    /// Number of the last advance in the step.
    pub(super) advanced: u64,
    pub(super) step: Result<CutStep, QueryError>,
}

/// Cut that answers queries.
pub(super) struct Worker<'m> {
    cut: Followed<'m>,
    model: &'m CutModel,
    fields: VertexFields,
    slots: GroupSlots,
    changes: Option<usize>,
    /// True until the first step.
    is_first: bool,
    is_moving: bool,
    /// Slots that the current step has changed, some of them more than once.
    touched: Vec<u32>,
    /// Nodes that the current step has moved, some of them more than once.
    moved: Vec<u32>,
    /// Scratch memory for the values of a node.
    state: VertexValues,
    /// Error found for the last number of faces.
    error: Option<f64>,
}

/// Rounds of bisection for a number of faces: an error to one part in four hundred.
const ROUNDS: usize = 8;

impl<'m> Worker<'m> {
    pub(super) fn new(model: &'m CutModel, options: &FollowOptions) -> Self {
        Self {
            cut: Followed::new(model, options.motion),
            fields: VertexFields::new(model),
            slots: GroupSlots::new(&model.groups),
            error: None,
            model,
            changes: options.changes,
            is_first: true,
            is_moving: false,
            touched: Vec::new(),
            moved: Vec::new(),
            state: VertexValues::default(),
        }
    }

    /// Answers requests until the follower is dropped: of several queries the last, and the sum of
    /// all times.
    pub(super) fn serve(mut self, requests: &Receiver<Request>, answers: &SyncSender<Answer>) {
        let mut query = None;
        let (mut asked, mut advanced) = (0, 0);
        loop {
            let mut elapsed = Duration::ZERO;
            let mut request = match &query {
                None => match requests.recv() {
                    Ok(request) => Some(request),
                    Err(_) => return,
                },
                Some(_) => None,
            };
            while let Some(next) = request.take().or_else(|| requests.try_recv().ok()) {
                match next {
                    Request::Ask(number, wanted) => (asked, query) = (number, Some(wanted)),
                    Request::Advance(number, time) => {
                        (advanced, elapsed) = (number, elapsed.saturating_add(time));
                    }
                }
            }
            let step = self.step(query.as_ref(), elapsed);
            if step.as_ref().map_or(true, |step| step.is_done) {
                query = None;
            }
            if answers.send(Answer { asked, advanced, step }).is_err() {
                return;
            }
        }
    }

    /// Lets time pass, and then changes the cut towards a query.
    fn step(&mut self, query: Option<&CutQuery>, elapsed: Duration) -> Result<CutStep, QueryError> {
        let start = Instant::now();
        let before = self.is_first.then(|| self.cut.shown().slots());
        if elapsed > Duration::ZERO {
            self.is_moving = self.cut.advance(elapsed);
            self.record();
        }
        let is_done = query.map_or(Ok(true), |query| match query.tolerance {
            CutTolerance::Faces(count) => self.reach(query, count),
            _ => self.follow(query),
        })?;
        // The base mesh came without patches.
        self.touched.extend(0..before.unwrap_or(0) as u32);
        self.is_first = false;
        self.touched.sort_unstable();
        self.touched.dedup();
        let shown = self.cut.shown();
        // Wedges, or nodes without wedges.
        let vertices = |slot| shown.wedges(slot).or_else(|| shown.triangle(slot));
        let now = self.touched.drain(..).map(|slot| (slot, vertices(slot)));
        let patches = self.slots.update(&self.model.groups, now);
        Ok(CutStep {
            patches,
            moved: self.take_moved(),
            faces: self.cut.shown().face_count(),
            vertices: self.cut.goal().vertex_count(),
            is_done,
            is_moving: self.is_moving,
            milliseconds: start.elapsed().as_secs_f64() * 1e3,
        })
    }

    /// Changes the cut towards an error or a number of pixels.
    fn follow(&mut self, query: &CutQuery) -> Result<bool, QueryError> {
        let places = &self.model.places;
        match query.tolerance {
            CutTolerance::Pixels { camera, pixels } if places.is_own() => {
                self.update(query.focus.clone(), Tolerance::Pixels { camera, pixels })
            }
            // What is out of sight where the levels have it may be in sight elsewhere.
            CutTolerance::Pixels { camera, pixels } => {
                let check = Query {
                    focus: Focus::Everything,
                    tolerance: Tolerance::Pixels { camera, pixels },
                };
                check.validate()?;
                let field = places.tolerance(&camera, pixels);
                self.update(self.focus(query), Tolerance::Field(&field))
            }
            CutTolerance::Uniform(most) => self.update(self.focus(query), Tolerance::Uniform(most)),
            CutTolerance::Faces(_) => Ok(true),
        }
    }

    /// Returns the focus of a query, in the space of the levels.
    fn focus(&self, query: &CutQuery) -> Focus {
        match &query.focus {
            Focus::Frustum(_) if !self.model.places.is_own() => Focus::Everything,
            focus => focus.clone(),
        }
    }

    fn update(&mut self, focus: Focus, tolerance: Tolerance<'_>) -> Result<bool, QueryError> {
        let changes = self.changes.filter(|_| !self.is_first);
        let limits = UpdateLimits { changes, time: None };
        let change = self.cut.update(&Query { focus, tolerance }, &limits)?;
        self.is_moving |= self.cut.morph().is_some() && change.splits + change.merges > 0;
        self.record();
        Ok(change.done)
    }

    /// Notes the slots and nodes that the last update or advance changed.
    fn record(&mut self) {
        self.touched.extend(self.cut.shown().touched_slots());
        self.moved.extend(self.cut.morph().into_iter().flat_map(Geomorph::moved));
    }

    /// Returns the vertices that have moved, each once and as it is now, in rising order.
    fn take_moved(&mut self) -> Vec<MovedVertex> {
        let mut moved = Vec::new();
        let levels = self.model.contractions();
        let (Some(morph), Some(levels)) = (self.cut.morph(), levels) else { return moved };
        self.moved.sort_unstable();
        self.moved.dedup();
        for node in self.moved.drain(..) {
            morph.values(node, &mut self.state);
            self.fields.moved(levels.wedges_of(node).start, &self.state, &mut moved);
        }
        moved
    }

    /// Finds about the smallest error with which the cut has at most `count` faces, starting at the
    /// error of the last search: the cost of a step is proportional to its changes.
    fn reach(&mut self, query: &CutQuery, count: usize) -> Result<bool, QueryError> {
        let unlimited = self.changes.take();
        let found = self.search(query, count);
        self.changes = unlimited;
        found
    }

    fn search(&mut self, query: &CutQuery, count: usize) -> Result<bool, QueryError> {
        let diagonal = self.model.bounds().diagonal();
        let range = diagonal * 1e-9..diagonal;
        let last = self.error.filter(|error| range.contains(error));
        let mut error = last.unwrap_or(diagonal * 1e-2);
        // Twice the error until the faces are few enough, or half of it while they are.
        let is_fine = self.faces_at(query, error)? > count;
        let by = if is_fine { 2.0 } else { 0.5 };
        while range.contains(&error) && (self.faces_at(query, error * by)? > count) == is_fine {
            error *= by;
        }
        let [mut low, mut high] = if is_fine { [error, error * by] } else { [error * by, error] };
        for _ in 0..ROUNDS {
            let middle = (low * high).sqrt();
            let faces = self.faces_at(query, middle)?;
            *(if faces > count { &mut low } else { &mut high }) = middle;
            if faces <= count && faces as f64 > 0.99 * count as f64 {
                break;
            }
        }
        self.error = Some(high);
        self.faces_at(query, high).map(|_| true)
    }

    /// Changes the cut to an error, and returns its faces.
    fn faces_at(&mut self, query: &CutQuery, error: f64) -> Result<usize, QueryError> {
        self.update(self.focus(query), Tolerance::Uniform(error))?;
        Ok(self.cut.goal().face_count())
    }
}
