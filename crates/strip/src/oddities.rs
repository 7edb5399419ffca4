//! What of a list of faces a strip cannot go through.

use meshlod_mesh::VertexId;

use crate::dual::{ends, whole};

/// How many of what there should be none of, in a mesh that is to be strips. All of it is drawn all the same, but for
/// faces that repeat a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Oddities {
    /// Faces that repeat a vertex.
    pub degenerate_faces: usize,
    /// Faces that are there before, with any first corner and either winding.
    pub repeated_faces: usize,
    /// Edges of more than two faces.
    pub non_manifold_edges: usize,
    /// Edges of two faces that run along them the same way.
    pub inconsistent_edges: usize,
}

impl Oddities {
    /// Counts them. Cost: O(n log n).
    pub fn new(faces: &[[VertexId; 3]]) -> Self {
        let mut wholes: Vec<_> = faces.iter().filter(|face| whole(face)).copied().collect();
        let mut sides: Vec<_> =
            wholes.iter().flat_map(|face| [0, 1, 2].map(|k| ends(face, k))).collect();
        let edge = |[from, to]: &[VertexId; 2]| [*from.min(to), *from.max(to)];
        sides.sort_unstable_by_key(edge);
        let mut oddities = Self { degenerate_faces: faces.len() - wholes.len(), ..Self::default() };
        for around in sides.chunk_by(|a, b| edge(a) == edge(b)) {
            oddities.non_manifold_edges += usize::from(around.len() > 2);
            oddities.inconsistent_edges += usize::from(around.len() == 2 && around[0] == around[1]);
        }
        wholes.iter_mut().for_each(|face| face.sort_unstable());
        wholes.sort_unstable();
        let all = wholes.len();
        wholes.dedup();
        oddities.repeated_faces = all - wholes.len();
        oddities
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_counted_once() {
        let faces = [[0, 1, 2], [1, 0, 3], [0, 1, 4], [0, 0, 1], [5, 6, 7], [7, 6, 5], [5, 6, 8]]
            .map(|face| face.map(VertexId));
        let expected = Oddities {
            degenerate_faces: 1,
            repeated_faces: 1,
            non_manifold_edges: 2,
            inconsistent_edges: 0,
        };
        assert_eq!(Oddities::new(&faces), expected);
        let turned = [[0, 1, 2], [0, 1, 3]].map(|face| face.map(VertexId));
        assert_eq!(Oddities::new(&turned).inconsistent_edges, 1);
        assert_eq!(Oddities::new(&[]), Oddities::default());
    }
}
