//! Welding: merging vertices at the same position, and wedges with the same values.

use std::cmp::Ordering;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

use crate::{Attributes, Buckets, Mesh, VertexId, WedgeId};
use glam::DVec3;

/// Merges vertices of `mesh` at the same position or within `epsilon`, and returns the number of
/// vertices removed.
///
/// `epsilon` is in model units. At 0 (or below, or NaN) the coordinates must be equal, where -0
/// equals 0. Above 0, vertices are taken in order, and each is merged into the first kept vertex
/// within `epsilon`: kept vertices are farther apart than that, and no vertex moves farther.
/// Vertices keep their order. Wedges keep their values, but wedges of one vertex with equal values
/// are merged too ([`merge_equal_wedges`]). Faces that lose their area stay.
///
/// Cost: O(n), n = vertices.
pub fn weld(mesh: &mut Mesh, epsilon: f64) -> usize {
    let joined = first_near(&mesh.positions, epsilon);
    let removed = join(mesh, joined);
    if removed > 0 {
        merge_equal_wedges(mesh);
    }
    removed
}

/// Returns, for each point, the index of the point that [`weld`] would merge it into: its own, or
/// an earlier one within `epsilon`.
///
/// Cost: O(n), n = points.
pub fn first_near(points: &[[f64; 3]], epsilon: f64) -> Vec<u32> {
    if epsilon > 0.0 { first_within(points, epsilon) } else { first_equal(points) }
}

/// Merges wedges of a vertex that have equal attribute values, and removes unused wedges.
///
/// An edge then is a seam only if the values of its faces really differ. The first of equal wedges
/// is kept, and wedges keep their order. A mesh without attributes does not change.
///
/// Cost: O(n log k), n = wedges, k = wedges of one vertex.
pub fn merge_equal_wedges(mesh: &mut Mesh) {
    let Some(attributes) = &mut mesh.attributes else { return };
    let mut vertex_of: Vec<Option<VertexId>> = vec![None; attributes.wedge_count];
    for (wedges, face) in attributes.corners.iter().zip(&mesh.faces) {
        for (wedge, &vertex) in wedges.iter().zip(face) {
            vertex_of[wedge.index()] = Some(vertex);
        }
    }
    // Unused wedges share one bucket, after those of the vertices.
    let unused = mesh.positions.len();
    let bucket = |vertex: &Option<VertexId>| vertex.map_or(unused, VertexId::index);
    let by_vertex = Buckets::new(unused + 1, vertex_of.iter().map(bucket));
    let mut kept: Vec<WedgeId> = (0..attributes.wedge_count).map(WedgeId::new).collect();
    let mut around: Vec<WedgeId> = Vec::new();
    for vertex in 0..unused {
        around.clear();
        around.extend(by_vertex.of(vertex).iter().map(|&wedge| WedgeId(wedge)));
        around.sort_by(|&a, &b| compare_values(attributes, a, b));
        for same in around.chunk_by(|&a, &b| compare_values(attributes, a, b).is_eq()) {
            // The sort is stable: the first of equal wedges has the lowest id.
            for wedge in same {
                kept[wedge.index()] = same[0];
            }
        }
    }
    for wedge in attributes.corners.as_flattened_mut() {
        *wedge = kept[wedge.index()];
    }
    attributes.compact();
}

/// Orders wedges by all their values, bit by bit but with -0 equal to 0.
fn compare_values(attributes: &Attributes, a: WedgeId, b: WedgeId) -> Ordering {
    // Adding 0 turns -0 into 0.
    let bits = |x: &f32| (x + 0.0).to_bits();
    let values = |layer: usize, wedge| attributes.layers[layer].of(wedge).iter().map(bits);
    (0..attributes.layers.len())
        .map(|layer| values(layer, a).cmp(values(layer, b)))
        .find(|order| order.is_ne())
        .unwrap_or(Ordering::Equal)
}

