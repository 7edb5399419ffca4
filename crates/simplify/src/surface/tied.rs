//! The ties of a surface that contractions change.

use meshlod_mesh::VertexId;

use crate::surface::ties::TiedSurface;
use crate::surface::{Flags, Surface};

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

#[cfg(test)]
mod tests {
    use meshlod_mesh::{Connectivity, Mesh};

    use super::*;
    use crate::refusal::Refusal;
    use crate::surface::contracted::Freedom;
    use crate::surface::ties::{Ties, partners};

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
