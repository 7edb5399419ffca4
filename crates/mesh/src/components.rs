//! Connected components of a mesh, found by union-find over its vertices.

use crate::VertexId;

/// Returns the number of each face's connected component, and the number of components.
///
/// Faces that share a vertex are in one component. Components are numbered from 0 in the order of
/// their first faces.
pub fn face_components(faces: &[[VertexId; 3]], vertex_count: usize) -> (Vec<u32>, usize) {
    let mut parent: Vec<u32> = (0..vertex_count as u32).collect();
    for &[a, b, c] in faces {
        join(&mut parent, a.0, b.0);
        join(&mut parent, a.0, c.0);
    }
    let mut number = vec![u32::MAX; vertex_count];
    let mut count = 0;
    let of_face = faces
        .iter()
        .map(|face| {
            let slot = &mut number[root(&mut parent, face[0].0) as usize];
            if *slot == u32::MAX {
                *slot = count;
                count += 1;
            }
            *slot
        })
        .collect();
    (of_face, count as usize)
}

fn join(parent: &mut [u32], a: u32, b: u32) {
    if parent[a as usize] == parent[b as usize] {
        return;
    }
    let (a, b) = (root(parent, a), root(parent, b));
    parent[a.max(b) as usize] = a.min(b);
}

fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        // Halving the path keeps later walks short.
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
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
