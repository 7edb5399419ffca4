//! Feature edges: boundaries, texture seams and contacts with other surfaces.

use meshlod_mesh::{FaceId, Side, VertexId};

use crate::surface::ties::is_contact;
use crate::surface::{Flags, Surface};

/// An edge that is visible in silhouettes, textures or contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FeatureEdge {
    /// Ends of the edge in the orientation of its face, or of one of its two faces.
    pub(crate) ends: [VertexId; 2],
    pub(crate) is_boundary: bool,
}

/// Returns the feature edges at the given vertices, each once.
///
/// Cost: quadratic in the valence, only for vertices on a feature edge.
pub(crate) fn feature_edges(surface: &Surface, vertices: &[VertexId]) -> Vec<FeatureEdge> {
    let mut found = Vec::new();
    for (i, &v) in vertices.iter().enumerate() {
        if !surface.flags(v).any(Flags::FEATURE) {
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
            if twin.is_none_or(|&(_, twin)| is_feature(surface, side, twin)) {
                let is_boundary = twin.is_none();
                found.push(FeatureEdge { ends: ends(surface, side), is_boundary });
            }
        }
    }
    found
}

/// Returns the two sides of a face at a vertex, each with its other end.
fn sides_at(surface: &Surface, face: FaceId, v: VertexId) -> [(VertexId, Side); 2] {
    let (corners, k) = (surface.face(face), surface.corner(face, v));
    let (next, last) = ((k + 1) % 3, (k + 2) % 3);
    [(corners[next], Side::new(face, k)), (corners[last], Side::new(face, last))]
}

/// Returns true if an edge with two faces is a feature: a seam, or a contact with a tied surface.
#[inline]
pub(crate) fn is_feature(surface: &Surface, side: Side, twin: Side) -> bool {
    is_seam(surface, side, twin) || is_contact(surface, ends(surface, side))
}

fn ends(surface: &Surface, side: Side) -> [VertexId; 2] {
    let (face, k) = (surface.face(side.face()), side.corner());
    [face[k], face[(k + 1) % 3]]
}

/// Returns true if the two faces of an edge use different charts at one of its ends.
fn is_seam(surface: &Surface, side: Side, twin: Side) -> bool {
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
