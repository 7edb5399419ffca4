//! An estimate of how much of a mesh is flat, from a sample of its faces.

use meshlod_mesh::{Mesh, VertexId};
use robust::{Coord3D, orient3d};
use rustc_hash::FxHashMap;

/// Number of faces that are looked at.
const SAMPLE: usize = 512;

/// Returns about which part of the faces of a mesh lie in one plane with all three beside them,
/// exactly.
///
/// Cost: O(n) with next to nothing a face, n = faces: a five hundredth of a run that contracts most.
/// # Panics
/// If the mesh is not valid, see [`Mesh::validate`].
pub fn flat_part(mesh: &Mesh) -> f64 {
    let count = mesh.faces.len();
    let step = count.div_ceil(SAMPLE).max(1);
    let sample: Vec<[VertexId; 3]> = mesh.faces.iter().copied().step_by(step).collect();
    if sample.is_empty() {
        return 0.0;
    }
    let mut is_near = vec![false; mesh.positions.len()];
    sample.iter().flatten().for_each(|v| is_near[v.index()] = true);
    // The corners opposite each edge of the sample, on either side.
    let mut beside: FxHashMap<[VertexId; 2], Vec<VertexId>> = FxHashMap::default();
    sample.iter().flat_map(edges).for_each(|(edge, _)| {
        beside.entry(edge).or_default();
    });
    let is_beside =
        |face: &&[VertexId; 3]| face.iter().map(|v| u8::from(is_near[v.index()])).sum::<u8>() > 1;
    for (edge, apex) in mesh.faces.iter().filter(is_beside).flat_map(edges) {
        if let Some(found) = beside.get_mut(&edge) {
            found.push(apex);
        }
    }
    let is_flat = |face: &&[VertexId; 3]| {
        let [a, b, c] = face.map(|v| coordinates(mesh, v));
        // More than two in one plane are faces that are there twice.
        edges(face).into_iter().all(|(edge, _)| match &beside[&edge][..] {
            [] | [_] => false,
            all => all.iter().all(|&v| orient3d(a, b, c, coordinates(mesh, v)) == 0.0),
        })
    };
    sample.iter().filter(is_flat).count() as f64 / sample.len() as f64
}

/// Returns the edges of a face, the ends of each in order, with the corners opposite them.
fn edges(&[a, b, c]: &[VertexId; 3]) -> [([VertexId; 2], VertexId); 3] {
    [[a, b, c], [b, c, a], [c, a, b]].map(|[a, b, c]| ([a.min(b), a.max(b)], c))
}

fn coordinates(mesh: &Mesh, v: VertexId) -> Coord3D<f64> {
    let [x, y, z] = mesh.positions[v.index()];
    Coord3D { x, y, z }
}

#[cfg(test)]
mod tests {
    use meshlod_samples as samples;

    use super::*;

    #[test]
    fn flat_parts_are_near_those_of_all_faces() {
        assert_eq!(flat_part(&Mesh::default()), 0.0);
        assert_eq!(flat_part(&samples::sphere(5_000)), 0.0);
        assert!(flat_part(&samples::terrain(5_000)) < 0.02);
        // A side of 16 × 16 squares has 60 with an edge on its rim, half of whose faces are flat.
        let inner = 1.0 - 60.0 / 512.0;
        let found = flat_part(&samples::cube(12 * 256));
        assert!((found - inner).abs() < 0.05, "{found}");
        // As in files of any order.
        let mut mixed = samples::cube(12 * 256);
        mixed.faces.sort_by_key(|face| face[0].0.wrapping_mul(0x9e37_79b9));
        assert!((flat_part(&mixed) - inner).abs() < 0.05);
    }
}
