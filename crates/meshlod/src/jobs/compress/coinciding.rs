//! Vertices that rounding puts at one place.

use meshlod_mesh::Mesh;
use rayon::prelude::*;

/// Counts the vertices of a mesh that decode to the place of another one, from which they were apart.
///
/// Cost: O(n log n), n = vertices.
pub(super) fn coinciding_vertices(mesh: &Mesh, decoded: &Mesh) -> usize {
    count_places(mesh).saturating_sub(count_places(decoded))
}

/// Counts the different places of the vertices of faces with three corners: no file has others.
fn count_places(mesh: &Mesh) -> usize {
    let mut is_used = vec![false; mesh.positions.len()];
    for face in mesh.faces.iter().filter(|&&[a, b, c]| a != b && b != c && c != a) {
        face.iter().for_each(|vertex| is_used[vertex.index()] = true);
    }
    let used = mesh.positions.par_iter().zip(&is_used).filter(|(_, used)| **used);
    // Adding 0 makes -0 the same place.
    let mut places: Vec<_> = used.map(|(at, _)| at.map(|x| (x + 0.0).to_bits())).collect();
    places.par_sort_unstable();
    places.dedup();
    places.len()
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::VertexId;

    use super::*;

    #[test]
    fn vertices_at_the_place_of_another_are_counted() {
        let mut mesh = meshlod_fixtures::tetrahedron();
        let mut rounded = mesh.clone();
        rounded.positions[1] = rounded.positions[0];
        assert_eq!(coinciding_vertices(&mesh, &mesh), 0);
        assert_eq!(coinciding_vertices(&mesh, &rounded), 1);
        assert_eq!(coinciding_vertices(&rounded, &rounded), 0, "they were not apart");
        // Vertices that no file has.
        let whole = mesh.clone();
        mesh.positions.extend([[7.0; 3], [8.0; 3]]);
        mesh.faces.push([4, 4, 0].map(VertexId::new));
        assert_eq!(coinciding_vertices(&mesh, &whole), 0);
    }
}
