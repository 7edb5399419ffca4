//! Faces that repeat others.

use std::collections::HashSet;

use crate::{Connectivity, FaceId, Side, Twin, VertexId};

/// Returns the faces that repeat one with a lower id: the same vertices in the same orientation,
/// and the same label.
///
/// Opposite orientations are the two sides of a thin sheet, and no duplicates.
///
/// Cost: O(n), n = faces.
pub(crate) fn duplicate_faces(
    faces: &[[VertexId; 3]],
    connectivity: &Connectivity,
    label: impl Fn(FaceId) -> u32,
) -> Vec<FaceId> {
    // All sides of such a face have another face that runs the same way.
    let is_suspect = |face: FaceId| {
        (0..3).all(|k| match connectivity.twin(Side::new(face, k)) {
            Twin::NonManifold => true,
            Twin::Side(twin) => twin.ends(faces) == Side::new(face, k).ends(faces),
            Twin::Boundary | Twin::Degenerate => false,
        })
    };
    let mut seen = HashSet::new();
    let repeats = |&face: &FaceId| {
        let [a, b, c] = faces[face.index()];
        let turned = [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
        !seen.insert((turned, label(face)))
    };
    (0..faces.len()).map(FaceId::new).filter(|&face| is_suspect(face)).filter(repeats).collect()
}

impl Connectivity {
    /// Builds the connectivity of faces without their duplicates, which count as degenerate, and
    /// returns it with the duplicates.
    ///
    /// A face is a duplicate if it has the vertices and the orientation of one with a lower id.
    /// Opposite orientations are the two sides of a thin sheet and stay.
    pub fn without_duplicates(faces: &[[VertexId; 3]], vertex_count: usize) -> (Self, Vec<FaceId>) {
        let connectivity = Self::new(faces, vertex_count);
        let duplicates = duplicate_faces(faces, &connectivity, |_| 0);
        if duplicates.is_empty() {
            return (connectivity, duplicates);
        }
        // Connectivity leaves out a face that repeats a vertex, so ids stay as they are.
        let mut distinct = faces.to_vec();
        for face in &duplicates {
            distinct[face.index()] = [VertexId(0); 3];
        }
        (Self::new(&distinct, vertex_count), duplicates)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn connectivity(faces: &[[u32; 3]]) -> (Connectivity, Vec<FaceId>) {
        let faces: Vec<_> = faces.iter().map(|face| face.map(VertexId)).collect();
        Connectivity::without_duplicates(&faces, 9)
    }

    #[test]
    fn a_face_given_three_times_counts_once() {
        let (found, duplicates) = connectivity(&[[0, 1, 2], [1, 3, 2], [2, 0, 1], [1, 2, 0]]);
        assert_eq!(duplicates, [FaceId(2), FaceId(3)]);
        assert_eq!((found.non_manifold_edges(), found.boundary_edges()), (0, 4));
    }

    #[test]
    fn the_two_sides_of_a_leaf_stay() {
        let (found, duplicates) = connectivity(&[[0, 1, 2], [2, 1, 0]]);
        assert_eq!((duplicates.len(), found.is_closed()), (0, true));
    }
}
