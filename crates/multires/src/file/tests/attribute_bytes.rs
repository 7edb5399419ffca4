//! Bytes that attributes add to a file.

use meshlod_mesh::Mesh;

use super::{Archive, Storage};
use crate::Forest;

/// Bytes of a file for each wedge of the input, beside those of the same updates without attributes.
fn bytes_per_wedge(meshes: &[Mesh]) -> (usize, f64) {
    let (mut wedges, mut bytes) = (0, 0);
    for mesh in meshes {
        let mut forest = Forest::new(mesh, &Default::default()).unwrap();
        let size = |forest: &Forest| Archive::write(forest, &Storage::default()).unwrap().0.len();
        let all = size(&forest);
        forest.wedges = None;
        bytes += all - size(&forest);
        wedges += mesh.attributes.as_ref().map_or(0, |all| all.wedge_count);
    }
    (wedges, bytes as f64 / wedges as f64)
}

#[test]
fn attributes_take_few_bytes() {
    for (name, _most) in [
        ("duck.glb", 8.0),
        ("spot.obj", 4.0),
        ("fish-bream.obj", 4.0),
        ("flight-helmet/FlightHelmet.gltf", 10.6),
    ] {
        let Some(path) = meshlod_fixtures::shared_mesh(name) else {
            eprintln!("skipped: {name} is missing");
            continue;
        };
        let scene = meshlod_io::read(&path, &Default::default()).unwrap();
        let meshes: Vec<Mesh> = scene.meshes.iter().map(|m| m.mesh.clone()).collect();

        eprintln!("MODEL {name}: {:?}", bytes_per_wedge(&meshes));
    }
}
