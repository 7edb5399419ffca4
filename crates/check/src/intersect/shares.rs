//! Places and edges that objects share.

use std::ops::ControlFlow;

use meshlod_mesh::{FaceId, VertexId};

use super::{Search, Step};
use crate::ObjectId;

/// With more objects at one place or edge, each is shown with the first of them only.
const CROWD: usize = 64;

/// An edge at the place in hand, by its other end, and a face at it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Spoke {
    to: VertexId,
    object: ObjectId,
    face: FaceId,
}

impl Search<'_> {
    /// Adds pairs of faces of the objects that share a place: the lowest at each edge there whose
    /// other end is a later place, and the lowest of those that share no edge there.
    pub(super) fn add_sharing(&mut self, star: &[FaceId], place: VertexId) -> Step {
        let object = |f: FaceId| self.ground.objects.of_face[f.index()];
        let Some(&first) = star.first() else { return ControlFlow::Continue(()) };
        if star.iter().all(|&f| object(f) == object(first)) {
            return ControlFlow::Continue(());
        }
        let mut spokes: Vec<Spoke> = Vec::with_capacity(2 * star.len());
        for &face in star {
            let ends = self.soup.corners[face.index()].into_iter().filter(|&v| v != place);
            spokes.extend(ends.map(|to| Spoke { to, object: object(face), face }));
        }
        spokes.sort_unstable();
        spokes.dedup_by_key(|spoke| (spoke.to, spoke.object));
        let mut joined = Vec::new();
        for edge in spokes.chunk_by(|a, b| a.to == b.to) {
            for [a, b] in pairs(edge) {
                joined.push((a.object, b.object));
                if place < a.to {
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

/// All pairs, or the pairs with the first where there are many.
fn pairs(spokes: &[Spoke]) -> impl Iterator<Item = [Spoke; 2]> + '_ {
    let first = if spokes.len() > CROWD { 1 } else { spokes.len() };
    (0..first).flat_map(move |i| spokes[i + 1..].iter().map(move |&b| [spokes[i], b]))
}
