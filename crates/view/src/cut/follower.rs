//! Thread that follows a moving query with a cut, and hands out what changes.

use std::cell::OnceCell;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, SyncSender, TryRecvError, channel, sync_channel};
use std::thread;

use meshlod::mesh::Bounds;
use meshlod::multires::{
    Focus, Hierarchy, HierarchyCut, Query, QueryError, Tolerance, UpdateLimits, ViewCamera,
};
use thiserror::Error;

/// Query for a [`CutFollower`].
#[derive(Clone, Debug)]
pub struct CutQuery {
    /// Region that is fine.
    pub focus: Focus,
    /// Fineness within the focus.
    pub tolerance: CutTolerance,
}

/// Fineness of a cut.
#[derive(Clone, Debug)]
pub enum CutTolerance {
    /// Error in model units.
    Uniform(f64),
    /// Error in pixels of a camera.
    Pixels {
        /// Camera from which it is seen.
        camera: ViewCamera,
        /// Number of pixels.
        pixels: f64,
    },
    /// As fine as a number of faces allows, with one error everywhere.
    Faces(usize),
}

/// Change of a cut: slots of the index buffer, and what they hold now.
#[derive(Clone, Debug, Default)]
pub struct CutStep {
    /// Slots that changed, with the nodes of their triangles; `None` for slots that are empty now.
    pub patches: Vec<(u32, Option<[u32; 3]>)>,
    /// Number of faces of the cut.
    pub faces: usize,
    /// Number of vertices of the cut.
    pub vertices: usize,
    /// True if the cut satisfies the query; false if a limit was reached first.
    pub is_done: bool,
    /// Time that the cut took to change, in milliseconds.
    pub milliseconds: f64,
}

/// Reason why a follower has no answer.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CutError {
    /// The query is invalid; the cut has not changed.
    #[error(transparent)]
    Query(#[from] QueryError),
    /// The thread has ended, which it never does by itself.
    #[error("the thread that follows the cut has ended")]
    Ended,
}

/// Follows a moving query on a thread of its own, which ends when this is dropped.
#[derive(Debug)]
pub struct CutFollower {
    queries: Sender<(u64, CutQuery)>,
    answers: Receiver<(u64, Result<CutStep, QueryError>)>,
    /// Number of the last query.
    asked: u64,
    is_waiting: bool,
}

impl CutFollower {
    /// Starts at the coarsest level: the first step has all its faces.
    ///
    /// A step does at most `changes` splits and merges, which bounds what a frame uploads: a change
    /// touches about six slots of 12 bytes. `None` answers every query in one step, and so does a
    /// search for a number of faces in any case.
    pub fn start(model: Arc<Hierarchy>, changes: Option<usize>) -> Self {
        let (queries, incoming) = channel();
        // One step at a time: the next one waits until this one has been taken.
        let (outgoing, answers) = sync_channel(0);
        thread::spawn(move || Worker::new(&model, changes).serve(&incoming, &outgoing));
        Self { queries, answers, asked: 0, is_waiting: false }
    }

    /// Asks for another cut; queries that have not been begun are forgotten.
    pub fn ask(&mut self, query: CutQuery) {
        self.asked += 1;
        self.is_waiting = true;
        // A thread that has ended is noticed by the next poll.
        let _ = self.queries.send((self.asked, query));
    }

    /// Returns true until the last query has been answered to the end.
    pub fn is_waiting(&self) -> bool {
        self.is_waiting
    }

    /// Returns the next step, if it is ready; never waits. It may still be one towards an earlier
    /// query.
    ///
    /// # Errors
    /// The last query is invalid, or the thread has ended.
    pub fn poll(&mut self) -> Option<Result<CutStep, CutError>> {
        match self.answers.try_recv() {
            Ok(answer) => self.take(answer),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => self.end(),
        }
    }

    /// Waits for the next step; `None` if nothing is asked.
    ///
    /// # Errors
    /// As [`CutFollower::poll`].
    pub fn wait(&mut self) -> Option<Result<CutStep, CutError>> {
        while self.is_waiting {
            let step = match self.answers.recv() {
                Ok(answer) => self.take(answer),
                Err(_) => self.end(),
            };
            if step.is_some() {
                return step;
            }
        }
        None
    }

