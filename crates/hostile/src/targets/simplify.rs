use meshlod_mesh::{Connectivity, Lock, Locks, Mesh, VertexId};
use meshlod_simplify::{Method, Options, Target, contract_to};

use crate::accept::accept;

/// Faces over few vertices, where nearly every edge is a special case. Bytes 0 to 3 choose the
/// number of vertices, the method, the ratio and the locks; coordinates and faces follow.
fn mesh(bytes: &[u8]) -> Option<(Mesh, Target, Options)> {
    let (&[count, method, ratio, locks], rest) = bytes.split_first_chunk()?;
    let count = 4 + usize::from(count % 60);
    let (coordinates, faces) = rest.split_at_checked(count * 3)?;
    let (points, _) = coordinates.as_chunks::<3>();
    let (triples, _) = faces.as_chunks::<3>();
    let positions: Vec<_> = points.iter().map(|p| p.map(|x| f64::from(x as i8))).collect();
    let faces = triples.iter().map(|t| t.map(|v| VertexId(u32::from(v) % count as u32)));
    let options = Options {
        method: Method::ALL[usize::from(method) % Method::ALL.len()],
        lock_boundary: locks & 1 != 0,
        locks: locks_of(locks, &positions),
        vanish_below: (locks & 16 != 0).then_some(100.0),
        ..Options::default()
    };
    let mesh = Mesh::new(positions, faces.collect());
    Some((mesh, Target::Ratio(f64::from(ratio) / 255.0), options))
}

/// Locks every third vertex, protects every fifth, and ties coincident ones, as the bits choose.
fn locks_of(bits: u8, positions: &[[f64; 3]]) -> Locks {
    let lock = |v: usize| match () {
        _ if bits & 2 != 0 && v.is_multiple_of(3) => Lock::Locked,
        _ if bits & 4 != 0 && v.is_multiple_of(5) => Lock::Protected,
        _ => Lock::Free,
    };
    let mut ties: Vec<Vec<VertexId>> = Vec::new();
    for v in (0..positions.len()).filter(|_| bits & 8 != 0) {
        let here = |tie: &&mut Vec<VertexId>| positions[tie[0].index()] == positions[v];
        match ties.iter_mut().find(here) {
            Some(tie) => tie.push(VertexId::new(v)),
            None => ties.push(vec![VertexId::new(v)]),
        }
    }
    Locks { of_vertex: (0..positions.len()).map(lock).collect(), ties }
}

/// Counts open and non-manifold edges.
fn defects(mesh: &Mesh) -> (usize, usize) {
    let c = Connectivity::new(&mesh.faces, mesh.positions.len());
    (c.boundary_edges(), c.non_manifold_edges())
}

/// Simplifies few faces by any method, with any locks.
pub fn run(bytes: &[u8]) {
    let Some((mesh, target, options)) = mesh(bytes) else { return };
    // Before any contraction, but after cleaning has removed faces.
    let Ok((cleaned, _)) = contract_to(&mesh, Target::Ratio(1.0), &options) else { return };
    let (level, _) = contract_to(&mesh, target, &options).expect("the target is valid");
    accept(&level);
    let (before, after) = (defects(&cleaned), defects(&level));
    assert!(after.0 <= before.0 && after.1 <= before.1, "{before:?} became {after:?}");
}
