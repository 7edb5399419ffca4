#![no_main]

use meshlod_mesh::{Connectivity, Mesh, VertexId};
use meshlod_simplify::{Method, Options, Target, simplify};

/// Faces over few vertices, where nearly every edge is a special case: bytes 0 to 3 choose the
/// number of vertices, the method, the ratio and the locks; coordinates and faces follow.
fn mesh(bytes: &[u8]) -> Option<(Mesh, Target, Options)> {
    let (&[count, method, ratio, locks], rest) = bytes.split_first_chunk()?;
    let count = 4 + usize::from(count % 60);
    let (coordinates, faces) = rest.split_at_checked(count * 3)?;
    let (points, _) = coordinates.as_chunks::<3>();
    let (triples, _) = faces.as_chunks::<3>();
    let positions = points.iter().map(|p| p.map(|x| f64::from(x as i8)));
    let faces = triples.iter().map(|t| t.map(|v| VertexId(u32::from(v) % count as u32)));
    let options = Options {
        method: Method::ALL[usize::from(method) % Method::ALL.len()],
        lock_boundary: locks & 1 != 0,
        locked: (0..count).map(|v| locks & 2 != 0 && v % 3 == 0).collect(),
        ..Options::default()
    };
    let mesh = Mesh::new(positions.collect(), faces.collect());
    Some((mesh, Target::Ratio(f64::from(ratio) / 255.0), options))
}

/// Open and non-manifold edges.
fn defects(mesh: &Mesh) -> (usize, usize) {
    let c = Connectivity::new(&mesh.faces, mesh.positions.len());
    (c.boundary_edges(), c.non_manifold_edges())
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Some((mesh, target, options)) = mesh(bytes) else { return };
    // With nothing contracted yet, but without the faces that are left out.
    let Ok((cleaned, _)) = simplify(&mesh, Target::Ratio(1.0), &options) else { return };
    let (level, _) = simplify(&mesh, target, &options).expect("the target is one");
    meshlod_fuzz::accept(&level);
    let (before, after) = (defects(&cleaned), defects(&level));
    assert!(after.0 <= before.0 && after.1 <= before.1, "{before:?} became {after:?}");
});
