//! meshoptimizer's vertex and index codecs.

use meshlod::mesh::VertexId;
use meshopt::{encode_index_buffer, encode_vertex_buffer, optimize_vertex_cache_strip};

/// Returns the sizes in bytes to which meshoptimizer encodes positions and faces: positions as four
/// `u16` in order of first use, faces in the order optimised for strips.
///
/// # Panics
/// If the library refuses its own order.
pub fn meshopt_codec(positions: &[[u16; 3]], faces: &[[VertexId; 3]]) -> [usize; 2] {
    let indices: Vec<u32> = faces.iter().flatten().map(|v| v.0).collect();
    let mut indices = optimize_vertex_cache_strip(&indices, positions.len());
    let vertices = by_first_use(&mut indices, positions);
    let bytes = encode_vertex_buffer(&vertices).expect("four u16 are eight bytes").len();
    [bytes, encode_index_buffer(&indices, vertices.len()).expect("indices are in range").len()]
}

/// Sorts vertices by first use in the indices, dropping unused ones. The crate's own function
/// (`optimize_vertex_fetch_remap`, meshopt 0.7.0) returns a map that is too short if there are
/// unused vertices.
fn by_first_use(indices: &mut [u32], positions: &[[u16; 3]]) -> Vec<[u16; 4]> {
    let mut number = vec![u32::MAX; positions.len()];
    let mut vertices = Vec::new();
    for index in indices {
        let [x, y, z] = positions[*index as usize];
        let number = &mut number[*index as usize];
        if *number == u32::MAX {
            *number = vertices.len() as u32;
            vertices.push([x, y, z, 0]);
        }
        *index = *number;
    }
    vertices
}

#[cfg(test)]
mod tests {
    use meshlod::samples;

    use super::*;

    #[test]
    fn a_smooth_mesh_takes_less_than_it_was() {
        let mesh = samples::torus(5000);
        let positions: Vec<_> =
            mesh.positions.iter().map(|p| p.map(|x| (1000.0 * (x + 2.0)) as u16)).collect();
        let [vertices, indices] = meshopt_codec(&positions, &mesh.faces);
        assert!((1..8 * positions.len()).contains(&vertices), "{vertices}");
        assert!((1..4 * mesh.faces.len()).contains(&indices), "{indices}");
    }

    #[test]
    fn vertices_that_nothing_uses_are_left_out() {
        let mut indices = [4, 1, 3, 3, 1, 0];
        let vertices = by_first_use(&mut indices, &[0, 1, 2, 3, 4].map(|x| [x; 3]));
        assert_eq!(vertices.iter().map(|v| v[0]).collect::<Vec<_>>(), [4, 1, 3, 0]);
        assert_eq!(indices, [0, 1, 2, 2, 1, 3]);
    }
}
