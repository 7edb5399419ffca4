//! A mesh being simplified: run it to a target, take the level, run on.

use meshlod_mesh::{Mesh, VertexId};

use crate::algorithms;
use crate::clean;
use crate::engine::Engine;
use crate::level::level;
use crate::options::{Options, Report, SimplifyError, Target};
use crate::policy::{Candidates, Memory, Observe, Placement, Priority, Stop};
use crate::refusal::Refusals;
use crate::surface::{Flags, Surface};

/// A mesh at work. Levels taken from one run are nested: each comes from the one before.
pub struct Simplifier<'m> {
    mesh: &'m Mesh,
    engine: Box<dyn Run>,
    input: Input,
}

/// What was found in the input.
#[derive(Clone, Copy)]
struct Input {
    degenerate_faces: usize,
    duplicate_faces: usize,
    non_manifold_vertices: usize,
}

/// An engine with its algorithm erased.
pub(crate) trait Run {
    fn run(&mut self, stop: &Stop, observer: &mut dyn Observe);
    fn step(&mut self, stop: &Stop, observer: &mut dyn Observe) -> bool;
    fn next_cost(&mut self) -> Option<f64>;
    fn surface(&self) -> &Surface;
    fn into_surface(self: Box<Self>) -> Surface;
    fn refusals(&self) -> Refusals;
    fn error_estimate(&self) -> f64;
}

impl<C, M, P, L> Run for Engine<C, M, P, L>
where
    C: Candidates,
    M: Memory,
    P: Priority<M>,
    L: Placement<M>,
{
    fn run(&mut self, stop: &Stop, observer: &mut dyn Observe) {
        Engine::run(self, stop, observer);
    }

    fn step(&mut self, stop: &Stop, observer: &mut dyn Observe) -> bool {
        Engine::step(self, stop, observer)
    }

    fn next_cost(&mut self) -> Option<f64> {
        Engine::next_cost(self)
    }

    fn surface(&self) -> &Surface {
        Engine::surface(self)
    }

    fn into_surface(self: Box<Self>) -> Surface {
        Engine::into_surface(*self)
    }

    fn refusals(&self) -> Refusals {
        Engine::refusals(self)
    }

    fn error_estimate(&self) -> f64 {
        Engine::error_estimate(self)
    }
}

impl<'m> Simplifier<'m> {
    /// Connects the mesh and costs its candidates; nothing is contracted yet.
    pub fn new(mesh: &'m Mesh, options: &Options) -> Result<Self, SimplifyError> {
        mesh.validate()?;
        if mesh.faces.is_empty() {
            return Err(SimplifyError::NoFaces);
        }
        let expected = mesh.positions.len();
        if !options.locked.is_empty() && options.locked.len() != expected {
            return Err(SimplifyError::BadMask { found: options.locked.len(), expected });
        }
        let (connectivity, duplicate_faces) = clean::connect(mesh);
        let degenerate_faces = connectivity.degenerate_faces() - duplicate_faces;
        if connectivity.edge_count() == 0 {
            return Err(SimplifyError::AllDegenerate(mesh.faces.len()));
        }
        let vertices = || (0..expected).map(VertexId::new);
        let non_manifold_vertices =
            vertices().filter(|&v| connectivity.marks(v).non_manifold()).count();
        let mut surface = Surface::new(mesh, &connectivity);
        for v in vertices() {
            let locked = options.locked.get(v.index()).is_some_and(|&locked| locked);
            if locked || (options.lock_boundary && connectivity.marks(v).boundary()) {
                surface.flag(v, Flags::PINNED);
            }
        }
        let input = Input { degenerate_faces, duplicate_faces, non_manifold_vertices };
        Ok(Self { mesh, engine: algorithms::start(options.method, surface, connectivity), input })
    }

    /// Contracts until the target is reached or nothing more may be contracted.
    pub fn run(
        &mut self,
        target: Target,
        observer: &mut dyn Observe,
    ) -> Result<Report, SimplifyError> {
        let stop = self.stop(target)?;
        self.engine.run(&stop, observer);
        Ok(self.report(target, &stop))
    }

    /// Makes the one next contraction that costs at most `most_cost`; false when none may be made.
    pub fn step(&mut self, most_cost: f64, observer: &mut dyn Observe) -> bool {
        self.engine.step(&Stop { cost: most_cost, ..Stop::NEVER }, observer)
    }

    /// The cost of the candidate that is tried next, in the method's own terms (for quadrics:
    /// squared distance times area); `None` when no candidate is left.
    ///
    /// It may turn out refused: the contraction that is made next costs this or more.
    pub fn next_cost(&mut self) -> Option<f64> {
        self.engine.next_cost()
    }

    /// How many faces are left.
    pub fn live_faces(&self) -> usize {
        self.engine.surface().live_faces()
    }

    /// What was done so far.
    fn report(&self, target: Target, stop: &Stop) -> Report {
        let output_faces = self.live_faces();
        let reached = matches!(target, Target::Error(_)) || output_faces <= stop.faces;
        Report {
            input_faces: self.mesh.faces.len(),
            degenerate_faces: self.input.degenerate_faces,
            duplicate_faces: self.input.duplicate_faces,
            non_manifold_vertices: self.input.non_manifold_vertices,
            output_faces,
            reached,
            error_estimate: self.engine.error_estimate(),
            refusals: self.engine.refusals(),
        }
    }

    fn stop(&self, target: Target) -> Result<Stop, SimplifyError> {
        let all = self.mesh.faces.len();
        match target {
            Target::Faces(faces) => Ok(Stop { faces, ..Stop::NEVER }),
            Target::Ratio(ratio) if (0.0..=1.0).contains(&ratio) => {
                // Never more than asked for, but 29 % of 100 is 29.
                let faces = (all as f64 * ratio + 1e-6).floor() as usize;
                Ok(Stop { faces, ..Stop::NEVER })
            }
            Target::Error(error) if error >= 0.0 => Ok(Stop { error, ..Stop::NEVER }),
            Target::Ratio(bad) | Target::Error(bad) => Err(SimplifyError::BadTarget(bad)),
        }
    }

    /// The mesh as it is now: unused vertices and wedges left out, the rest in the input's order.
    pub fn level(&self) -> Mesh {
        level(self.mesh, self.engine.surface())
    }

    pub(crate) fn into_surface(self) -> (&'m Mesh, Surface) {
        (self.mesh, self.engine.into_surface())
    }
}
