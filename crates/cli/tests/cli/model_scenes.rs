//! Scenes through multiresolution files: built, and extracted again.

use std::path::Path;

use meshlod::{ReadOptions, Scene};
use meshlod_fixtures::shared_mesh;

use crate::documents::document;
use crate::models::{bytes, extract, number, write};
use crate::run::Run;

const MODELS: [&str; 5] = [
    "fox.glb",
    "cesium-man.glb",
    "cesium-milk-truck.glb",
    "duck.glb",
    "flight-helmet/FlightHelmet.gltf",
];

fn read(path: &Path) -> Scene {
    meshlod::read(path, &ReadOptions::default()).unwrap()
}

#[test]
fn real_scenes_come_back_whole() {
    for name in MODELS {
        let Some(path) = shared_mesh(name) else { continue };
        let run = Run::new();
        let input = path.to_str().unwrap();
        // Otherwise faces without which nothing changes in the file's pose are left out.
        let built = run.json(&["build", input, "a.mlod", "--estimates", "--lossless"]);
        extract(&run, "a.mlod", "b.glb", &["--error", "0"]);
        let (old, new) = (document(&path), document(&run.path("b.glb")));
        assert_eq!(old, new, "{name}: nodes, materials, skins, animations");
        let [old, new] = [read(&path), read(&run.path("b.glb"))];
        assert!(old.images == new.images || name.starts_with("flight"), "{name}");
        let contents = |scene: &Scene| -> Vec<_> {
            scene.images.iter().map(|image| image.bytes.clone()).collect()
        };
        assert!(contents(&old) == contents(&new) && !contents(&new).contains(&vec![]), "{name}");
        for (old, new) in old.meshes.iter().zip(&new.meshes) {
            // All bits, but for next to nothing, where the help says that they may differ.
            let nothing = old.mesh.bounds().diagonal() / f64::from(1 << 26);
            let bits = |x: f64| if x.abs() < nothing { 0 } else { x.to_bits() };
            let mut places = [old, new].map(|mesh| {
                let used = mesh.mesh.faces.iter().flatten().map(|v| mesh.mesh.positions[v.index()]);
                used.map(|p| p.map(bits)).collect::<Vec<_>>()
            });
            places.iter_mut().for_each(|places| places.sort_unstable());
            assert!(places[0] == places[1], "{name}: {}", old.name);
        }
        let count = |key: &str| document(&path)[key].as_array().map_or(0, Vec::len) as u64;
        for key in ["nodes", "materials", "images", "skins", "animations"] {
            assert_eq!(number(&built["scene"][key]), count(key), "{name} {key}");
        }
    }
}

#[test]
fn counts_say_where_a_mesh_counts_once() {
    let Some(path) = shared_mesh("cesium-milk-truck.glb") else {
        println!("skipped: the milk truck is not there");
        return;
    };
    let run = Run::new();
    run.json(&["build", path.to_str().unwrap(), "truck.mlod"]);
    let once = extract(&run, "truck.mlod", "truck.glb", &["--error", "0"]);
    let info = run.json(&["info", "truck.mlod"]);
    assert_eq!((&info["faces"], &info["stored"]["faces"]), (&once["shown_faces"], &once["faces"]));
    assert_ne!(once["shown_faces"], once["faces"]);
    let text = run.run(&["info", "truck.mlod"]);
    assert!(text.text().contains("faces, each mesh once"), "{text:?}");
    let walk = run.json(&["strip", "truck.mlod", "--follow", "0"]);
    assert_eq!(
        (&walk["cuts"][0]["triangles"], &walk["each_mesh_once"]),
        (&once["faces"], &true.into())
    );
    let strips = run.json(&["strip", "truck.mlod", "--error", "0"]);
    assert_eq!(strips["input_faces"], once["shown_faces"]);
}

