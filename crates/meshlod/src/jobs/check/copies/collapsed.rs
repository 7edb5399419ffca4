//! Vertices that are apart in a mesh, but at one place where an instance has them.

use std::collections::{HashMap, HashSet};

use meshlod_io::Scene;
use meshlod_mesh::{Mesh, VertexId};
use rayon::prelude::*;

use super::placed::{PlacedInstances, PlacedMesh, reach};

/// Largest distance of vertices that rounding may move to one place, as a part of the coordinates
/// that a transform adds up: each of the two places is off by a few roundings.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Returns the vertices that the transform of an instance moves to one place though they are apart
/// in its mesh, with that place, by the ids of the merged mesh.
///
/// Exported cylinders have a seam with 6e-17 on one side and 0 on the other.
pub fn collapsed(scene: &Scene, placed: &PlacedInstances) -> Vec<([u64; 3], Vec<VertexId>)> {
    let reaches: Vec<f64> = scene.meshes.iter().map(|mesh| reach(&mesh.mesh)).collect();
    let mut summands = vec![0.0_f64; scene.meshes.len()];
    for own in &placed.instances {
        let most = &mut summands[own.shown.mesh];
        *most = most.max(own.summands(reaches[own.shown.mesh]));
    }
    let meshes = scene.meshes.par_iter().zip(&summands);
    let close: Vec<Vec<VertexId>> =
        meshes.map(|(mesh, summands)| close_vertices(&mesh.mesh, ROUNDING * summands)).collect();
    let mut found = Vec::new();
    for own in placed.instances.iter().filter(|own| !close[own.shown.mesh].is_empty()) {
        let mesh = &scene.meshes[own.shown.mesh].mesh;
        found.extend(collapsed_in(own, mesh, &close[own.shown.mesh]));
    }
    found
}

/// Returns the vertices among some of a mesh that an instance has at one place.
fn collapsed_in(
    own: &PlacedMesh,
    mesh: &Mesh,
    close: &[VertexId],
) -> impl Iterator<Item = ([u64; 3], Vec<VertexId>)> {
    let mut at_place: HashMap<[u64; 3], Vec<VertexId>> = HashMap::new();
    for v in close {
        at_place.entry(bits(own.point(mesh.positions[v.index()]))).or_default().push(*v);
    }
    at_place.retain(|_, vertices| are_apart(mesh, vertices));
    let named = |v: VertexId| own.vertex(v);
    at_place
        .into_iter()
        .map(move |(place, vertices)| (place, vertices.into_iter().map(named).collect()))
}

/// Returns the used vertices of a mesh that have another one near them, but not at their place.
///
/// In one of eight grids, each moved by half a cell along some axes, two such vertices share a cell.
/// Cost: linear.
fn close_vertices(mesh: &Mesh, distance: f64) -> Vec<VertexId> {
    let cell = 2.0 * distance;
    if !cell.is_normal() {
        return Vec::new();
    }
    let is_used = mesh.used_vertices();
    let used: Vec<VertexId> =
        (0..is_used.len()).filter(|&i| is_used[i]).map(VertexId::new).collect();
    let mut is_close = vec![false; is_used.len()];
    for grid in 0..8 {
        let shift = [0, 1, 2].map(|axis| f64::from(grid >> axis & 1) * 0.5);
        // The first vertex of each cell stands for those at its place.
        let mut firsts: HashMap<[u64; 3], VertexId> = HashMap::new();
        for &v in &used {
            let at = mesh.positions[v.index()];
            let key = [0, 1, 2].map(|axis| (at[axis] / cell + shift[axis]).floor());
            let first = *firsts.entry(bits(key)).or_insert(v);
            if bits(mesh.positions[first.index()]) != bits(at) {
                (is_close[first.index()], is_close[v.index()]) = (true, true);
            }
        }
    }
    // Others at the place of one that is close are, too.
    let close = used.iter().filter(|v| is_close[v.index()]);
    let places: HashSet<[u64; 3]> = close.map(|v| bits(mesh.positions[v.index()])).collect();
    used.into_iter().filter(|v| places.contains(&bits(mesh.positions[v.index()]))).collect()
}

/// Returns true if not all of these vertices are at one place in their mesh.
fn are_apart(mesh: &Mesh, vertices: &[VertexId]) -> bool {
    let place = |v: &VertexId| bits(mesh.positions[v.index()]);
    vertices.iter().any(|v| place(v) != place(&vertices[0]))
}

/// Returns bits that are equal for equal places: zero has two signs.
pub fn bits(at: [f64; 3]) -> [u64; 3] {
    at.map(|x| (x + 0.0).to_bits())
}
