//! The interface of both engines to [`Simplifier`](crate::Simplifier).

use std::sync::Arc;

use meshlod_mesh::Mesh;
use meshlod_spatial::{Bvh, Mates};

use crate::engine::policy::{Observe, Stop};
use crate::excess::Excess;
use crate::held::Held;
use crate::history::volume::VolumeLoss;
use crate::kernel::retrace::Retrace;
use crate::options::{Contractions, HandleCounts};
use crate::refusal::Refusals;
use crate::surface::Surface;
use crate::surface::level::level;

/// A running simplification, whatever its algorithm.
pub(crate) trait Run {
    /// Contracts until a limit of `stop` is reached or no candidate is allowed.
    fn run(&mut self, stop: &Stop, observer: &mut dyn Observe);
    /// Contracts as [`run`](Self::run) does, for the last time, and returns the counts and the number
    /// of faces left. What no more contractions need may be freed before the observer sees these.
    fn run_out(mut self: Box<Self>, stop: &Stop, observer: &mut dyn Observe) -> (Tally, usize) {
        self.run(stop, observer);
        (self.tally(), self.live_faces())
    }
    /// Makes one contraction. Returns false if no candidate is allowed at this cost.
    fn step(&mut self, stop: &Stop, observer: &mut dyn Observe) -> bool;
    /// Returns the cost of the next candidate, before any check.
    fn next_cost(&mut self) -> Option<f64>;
    /// Returns the number of faces left.
    fn live_faces(&self) -> usize;
    fn surface(&self) -> &Surface;
    fn into_surface(self: Box<Self>) -> Surface;
    /// Returns the input mesh in its current state.
    fn level(&self, mesh: &Mesh) -> Mesh {
        level(mesh, self.surface())
    }
    /// Returns the input mesh in its current state, repaid as far as possible the volume that
    /// contractions owe, and the volume repaid, in cubic model units.
    fn settled_level(&self, mesh: &Mesh) -> (Mesh, f64) {
        (self.level(mesh), 0.0)
    }
    /// Returns the hierarchy over the faces of the input, and which of them share edges, if an error
    /// was measured by them.
    fn hierarchy(&self) -> Option<(Arc<Bvh>, Arc<Mates>)> {
        None
    }
    fn tally(&self) -> Tally;
    /// Chooses the contractions to take back because of faces that are too far away; `None` if that
    /// is not possible. Afterwards only a fresh run that [follows](Self::follow) may go on.
    fn retrace(&mut self, _: &[Excess]) -> Option<Retrace> {
        None
    }
    /// Repeats, on the unchanged input, the contractions that are not taken back.
    fn follow(&mut self, _: Retrace) {}
}

/// Counts and totals of a simplification run so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tally {
    /// Number of connected components that have been removed as a whole.
    pub(crate) vanished: usize,
    /// Handles, if any may close.
    pub(crate) handles: Option<HandleCounts>,
    pub(crate) contractions: Contractions,
    pub(crate) refusals: Refusals,
    /// Greatest estimated distance of any contraction from the input, in model units.
    pub(crate) error_estimate: f64,
    /// True if most of the surface can go no further, and the rest has moved far for it.
    pub(crate) near_limit: bool,
    pub(crate) volume: VolumeLoss,
}

/// Numbers of input faces left out and of input vertices held in place.
#[derive(Clone, Copy)]
pub(crate) struct InputSummary {
    pub(crate) degenerate_faces: usize,
    pub(crate) duplicate_faces: usize,
    pub(crate) non_manifold_vertices: usize,
    pub(crate) held: Held,
}

/// A running engine, and the summary of the mesh it works on.
pub(crate) type Started<'m> = (Box<dyn Run + 'm>, InputSummary);

/// Kind of mesh that an engine is started for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// Any mesh.
    All,
    /// A mesh without non-manifold vertices.
    Manifold,
}
