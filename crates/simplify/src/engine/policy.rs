//! Policies that define a simplification algorithm for the engine.
//!
//! | policy | decides |
//! |---|---|
//! | [`Candidates`] | the edges and faces that may be contracted, and updates to them |
//! | [`Priority`] | the cost of a candidate, or that it is never contracted |
//! | [`Placement`] | the position of the new vertex, or a refusal |
//! | [`Stop`] | when the run ends |
//! | [`Observe`] | nothing: it watches contractions before and after |
//!
//! Priority and placement share a [`Memory`]: the data that the algorithm keeps per vertex.

use meshlod_mesh::{Connectivity, FaceId, VertexId};

use crate::refusal::Refusal;
use crate::surface::candidate_states::CandidateId;
use crate::surface::contracted::{Contracted, Freedom};
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Placed, Surface};

/// Policy that chooses the edges and faces that may be contracted.
pub(crate) trait Candidates: Sync {
    /// Returns the candidates of an untouched surface, each once.
    fn seed(&self, surface: &Surface, connectivity: &Connectivity) -> Vec<CandidateId>;

    /// Returns the vertices that contracting the candidate would merge.
    fn vertices(&self, surface: &Surface, id: CandidateId) -> Contracted;

    /// Opens alternatives to a refused candidate.
    fn refused(&self, id: CandidateId, sink: &mut dyn CandidateSink) {
        let _ = (id, sink);
    }

    /// Updates the candidates after a contraction: closes those of removed faces, and ensures that
    /// each remaining one is open exactly once.
    fn update(&self, neighbourhood: &Neighbourhood, kept: VertexId, sink: &mut dyn CandidateSink);
}

/// Set of candidates open for contraction, as a [`Candidates`] policy updates it.
pub(crate) trait CandidateSink {
    /// Returns the surface of the candidates.
    fn surface(&self) -> &Surface;
    /// Returns true if the candidate is open.
    fn is_open(&self, id: CandidateId) -> bool;
    /// Opens a candidate.
    fn open(&mut self, id: CandidateId);
    /// Closes a candidate.
    fn close(&mut self, id: CandidateId);
}

/// Data that an algorithm keeps per vertex, such as quadrics; `()` if it keeps none.
pub(crate) trait Memory: Sync {
    /// True if a vertex's data changes with the faces around it, so that a contraction makes the
    /// costs along its whole ring stale.
    const KNOWS_RING: bool = false;

    /// Updates the data just before a contraction changes the surface.
    fn merge(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        let _ = (surface, neighbourhood, placed);
    }

    /// Updates the data just after a contraction; `neighbourhood` is as gathered before it.
    fn renew(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        let _ = (surface, neighbourhood, placed);
    }
}

impl Memory for () {}

/// Policy that decides the order of contractions by their costs.
pub(crate) trait Priority<M>: Sync {
    /// Returns the cost of a candidate, which is contracted lowest first; `None` means never.
    ///
    /// Between contractions the cost of a candidate may rise unnoticed. If it falls, that may be
    /// noticed late.
    fn cost(&self, surface: &Surface, memory: &M, of: &Contracted, freedom: Freedom)
    -> Option<f64>;
}

/// Policy that positions the new vertex of a contraction.
pub(crate) trait Placement<M>: Sync {
    /// Places the new vertex within the neighbourhood's freedom. The error estimate covers this
    /// contraction alone; the engine adds the accumulated error.
    fn place(
        &self,
        surface: &Surface,
        memory: &M,
        neighbourhood: &Neighbourhood,
    ) -> Result<Placed, Refusal>;
}

/// Limits at which a simplification run stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stop {
    /// Number of faces at which the run stops.
    pub(crate) faces: usize,
    /// Largest estimated error allowed, in model units; contractions above it are refused.
    pub(crate) error: f64,
    /// Largest cost of the next contraction at which the run goes on.
    pub(crate) cost: f64,
    /// True if the caller compares the level with the input, so that less has to be measured.
    pub(crate) is_compared: bool,
}

impl Stop {
    /// Limits that never stop a simplification run.
    pub(crate) const NEVER: Self =
        Self { faces: 0, error: f64::INFINITY, cost: f64::INFINITY, is_compared: false };
}

/// Observer of the contractions of a simplification. All methods do nothing by default.
///
/// Observers see edges only: a face is contracted as two edges, the second through the vertex of
/// the first. They see the contractions in order, each with the surface as it was at that moment.
/// The kernel shows all contractions of a run at its end.
pub trait Observe {
    /// Returns true if the observer needs to see contractions. Otherwise only [`gone`](Self::gone)
    /// may be called, and the kernel need not build a surface to show.
    fn needs_surface(&self) -> bool {
        true
    }

    /// Called when `faces` more faces are gone, by one contraction or several.
    fn gone(&mut self, faces: usize) {
        let _ = faces;
    }

    /// Called before a face is contracted: the next two contractions are its edges, to one
    /// position.
    fn face(&mut self) {}

    /// Called before a contraction changes `surface`.
    fn before(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        let _ = (surface, neighbourhood, placed);
    }

    /// Called after a contraction has changed `surface`.
    fn after(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        let _ = (surface, neighbourhood, placed);
    }

    /// Called before a component vanishes as a whole; `faces` are its remaining faces.
    fn vanish(&mut self, surface: &Surface, faces: &[FaceId]) {
        let _ = (surface, faces);
    }
}

impl Observe for () {
    fn needs_surface(&self) -> bool {
        false
    }
}

impl<A: Observe, B: Observe> Observe for (A, B) {
    fn needs_surface(&self) -> bool {
        self.0.needs_surface() || self.1.needs_surface()
    }

    fn gone(&mut self, faces: usize) {
        self.0.gone(faces);
        self.1.gone(faces);
    }

    fn face(&mut self) {
        self.0.face();
        self.1.face();
    }

    fn before(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        self.0.before(surface, neighbourhood, placed);
        self.1.before(surface, neighbourhood, placed);
    }

    fn after(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        self.0.after(surface, neighbourhood, placed);
        self.1.after(surface, neighbourhood, placed);
    }

    fn vanish(&mut self, surface: &Surface, faces: &[FaceId]) {
        self.0.vanish(surface, faces);
        self.1.vanish(surface, faces);
    }
}

impl<O: Observe + ?Sized> Observe for &mut O {
    fn needs_surface(&self) -> bool {
        (**self).needs_surface()
    }

    fn gone(&mut self, faces: usize) {
        (**self).gone(faces);
    }

    fn face(&mut self) {
        (**self).face();
    }

    fn before(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        (**self).before(surface, neighbourhood, placed);
    }

    fn after(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        (**self).after(surface, neighbourhood, placed);
    }

    fn vanish(&mut self, surface: &Surface, faces: &[FaceId]) {
        (**self).vanish(surface, faces);
    }
}
