//! meshoptimizer's codecs of vertices and indices.

use meshlod::mesh::VertexId;
use meshopt::{
    encode_index_buffer, encode_vertex_buffer, optimize_vertex_cache_strip,
    optimize_vertex_fetch_remap, remap_index_buffer, remap_vertex_buffer,
};

/// What positions and faces take by meshoptimizer's codecs, in bytes: positions as four `u16`, in the order in which
/// faces in the order for strips come to them.
///
/// # Panics
/// Where the library refuses what it has ordered itself.
pub fn meshopt_codec(positions: &[[u16; 3]], faces: &[[VertexId; 3]]) -> [usize; 2] {
    let indices: Vec<u32> = faces.iter().flatten().map(|v| v.0).collect();
    let indices = optimize_vertex_cache_strip(&indices, positions.len());
    let padded: Vec<[u16; 4]> = positions.iter().map(|&[x, y, z]| [x, y, z, 0]).collect();
    let remap = optimize_vertex_fetch_remap(&indices, padded.len());
    let used = remap.iter().filter(|&&to| to != u32::MAX).count();
    let indices = remap_index_buffer(Some(&indices), indices.len(), &remap);
    let vertices = remap_vertex_buffer(&padded, used, &remap);
    let vertices = encode_vertex_buffer(&vertices).expect("four u16 are eight bytes");
    let indices = encode_index_buffer(&indices, used).expect("indices are in range");
    [vertices.len(), indices.len()]
}

#[cfg(test)]
mod tests {
    use meshlod::mesh::sample;

    use super::*;

    #[test]
    fn a_smooth_mesh_takes_less_than_it_was() {
        let mesh = sample::torus(5000);
        let positions: Vec<_> =
            mesh.positions.iter().map(|p| p.map(|x| (1000.0 * (x + 2.0)) as u16)).collect();
        let [vertices, indices] = meshopt_codec(&positions, &mesh.faces);
        assert!((1..8 * positions.len()).contains(&vertices), "{vertices}");
        assert!((1..4 * mesh.faces.len()).contains(&indices), "{indices}");
    }
}
