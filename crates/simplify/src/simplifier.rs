//! Incremental simplification: runs to a target, returns the level, and can continue from there.

use std::sync::Arc;

use meshlod_mesh::{Bounds, Mesh, VertexId};
use meshlod_spatial::{Bvh, Mates};

use crate::clean;
use crate::engine::locks;
use crate::engine::policy::{Observe, Stop};
use crate::engine::prepared_surface::PreparedSurface;
use crate::engine::vanishing::Vanishing;
use crate::excess::Excess;
use crate::history::volume::VolumeLoss;
use crate::kernel::{self, PlaneDistance, SweptVolume};
use crate::method::Method;
use crate::methods;
use crate::options::{Options, Report, SimplifyError, Target, Topology};
use crate::run::{InputSummary, Run, Started, Tally, Wanted};
use crate::surface::Surface;
use crate::surface::rims::Rims;

/// Bounding-box diagonals that can be worked with. Costs grow with up to the sixth power of a
/// length and checks with the eighth; outside this range doubles would overflow or underflow.
const EXTENTS: std::ops::RangeInclusive<f64> = 1e-30..=1e30;

/// Incremental simplification of one mesh, whose successive levels are nested: each is made from
/// the previous one.
pub struct Simplifier<'m> {
    mesh: &'m Mesh,
    engine: Box<dyn Run + 'm>,
    options: Options,
    input: InputSummary,
}

impl<'m> Simplifier<'m> {
    /// Builds the connectivity of the mesh and the costs of its contractions, without contracting
    /// anything yet.
    ///
    /// The method alone decides which engine runs: the kernel for [`Method::LindstromTurk`] and
    /// [`Method::Qem`], the policy engine for the others.
    ///
    /// # Errors
    /// The mesh, its extent, the locks or an option is invalid, or no face has three different
    /// vertices.
    pub fn new(mesh: &'m Mesh, options: &Options) -> Result<Self, SimplifyError> {
        let bounds = validate(mesh, options)?;
        let (engine, input) = start(mesh, &bounds, options)?;
        Ok(Self { mesh, engine, options: options.clone(), input })
    }

    /// Builds what [`new`](Self::new) does, or returns `None` if the mesh has a non-manifold vertex,
    /// which a caller may want to [split](meshlod_mesh::condition) first.
    ///
    /// Cost: a small part of that of [`new`](Self::new) where it returns `None`.
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn of_manifold(mesh: &'m Mesh, options: &Options) -> Result<Option<Self>, SimplifyError> {
        let bounds = validate(mesh, options)?;
        let started = start_wanted(mesh, &bounds, (options, Wanted::Manifold))?;
        Ok(started.map(|(engine, input)| Self { mesh, engine, options: options.clone(), input }))
    }

    /// Prepares any method to run on the policy engine. Tests use it to compare the kernel with
    /// general versions of its two methods.
    ///
    /// # Errors
    /// The mesh, its extent, the locks or an option is invalid, or no face has three different
    /// vertices.
    #[cfg(feature = "oracle")]
    pub fn on_policy_engine(mesh: &'m Mesh, options: &Options) -> Result<Self, SimplifyError> {
        validate(mesh, options)?;
        let method = options.method;
        let started = by_policies(mesh, method, (options, Wanted::All))?;
        let (engine, input) = started.expect("any mesh is wanted");
        Ok(Self { mesh, engine, options: options.clone(), input })
    }

