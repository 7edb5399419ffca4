//! Connected components of a mesh, found by union-find over its vertices.

use crate::{UnionFind, VertexId};

/// Returns the sets of vertices that faces join.
pub fn joined_vertices(faces: &[[VertexId; 3]], vertex_count: usize) -> UnionFind {
    let mut joined = UnionFind::new(vertex_count);
    for &[a, b, c] in faces {
        joined.union(a.0, b.0);
        joined.union(a.0, c.0);
    }
    joined
}

/// Returns the number of each face's connected component, and the number of components.
///
/// Faces that share a vertex are in one component. Components are numbered from 0 in the order of
/// their first faces.
pub fn face_components(faces: &[[VertexId; 3]], vertex_count: usize) -> (Vec<u32>, usize) {
    let mut joined = joined_vertices(faces, vertex_count);
    let mut number = vec![u32::MAX; vertex_count];
    let mut count = 0;
    let of_face = faces
        .iter()
        .map(|face| {
            let slot = &mut number[joined.find(face[0].0) as usize];
            if *slot == u32::MAX {
                *slot = count;
                count += 1;
            }
            *slot
        })
        .collect();
    (of_face, count as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_that_share_a_vertex_are_one_component() {
        let faces = [[0, 1, 2], [5, 6, 7], [2, 3, 4]].map(|face| face.map(VertexId));
        assert_eq!(face_components(&faces, 9), (vec![0, 1, 0], 2));
    }
}
