//! Thread that follows a moving query with a cut, and sends the changes.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel, sync_channel};
use std::thread;
use std::time::Duration;

use super::error::CutError;
use super::model::CutModel;
use super::query::{CutQuery, CutStep, FollowOptions};
use super::worker::{Answer, Request, Worker};

/// Follows a moving query on its own thread, which ends when this is dropped.
#[derive(Debug)]
pub struct CutFollower {
    requests: Sender<Request>,
    answers: Receiver<Answer>,
    /// Number of the last query.
    asked: u64,
    is_waiting: bool,
    /// Numbers of the last requested advance and of the last answered one.
    advanced: [u64; 2],
}

impl CutFollower {
    /// Starts at the coarsest level: the first step has all its faces.
    pub fn start(model: Arc<CutModel>, options: FollowOptions) -> Self {
        let (requests, incoming) = channel();
        // One step at a time: the next one waits until this one has been taken.
        let (outgoing, answers) = sync_channel(0);
        thread::spawn(move || Worker::new(&model, &options).serve(&incoming, &outgoing));
        Self { requests, answers, asked: 0, is_waiting: false, advanced: [0; 2] }
    }

    /// Asks for another cut; queries that have not been begun are forgotten.
    pub fn ask(&mut self, query: CutQuery) {
        self.asked += 1;
        self.is_waiting = true;
        // A thread that has ended is noticed by the next poll.
        let _ = self.requests.send(Request::Ask(self.asked, query));
    }

    /// Lets time pass for vertices that move; a later step has their new positions.
    pub fn advance(&mut self, elapsed: Duration) {
        self.advanced[0] += 1;
        let _ = self.requests.send(Request::Advance(self.advanced[0], elapsed));
    }

    /// Returns true until the last query has been answered to the end.
    pub fn is_waiting(&self) -> bool {
        self.is_waiting
    }

    /// Returns true until the time that has passed is in a step.
    pub fn is_advancing(&self) -> bool {
        self.advanced[0] != self.advanced[1]
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

    /// Waits for the next step; `None` if no request is open.
    ///
    /// # Errors
    /// As [`CutFollower::poll`].
    pub fn wait(&mut self) -> Option<Result<CutStep, CutError>> {
        while self.is_waiting || self.is_advancing() {
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
    fn take(&mut self, answer: Answer) -> Option<Result<CutStep, CutError>> {
        self.advanced[1] = answer.advanced;
        let is_last = answer.asked == self.asked;
        match answer.step {
            Ok(step) => {
                self.is_waiting &= !(is_last && step.is_done);
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
        let was_waiting = std::mem::take(&mut self.is_waiting) || self.is_advancing();
        self.advanced[1] = self.advanced[0];
        was_waiting.then_some(Err(CutError::Ended))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use meshlod::model::SceneLayout;
    use meshlod::multires::{
        Focus, Forest, HeightField, Hierarchy, Implicit, Query, Rtin, UpdateLimits,
    };
    use meshlod::samples;

    use super::*;
    use crate::CutTolerance;

    fn of(levels: Hierarchy) -> Arc<CutModel> {
        Arc::new(CutModel::new(levels, &SceneLayout::default()).unwrap())
    }

    fn model() -> Arc<CutModel> {
        let forest = Forest::new(&samples::torus(3_000), &Default::default()).unwrap();
        of(Implicit::new(&forest).unwrap().into())
    }

    fn field() -> Arc<CutModel> {
        let field = HeightField::from_mesh(&samples::terrain(3_000)).unwrap();
        of(Rtin::new(&field).into())
    }

    fn options(changes: Option<usize>) -> FollowOptions {
        FollowOptions { changes, motion: None }
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
            for patch in &step.patches {
                match patch.vertices {
                    Some(vertices) => slots.insert(patch.slot, vertices),
                    None => slots.remove(&patch.slot),
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
            let mut follower = CutFollower::start(model.clone(), options(changes));
            let mut slots = HashMap::new();
            for error in [1.0, 0.01, 0.0, 0.002, 0.1] {
                follow(&mut follower, uniform(error), &mut slots);
                let mut cut = model.levels().cut();
                cut.update(&Query::uniform(error), &UpdateLimits::default()).unwrap();
                let sorted = |all: Vec<[u32; 3]>| {
                    let mut all: Vec<_> = all.into_iter().map(rotated).collect();
                    all.sort_unstable();
                    all
                };
                let vertices = |(slot, nodes)| cut.slot_mesh().wedges(slot).unwrap_or(nodes);
                let expected = sorted(cut.slot_mesh().triangles().map(vertices).collect());
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
        let mut follower = CutFollower::start(model(), options(Some(100)));
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
        let mut follower = CutFollower::start(model(), options(None));
        let finest = model().levels().cut().slot_mesh().face_count();
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
        let mut follower = CutFollower::start(model(), options(None));
        let mut slots = HashMap::new();
        follow(&mut follower, uniform(0.01), &mut slots);
        follower.ask(uniform(f64::NAN));
        assert!(follower.wait().unwrap().is_err());
        assert!(follow(&mut follower, uniform(0.01), &mut slots).patches.is_empty());
    }

    #[test]
    fn vertices_that_move_arrive_where_the_cut_has_them() {
        let model = model();
        let motion = Some(Duration::from_millis(100));
        let mut moving = CutFollower::start(model.clone(), FollowOptions { changes: None, motion });
        let fields = crate::cut::fields::VertexFields::new(&model);
        let (home, _) = fields.all(&model);
        let (mut slots, mut places) = (HashMap::new(), home.clone());
        let mut moves = 0;
        for error in [1.0, 0.01, 0.0, 0.002, 0.1] {
            let mut step = follow(&mut moving, uniform(error), &mut slots);
            loop {
                for moved in &step.moved {
                    places[moved.vertex as usize] = moved.now.position;
                    moves += usize::from(moved.now.position != home[moved.vertex as usize]);
                }
                if !step.is_moving {
                    break;
                }
                moving.advance(Duration::from_millis(40));
                assert!(moving.is_advancing());
                step = moving.wait().unwrap().unwrap();
                for patch in &step.patches {
                    match patch.vertices {
                        Some(vertices) => slots.insert(patch.slot, vertices),
                        None => slots.remove(&patch.slot),
                    };
                }
                assert_eq!(slots.len(), step.faces);
            }
            let mut at_once = CutFollower::start(model.clone(), options(None));
            let mut expected = HashMap::new();
            follow(&mut at_once, uniform(error), &mut expected);
            let sorted = |slots: &HashMap<u32, [u32; 3]>| {
                let mut all: Vec<_> = slots.values().copied().map(rotated).collect();
                all.sort_unstable();
                all
            };
            assert_eq!(sorted(&slots), sorted(&expected), "at {error}");
            let drawn = slots.values().flatten().map(|&vertex| vertex as usize);
            assert!(drawn.into_iter().all(|vertex| places[vertex] == home[vertex]), "at {error}");
        }
        assert!(moves > 1_000, "{moves} vertices were on their way");
    }
}
