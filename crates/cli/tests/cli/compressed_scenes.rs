//! Scenes through compressed files, `.mlq` and `.mlz`.

use meshlod::codec::{
    Compressed, CompressionTarget, Scheme, Transport, TransportOptions, compress,
};
use meshlod::io::{Node, SceneMesh};
use meshlod::mesh::{AttributeBounds, LayerKind, Mesh};
use meshlod::model::place_scene;
use meshlod::{Constraints, Options, ReadOptions, Scene, WriteOptions, read, samples, write};
use meshlod_fixtures::shared_mesh;

use crate::documents::document;
use crate::models::{bytes, number};
use crate::run::Run;

const MODELS: [&str; 4] =
    ["fox.glb", "duck.glb", "cesium-milk-truck.glb", "flight-helmet/FlightHelmet.gltf"];
const FILES: [&str; 2] = ["a.mlq", "a.mlz"];

fn scene_of(run: &Run, name: &str) -> Scene {
    read(run.path(name), &ReadOptions::default()).unwrap()
}

/// A torus that two nodes show, the second one turned and at half the size.
fn two_instances() -> Scene {
    let turned =
        [[0.0, 0.5, 0.0, 0.0], [-0.5, 0.0, 0.0, 0.0], [0.0, 0.0, 0.5, 0.0], [4.0, 1.0, 0.0, 1.0]];
    let mut scene = Scene::from_mesh("torus", samples::torus(600));
    scene.nodes[0].name = "large".into();
    let small = Node { name: "small".into(), transform: turned, mesh: Some(0), ..Node::default() };
    scene.nodes.push(small);
    scene.roots.push(1);
    scene
}

fn write_two_instances(run: &Run) {
    write(run.path("in.glb"), &two_instances(), &WriteOptions::default()).unwrap();
}

/// Returns the mean weight that each joint has over the corners of a mesh; none without joints.
fn mean_weights(mesh: &Mesh) -> Vec<f64> {
    let Some(attributes) = &mesh.attributes else { return Vec::new() };
    let layer = |kind| attributes.layer(kind);
    let layers = layer(LayerKind::Joints(0)).zip(layer(LayerKind::Weights(0)));
    let Some((joints, weights)) = layers else { return Vec::new() };
    let mut means = vec![0.0; 256];
    let corners: Vec<_> = attributes.corners.iter().flatten().collect();
    for &&wedge in &corners {
        for (joint, weight) in joints.of(wedge).iter().zip(weights.of(wedge)) {
            means[*joint as usize] += f64::from(*weight) / corners.len() as f64;
        }
    }
    means
}

#[test]
fn real_scenes_come_back_whole_from_both_formats() {
    for name in MODELS {
        let Some(path) = shared_mesh(name) else { continue };
        let run = Run::new();
        let was = read(&path, &ReadOptions::default()).unwrap();
        for file in FILES {
            let packed = run.json(&["compress", path.to_str().unwrap(), file, "--bits", "14"]);
            run.json(&["decompress", file, "b.glb"]);
            let (old, new) = (document(&path), document(&run.path("b.glb")));
            assert_eq!(old, new, "{name}, {file}: nodes, materials, skins, animations");
            let is = scene_of(&run, "b.glb");
            let images = |scene: &Scene| -> Vec<_> {
                scene.images.iter().map(|image| image.bytes.clone()).collect()
            };
            assert!(images(&was) == images(&is) && !images(&is).contains(&vec![]), "{name}");
            for (old, new) in was.meshes.iter().zip(&is.meshes) {
                assert_near(old, new, &format!("{name}, {file}"));
            }
            let count = |key: &str| old[key].as_array().map_or(0, Vec::len) as u64;
            for key in ["nodes", "materials", "images", "skins", "animations"] {
                assert_eq!(number(&packed["scene"][key]), count(key), "{name} {key}");
            }
        }
    }
}