#[test]
fn what_is_cut_off_of_a_scene_is_missed_by_every_verb() {
    let Some(path) = shared_mesh("duck.glb") else {
        println!("skipped: the duck is not there");
        return;
    };
    let run = Run::new();
    run.json(&["build", path.to_str().unwrap(), "duck.mlod"]);
    let whole = bytes(&run, "duck.mlod");
    let (mut scene, mut images) = (0, 0);
    for part in 1..16 {
        write(&run, "short.mlod", &whole[..whole.len() * part / 16]);
        let taken = run.run(&["extract", "short.mlod", "out.glb", "--error", "0", "--json"]);
        if taken.code != 0 {
            continue;
        }
        for verb in [&["check"][..], &["strip", "--follow", "1%"], &["info"]] {
            let done = run.run(&[&[verb[0], "short.mlod"], &verb[1..]].concat());
            assert_eq!((done.code, &done.err), (0, &taken.err), "{verb:?} {part}");
        }
        let missing = &run.json(&["check", "short.mlod"])["scene_missing"];
        scene += u32::from(missing["scene"] == true);
        images += u32::from(missing["images"] == 1 || missing["previews"] == 1);
        assert_eq!(run.run(&["check", "short.mlod", "--strict"]).code, 1);
    }
    assert!(images > 1, "{scene} without a scene, {images} without an image");
    // Damage is found wherever it is.
    for part in 1..16 {
        let mut wrong = whole.clone();
        wrong[whole.len() * part / 16] ^= 1;
        write(&run, "wrong.mlod", &wrong);
        assert_eq!(run.run(&["check", "wrong.mlod"]).code, 1, "{part}");
    }
}

#[test]
fn images_are_no_bytes_of_vertices() {
    let Some(path) = shared_mesh("duck.glb") else {
        println!("skipped: the duck is not there");
        return;
    };
    let run = Run::new();
    let built = run.json(&["build", path.to_str().unwrap(), "a.mlod"]);
    let scene = number(&built["scene_bytes"]);
    let surface = number(&built["bytes"]) - scene;
    let each = surface as f64 / number(&built["input_vertices"]) as f64;
    assert_eq!(built["bytes_per_vertex"], each);
    let largest = read(&path).images.iter().map(|image| image.bytes.len() as u64).max();
    assert!(Some(scene) >= largest && each < 20.0, "{built}");
}

#[test]
fn a_gltf_file_has_its_images_beside_it() {
    let Some(path) = shared_mesh("flight-helmet/FlightHelmet.gltf") else { return };
    let run = Run::new();
    run.json(&["build", path.to_str().unwrap(), "a.mlod", "--estimates"]);
    extract(&run, "a.mlod", "b.gltf", &["--faces", "5000"]);
    let images = run.files().iter().filter(|name| name.ends_with(".png")).count();
    assert_eq!(images, 15);
    assert_eq!(read(&run.path("b.gltf")).images, read(&path).images);
}

#[test]
fn instances_are_stored_once_and_shown_by_all() {
    let Some(path) = shared_mesh("cesium-milk-truck.glb") else { return };
    let run = Run::new();
    let built = run.json(&["build", path.to_str().unwrap(), "a.mlod", "--estimates"]);
    let scene = &built["scene"];
    assert_eq!((number(&scene["meshes"]), number(&scene["instances"])), (2, 3));
    let all = ["--faces", "1000000"];
    let [glb, obj] = ["b.glb", "b.obj"].map(|out| extract(&run, "a.mlod", out, &all));
    assert!(glb["shown_faces"] == obj["shown_faces"]);
    assert!(number(&glb["shown_faces"]) > number(&glb["faces"]));
    for out in ["b.glb", "b.obj"] {
        assert_eq!(run.json(&["info", out])["faces"], glb["shown_faces"], "{out}");
    }
    let measured = run.json(&["measure", "b.glb", "b.obj", "--samples", "2000"]);
    let far = measured["max"].as_f64().unwrap();
    assert!(far < 1e-5, "{far}");
}