/// Returns for each vertex the first one with equal coordinates: itself, or an earlier one.
fn first_equal(positions: &[[f64; 3]]) -> Vec<u32> {
    // The standard hasher: positions chosen to collide must not make this quadratic.
    let mut first: HashMap<[u64; 3], u32> = HashMap::with_capacity(positions.len());
    (0..positions.len() as u32)
        .map(|v| {
            let bits = positions[v as usize].map(|x| (x + 0.0).to_bits());
            *first.entry(bits).or_insert(v)
        })
        .collect()
}

/// Returns for each vertex the first kept one within `epsilon`: itself, or an earlier one.
///
/// Kept vertices are in a hashed grid with cells twice `epsilon` wide, so that all of them within
/// `epsilon` of a point lie in 8 cells. They are more than `epsilon` apart: no cell holds many.
fn first_within(positions: &[[f64; 3]], epsilon: f64) -> Vec<u32> {
    // Squares of larger distances would overflow.
    let epsilon = epsilon.min(1e150);
    let mut newest: HashMap<[i64; 3], u32> = HashMap::with_capacity(positions.len());
    // The kept vertex added to the same cell before this one.
    let mut older: Vec<Option<u32>> = vec![None; positions.len()];
    let mut joined = Vec::with_capacity(positions.len());
    for v in 0..positions.len() as u32 {
        let here = positions[v as usize];
        let is_near =
            |other: u32| DVec3::from(positions[other as usize]).distance(here.into()) <= epsilon;
        let low = here.map(|x| cell(x - epsilon, epsilon));
        let high = here.map(|x| cell(x + epsilon, epsilon));
        let mut found = None;
        for corner in 0..8 {
            let at = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
            // If both ends lie in one cell, visit it once.
            if (0..3).any(|axis| corner >> axis & 1 == 1 && low[axis] == high[axis]) {
                continue;
            }
            let mut next = newest.get(&[at(0), at(1), at(2)]).copied();
            while let Some(other) = next {
                if is_near(other) && found.is_none_or(|found| other < found) {
                    found = Some(other);
                }
                next = older[other as usize];
            }
        }
        if found.is_none() {
            match newest.entry(here.map(|x| cell(x, epsilon))) {
                Entry::Occupied(mut entry) => older[v as usize] = Some(entry.insert(v)),
                Entry::Vacant(entry) => {
                    entry.insert(v);
                }
            }
        }
        joined.push(found.unwrap_or(v));
    }
    joined
}

/// Returns the cell of a coordinate; where cells are finer than `f64`, every coordinate has its
/// own.
fn cell(x: f64, epsilon: f64) -> i64 {
    const WHOLE: f64 = (1_u64 << 52) as f64;
    let cell = (x / (2.0 * epsilon)).floor();
    if cell.abs() < WHOLE { cell as i64 } else { (x + 0.0).to_bits() as i64 }
}