fn assert_near(old: &SceneMesh, new: &SceneMesh, what: &str) {
    let [was, is] = [old, new].map(|mesh| mesh.mesh.bounds());
    let near = 1e-3 * was.diagonal();
    for k in 0..3 {
        assert!((was.min[k] - is.min[k]).abs() < near, "{what}: {was:?} {is:?}");
        assert!((was.max[k] - is.max[k]).abs() < near, "{what}: {was:?} {is:?}");
    }
    let faces = [old, new].map(|mesh| mesh.mesh.faces.len());
    assert!(faces[1] <= faces[0] && faces[1] * 100 >= faces[0] * 99, "{what}: {faces:?}");
    let [was, is] = [old, new].map(|mesh| mean_weights(&mesh.mesh));
    assert_eq!(was.len(), is.len(), "{what}");
    let off = was.iter().zip(&is).map(|(was, is)| (was - is).abs()).fold(0.0, f64::max);
    assert!(off < 2e-3, "{what}: weights of joints, {off}");
}

#[test]
fn instances_are_stored_once_and_shown_by_all() {
    let run = Run::new();
    write_two_instances(&run);
    for file in FILES {
        let packed = run.json(&["compress", "in.glb", file]);
        assert_eq!(number(&packed["scene"]["instances"]), 2);
        for out in ["b.glb", "b.obj"] {
            let back = run.json(&["decompress", file, out]);
            assert_eq!(back["faces"], packed["faces"]);
            assert_eq!(number(&back["shown_faces"]), 2 * number(&back["faces"]));
            let far = run.json(&["measure", "in.glb", out, "--samples", "2000"])["max"].as_f64();
            assert!(far.unwrap() < 2e-3, "{file}, {out}: {far:?}");
        }
        let nodes = scene_of(&run, "b.glb").nodes;
        assert_eq!(nodes, scene_of(&run, "in.glb").nodes, "{file}");
    }
}

#[test]
fn contacts_of_instances_stay_at_one_place() {
    let run = Run::new();
    write_two_instances(&run);
    for file in FILES {
        let told = run.run(&["compress", "in.glb", file, "--lock-contacts", "--json"]);
        assert!(told.code == 0 && told.only_line().contains("several nodes show"), "{told:?}");
        let one = number(&run.json(&["info", "in.glb"])["faces"]);
        assert_eq!(number(&told.json()["faces"]), one, "both copies are in the mesh");
        run.json(&["decompress", file, "b.glb"]);
        assert_eq!(number(&run.json(&["info", "b.glb"])["faces"]), one);
    }
}

#[test]
fn damaged_scenes_are_refused_with_one_line() {
    let run = Run::new();
    let placed = place_scene(two_instances(), &Constraints::default(), Options::default()).unwrap();
    let mesh = placed.mesh;
    let whole = placed.rest.unwrap().to_bytes().unwrap();
    let bounds = AttributeBounds::default();
    let resident = compress(&mesh, Scheme::Blocks, CompressionTarget::Bits(11), &bounds).unwrap();
    let files = |scene: &[u8]| {
        let resident: Compressed = resident.compressed.clone().with_resources(scene.to_vec());
        let options = TransportOptions::default();
        let sent = Transport::encode_with_resources(&mesh, scene, &options).unwrap();
        [("a.mlq", resident.to_bytes()), ("a.mlz", sent.bytes)]
    };
    let more = [&whole[..], &[1, 0, 0, 0, 0]].concat();
    let long = [&u32::MAX.to_le_bytes()[..], &whole[4..]].concat();
    let damaged = [&whole[..whole.len() - 1], &whole[..3], &more, &long, b"no scene at all"];
    for (case, scene) in damaged.iter().enumerate() {
        for (file, bytes) in files(scene) {
            std::fs::write(run.path(file), bytes).unwrap();
            let done = run.run(&["decompress", file, "out.glb"]);
            assert_eq!(done.code, 1, "{case}, {file}: {done:?}");
            assert!(done.only_line().contains(file), "{case}, {file}: {done:?}");
        }
    }
    for (file, bytes) in files(&whole) {
        std::fs::write(run.path(file), bytes).unwrap();
        assert!(!run.path("out.glb").exists());
        run.json(&["decompress", file, "out.glb"]);
        std::fs::remove_file(run.path("out.glb")).unwrap();
    }
}

#[test]
fn the_bytes_of_a_scene_do_not_depend_on_the_run() {
    let run = Run::new();
    write_two_instances(&run);
    for file in FILES {
        run.json(&["compress", "in.glb", file]);
        let first = bytes(&run, file);
        run.json(&["compress", "in.glb", file]);
        assert!(bytes(&run, file) == first, "{file}");
    }
}