/// Writes a scene that shows a sphere at these places along z.
fn spheres(run: &Run, name: &str, places: &[f64]) {
    let mut scene = Scene::from_mesh("sphere", meshlod::samples::sphere(6000));
    let node = scene.nodes[0].clone();
    let place = |&z: &f64| {
        let mut node = node.clone();
        node.transform[3][2] = z;
        node
    };
    scene.nodes = places.iter().map(place).collect();
    scene.roots = (0..places.len()).collect();
    write(run, name, &meshlod::io::gltf::write_glb(&scene, &[]).unwrap());
}

#[test]
fn cameras_and_regions_count_for_every_instance() {
    let run = Run::new();
    let camera = ["--error", "1px", "--camera", "eye=0,0,4 look=0,0,0 fov=45 1920x1080"];
    let only = ["--error", "0.01%", "--focus", "sphere=0,0,0,1.5", "--only"];
    let point = ["--error", "0.01%", "--focus", "point=0,0,2", "--only"];
    for query in [&camera[..], &only[..], &point[..]] {
        let faces = |places: &[f64]| {
            spheres(&run, "in.glb", places);
            run.json(&["build", "in.glb", "a.mlod", "--lossless"]);
            let found = extract(&run, "a.mlod", "b.glb", query);
            assert_ne!(found["error"]["kept"], false, "{found}");
            number(&found["faces"])
        };
        let [alone, near, far] = [&[0.0][..], &[0.0, -1000.0], &[-1000.0, 0.0]].map(faces);
        assert!(alone == near && alone == far && alone > 0, "{query:?}: {alone} {near} {far}");
    }
}

#[test]
fn nodes_of_meshes_that_are_cut_away_show_nothing() {
    let run = Run::new();
    let mut scene = Scene::from_mesh("near", meshlod::samples::sphere(300));
    scene.nodes.push(scene.nodes[0].clone());
    scene.meshes.push(scene.meshes[0].clone());
    scene.nodes[1].mesh = Some(1);
    scene.nodes[1].transform[3][0] = 9.0;
    scene.roots.push(1);
    write(&run, "in.glb", &meshlod::io::gltf::write_glb(&scene, &[]).unwrap());
    run.json(&["build", "in.glb", "a.mlod"]);
    let only = ["--error", "0", "--focus", "sphere=0,0,0,1.2", "--only"];
    let found = extract(&run, "a.mlod", "b.glb", &only);
    let nodes = &document(&run.path("b.glb"))["nodes"];
    assert!(nodes[0]["mesh"] == 0 && nodes[1].get("mesh").is_none(), "{nodes}");
    assert_eq!(run.json(&["info", "b.glb"])["faces"], found["faces"]);
}

#[test]
fn the_pose_for_which_errors_hold_is_told() {
    let Some(path) = shared_mesh("fox.glb") else { return };
    let run = Run::new();
    let told = run.run(&["build", path.to_str().unwrap(), "a.mlod", "--estimates"]);
    let line = "errors hold in the pose of the file, not in those of 1 skinned mesh, 3 animations";
    assert!(told.code == 0 && told.text().contains(line), "{told:?}");
    run.sample("torus", 200, "torus.ply");
    let told = run.run(&["build", "torus.ply", "b.mlod"]);
    assert!(told.code == 0 && !told.text().contains("scene:"), "{told:?}");
}

