//! The policies. An algorithm is a choice of them; the engine asks, they answer.
//!
//! | policy | answers |
//! |---|---|
//! | [`Candidates`] | what may be contracted, and what to ask again after a contraction |
//! | [`Priority`] | the cost of a candidate, or "never" |
//! | [`Placement`] | where the new vertex goes, or "cannot" |
//! | [`Stop`] | enough |
//! | [`Observe`] | hooks before and after |
//!
//! Priority and placement share a [`Memory`]: what the algorithm keeps per vertex.

use meshlod_mesh::{Connectivity, FaceId, VertexId};

use crate::engine::candidates::CandidateId;
use crate::refusal::Refusal;
use crate::surface::contracted::{Contracted, Freedom};
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Placed, Surface};

/// What may be contracted.
pub(crate) trait Candidates: Sync {
    /// The candidates of an untouched surface, each once.
    fn seed(&self, surface: &Surface, connectivity: &Connectivity) -> Vec<CandidateId>;

    /// The vertices that the candidate would make one.
    fn vertices(&self, surface: &Surface, id: CandidateId) -> Contracted;

    /// After a refusal: opens what may go in its place.
    fn refused(&self, id: CandidateId, books: &mut dyn Books) {
        let _ = (id, books);
    }

    /// After a contraction: closes the candidates that went with their faces, and sees to it that
    /// each of the others is on the books once.
    fn settle(&self, hood: &Neighbourhood, kept: VertexId, books: &mut dyn Books);
}

/// The engine's books of which candidates are waiting.
pub(crate) trait Books {
    /// The surface that they are on.
    fn surface(&self) -> &Surface;
    /// Whether the candidate is waiting.
    fn is_open(&self, id: CandidateId) -> bool;
    /// Puts a candidate on the books.
    fn open(&mut self, id: CandidateId);
    /// Takes a candidate off the books.
    fn close(&mut self, id: CandidateId);
}

/// What an algorithm keeps per vertex, such as quadrics. `()` for the memoryless.
pub(crate) trait Memory: Sync {
    /// Whether what is kept of a vertex changes with the faces around it, so that a contraction
    /// makes costs stale all along its ring.
    const KNOWS_RING: bool = false;

    /// Told of a contraction just before the surface changes.
    fn merge(&mut self, surface: &Surface, hood: &Neighbourhood, placed: &Placed) {
        let _ = (surface, hood, placed);
    }

    /// Told of it again just after. `hood` is as it was gathered before.
    fn renew(&mut self, surface: &Surface, hood: &Neighbourhood, placed: &Placed) {
        let _ = (surface, hood, placed);
    }
}

impl Memory for () {}

/// The order of contractions.
pub(crate) trait Priority<M>: Sync {
    /// The cost of a candidate, lowest first; `None` is never. Between contractions the cost of a
    /// candidate may rise unseen; if it falls, that may be noticed late.
    fn cost(&self, surface: &Surface, memory: &M, of: &Contracted, freedom: Freedom)
    -> Option<f64>;
}

/// The place of the new vertex.
pub(crate) trait Placement<M>: Sync {
    /// Where the new vertex goes, within the neighbourhood's freedom. Its error is what the method
    /// itself says of this contraction alone; the engine adds what it sees.
    fn place(&self, surface: &Surface, memory: &M, hood: &Neighbourhood)
    -> Result<Placed, Refusal>;
}

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stop {
    /// Enough when no more faces than this are left.
    pub(crate) faces: usize,
    /// Contractions estimated to move the surface further than this, in model units, are refused.
    pub(crate) error: f64,
    /// Enough when the next contraction costs more than this.
    pub(crate) cost: f64,
}

impl Stop {
    /// Goes on while anything may be contracted.
    pub(crate) const NEVER: Self = Self { faces: 0, error: f64::INFINITY, cost: f64::INFINITY };
}

/// Hooks into the engine's loop. All do nothing unless written.
///
/// They see edges only: a face is contracted as two edges, the second through the first's vertex.
/// They see them in their order, with the surface as it was at each; an engine that keeps no surface
/// shows all of a run at its end.
pub trait Observe {
    /// Whether it wants to see contractions. If not, only [`gone`](Self::gone) may be called: the fast
    /// engine spares making a surface to show.
    fn needs_surface(&self) -> bool {
        true
    }

    /// So many faces more are gone, by one contraction or by several.
    fn gone(&mut self, faces: usize) {
        let _ = faces;
    }

    /// A face is about to be contracted: the next two contractions are its edges, to one place.
    fn face(&mut self) {}

    /// A contraction is about to change `surface`.
    fn before(&mut self, surface: &Surface, hood: &Neighbourhood, placed: &Placed) {
        let _ = (surface, hood, placed);
    }

    /// The contraction is done.
    fn after(&mut self, surface: &Surface, hood: &Neighbourhood, placed: &Placed) {
        let _ = (surface, hood, placed);
    }

    /// A component is about to vanish as a whole: these are the faces that are left of it.
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

    fn before(&mut self, surface: &Surface, hood: &Neighbourhood, placed: &Placed) {
        self.0.before(surface, hood, placed);
        self.1.before(surface, hood, placed);
    }

    fn after(&mut self, surface: &Surface, hood: &Neighbourhood, placed: &Placed) {
        self.0.after(surface, hood, placed);
        self.1.after(surface, hood, placed);
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

    fn before(&mut self, surface: &Surface, hood: &Neighbourhood, placed: &Placed) {
        (**self).before(surface, hood, placed);
    }

    fn after(&mut self, surface: &Surface, hood: &Neighbourhood, placed: &Placed) {
        (**self).after(surface, hood, placed);
    }

    fn vanish(&mut self, surface: &Surface, faces: &[FaceId]) {
        (**self).vanish(surface, faces);
    }
}
