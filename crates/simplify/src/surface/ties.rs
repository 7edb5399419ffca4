//! Ties: vertices of several objects at one position, which move together or not at all.

use meshlod_mesh::VertexId;
use rustc_hash::FxHashMap;

use crate::refusal::Refusal;
use crate::surface::contracted::Freedom;

/// Largest number of vertices of a tie; larger ones are locked, because edges between two ties are
/// searched from each of their vertices.
pub(crate) const MOST_MEMBERS: usize = 16;

/// The current ties. A vertex merged into another leaves its tie; the other takes its place.
#[derive(Default)]
pub(crate) struct Ties {
    of_vertex: FxHashMap<VertexId, u32>,
    members: Vec<Vec<VertexId>>,
}

impl Ties {
    pub(crate) fn new(members: Vec<Vec<VertexId>>) -> Self {
        let of = |(tie, members): (usize, &Vec<VertexId>)| {
            members.iter().map(|&v| (v, tie as u32)).collect::<Vec<_>>()
        };
        let of_vertex = members.iter().enumerate().flat_map(of).collect();
        Self { of_vertex, members }
    }

    /// Returns all vertices tied to `vertex`, including itself; empty if it is not tied.
    pub(crate) fn with(&self, vertex: VertexId) -> &[VertexId] {
        self.of_vertex.get(&vertex).map_or(&[], |&tie| &self.members[tie as usize])
    }

    /// Removes a vertex from its tie.
    pub(crate) fn leave(&mut self, vertex: VertexId) {
        if let Some(tie) = self.of_vertex.remove(&vertex) {
            self.members[tie as usize].retain(|&member| member != vertex);
        }
    }
}

/// A surface with ties, as needed to decide which edges must be contracted together.
pub(crate) trait TiedSurface {
    /// Returns true if a vertex is in a tie.
    fn is_tied(&self, vertex: VertexId) -> bool;

    /// Returns the vertices of its tie, including itself; empty if it is in no tie.
    fn tie_of(&self, vertex: VertexId) -> &[VertexId];

    /// Returns true if an edge connects two vertices.
    fn are_joined(&self, a: VertexId, b: VertexId) -> bool;

    /// Returns true if too many faces are around these vertices for a contraction.
    fn is_crowded(&self, vertices: &[VertexId]) -> bool;
}

/// Determines the freedom that ties leave the contraction of an edge, and collects in `partners`
/// the edges to contract with it, each with its ends in corresponding order.
///
/// An edge between a tie and a free vertex is contracted onto the tie. An edge between two ties
/// takes with it every edge between them, at most one at each vertex. A vertex without such an edge
/// stays, so all must be contracted onto its end; if both ends have one, the contraction is
/// refused.
pub(crate) fn partners(
    surface: &impl TiedSurface,
    [v0, v1]: [VertexId; 2],
    partners: &mut Vec<[VertexId; 2]>,
) -> Result<Freedom, Refusal> {
    partners.clear();
    match [v0, v1].map(|v| surface.is_tied(v)) {
        [false, false] => return Ok(Freedom::Free),
        [true, false] => return Ok(Freedom::At(0)),
        [false, true] => return Ok(Freedom::At(1)),
        [true, true] => {}
    }
    let [firsts, seconds] = [v0, v1].map(|v| surface.tie_of(v));
    if surface.is_crowded(firsts) || surface.is_crowded(seconds) {
        return Err(Refusal::Valence);
    }
    if firsts.contains(&v1) {
        return Ok(Freedom::At(0));
    }
    let mut joined = 0;
    for &first in firsts {
        let mut met = seconds.iter().filter(|&&second| surface.are_joined(first, second));
        let Some(&second) = met.next() else { continue };
        let alone = firsts.iter().all(|&v| v == first || !surface.are_joined(v, second));
        if met.next().is_some() || !alone {
            return Err(Refusal::Tied);
        }
        joined += 1;
        if first != v0 {
            partners.push([first, second]);
        }
    }
    match [firsts, seconds].map(|tie| tie.len() == joined) {
        [true, true] => Ok(Freedom::Free),
        [false, true] => Ok(Freedom::At(0)),
        [true, false] => Ok(Freedom::At(1)),
        [false, false] => Err(Refusal::Tied),
    }
}

/// Returns true if an edge between two ties has parallel edges on tied surfaces.
pub(crate) fn is_contact(surface: &impl TiedSurface, edge: [VertexId; 2]) -> bool {
    if !edge.iter().all(|&v| surface.is_tied(v)) {
        return false;
    }
    let [firsts, seconds] = edge.map(|v| surface.tie_of(v));
    let joined = |a: VertexId| seconds.iter().any(|&b| b != edge[1] && surface.are_joined(a, b));
    firsts.iter().any(|&a| a != edge[0] && joined(a))
}