/// Replaces each vertex by the one it was merged into, and returns the number of vertices removed.
///
/// `joined` holds for each vertex itself, or an earlier one that is kept.
fn join(mesh: &mut Mesh, joined: Vec<u32>) -> usize {
    let mut renumbered = joined;
    let mut kept = 0;
    for v in 0..renumbered.len() {
        let to = renumbered[v] as usize;
        if to == v {
            mesh.positions[kept] = mesh.positions[v];
            renumbered[v] = kept as u32;
            kept += 1;
        } else {
            renumbered[v] = renumbered[to];
        }
    }
    let removed = renumbered.len() - kept;
    mesh.positions.truncate(kept);
    for v in mesh.faces.as_flattened_mut() {
        v.0 = renumbered[v.index()];
    }
    removed
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{Layer, LayerKind};

    /// Two triangles that share an edge by place only, with a uv for each corner.
    fn torn(uvs: [[f32; 2]; 6]) -> Mesh {
        let positions = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, -0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        let faces = vec![[0, 1, 2].map(VertexId), [3, 4, 5].map(VertexId)];
        let attributes = Attributes {
            corners: vec![[0, 1, 2].map(WedgeId), [3, 4, 5].map(WedgeId)],
            wedge_count: 6,
            layers: vec![Layer {
                kind: LayerKind::Uv(0),
                name: "uv".to_owned(),
                width: 2,
                values: uvs.as_flattened().to_vec(),
            }],
        };
        Mesh { attributes: Some(attributes), ..Mesh::new(positions, faces) }
    }

    #[test]
    fn a_torn_edge_without_a_seam_becomes_one() {
        let mut mesh = torn([[0.0; 2], [0.5; 2], [0.75; 2], [0.5; 2], [1.0; 2], [0.75; 2]]);
        assert_eq!(weld(&mut mesh, 0.0), 2);
        assert_eq!(mesh.faces, [[0, 1, 2].map(VertexId), [1, 3, 2].map(VertexId)]);
        let attributes = mesh.attributes.as_ref().unwrap();
        assert_eq!(attributes.corners, [[0, 1, 2].map(WedgeId), [1, 3, 2].map(WedgeId)]);
        assert_eq!(attributes.layers[0].values, [0.0, 0.0, 0.5, 0.5, 0.75, 0.75, 1.0, 1.0]);
        assert_eq!(mesh.validate(), Ok(()));
    }

    #[test]
    fn a_seam_keeps_its_wedges() {
        let mut mesh = torn([[0.0; 2], [0.5; 2], [0.75; 2], [0.4; 2], [1.0; 2], [0.75; 2]]);
        assert_eq!(weld(&mut mesh, 0.0), 2);
        assert_eq!(mesh.faces, [[0, 1, 2].map(VertexId), [1, 3, 2].map(VertexId)]);
        let attributes = mesh.attributes.as_ref().unwrap();
        assert_eq!(attributes.corners, [[0, 1, 2].map(WedgeId), [3, 4, 2].map(WedgeId)]);
        assert_eq!(mesh.validate(), Ok(()));
    }

    #[test]
    fn without_equal_vertices_nothing_changes() {
        let mut mesh = torn([[0.0; 2]; 6]);
        mesh.positions = (0..6).map(|i| [f64::from(i); 3]).collect();
        let before = mesh.clone();
        assert_eq!(weld(&mut mesh, 0.1), 0);
        assert_eq!(mesh, before);
    }

    #[test]
    fn within_epsilon_the_first_wins_and_chains_do_not_run_away() {
        let positions: Vec<[f64; 3]> =
            [0.0, 0.9, 1.8, 2.7, -0.5].iter().map(|&x| [x, 0.0, 0.0]).collect();
        assert_eq!(first_within(&positions, 1.0), [0, 0, 2, 2, 0]);
    }

    #[test]
    fn epsilons_beyond_the_coordinates_do_no_harm() {
        let positions = [[1e300, -1e300, 0.0], [1e300, -1e300, 0.0], [-1e300, 0.0, 1e-300]];
        for epsilon in [1e-300, f64::MIN_POSITIVE, 1.0] {
            assert_eq!(first_within(&positions, epsilon), [0, 0, 2]);
        }
        assert_eq!(first_within(&[[1.0; 3], [-1e100; 3]], f64::INFINITY), [0, 0]);
    }

    proptest! {
        #[test]
        fn the_grid_finds_what_comparing_all_finds(
            points in prop::collection::vec(prop::array::uniform3(-3_i32..3), 0..60),
            epsilon in 0.05..0.9,
        ) {
            let positions: Vec<[f64; 3]> =
                points.iter().map(|p| p.map(|x| f64::from(x) * 0.3)).collect();
            let mut expected: Vec<u32> = Vec::new();
            for (v, &here) in positions.iter().enumerate() {
                let near = |&other: &usize| {
                    expected[other] as usize == other
                        && DVec3::from(positions[other]).distance(here.into()) <= epsilon
                };
                expected.push((0..v).find(near).unwrap_or(v) as u32);
            }
            prop_assert_eq!(first_within(&positions, epsilon), expected);
        }
    }
}
