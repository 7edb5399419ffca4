//! Thread that follows a moving query with a cut, and hands out what changes.

use std::cell::OnceCell;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread;

use meshlod::mesh::Bounds;
use meshlod::multires::{
    Cut, Focus, Implicit, Query, QueryError, Tolerance, UpdateLimits, ViewCamera,
};

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

/// Follows a moving query on a thread of its own. Drop it to end the thread.
#[derive(Debug)]
pub struct CutFollower {
    queries: Option<Sender<CutQuery>>,
    steps: Option<Receiver<Result<CutStep, QueryError>>>,
    thread: Option<thread::JoinHandle<()>>,
}

impl CutFollower {
    /// Starts at the coarsest level: the first step has all its faces.
    ///
    /// A step does at most `changes` splits and merges, which bounds what a frame uploads: a change
    /// touches about six slots of 12 bytes. `None` answers every query in one step.
    pub fn start(model: Arc<Implicit>, changes: Option<usize>) -> Self {
        let (queries, incoming) = channel();
        // One step at a time: the next one waits until this one has been taken.
        let (outgoing, steps) = sync_channel(0);
        let thread = thread::spawn(move || Worker::new(&model, changes).serve(incoming, outgoing));
        Self { queries: Some(queries), steps: Some(steps), thread: Some(thread) }
    }

    /// Asks for another cut; queries that have not been begun are forgotten.
    pub fn ask(&self, query: CutQuery) {
        if let Some(queries) = &self.queries {
            // A thread that has ended is told by the steps.
            let _ = queries.send(query);
        }
    }

    /// Returns the next step, if there is one; never waits.
    ///
    /// # Errors
    /// The query is invalid; the cut has not changed.
    pub fn poll(&self) -> Option<Result<CutStep, QueryError>> {
        self.steps.as_ref()?.try_recv().ok()
    }

    /// Waits for the next step of a query that was asked; `None` if the thread has ended.
    ///
    /// # Errors
    /// As [`CutFollower::poll`].
    pub fn wait(&self) -> Option<Result<CutStep, QueryError>> {
        self.steps.as_ref()?.recv().ok()
    }
}

impl Drop for CutFollower {
    fn drop(&mut self) {
        // Closed channels end the thread, wherever it is.
        (self.queries, self.steps) = (None, None);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Cut that answers queries.
struct Worker<'m> {
    cut: Cut<'m>,
    model: &'m Implicit,
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
    fn new(model: &'m Implicit, changes: Option<usize>) -> Self {
        Self {
            cut: Cut::new(model),
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
        queries: Receiver<CutQuery>,
        steps: SyncSender<Result<CutStep, QueryError>>,
    ) {
        let Ok(mut query) = queries.recv() else { return };
        loop {
            query = queries.try_iter().last().unwrap_or(query);
            let step = self.step(&query);
            let is_done = step.as_ref().map_or(true, |step| step.is_done);
            if steps.send(step).is_err() {
                return;
            }
            if is_done {
                let Ok(next) = queries.recv() else { return };
                query = next;
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
        let mut error = self.error.unwrap_or(diagonal * 1e-2);
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
            if faces > count {
                low = middle
            } else {
                high = middle
            }
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

fn diagonal(model: &Implicit) -> f64 {
    let places: Vec<_> = (0..model.node_count() as u32).map(|node| model.position(node)).collect();
    Bounds::of(&places).diagonal()
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use meshlod::multires::{Forest, Model};
    use meshlod::samples;

    use super::*;

    fn model() -> Arc<Implicit> {
        let forest = Forest::new(&samples::torus(3_000), &Default::default()).unwrap();
        Arc::new(Model::new(&forest).unwrap().implicit().clone())
    }

    fn uniform(error: f64) -> CutQuery {
        CutQuery { focus: Focus::Everything, tolerance: CutTolerance::Uniform(error) }
    }

    /// Applies steps until one is done, and returns the triangles.
    fn follow(
        follower: &CutFollower,
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
            if step.is_done {
                return step;
            }
        }
    }

    #[test]
    fn patches_add_up_to_the_cut() {
        let model = model();
        for changes in [None, Some(40)] {
            let follower = CutFollower::start(model.clone(), changes);
            let mut slots = HashMap::new();
            for error in [1.0, 0.01, 0.0, 0.002, 0.1] {
                follow(&follower, uniform(error), &mut slots);
                let cut = Cut::at(&model, &Query::uniform(error)).unwrap();
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
        let follower = CutFollower::start(model(), Some(100));
        let mut slots = HashMap::new();
        for count in [500, 2_000, 100] {
            let tolerance = CutTolerance::Faces(count);
            let query = CutQuery { focus: Focus::Everything, tolerance };
            let step = follow(&follower, query, &mut slots);
            assert!(step.faces <= count && step.faces > count * 9 / 10, "{} {count}", step.faces);
        }
    }

    #[test]
    fn a_bad_query_is_an_error_and_changes_nothing() {
        let follower = CutFollower::start(model(), None);
        let mut slots = HashMap::new();
        follow(&follower, uniform(0.01), &mut slots);
        follower.ask(uniform(f64::NAN));
        assert!(follower.wait().unwrap().is_err());
        assert!(follow(&follower, uniform(0.01), &mut slots).patches.is_empty());
    }
}
