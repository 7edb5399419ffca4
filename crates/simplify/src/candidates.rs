//! Edges as candidates.

use meshlod_mesh::{Connectivity, FaceId};

use crate::contracted::Contracted;
use crate::neighbourhood::{Neighbourhood, Spoke};
use crate::policy::{Books, Candidates};
use crate::surface::Surface;

/// A candidate by number: side k of face f, from corner k to corner k + 1, is 3f + k; a face is its
/// side 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CandidateId(pub(crate) u32);

impl CandidateId {
    #[inline]
    pub(crate) fn side(face: FaceId, k: usize) -> Self {
        Self(face.0 * 3 + k as u32)
    }

    #[inline]
    pub(crate) fn face(self) -> FaceId {
        FaceId(self.0 / 3)
    }

    #[inline]
    pub(crate) fn corner(self) -> usize {
        (self.0 % 3) as usize
    }
}

/// Every edge, by one of its sides.
///
/// A side lives as long as its face, whatever becomes of its vertices. So a contraction moves no
/// candidate; it only ends those of the dying faces, and where two edges fall together it keeps one
/// side of the two.
pub(crate) struct Edges;

impl Candidates for Edges {
    fn seed(&self, _: &Surface, connectivity: &Connectivity) -> Vec<CandidateId> {
        connectivity.edges().map(|side| CandidateId::side(side.face(), side.corner())).collect()
    }

    #[inline]
    fn vertices(&self, surface: &Surface, id: CandidateId) -> Contracted {
        let face = surface.face(id.face());
        let k = id.corner();
        Contracted::edge([face[k], face[(k + 1) % 3]])
    }

    fn settle(&self, hood: &Neighbourhood, books: &mut dyn Books) {
        for dying in &hood.dying {
            (0..3).for_each(|k| books.close(CandidateId::side(dying.face, k)));
        }
        for wing in hood.dying.iter().filter_map(|dying| dying.apex()) {
            keep_one(hood, wing as u32, books);
        }
    }
}

/// Leaves one open side on the edge from the new vertex to a wing.
fn keep_one(hood: &Neighbourhood, wing: u32, books: &mut dyn Books) {
    let side = |spoke: &Spoke| {
        let k = if spoke.a == wing { spoke.corner() } else { (spoke.corner() + 2) % 3 };
        (spoke.a == wing || spoke.b == wing).then(|| CandidateId::side(spoke.face, k))
    };
    let mut first = None;
    let mut open = false;
    for side in hood.spokes.iter().filter_map(side) {
        first = first.or(Some(side));
        if open {
            books.close(side);
        }
        open |= books.is_open(side);
    }
    if let (Some(side), false) = (first, open) {
        books.open(side);
    }
}
