//! Edges where the surface ends, or a chart of its textures.

use meshlod_mesh::{FaceId, Side, VertexId};

use crate::surface::{Flags, Surface};

/// An edge that is seen in silhouettes or textures wherever it goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Outline {
    /// Its ends, as its face goes round; of a seam, one of its two faces.
    pub(crate) ends: [VertexId; 2],
    pub(crate) is_seam: bool,
}

/// The boundary edges and seams at some vertices, each once.
///
/// Cost: the square of a vertex's faces, but only of those that are on one.
pub(crate) fn outlines(surface: &Surface, vertices: &[VertexId]) -> Vec<Outline> {
    let mut found = Vec::new();
    for (i, &v) in vertices.iter().enumerate() {
        if !surface.flags(v).any(Flags::BOUNDARY.or(Flags::SEAM)) {
            continue;
        }
        let sides: Vec<_> = surface.star(v).flat_map(|face| sides_at(surface, face, v)).collect();
        for (place, &(other, side)) in sides.iter().enumerate() {
            let same = |&&(vertex, _): &&(VertexId, Side)| vertex == other;
            let is_first = !sides[..place].iter().any(|side| same(&side));
            if !is_first || vertices[..i].contains(&other) {
                continue;
            }
            let twin = sides[place + 1..].iter().find(same);
            let is_seam = twin.is_some_and(|&(_, twin)| is_seam(surface, side, twin));
            if is_seam || twin.is_none() {
                let (face, k) = (surface.face(side.face()), side.corner());
                found.push(Outline { ends: [face[k], face[(k + 1) % 3]], is_seam });
            }
        }
    }
    found
}

/// The two sides of a face at a vertex, each with its other end.
fn sides_at(surface: &Surface, face: FaceId, v: VertexId) -> [(VertexId, Side); 2] {
    let (corners, k) = (surface.face(face), surface.corner(face, v));
    let (next, last) = ((k + 1) % 3, (k + 2) % 3);
    [(corners[next], Side::new(face, k)), (corners[last], Side::new(face, last))]
}

/// Whether the two faces of an edge use different charts at an end of it.
pub(super) fn is_seam(surface: &Surface, side: Side, twin: Side) -> bool {
    let Some(wedges) = &surface.wedges else { return false };
    let ends = |side: Side| [side.corner(), (side.corner() + 1) % 3];
    let vertex = |side: Side, k: usize| surface.face(side.face())[k];
    ends(side).into_iter().any(|k| {
        let at: VertexId = vertex(side, k);
        ends(twin).into_iter().any(|l| {
            vertex(twin, l) == at
                && wedges.chart_at(twin.face(), l) != wedges.chart_at(side.face(), k)
        })
    })
}
