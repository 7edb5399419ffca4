//! A mesh at work by the fast engine, as [`Simplifier`](crate::Simplifier) has it.

use std::cell::OnceCell;

use meshlod_mesh::Mesh;

use crate::clean;
use crate::engine::{Run, Tally};
use crate::fast::engine::Engine;
use crate::fast::frame::Frame;
use crate::fast::level::{level, workspace};
use crate::fast::log::{Names, replay};
use crate::fast::queue::{NONE, bucket, least_of};
use crate::policy::{Observe, Stop};
use crate::refusal::Refusal;
use crate::surface::Surface;

/// How many faces go between two calls of an observer that wants to know how many.
const FACES_A_CALL: usize = 8192;

/// A mesh at work.
pub(super) struct Work<'m> {
    mesh: &'m Mesh,
    frame: Frame,
    /// The faces on copies of vertices, where there are any.
    faces: Option<Vec<[u32; 3]>>,
    engine: Engine,
    /// The narrowest bound of the error that has refused an edge since all were awake.
    refused_above: f64,
    /// As it is now, if anybody has looked since it last changed unseen.
    surface: OnceCell<Surface>,
}

impl<'m> Work<'m> {
    pub(super) fn new(
        mesh: &'m Mesh,
        frame: Frame,
        faces: Option<Vec<[u32; 3]>>,
        engine: Engine,
    ) -> Self {
        let (refused_above, surface) = (f64::INFINITY, OnceCell::new());
        Self { mesh, frame, faces, engine, refused_above, surface }
    }

    fn names(&self) -> Names<'_> {
        Names { mesh: self.mesh, frame: &self.frame, vertices: &self.engine.vertices }
    }

    /// What the engine's costs are multiplied by in model units.
    fn cost_unit(&self) -> f64 {
        self.frame.unit.powi(6)
    }

    /// The last bucket with something that costs no more than this. The cost of a bucket is the least
    /// in it, so that what [`Run::next_cost`] tells is always enough to go on.
    fn last_bucket(&self, cost: f64) -> u16 {
        let unit = self.cost_unit();
        let costs_at_most = |bucket: u16| f64::from(least_of(bucket)) * unit <= cost;
        // The division may have rounded either way.
        let about = bucket((cost / unit) as f32);
        let near = [about.saturating_add(1), about, about.saturating_sub(1)];
        match about {
            NONE => NONE,
            _ => near.into_iter().find(|&b| b < NONE && costs_at_most(b)).unwrap_or(0),
        }
    }

    /// Lets those try again that a narrower bound of the error has refused.
    fn try_again_within(&mut self, error: f64) {
        if error > self.refused_above {
            self.refused_above = f64::INFINITY;
            self.engine.wake_all();
        }
    }

    /// Goes on to so many faces, and shows the observer what it wants to see.
    fn advance(&mut self, faces: usize, stop: &Stop, observer: &mut dyn Observe) {
        let is_shown = observer.needs_surface();
        if is_shown {
            self.surface();
            self.engine.log = Some(Vec::new());
        }
        self.try_again_within(stop.error);
        self.engine.most_error = (stop.error / self.frame.unit).powi(2);
        let last = self.last_bucket(stop.cost);
        let refused = |engine: &Engine| engine.refusals.count(Refusal::Error);
        let (refused_before, at_first) = (refused(&self.engine), self.engine.live_faces);
        loop {
            let before = self.engine.live_faces;
            self.engine.run(faces.max(before.saturating_sub(FACES_A_CALL)), last);
            let gone = before - self.engine.live_faces;
            observer.gone(gone);
            if gone < FACES_A_CALL || self.engine.live_faces <= faces {
                break;
            }
        }
        if refused(&self.engine) > refused_before {
            self.refused_above = self.refused_above.min(stop.error);
        }
        match (self.engine.log.take(), self.surface.take()) {
            (Some(log), Some(mut surface)) => {
                replay(&log, self.names(), &mut surface, observer);
                self.surface = surface.into();
            }
            (_, surface) if self.engine.live_faces == at_first => {
                self.surface = surface.map_or_else(OnceCell::new, OnceCell::from);
            }
            _ => {}
        }
    }
}

impl Run for Work<'_> {
    fn run(&mut self, stop: &Stop, observer: &mut dyn Observe) {
        self.advance(stop.faces, stop, observer);
    }

    fn step(&mut self, stop: &Stop, observer: &mut dyn Observe) -> bool {
        let before = self.engine.live_faces;
        self.advance(before.saturating_sub(1), stop, observer);
        self.engine.live_faces < before
    }

    fn next_cost(&mut self) -> Option<f64> {
        self.try_again_within(f64::INFINITY);
        let bucket = self.engine.next_bucket()?;
        Some(f64::from(least_of(bucket)) * self.cost_unit())
    }

    fn live_faces(&self) -> usize {
        self.engine.live_faces
    }

    fn level(&self, _: &Mesh) -> Mesh {
        level(self.names(), self.faces.as_deref())
    }

    fn surface(&self) -> &Surface {
        self.surface.get_or_init(|| {
            let mesh = workspace(self.names(), self.faces.as_deref());
            let (connectivity, _) = clean::connect(&mesh);
            Surface::new(&mesh, &connectivity)
        })
    }

    fn into_surface(self: Box<Self>) -> Surface {
        self.surface();
        self.surface.into_inner().expect("it was made just now")
    }

    fn tally(&self) -> Tally {
        Tally {
            vanished: 0,
            refusals: self.engine.refusals,
            error_estimate: self.engine.error.sqrt() * self.frame.unit,
            volume: self.engine.volume.loss(&self.frame),
        }
    }
}
