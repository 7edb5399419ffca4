//! Levels of detail on a stage: a cut that follows what is asked of it.

use std::sync::Arc;

use meshlod::mesh::Bounds;
use meshlod::multires::{Focus, Hierarchy};
use wgpu::RenderPass;

use super::Display;
use crate::{
    CutError, CutFollower, CutQuery, CutStep, CutTolerance, CutVertices, GpuCut, Placement,
    Renderer, Transition, ViewError,
};

/// Levels of a multiresolution model on the GPU, and the cut of them that is shown.
///
/// The cut changes on a thread of its own: ask for a cut with [`LevelsSubject::ask`], and take what is
/// ready with [`LevelsSubject::poll`] before every frame.
#[derive(Debug)]
pub struct LevelsSubject {
    cut: GpuCut,
    follower: CutFollower,
    bounds: Bounds,
    /// How the cut changes on the screen.
    pub transition: Transition,
    /// Time of the current transition, in seconds.
    fade_s: f32,
    /// Placements of the triangles that go and come.
    fading: [Placement; 2],
    last: CutStep,
}

/// Duration of a dithered transition, in seconds.
const FADE_S: f32 = 0.25;

/// Splits and merges in one step, about 1.5 MB of uploads: what a frame can take.
const CHANGES: usize = 20_000;

/// Faces that are shown before anything is asked for.
const FIRST_FACES: usize = 50_000;

impl LevelsSubject {
    /// Uploads the vertices of all levels of a model, and shows a level of at most 50,000 faces,
    /// or the coarsest.
    /// Blocks while normals are computed.
    ///
    /// # Errors
    /// A model beyond the limits of the GPU.
    pub fn new(renderer: &Renderer, model: &Arc<Hierarchy>) -> Result<Self, ViewError> {
        let vertices = CutVertices::new(model).map_err(CutError::from)?;
        let mut this = Self {
            cut: GpuCut::new(renderer, model, &vertices)?,
            bounds: vertices.bounds(),
            follower: CutFollower::start(model.clone(), Some(CHANGES)),
            transition: Transition::default(),
            fade_s: 0.0,
            fading: [renderer.placement(), renderer.placement()],
            last: CutStep::default(),
        };
        let tolerance = CutTolerance::Faces(FIRST_FACES);
        this.ask(CutQuery { focus: Focus::Everything, tolerance });
        this.finish()?;
        Ok(this)
    }

    /// Asks for another cut; the one shown stays until steps towards it are ready.
    pub fn ask(&mut self, query: CutQuery) {
        self.follower.ask(query);
    }

    /// Takes the next step towards the cut that was asked for, if it is ready, and returns whether
    /// the picture changes. While old triangles dissolve into new ones, the next step waits.
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
        let Some(step) = self.follower.poll() else { return Ok(false) };
        self.show(step?);
        Ok(true)
    }

    /// Waits until the cut is the one that was asked for, and shows it at once.
    ///
    /// # Errors
    /// As [`LevelsSubject::poll`].
    pub fn finish(&mut self) -> Result<(), CutError> {
        while let Some(step) = self.follower.wait() {
            self.show(step?);
        }
        self.cut.finish_fade();
        Ok(())
    }

    fn show(&mut self, step: CutStep) {
        self.cut.apply(&step, self.transition);
        self.fade_s = 0.0;
        self.last = CutStep { patches: Vec::new(), ..step };
    }

    /// Returns true while the cut is on the way to the one that was asked for.
    pub fn is_changing(&self) -> bool {
        self.follower.is_waiting() || self.cut.is_fading()
    }

    /// Returns the counts and the time of the last step, without its patches.
    pub fn last_step(&self) -> &CutStep {
        &self.last
    }

    /// Returns the bytes that have been sent to the GPU since this was last asked.
    pub fn take_uploaded(&mut self) -> u64 {
        self.cut.take_uploaded()
    }

    /// Returns the cut.
    pub fn cut(&self) -> &GpuCut {
        &self.cut
    }

    pub(super) fn bounds(&self) -> Bounds {
        self.bounds
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

    /// Sets what dissolves as the placement of the whole is set by `set`, with the share of its
    /// pixels that is shown.
    pub(super) fn place_fade(&self, set: impl Fn(&Placement, f32)) {
        let t = (self.fade_s / FADE_S).clamp(0.0, 1.0);
        set(&self.fading[0], t - 1.0);
        set(&self.fading[1], t);
    }
}
