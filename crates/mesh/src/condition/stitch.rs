//! Borders that lie on each other: boundary edges at equal positions, of opposite directions.
//!
//! docs/notes/splitting.md says how this differs from the other splitters and sewers.

use crate::condition::links::Links;
use crate::condition::pairing::{self, normal};
use crate::{Locks, Mesh, Side, VertexId, first_near};

/// Cosine of the angle between the normals of two faces that lie on each other, as the two sides
/// of a leaf do. They are not sewn to a bag without volume.
const FOLDED: f64 = -1.0 + 1e-9;

/// Links those of some boundary edges that lie on each other, and returns the pairs.
pub(super) fn sew(
    mesh: &Mesh,
    border: &[Side],
    locks: &Locks,
    links: &mut Links,
) -> Vec<[Side; 2]> {
    let places = Places::new(mesh, border, 0.0);
    let ties = tied(locks);
    let may_merge = |v: VertexId, w: VertexId| {
        v == w || (locks.of(v) == locks.of(w) && !is_tied(&ties, v) && !is_tied(&ties, w))
    };
    let may_meet = |a: Side, b: Side| {
        let ([v0, v1], [w0, w1]) = (a.ends(&mesh.faces), b.ends(&mesh.faces));
        may_merge(v0, w1) && may_merge(v1, w0) && lie_on_each_other(mesh, &places, a, b)
    };
    let mut sewn = Vec::new();
    for sides in places.by_edge(mesh, border) {
        sewn.extend(pairing::pair(mesh, &sides, may_meet));
    }
    sewn.iter().for_each(|pair| links.link(pair[0], pair[1]));
    sewn
}

/// Returns true if two boundary edges have their ends at the same places, run in opposite
/// directions, and do not fold two faces onto each other.
pub(super) fn lie_on_each_other(mesh: &Mesh, places: &Places, a: Side, b: Side) -> bool {
    let [[v0, v1], [w0, w1]] = [a, b].map(|side| side.ends(&mesh.faces).map(|v| places.of(v)));
    v0 == w1 && v1 == w0 && normal(mesh, a).dot(normal(mesh, b)) > FOLDED
}

/// Returns all tied vertices, in order.
fn tied(locks: &Locks) -> Vec<VertexId> {
    let mut tied: Vec<VertexId> = locks.ties.iter().flatten().copied().collect();
    tied.sort_unstable();
    tied
}

fn is_tied(tied: &[VertexId], v: VertexId) -> bool {
    tied.binary_search(&v).is_ok()
}

/// Places of the vertices on a border: vertices at equal or near positions share one.
pub(super) struct Places {
    /// Vertices on the border, in order.
    vertices: Vec<VertexId>,
    /// Place of each of them.
    places: Vec<u32>,
}

impl Places {
    /// Finds the places of the vertices of some sides, where vertices within `epsilon` of the first
    /// vertex of a place are there too.
    pub(super) fn new(mesh: &Mesh, border: &[Side], epsilon: f64) -> Self {
        let mut vertices: Vec<VertexId> =
            border.iter().flat_map(|side| side.ends(&mesh.faces)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let points: Vec<_> = vertices.iter().map(|v| mesh.positions[v.index()]).collect();
        Self { vertices, places: first_near(&points, epsilon) }
    }

    /// Returns the place of a vertex on the border.
    pub(super) fn of(&self, v: VertexId) -> u32 {
        self.places[self.vertices.binary_search(&v).expect("a vertex of the border")]
    }

    /// Groups sides by the places of their two ends, without those that have both ends at one, and
    /// returns the groups of two and more.
    pub(super) fn by_edge(&self, mesh: &Mesh, border: &[Side]) -> Vec<Vec<Side>> {
        let key = |side: &Side| {
            let mut ends = side.ends(&mesh.faces).map(|v| self.of(v));
            ends.sort_unstable();
            (ends, *side)
        };
        let mut sides: Vec<([u32; 2], Side)> = border.iter().map(key).collect();
        sides.retain(|(ends, _)| ends[0] != ends[1]);
        sides.sort_unstable();
        let groups = sides.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1);
        groups.map(|group| group.iter().map(|&(_, side)| side).collect()).collect()
    }
}
