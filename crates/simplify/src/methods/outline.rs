//! Edges where the surface ends, or a chart of its textures.

use meshlod_mesh::{FaceId, VertexId};

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
        for (place, side) in sides.iter().enumerate() {
            let same = |other: &&Side| other.other == side.other;
            let is_first = !sides[..place].iter().any(|other| same(&other));
            if !is_first || vertices[..i].contains(&side.other) {
                continue;
            }
            let twin = sides[place + 1..].iter().find(same);
            let is_seam = twin.is_some_and(|twin| is_seam(surface, side, twin, v));
            if is_seam || twin.is_none() {
                found.push(Outline { ends: side.ends, is_seam });
            }
        }
    }
    found
}

/// A side of a face at a vertex.
struct Side {
    face: FaceId,
    /// Its end that is not the vertex.
    other: VertexId,
    ends: [VertexId; 2],
}

fn sides_at(surface: &Surface, face: FaceId, v: VertexId) -> [Side; 2] {
    let (corners, k) = (surface.face(face), surface.corner(face, v));
    let (next, last) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
    [Side { face, other: next, ends: [v, next] }, Side { face, other: last, ends: [last, v] }]
}

fn is_seam(surface: &Surface, side: &Side, twin: &Side, v: VertexId) -> bool {
    let Some(wedges) = &surface.wedges else { return false };
    [v, side.other].into_iter().any(|end| {
        let chart = |face| wedges.chart_at(face, surface.corner(face, end));
        chart(side.face) != chart(twin.face)
    })
}
