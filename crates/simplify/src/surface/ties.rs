//! Ties: vertices of several objects at one position, which move together or not at all.

use meshlod_mesh::VertexId;
use rustc_hash::FxHashMap;

use crate::refusal::Refusal;
use crate::surface::contracted::Freedom;
use crate::surface::{Flags, Surface};

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

impl TiedSurface for Surface {
    fn is_tied(&self, vertex: VertexId) -> bool {
        self.flags(vertex).any(Flags::TIED)
    }

    fn tie_of(&self, vertex: VertexId) -> &[VertexId] {
        self.ties.with(vertex)
    }

    fn are_joined(&self, a: VertexId, b: VertexId) -> bool {
        let [fewer, other] = if self.valence(a) <= self.valence(b) { [a, b] } else { [b, a] };
        self.star(fewer).any(|face| self.face(face).contains(&other))
    }

    fn is_crowded(&self, vertices: &[VertexId]) -> bool {
        Self::is_crowded(self, vertices)
    }
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
pub(crate) fn is_contact(surface: &Surface, edge: [VertexId; 2]) -> bool {
    if !edge.iter().all(|&v| surface.is_tied(v)) {
        return false;
    }
    let [firsts, seconds] = edge.map(|v| surface.tie_of(v));
    let joined = |a: VertexId| seconds.iter().any(|&b| b != edge[1] && surface.are_joined(a, b));
    firsts.iter().any(|&a| a != edge[0] && joined(a))
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::{Connectivity, Mesh};

    use super::*;

    /// Two unit squares at the same positions, v0 to v3 and v4 to v7 in order around them, cut
    /// along the same diagonal or along both, and a triangle that touches them only in their first
    /// corner.
    fn squares(cut_alike: bool, ties: &[&[u32]]) -> Surface {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let third = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 1.0]];
        let positions = corners.into_iter().chain(corners).chain(third).collect();
        let second = if cut_alike { [[4, 5, 6], [4, 6, 7]] } else { [[4, 5, 7], [5, 6, 7]] };
        let faces = [[0, 1, 2], [0, 2, 3], second[0], second[1], [8, 9, 10]];
        let mesh = Mesh::new(positions, faces.map(|face| face.map(VertexId)).to_vec());
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        let mut surface = Surface::new(&mesh, &connectivity);
        ties.iter().copied().flatten().for_each(|&v| surface.flag(VertexId(v), Flags::TIED));
        let tie = |tie: &&[u32]| tie.iter().map(|&v| VertexId(v)).collect();
        surface.ties = Ties::new(ties.iter().map(tie).collect());
        surface
    }

    fn found(surface: &Surface, edge: [u32; 2]) -> Result<(Freedom, Vec<[u32; 2]>), Refusal> {
        let mut others = Vec::new();
        let freedom = partners(surface, edge.map(VertexId), &mut others)?;
        Ok((freedom, others.into_iter().map(|edge| edge.map(|v| v.0)).collect()))
    }

    #[test]
    fn an_edge_goes_with_those_beside_it() {
        let surface = squares(false, &[&[0, 4], &[1, 5], &[2, 6]]);
        assert_eq!(found(&surface, [0, 1]), Ok((Freedom::Free, vec![[4, 5]])));
        assert_eq!(found(&surface, [6, 5]), Ok((Freedom::Free, vec![[2, 1]])));
    }

    #[test]
    fn it_goes_to_the_tie_if_one_end_is_free() {
        let surface = squares(false, &[&[0, 4], &[1, 5], &[2, 6]]);
        assert_eq!(found(&surface, [3, 0]), Ok((Freedom::At(1), vec![])));
        assert_eq!(found(&surface, [2, 3]), Ok((Freedom::At(0), vec![])));
    }

    #[test]
    fn a_diagonal_that_only_one_surface_has_stays() {
        let all: &[&[u32]] = &[&[0, 4], &[1, 5], &[2, 6], &[3, 7]];
        assert_eq!(found(&squares(false, all), [0, 2]), Err(Refusal::Tied));
        assert_eq!(found(&squares(true, all), [0, 2]), Ok((Freedom::Free, vec![[4, 6]])));
    }

    #[test]
    fn all_go_to_where_one_cannot_leave() {
        let surface = squares(false, &[&[0, 4, 8], &[1, 5]]);
        assert_eq!(found(&surface, [1, 0]), Ok((Freedom::At(1), vec![[5, 4]])));
        let at_both_ends = squares(false, &[&[0, 4, 8], &[1, 5, 9]]);
        assert_eq!(found(&at_both_ends, [0, 1]), Ok((Freedom::Free, vec![[4, 5], [8, 9]])));
        let apart = squares(false, &[&[0, 4, 8], &[1, 5, 3]]);
        assert_eq!(found(&apart, [4, 5]), Err(Refusal::Tied));
    }

    #[test]
    fn what_has_left_a_tie_holds_nobody() {
        let mut surface = squares(false, &[&[0, 4, 8], &[1, 5]]);
        surface.ties.leave(VertexId(8));
        assert_eq!(found(&surface, [0, 1]), Ok((Freedom::Free, vec![[4, 5]])));
        assert_eq!(surface.ties.with(VertexId(4)), [0, 4].map(VertexId));
    }
}
