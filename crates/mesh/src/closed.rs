//! Connected components that enclose a volume.

use crate::components::face_components;
use crate::connectivity::{Connectivity, Side, Twin};
use crate::{FaceId, VertexId};

/// Marks the faces of connected components that are closed and consistently oriented.
///
/// A component is so if every edge of it has as many faces in one direction as in the other, which
/// also allows for non-manifold edges; its signed volume does not depend on the origin. Faces that
/// share a vertex are in one component. A face that repeats another is left out and opens nothing,
/// so a mesh and a level of it, which has no such faces, agree on what is closed.
///
/// Cost: O(n), n = faces, and O(m log m) for m faces at non-manifold edges.
pub fn closed_faces(faces: &[[VertexId; 3]], vertex_count: usize) -> Vec<bool> {
    let (connectivity, duplicates) = Connectivity::without_duplicates(faces, vertex_count);
    let (labels, count) = face_components(faces, vertex_count);
    let mut is_closed = vec![true; count];
    let mut crowded = Vec::new();
    for (f, &label) in labels.iter().enumerate() {
        for side in (0..3).map(|k| Side::new(FaceId::new(f), k)) {
            let [a, b] = side.ends(faces);
            match connectivity.twin(side) {
                Twin::Side(twin) if twin.ends(faces) == [b, a] => {}
                Twin::Side(_) | Twin::Boundary => is_closed[label as usize] = false,
                Twin::NonManifold => crowded.push((a.min(b), a.max(b), a < b, label)),
                Twin::Degenerate => {}
            }
        }
    }
    crowded.sort_unstable();
    for edge in crowded.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let forward = edge.iter().filter(|side| side.2).count();
        is_closed[edge[0].3 as usize] &= 2 * forward == edge.len();
    }
    let mut marks: Vec<bool> = labels.into_iter().map(|l| is_closed[l as usize]).collect();
    duplicates.iter().for_each(|face| marks[face.index()] = false);
    marks
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Faces of a tetrahedron on four vertices.
    fn solid([a, b, c, d]: [u32; 4]) -> [[VertexId; 3]; 4] {
        [[a, c, b], [a, b, d], [b, c, d], [c, a, d]].map(|face| face.map(VertexId))
    }

    #[test]
    fn open_and_twisted_components_are_left_out() {
        let mut faces = Vec::from(solid([0, 1, 2, 3]));
        faces.extend(&solid([4, 5, 6, 7])[1..]);
        let mut twisted = solid([8, 9, 10, 11]);
        twisted[0].reverse();
        faces.extend(twisted);
        let expected: Vec<bool> = (0..11).map(|face| face < 4).collect();
        assert_eq!(closed_faces(&faces, 12), expected);
    }

    #[test]
    fn a_face_given_twice_opens_nothing_and_counts_once() {
        let mut faces = Vec::from(solid([0, 1, 2, 3]));
        let [a, b, c] = faces[1];
        faces.extend([[b, c, a], [a, b, c]]);
        assert_eq!(closed_faces(&faces, 4), [true, true, true, true, false, false]);
    }

    #[test]
    fn solids_that_share_an_edge_are_closed() {
        let mut faces = [solid([0, 1, 2, 3]), solid([0, 1, 4, 5])].concat();
        assert_eq!(closed_faces(&faces, 6), [true; 8]);
        faces[7].reverse();
        assert_eq!(closed_faces(&faces, 6), [false; 8]);
    }
}