    /// Takes an answer; `None` for a refusal of an earlier query.
    fn take(
        &mut self,
        (number, step): (u64, Result<CutStep, QueryError>),
    ) -> Option<Result<CutStep, CutError>> {
        let is_last = number == self.asked;
        match step {
            Ok(step) => {
                self.is_waiting = !(is_last && step.is_done);
                Some(Ok(step))
            }
            Err(error) if is_last => {
                self.is_waiting = false;
                Some(Err(error.into()))
            }
            Err(_) => None,
        }
    }

    fn end(&mut self) -> Option<Result<CutStep, CutError>> {
        let was_waiting = std::mem::take(&mut self.is_waiting);
        was_waiting.then_some(Err(CutError::Ended))
    }
}

/// Cut that answers queries.
struct Worker<'m> {
    cut: HierarchyCut<'m>,
    model: &'m Hierarchy,
    changes: Option<usize>,
    /// True until the first step.
    is_first: bool,
    /// Slots that the current step has changed, some of them more than once.
    touched: Vec<u32>,
    /// Error found for the last number of faces.
    error: Option<f64>,
    /// Diagonal of the model's box, once it is needed.
    diagonal: OnceCell<f64>,
}

/// Rounds of bisection for a number of faces: an error to one part in four hundred.
const ROUNDS: usize = 8;

impl<'m> Worker<'m> {
    fn new(model: &'m Hierarchy, changes: Option<usize>) -> Self {
        Self {
            cut: model.cut(),
            error: None,
            model,
            changes,
            is_first: true,
            touched: Vec::new(),
            diagonal: OnceCell::new(),
        }
    }

    fn serve(
        mut self,
        queries: &Receiver<(u64, CutQuery)>,
        answers: &SyncSender<(u64, Result<CutStep, QueryError>)>,
    ) {
        let Ok((mut number, mut query)) = queries.recv() else { return };
        loop {
            (number, query) = queries.try_iter().last().unwrap_or((number, query));
            let step = self.step(&query);
            let is_done = step.as_ref().map_or(true, |step| step.is_done);
            if answers.send((number, step)).is_err() {
                return;
            }
            if is_done {
                let Ok(next) = queries.recv() else { return };
                (number, query) = next;
            }
        }
    }

    fn step(&mut self, query: &CutQuery) -> Result<CutStep, QueryError> {
        let start = std::time::Instant::now();
        let before = self.is_first.then(|| self.cut.slots());
        self.touched.clear();
        let is_done = match query.tolerance {
            CutTolerance::Uniform(most) => self.update(query, Tolerance::Uniform(most))?,
            CutTolerance::Pixels { camera, pixels } => {
                self.update(query, Tolerance::Pixels { camera, pixels })?
            }
            CutTolerance::Faces(count) => self.reach(query, count)?,
        };
        // The base mesh came without patches.
        self.touched.extend(0..before.unwrap_or(0) as u32);
        self.is_first = false;
        Ok(CutStep {
            patches: self.patches(),
            faces: self.cut.face_count(),
            vertices: self.cut.vertex_count(),
            is_done,
            milliseconds: start.elapsed().as_secs_f64() * 1e3,
        })
    }

    fn update(&mut self, query: &CutQuery, tolerance: Tolerance<'_>) -> Result<bool, QueryError> {
        let query = Query { focus: query.focus.clone(), tolerance };
        let limits = UpdateLimits { changes: self.changes, time: None };
        let change = self.cut.update(&query, &limits)?;
        self.touched.extend(self.cut.patches().map(|patch| patch.slot));
        Ok(change.done)
    }

    /// Finds about the smallest error with which the cut has at most `count` faces, beginning at that
    /// of the last search: every step costs what it changes.
    fn reach(&mut self, query: &CutQuery, count: usize) -> Result<bool, QueryError> {
        let unlimited = self.changes.take();
        let found = self.search(query, count);
        self.changes = unlimited;
        found
    }

    fn search(&mut self, query: &CutQuery, count: usize) -> Result<bool, QueryError> {
        let diagonal = *self.diagonal.get_or_init(|| diagonal(self.model));
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
        self.update(query, Tolerance::Uniform(error))?;
        Ok(self.cut.face_count())
    }

    /// Returns what the slots that were touched hold now.
    fn patches(&mut self) -> Vec<(u32, Option<[u32; 3]>)> {
        self.touched.sort_unstable();
        self.touched.dedup();
        self.touched.iter().map(|&slot| (slot, self.cut.triangle(slot))).collect()
    }
}

