//! Candidate policies: contract edges only, or faces, and edges where a face cannot be contracted.

use meshlod_mesh::{Connectivity, FaceId, VertexId};

use crate::engine::policy::{CandidateSink, Candidates};
use crate::surface::candidate_states::CandidateId;
use crate::surface::contracted::Contracted;
use crate::surface::neighbourhood::{Neighbourhood, Spoke};
use crate::surface::{Flags, Surface};

/// Returns the vertices of a candidate.
#[inline]
fn vertices(surface: &Surface, id: CandidateId) -> Contracted {
    let face = surface.face(id.face());
    match id.slot() {
        3 => Contracted::face(face),
        k => Contracted::edge([face[k], face[(k + 1) % 3]]),
    }
}

/// Candidate policy that contracts every edge, represented by one of its sides.
///
/// A side lives as long as its face, whatever becomes of its vertices, so a contraction moves no
/// candidate. It only closes those of removed faces, and keeps one of the two sides where two edges
/// coincide.
pub(crate) struct EdgeCandidates;

impl Candidates for EdgeCandidates {
    fn seed(&self, _: &Surface, connectivity: &Connectivity) -> Vec<CandidateId> {
        connectivity.edges().map(|side| CandidateId::side(side.face(), side.corner())).collect()
    }

    #[inline]
    fn vertices(&self, surface: &Surface, id: CandidateId) -> Contracted {
        vertices(surface, id)
    }

    fn update(&self, neighbourhood: &Neighbourhood, _: VertexId, sink: &mut dyn CandidateSink) {
        close_removed(neighbourhood, sink);
        for wing in neighbourhood.removed_faces.iter().filter_map(|removed| removed.apex()) {
            keep_one(neighbourhood, wing as u32, sink);
        }
    }
}

/// Candidate policy that contracts every face with at most one special corner, and every edge with
/// a special end.
///
/// A face whose corners are inside a chart, off every boundary and free to move is contracted to
/// any position; a face with one special corner is contracted onto it; a face with more is left to
/// its edges.
pub(crate) struct FaceAndEdgeCandidates;

impl Candidates for FaceAndEdgeCandidates {
    fn seed(&self, surface: &Surface, connectivity: &Connectivity) -> Vec<CandidateId> {
        let faces = (0..surface.face_count())
            .map(FaceId::new)
            .filter(|&face| surface.is_alive(face))
            .filter(|&face| {
                surface.face(face).into_iter().filter(|&v| special(surface, v)).count() < 2
            })
            .map(CandidateId::whole);
        let edges = connectivity
            .edges()
            .map(|side| CandidateId::side(side.face(), side.corner()))
            .filter(|&id| vertices(surface, id).iter().any(|&v| special(surface, v)));
        faces.chain(edges).collect()
    }

    #[inline]
    fn vertices(&self, surface: &Surface, id: CandidateId) -> Contracted {
        vertices(surface, id)
    }

    fn refused(&self, id: CandidateId, sink: &mut dyn CandidateSink) {
        if id.slot() == 3 {
            let surface = sink.surface();
            let corners = surface.face(id.face()).map(|v| surface.position(v));
            let length = |k: usize| corners[k].distance_squared(corners[(k + 1) % 3]);
            let shortest = (0..3).min_by(|&k, &l| length(k).total_cmp(&length(l)));
            let side = CandidateId::side(id.face(), shortest.unwrap_or(0));
            if !sink.is_open(side) {
                sink.open(side);
            }
        }
    }

    fn update(&self, neighbourhood: &Neighbourhood, kept: VertexId, sink: &mut dyn CandidateSink) {
        close_removed(neighbourhood, sink);
        for (place, r) in neighbourhood.ring.iter().enumerate() {
            if [kept, r.id].iter().any(|&v| special(sink.surface(), v)) {
                keep_one(neighbourhood, place as u32, sink);
            }
        }
    }
}

/// Returns true if a vertex cannot simply be merged into the interior of a face.
#[inline]
fn special(surface: &Surface, v: VertexId) -> bool {
    surface.flags(v).any(Flags::BOUNDARY.or(Flags::PINNED).or(Flags::SEAM).or(Flags::TIED))
}

fn close_removed(neighbourhood: &Neighbourhood, sink: &mut dyn CandidateSink) {
    for removed in &neighbourhood.removed_faces {
        (0..3).for_each(|k| sink.close(CandidateId::side(removed.face, k)));
        sink.close(CandidateId::whole(removed.face));
    }
}

/// Keeps exactly one side open on the edge from the new vertex to a ring vertex.
fn keep_one(neighbourhood: &Neighbourhood, ring: u32, sink: &mut dyn CandidateSink) {
    let side = |spoke: &Spoke| {
        let k = if spoke.a == ring { spoke.corner() } else { (spoke.corner() + 2) % 3 };
        (spoke.a == ring || spoke.b == ring).then(|| CandidateId::side(spoke.face, k))
    };
    let mut first = None;
    let mut open = false;
    for side in neighbourhood.spokes.iter().filter_map(side) {
        first = first.or(Some(side));
        if open {
            sink.close(side);
        }
        open |= sink.is_open(side);
    }
    if let (Some(side), false) = (first, open) {
        sink.open(side);
    }
}
