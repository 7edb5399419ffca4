//! Connectivity of a mesh without its degenerate and duplicate faces.

use meshlod_mesh::{Connectivity, FaceId, Mesh, Side, Twin, VertexId};

/// Builds the connectivity of a mesh, leaving out duplicate faces, and returns it with their
/// number.
///
/// Two faces are duplicates if they have the same vertices in the same orientation. Opposite
/// orientations are the two sides of a thin sheet and stay.
pub(crate) fn connect(mesh: &Mesh) -> (Connectivity, usize) {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let duplicates = duplicates(&mesh.faces, &connectivity);
    if duplicates.is_empty() {
        return (connectivity, 0);
    }
    // Connectivity leaves out a face that repeats a vertex, so ids stay as they are.
    let mut faces = mesh.faces.clone();
    for face in &duplicates {
        faces[face.index()] = [VertexId(0); 3];
    }
    (Connectivity::new(&faces, mesh.positions.len()), duplicates.len())
}

/// Returns the faces that repeat one with a lower id.
fn duplicates(faces: &[[VertexId; 3]], connectivity: &Connectivity) -> Vec<FaceId> {
    let suspect = |face: FaceId| {
        (0..3).all(|k| match connectivity.twin(Side::new(face, k)) {
            Twin::NonManifold => true,
            Twin::Side(twin) => twin.ends(faces) == Side::new(face, k).ends(faces),
            Twin::Boundary | Twin::Degenerate => false,
        })
    };
    (0..faces.len())
        .map(FaceId::new)
        .filter(|&face| suspect(face) && repeats_lower(faces, connectivity, face))
        .collect()
}

fn repeats_lower(faces: &[[VertexId; 3]], connectivity: &Connectivity, face: FaceId) -> bool {
    let [a, b, c] = faces[face.index()];
    let turns = [[a, b, c], [b, c, a], [c, a, b]];
    // A hub has many faces, but the vertices on its rim have few.
    let corner = [a, b, c].into_iter().min_by_key(|&v| connectivity.star(v).len());
    connectivity
        .star(corner.unwrap_or(a))
        .iter()
        .take_while(|&&other| other < face)
        .any(|other| turns.contains(&faces[other.index()]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(faces: &[[u32; 3]]) -> Mesh {
        let positions = (0..9).map(|i| [f64::from(i), f64::from(i * i), 0.0]).collect();
        Mesh::new(positions, faces.iter().map(|face| face.map(VertexId)).collect())
    }

    #[test]
    fn a_face_given_twice_counts_once() {
        let (connectivity, duplicates) =
            connect(&mesh(&[[0, 1, 2], [1, 3, 2], [2, 0, 1], [1, 2, 0]]));
        assert_eq!(duplicates, 2);
        assert_eq!((connectivity.non_manifold_edges(), connectivity.boundary_edges()), (0, 4));
    }

    #[test]
    fn the_two_sides_of_a_leaf_stay() {
        let (connectivity, duplicates) = connect(&mesh(&[[0, 1, 2], [2, 1, 0]]));
        assert_eq!((duplicates, connectivity.is_closed()), (0, true));
    }
}