fn diagonal(model: &Hierarchy) -> f64 {
    let places: Vec<_> = (0..model.node_count() as u32).map(|node| model.position(node)).collect();
    Bounds::of(&places).diagonal()
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use meshlod::multires::{Forest, HeightField, Model, Rtin};
    use meshlod::samples;

    use super::*;

    fn model() -> Arc<Hierarchy> {
        let forest = Forest::new(&samples::torus(3_000), &Default::default()).unwrap();
        Arc::new(Model::new(&forest).unwrap().implicit().clone().into())
    }

    fn field() -> Arc<Hierarchy> {
        let field = HeightField::from_mesh(&samples::terrain(3_000)).unwrap();
        Arc::new(Rtin::new(&field).into())
    }

    fn uniform(error: f64) -> CutQuery {
        CutQuery { focus: Focus::Everything, tolerance: CutTolerance::Uniform(error) }
    }

    /// Applies steps until one is done, and returns the triangles.
    fn follow(
        follower: &mut CutFollower,
        query: CutQuery,
        slots: &mut HashMap<u32, [u32; 3]>,
    ) -> CutStep {
        follower.ask(query);
        loop {
            let step = follower.wait().unwrap().unwrap();
            for &(slot, nodes) in &step.patches {
                match nodes {
                    Some(nodes) => slots.insert(slot, nodes),
                    None => slots.remove(&slot),
                };
            }
            assert_eq!(slots.len(), step.faces);
            if !follower.is_waiting() {
                return step;
            }
        }
    }

    #[test]
    fn patches_add_up_to_the_cut() {
        let models = [model(), field()];
        for (model, changes) in models.iter().flat_map(|m| [None, Some(40)].map(|c| (m, c))) {
            let mut follower = CutFollower::start(model.clone(), changes);
            let mut slots = HashMap::new();
            for error in [1.0, 0.01, 0.0, 0.002, 0.1] {
                follow(&mut follower, uniform(error), &mut slots);
                let mut cut = model.cut();
                cut.update(&Query::uniform(error), &UpdateLimits::default()).unwrap();
                let sorted = |all: Vec<[u32; 3]>| {
                    let mut all: Vec<_> = all.into_iter().map(rotated).collect();
                    all.sort_unstable();
                    all
                };
                let expected = sorted(cut.triangles().map(|(_, nodes)| nodes).collect());
                assert_eq!(sorted(slots.values().copied().collect()), expected);
            }
        }
    }

    /// Rotates the least node to the front.
    fn rotated([a, b, c]: [u32; 3]) -> [u32; 3] {
        if a <= b && a <= c {
            [a, b, c]
        } else if b <= c {
            [b, c, a]
        } else {
            [c, a, b]
        }
    }

    #[test]
    fn a_number_of_faces_is_reached_from_below() {
        let mut follower = CutFollower::start(model(), Some(100));
        let mut slots = HashMap::new();
        let all = follow(&mut follower, uniform(0.0), &mut slots).faces;
        // Beyond both ends, too: what is found there must not lead the next search astray.
        for (count, least) in
            [(500, 450), (2_000, 1_800), (0, 0), (2_000, 1_800), (2 * all, all), (100, 80)]
        {
            let tolerance = CutTolerance::Faces(count);
            let query = CutQuery { focus: Focus::Everything, tolerance };
            let step = follow(&mut follower, query, &mut slots);
            let base = follow(&mut follower, uniform(1e9), &mut slots).faces;
            assert!((least..=count.max(base)).contains(&step.faces), "{} {count}", step.faces);
        }
    }

    #[test]
    fn a_step_towards_an_earlier_query_is_not_the_answer() {
        let mut follower = CutFollower::start(model(), None);
        let finest = model().cut().face_count();
        follower.ask(uniform(0.0));
        // The worker may be done with it, and wait to hand it over.
        std::thread::sleep(std::time::Duration::from_millis(50));
        follower.ask(uniform(f64::NAN));
        follower.ask(uniform(1e9));
        let mut last = None;
        while let Some(step) = follower.wait() {
            last = Some(step.unwrap());
        }
        assert_eq!(last.map(|step| step.faces), Some(finest), "the coarsest, asked for last");
        assert!(!follower.is_waiting() && follower.poll().is_none());
    }

    #[test]
    fn a_bad_query_is_an_error_and_changes_nothing() {
        let mut follower = CutFollower::start(model(), None);
        let mut slots = HashMap::new();
        follow(&mut follower, uniform(0.01), &mut slots);
        follower.ask(uniform(f64::NAN));
        assert!(follower.wait().unwrap().is_err());
        assert!(follow(&mut follower, uniform(0.01), &mut slots).patches.is_empty());
    }
}
