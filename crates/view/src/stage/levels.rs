//! Levels of detail on a stage: a cut that follows queries.

use std::sync::Arc;
use std::time::Duration;

use meshlod::mesh::Bounds;
use meshlod::multires::Focus;
use wgpu::RenderPass;

use super::Display;
use crate::{
    CutError, CutFollower, CutModel, CutQuery, CutStep, CutTolerance, FollowOptions, GpuCut,
    Placement, Renderer, Transition, ViewError,
};

/// Levels of a multiresolution model on the GPU, and the cut of them that is shown.
///
/// The cut changes on its own thread: ask for a cut with [`LevelsSubject::ask`], and take the steps
/// that are ready with [`LevelsSubject::poll`] before every frame.
#[derive(Debug)]
pub struct LevelsSubject {
    model: Arc<CutModel>,
    cut: GpuCut,
    follower: CutFollower,
    motion: Option<Duration>,
    /// Follower with another motion, which takes over with its first step.
    next: Option<CutFollower>,
    query: CutQuery,
    /// How the cut changes on the screen, if vertices do not move.
    pub transition: Transition,
    /// Time of the current transition, in seconds.
    fade_s: f32,
    /// Time that is still to pass for vertices that move.
    elapsed: Duration,
    /// Placements of the triangles that go and come.
    fading: [Placement; 2],
    last: CutStep,
}

/// Duration of a dithered transition, in seconds.
const FADE_S: f32 = 0.25;

/// Splits and merges in one step, about 1.5 MB of uploads: as much as a frame can take.
const CHANGES: usize = 20_000;

/// Faces shown before the first query.
const FIRST_FACES: usize = 50_000;

fn start(model: &Arc<CutModel>, motion: Option<Duration>) -> CutFollower {
    CutFollower::start(model.clone(), FollowOptions { changes: Some(CHANGES), motion })
}

impl LevelsSubject {
    /// Uploads the vertices of all levels of a model, and shows a level of at most 50,000 faces,
    /// or the coarsest.
    ///
    /// # Errors
    /// A model beyond the limits of the GPU.
    pub fn new(renderer: &Renderer, model: &Arc<CutModel>) -> Result<Self, ViewError> {
        let tolerance = CutTolerance::Faces(FIRST_FACES);
        let query = CutQuery { focus: Focus::Everything, tolerance };
        let mut this = Self {
            cut: GpuCut::new(renderer, model)?,
            follower: start(model, None),
            model: model.clone(),
            motion: None,
            next: None,
            query: query.clone(),
            transition: Transition::default(),
            fade_s: 0.0,
            elapsed: Duration::ZERO,
            fading: [renderer.placement(), renderer.placement()],
            last: CutStep::default(),
        };
        this.ask(query);
        this.finish()?;
        Ok(this)
    }

    /// Sets the time in which vertices move to their new positions; with `None` the cut changes as
    /// [`transition`](Self::transition) says. Height fields have no such motion.
    ///
    /// Another follower starts, and takes over when it has reached the query; until then the cut
    /// that is shown follows as before.
    pub fn set_motion(&mut self, motion: Option<Duration>) {
        if motion == self.motion {
            return;
        }
        self.motion = motion;
        let mut next = start(&self.model, motion);
        next.ask(self.query.clone());
        self.next = Some(next);
    }

    /// Asks for another cut; the one shown stays until steps towards it are ready.
    pub fn ask(&mut self, query: CutQuery) {
        self.query = query.clone();
        if let Some(next) = &mut self.next {
            next.ask(query.clone());
        }
        self.follower.ask(query);
    }