    /// Returns the mesh that is being simplified, as it was given.
    pub fn input(&self) -> &'m Mesh {
        self.mesh
    }

    /// Returns the hierarchy over the faces of the input, and which of them share edges, if a run
    /// within an error has measured distances by them.
    pub fn hierarchy(&self) -> Option<(Arc<Bvh>, Arc<Mates>)> {
        self.engine.hierarchy()
    }

    /// Contracts edges or faces until the target is reached or no contraction is allowed any more.
    ///
    /// # Errors
    /// The target is out of range.
    pub fn run(
        &mut self,
        target: Target,
        observer: &mut dyn Observe,
    ) -> Result<Report, SimplifyError> {
        let stop = self.stop(target)?;
        self.engine.run(&stop, observer);
        Ok(self.report(target, &stop))
    }

    /// Contracts as far as possible, as [`run`](Self::run) to no faces does, and ends.
    ///
    /// The kernel frees its vertices before it shows the contractions to the observer, who thus takes
    /// their place in memory: about 130 bytes a face.
    pub fn run_out(self, observer: &mut dyn Observe) -> Report {
        let Self { mesh, engine, options, input } = self;
        let done = engine.run_out(&Stop { faces: 0, ..Stop::NEVER }, observer);
        report((mesh, options.method, &input), Target::Faces(0), 0, done)
    }

    /// Contracts within an error as [`run`](Self::run) does, for a caller who compares the level with
    /// the input and [takes back](Self::take_back) what is beyond: it takes about two thirds of
    /// the time, and places have been up to 2.3 times as far away: docs/notes/kernel.md has figures.
    ///
    /// # Errors
    /// The error is out of range.
    pub fn run_to_compare(
        &mut self,
        error: f64,
        observer: &mut dyn Observe,
    ) -> Result<Report, SimplifyError> {
        let target = Target::Error(error);
        let stop = Stop { is_compared: true, ..self.stop(target)? };
        self.engine.run(&stop, observer);
        Ok(self.report(target, &stop))
    }

    /// Makes the next contraction if it costs at most `most_cost`. Returns false if there was no
    /// such contraction.
    pub fn step(&mut self, most_cost: f64, observer: &mut dyn Observe) -> bool {
        let stop = Stop { cost: most_cost, ..Stop::NEVER };
        self.engine.step(&stop, observer)
    }

    /// Makes the next contraction on the way to a target. Returns false if the target is reached or
    /// there was no such contraction.
    /// # Errors
    /// An invalid target.
    pub fn step_to(
        &mut self,
        target: Target,
        observer: &mut dyn Observe,
    ) -> Result<bool, SimplifyError> {
        let stop = self.stop(target)?;
        Ok(self.live_faces() > stop.faces && self.engine.step(&stop, observer))
    }

    /// Takes back the contractions that made faces too far away, and those that depend on them. A
    /// run to the same [`Target::Error`] then goes on from there, with a lower bound at these places
    /// and no change elsewhere.
    ///
    /// `excess` is what a comparison of the [level](Self::level) with the input has found. Returns
    /// false, with nothing changed, if that is not possible: on the policy engine, with ties, where
    /// an observer has seen contractions, where some were made without a bound, or if none made any
    /// of the faces.
    ///
    /// Cost: about that of a run without a bound.
    pub fn take_back(&mut self, excess: &[Excess]) -> bool {
        let Some(retrace) = self.engine.retrace(excess) else { return false };
        let bounds = self.mesh.bounds();
        let (mut engine, _) = start(self.mesh, &bounds, &self.options)
            .expect("the same mesh and options have been started before");
        engine.follow(retrace);
        self.engine = engine;
        true
    }

    /// Returns the cost of the next candidate for contraction in the units of the method, see
    /// [`Method::cost_power`](crate::Method::cost_power); `None` if no candidate is left.
    ///
    /// The candidate may still be refused, so the next contraction costs at least this.
    pub fn next_cost(&mut self) -> Option<f64> {
        self.engine.next_cost()
    }

    /// Returns the current surface, with the vertex and face ids of the input.
    ///
    /// The kernel builds it on the first call and then keeps it up to date while observers watch.
    /// In a removed face, each corner is the vertex that it was merged into.
    pub fn surface(&self) -> &Surface {
        self.engine.surface()
    }

    /// Returns the number of faces that the current mesh has.
    pub fn live_faces(&self) -> usize {
        self.engine.live_faces()
    }

    /// Returns the number of non-manifold input vertices, which are kept in place.
    pub fn non_manifold_vertices(&self) -> usize {
        self.input.non_manifold_vertices
    }

    /// Builds the report of the run so far.
    fn report(&self, target: Target, stop: &Stop) -> Report {
        let done = (self.engine.tally(), self.live_faces());
        report((self.mesh, self.options.method, &self.input), target, stop.faces, done)
    }

    fn stop(&self, target: Target) -> Result<Stop, SimplifyError> {
        Ok(match target.valid()? {
            Target::Error(error) => Stop { error, ..Stop::NEVER },
            target => Stop { faces: target.faces_of(self.mesh.faces.len()), ..Stop::NEVER },
        })
    }

    /// Returns the current mesh without unused vertices and wedges; what remains is in the order of
    /// the input.
    pub fn level(&self) -> Mesh {
        self.engine.level(self.mesh)
    }

    /// Returns the current mesh as [`Self::level`] does, but with the volume that
    /// [`Method::LindstromTurk`] still owes repaid by vertices around, which move along their
    /// normals by a small part of an edge.
    ///
    /// Locked and tied vertices and boundaries stay, and so does a debt that no small move repays.
    /// A run to [`Target::Error`] owes its bound more than its volume, and repays nothing. Histories
    /// have the levels without repayment. Sets [`VolumeLoss::repaid`] of `loss`, the volume of the
    /// run's report, to what the level has been repaid.
    pub fn settled_level(&self, loss: &mut VolumeLoss) -> Mesh {
        let (level, repaid) = self.engine.settled_level(self.mesh);
        loss.repaid = repaid;
        level
    }

    /// Returns the number of input faces without those left out as degenerate or duplicate.
    pub(crate) fn first_faces(&self) -> usize {
        self.mesh.faces.len() - self.input.degenerate_faces - self.input.duplicate_faces
    }

    pub(crate) fn into_surface(self) -> (&'m Mesh, Surface) {
        (self.mesh, self.engine.into_surface())
    }
}

