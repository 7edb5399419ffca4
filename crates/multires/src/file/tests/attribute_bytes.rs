//! Values of attributes in files: their bytes, their errors, and files of earlier versions.

use meshlod_fixtures as fixtures;
use meshlod_mesh::{AttributeBounds, LayerKind, Mesh};

use super::{Archive, Storage, diagonal, lattice};
use crate::{Forest, Implicit, Query, StoredErrors};

/// Reads the meshes of a scene, and a bound on the bytes that attributes take for each wedge, of
/// which the order of contractions takes nearly one.
fn models() -> impl Iterator<Item = (&'static str, f64, Vec<Mesh>)> {
    let all = [
        ("duck.glb", 6.9),
        ("spot.obj", 3.9),
        ("fish-bream.obj", 5.6),
        ("flight-helmet/FlightHelmet.gltf", 8.6),
    ];
    all.into_iter().filter_map(|(name, most)| {
        let Some(path) = fixtures::shared_mesh(name) else {
            eprintln!("skipped: {name} is missing");
            return None;
        };
        let scene = meshlod_io::read(&path, &meshlod_io::ReadOptions::default()).unwrap();
        Some((name, most, scene.meshes.into_iter().map(|mesh| mesh.mesh).collect()))
    })
}

fn forest(mesh: &Mesh) -> Forest {
    Forest::new(mesh, &Default::default()).unwrap()
}

/// `cargo test --release -p meshlod-multires --lib attributes_take -- --nocapture` prints the figures.
#[test]
fn attributes_take_few_bytes() {
    for (name, most, meshes) in models() {
        let (mut wedges, mut bytes) = (0, 0);
        for mesh in &meshes {
            let mut forest = forest(mesh);
            let size =
                |forest: &Forest| Archive::write(forest, &Storage::default()).unwrap().0.len();
            let all = size(&forest);
            forest.wedges = None;
            bytes += all - size(&forest);
            wedges += mesh.attributes.as_ref().map_or(0, |all| all.wedge_count);
        }
        let each = bytes as f64 / wedges as f64;
        println!("{name}: {wedges} wedges, {each:.2} bytes for the attributes of each");
        assert!(each < most, "{name}: {each}");
    }
}

#[test]
fn values_of_vertices_that_are_split_are_off_by_a_few_bounds_more() {
    let bounds = AttributeBounds::default();
    let mut off = 0.0f32;
    for (name, _, meshes) in models() {
        let forest = forest(&meshes[0]);
        let storage = Storage::default();
        let cells = lattice(&forest, &storage, diagonal(&forest));
        let rounded = forest.quantized(cells, StoredErrors::AsRecorded).unwrap().forest;
        let was = Implicit::new(&rounded).unwrap();
        let file = Archive::write(&forest, &storage).unwrap().0;
        let is = Archive::open(file).unwrap().read().unwrap().0;
        let (mut was_values, mut values) = (Vec::new(), Vec::new());
        let mut end = 0;
        for layer in is.layers() {
            let start = end;
            end += layer.width;
            let (bound, times) = match layer.kind {
                LayerKind::Uv(_) => (bounds.uv as f32, 15.0),
                LayerKind::Normal => (2.0 * bounds.direction_rad as f32, 7.0),
                _ => continue,
            };
            for node in 0..was.node_count() as u32 {
                assert_eq!(was.wedges_of(node), is.wedges_of(node), "{name}");
                let times = if was.update_of(node).is_some() { times } else { 1.0 };
                for wedge in was.wedges_of(node) {
                    for (model, values) in [(&was, &mut was_values), (&is, &mut values)] {
                        values.clear();
                        model.append_values(wedge, values);
                    }
                    for (a, b) in was_values[start..end].iter().zip(&values[start..end]) {
                        assert!((a - b).abs() <= times * bound + 1e-6, "{name} {node}: {a} {b}");
                        off = off.max((a - b).abs() / bound);
                    }
                }
            }
        }
    }
    assert!(off == 0.0 || off > 3.0, "the leeway is used where there are models: {off}");
}

#[test]
fn files_of_earlier_versions_have_their_values() {
    // A tube with a seam, where u is the angle and v the height, built before values came in pairs.
    let archive = Archive::open(include_bytes!("earlier.mlod").to_vec()).unwrap();
    assert!(!archive.header.wedges_in_pairs);
    let mesh = archive.extract(&Query::uniform(0.0)).unwrap().level.mesh();
    assert!(mesh.faces.len() > 150);
    let attributes = mesh.attributes.as_ref().unwrap();
    let uvs = attributes.layer(LayerKind::Uv(0)).unwrap();
    for (face, corners) in mesh.faces.iter().zip(&attributes.corners) {
        for (v, &wedge) in face.iter().zip(corners) {
            let [x, y, z] = mesh.positions[v.index()];
            let turn = (y.atan2(x) / std::f64::consts::TAU).rem_euclid(1.0);
            let &[u, v] = uvs.of(wedge) else { panic!() };
            let off = (f64::from(u) - turn).abs();
            assert!(off.min((off - 1.0).abs()) < 4e-4, "{u} {turn}");
            assert!((f64::from(v) - z / 2.0).abs() < 4e-4, "{v} {z}");
        }
    }
}