    /// Takes the next step towards the answer to the last query, if it is ready, and returns
    /// whether the picture changes. While old triangles dissolve into new ones, the next step
    /// waits.
    ///
    /// `seconds` is the time since the last call.
    ///
    /// # Errors
    /// The query was invalid; the cut has not changed.
    pub fn poll(&mut self, seconds: f32) -> Result<bool, CutError> {
        if self.cut.is_fading() {
            self.fade_s += seconds;
            if self.fade_s >= FADE_S {
                self.cut.finish_fade();
            }
            return Ok(true);
        }
        if let Some(first) = self.next.as_mut().and_then(CutFollower::poll) {
            return self.take_over(first).map(|()| true);
        }
        self.pass_time(Duration::try_from_secs_f32(seconds).unwrap_or_default());
        let Some(step) = self.follower.poll() else { return Ok(false) };
        self.show(step?);
        Ok(true)
    }

    /// Lets time pass for vertices that move, as soon as the follower has taken the time before.
    fn pass_time(&mut self, time: Duration) {
        if !self.last.is_moving {
            self.elapsed = Duration::ZERO;
            return;
        }
        self.elapsed += time;
        if self.elapsed > Duration::ZERO && !self.follower.is_advancing() {
            self.follower.advance(std::mem::take(&mut self.elapsed));
        }
    }

    /// Waits until the cut answers the last query, and shows it at once.
    ///
    /// # Errors
    /// As [`LevelsSubject::poll`].
    pub fn finish(&mut self) -> Result<(), CutError> {
        if let Some(first) = self.next.as_mut().and_then(CutFollower::wait) {
            self.take_over(first)?;
        }
        self.settle()?;
        self.cut.finish_fade();
        Ok(())
    }

    /// Waits until the cut answers the last query and every vertex has arrived.
    fn settle(&mut self) -> Result<(), CutError> {
        loop {
            while let Some(step) = self.follower.wait() {
                self.show(step?);
            }
            if !self.last.is_moving {
                return Ok(());
            }
            self.follower.advance(Duration::MAX);
        }
    }

    /// Goes on with another follower, given its first step, after all vertices have arrived.
    fn take_over(&mut self, first: Result<CutStep, CutError>) -> Result<(), CutError> {
        let Some(next) = self.next.take() else { return Ok(()) };
        let first = first?;
        self.settle()?;
        self.cut.clear();
        self.follower = next;
        self.show(first);
        Ok(())
    }

    fn show(&mut self, step: CutStep) {
        let transition = match self.motion {
            Some(_) => Transition::Immediate,
            None => self.transition,
        };
        self.cut.apply(&step, transition);
        self.fade_s = 0.0;
        self.last = CutStep { patches: Vec::new(), moved: Vec::new(), ..step };
    }

    /// Returns true while the cut is on the way to the answer to the last query.
    pub fn is_changing(&self) -> bool {
        self.follower.is_waiting()
            || self.cut.is_fading()
            || self.last.is_moving
            || self.next.is_some()
    }

    /// Returns the counts and the time of the last step, without its patches.
    pub fn last_step(&self) -> &CutStep {
        &self.last
    }

    /// Returns the bytes sent to the GPU since the last call.
    pub fn take_uploaded(&mut self) -> u64 {
        self.cut.take_uploaded()
    }

    /// Returns the cut.
    pub fn cut(&self) -> &GpuCut {
        &self.cut
    }

    pub(super) fn bounds(&self) -> Bounds {
        self.model.bounds()
    }

    pub(super) fn draw(
        &self,
        renderer: &Renderer,
        pass: &mut RenderPass<'_>,
        placement: &Placement,
        display: &Display,
    ) {
        if display.wireframe {
            self.cut.draw_faces(renderer, pass, placement);
        } else {
            self.cut.draw(renderer, pass, placement);
        }
        self.cut.draw_fade(renderer, pass, [&self.fading[0], &self.fading[1]]);
    }

    /// Calls `set` for the placements of dissolving triangles, with the share of their pixels that
    /// is shown.
    pub(super) fn place_fade(&self, set: impl Fn(&Placement, f32)) {
        let t = (self.fade_s / FADE_S).clamp(0.0, 1.0);
        set(&self.fading[0], t - 1.0);
        set(&self.fading[1], t);
    }
}