/// Builds the report of a run to a target that allows `most` faces, from what was done and the number
/// of faces left.
fn report(
    (mesh, method, input): (&Mesh, Method, &InputSummary),
    target: Target,
    most: usize,
    (tally, output_faces): (Tally, usize),
) -> Report {
    let Tally { vanished, handles, contractions, refusals, error_estimate, near_limit, volume } =
        tally;
    Report {
        method,
        input_faces: mesh.faces.len(),
        degenerate_faces: input.degenerate_faces,
        duplicate_faces: input.duplicate_faces,
        non_manifold_vertices: input.non_manifold_vertices,
        held: input.held,
        output_faces,
        contractions,
        vanished,
        handles,
        reached: matches!(target, Target::Error(_)) || output_faces <= most,
        error_estimate,
        near_limit,
        proof: None,
        refusals,
        volume,
    }
}

/// Returns the bounding box of the mesh; refuses meshes and options that no method can work with.
fn validate(mesh: &Mesh, options: &Options) -> Result<Bounds, SimplifyError> {
    mesh.validate()?;
    if mesh.faces.is_empty() {
        return Err(SimplifyError::NoFaces);
    }
    let bounds = mesh.bounds();
    let diagonal = bounds.diagonal();
    if diagonal > 0.0 && !EXTENTS.contains(&diagonal) {
        return Err(SimplifyError::Extent { diagonal });
    }
    locks::validate(&options.locks, mesh)?;
    options.validate()?;
    if let Some(size) = options.vanish_below.filter(|size| size.is_nan() || *size < 0.0) {
        return Err(SimplifyError::BadSize(size));
    }
    Ok(bounds)
}

/// Starts the engine of the method on a valid mesh.
fn start<'m>(
    mesh: &'m Mesh,
    bounds: &Bounds,
    options: &Options,
) -> Result<Started<'m>, SimplifyError> {
    let started = start_wanted(mesh, bounds, (options, Wanted::All))?;
    Ok(started.expect("any mesh is wanted"))
}

/// Starts the engine of the method on a valid mesh, if it is wanted.
fn start_wanted<'m>(
    mesh: &'m Mesh,
    bounds: &Bounds,
    of: (&Options, Wanted),
) -> Result<Option<Started<'m>>, SimplifyError> {
    match of.0.method {
        Method::LindstromTurk => kernel::start(SweptVolume, mesh, bounds, of),
        Method::Qem => kernel::start(PlaneDistance, mesh, bounds, of),
        method => by_policies(mesh, method, of),
    }
}

/// Starts the policy engine on a valid mesh, if it is wanted.
fn by_policies<'m>(
    mesh: &'m Mesh,
    method: Method,
    (options, wanted): (&Options, Wanted),
) -> Result<Option<Started<'m>>, SimplifyError> {
    let (connectivity, duplicate_faces) = clean::connect(mesh);
    let degenerate_faces = connectivity.degenerate_faces() - duplicate_faces;
    if connectivity.edge_count() == 0 {
        return Err(SimplifyError::AllDegenerate(mesh.faces.len()));
    }
    let non_manifold_vertices = (0..mesh.positions.len())
        .filter(|&v| connectivity.marks(VertexId::new(v)).non_manifold())
        .count();
    if wanted == Wanted::Manifold && non_manifold_vertices > 0 {
        return Ok(None);
    }
    let mut surface = Surface::new(mesh, &connectivity);
    surface.rims = Rims::new(mesh, &connectivity);
    let held = locks::apply(options, &connectivity, &mut surface);
    let input = InputSummary { degenerate_faces, duplicate_faces, non_manifold_vertices, held };
    let below = options.vanish_below.filter(|_| options.topology == Topology::Free);
    let vanishing = Vanishing::new(&surface, method, below);
    let engine =
        methods::start(method, options, PreparedSurface { surface, connectivity, vanishing });
    Ok(Some((engine, input)))
}
