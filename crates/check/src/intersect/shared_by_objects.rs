//! Finds the vertices and edges that several objects share.

use std::ops::ControlFlow;

use meshlod_mesh::{FaceId, VertexId};

use super::{Flow, Search};
use crate::ObjectId;

/// Number of objects at one vertex or edge beyond which each is paired with the first only.
const CROWD: usize = 64;

/// An edge at the vertex in question, given by its other end, and a face at that edge.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Spoke {
    to: VertexId,
    object: ObjectId,
    face: FaceId,
}

impl Search<'_> {
    /// Adds pairs of faces of the objects that share a vertex: the lowest faces at each shared edge
    /// whose other end has a higher id, and the lowest faces of objects that share no edge there.
    pub(super) fn add_sharing(&mut self, star: &[FaceId], center: VertexId) -> Flow {
        let object = |f: FaceId| self.input.objects.of_face[f.index()];
        let Some(&first) = star.first() else { return ControlFlow::Continue(()) };
        if star.iter().all(|&f| object(f) == object(first)) {
            return ControlFlow::Continue(());
        }
        let mut spokes: Vec<Spoke> = Vec::with_capacity(2 * star.len());
        for &face in star {
            let ends = self.soup.corners[face.index()].into_iter().filter(|&v| v != center);
            spokes.extend(ends.map(|to| Spoke { to, object: object(face), face }));
        }
        spokes.sort_unstable();
        spokes.dedup_by_key(|spoke| (spoke.to, spoke.object));
        let mut joined = Vec::new();
        for edge in spokes.chunk_by(|a, b| a.to == b.to) {
            for [a, b] in pairs(edge) {
                joined.push((a.object, b.object));
                if center < a.to {
                    self.keep([a.face, b.face])?;
                }
            }
        }
        joined.sort_unstable();
        spokes.sort_unstable_by_key(|spoke| (spoke.object, spoke.face));
        spokes.dedup_by_key(|spoke| spoke.object);
        let apart = |[a, b]: &[Spoke; 2]| joined.binary_search(&(a.object, b.object)).is_err();
        pairs(&spokes).filter(apart).try_for_each(|[a, b]| self.keep([a.face, b.face]))
    }
}

/// Iterates over all pairs, or over the pairs with the first if there are many.
fn pairs(spokes: &[Spoke]) -> impl Iterator<Item = [Spoke; 2]> + '_ {
    let first = if spokes.len() > CROWD { 1 } else { spokes.len() };
    (0..first).flat_map(move |i| spokes[i + 1..].iter().map(move |&b| [spokes[i], b]))
}