#[test]
fn errors_are_measured_over_the_poses_of_animations() {
    let run = Run::new();
    let strip = meshlod_fixtures::folding_strip(40);
    write(&run, "strip.glb", &strip);
    let told = run.run(&["build", "strip.glb", "a.mlod"]);
    let line = "errors measured over 6 poses of 1 animation";
    assert!(told.code == 0 && told.text().contains(line), "{told:?}");
    assert!(told.text().contains("may be exceeded in poses between"), "{told:?}");
    let told = run.run(&["check", "a.mlod"]);
    assert!(told.code == 0 && told.text().contains(line), "{told:?}");
    let poses = serde_json::json!({ "measured": 6, "animations": 1 });
    assert_eq!(run.json(&["build", "strip.glb", "a.mlod"])["poses"], poses);
    assert_eq!(run.json(&["check", "a.mlod"])["poses"], poses);
    let few = extract(&run, "a.mlod", "few.glb", &["--faces", "30"]);
    let stored = few["error"]["poses"]["error"].as_f64().unwrap();
    let apart = run.json(&["measure", "strip.glb", "few.glb", "--poses", "8", "--samples", "3000"]);
    let far = apart["max"].as_f64().unwrap();
    assert!(stored >= 0.5 * far && stored <= 4.0 * far + 1e-3, "{stored}, measured {far}");
    let told = run.run(&["extract", "a.mlod", "few.glb", "--faces", "30"]);
    assert!(told.text().contains("in the pose of the file, measured"), "{told:?}");
    assert!(told.text().contains("over 6 poses of 1 animation"), "{told:?}");
    // Without animations, the pose of its nodes counts.
    let mut still = strip.clone();
    let at = still.windows(12).position(|bytes| bytes == b"\"animations\"").unwrap();
    still[at + 1] = b'x';
    write(&run, "still.glb", &still);
    let poses = serde_json::json!({ "measured": 1, "animations": 0 });
    assert_eq!(run.json(&["build", "still.glb", "s.mlod"])["poses"], poses);
    for kind in ["--estimates", "--bounds"] {
        let built = run.json(&["build", "strip.glb", "b.mlod", kind]);
        assert!(built["poses"].is_null(), "{kind}: {built}");
    }
    // An animation without samplers.
    let mut damaged = strip;
    let at = damaged.windows(8).position(|bytes| bytes == b"samplers").unwrap();
    damaged[at] = b'x';
    write(&run, "damaged.glb", &damaged);
    let told = run.run(&["build", "damaged.glb", "c.mlod"]);
    assert!(told.code == 0 && told.err.contains("sampler 0 is not there"), "{told:?}");
}

#[test]
fn truncated_files_say_what_they_lack() {
    let Some(path) = shared_mesh("fox.glb") else { return };
    let run = Run::new();
    run.json(&["build", path.to_str().unwrap(), "a.mlod", "--estimates", "--in-chunk", "50"]);
    let whole = bytes(&run, "a.mlod");
    let (mut faces, mut lines) = (0, Vec::new());
    for end in (0..whole.len()).step_by(1009) {
        write(&run, "part.mlod", &whole[..end]);
        let done = run.run(&["extract", "part.mlod", "b.glb", "--error", "0", "--json"]);
        if done.code != 0 {
            assert!(faces == 0 && done.only_line().contains("truncated"), "{done:?}");
            continue;
        }
        let found = number(&done.json()["faces"]);
        assert!(found >= faces, "{found} after {faces}");
        faces = found;
        lines.push(done.err.clone());
        assert!(run.run(&["render", "b.glb", "b.png", "--size", "64x64"]).code == 0);
    }
    let told = |what: &str| lines.iter().filter(|line| line.contains(what)).count();
    assert!(told("set of animations") > 3 && told("smaller version") > 3, "{lines:?}");
}

#[test]
fn images_that_are_not_found_are_told() {
    let run = Run::new();
    write(&run, "in.mtl", b"newmtl sea\nmap_Kd sea.png\n");
    let obj = "mtllib in.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl sea\nf 1 2 3\n";
    write(&run, "in.obj", obj.as_bytes());
    let told = run.run(&["build", "in.obj", "a.mlod"]);
    assert!(
        told.code == 0 && told.only_line().contains("1 image that was not found or cannot be used"),
        "{told:?}"
    );
    extract(&run, "a.mlod", "b.obj", &["--error", "0"]);
    let library = String::from_utf8(bytes(&run, "b.mtl")).unwrap();
    assert!(library.contains("map_Kd sea.png"), "{library}");
}
