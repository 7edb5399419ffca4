//! Packed animations.

use serde_json::{Value, json};

use crate::gltf::animation::packing::key_track::{KeyTrack, arc, distance, nearer};
use crate::gltf::animation::packing::properties;
use crate::gltf::document::Document;
use crate::gltf::write::settings::Compression;
use crate::gltf::write::write_compressed_glb;
use crate::{Format, ReadOptions, Scene, read_bytes};

const DEGREES: f64 = 0.1;

fn packing(meshopt: bool) -> Compression {
    Compression { animation_degrees: DEGREES, meshopt, ..Compression::default() }
}

/// Lists the tracks of all samplers, by animation and sampler.
fn tracks(scene: &Scene) -> Vec<((usize, usize), Option<KeyTrack>)> {
    let contents = &scene.source.as_ref().unwrap().0;
    let document = Document::new(&contents.json, &contents.buffers).unwrap();
    let animations = contents.json["animations"].as_array().unwrap();
    let mut tracks = Vec::new();
    for (a, animation) in animations.iter().enumerate() {
        for (sampler, property) in properties(animation) {
            let read = |p| KeyTrack::read(&document, &animation["samplers"][sampler], p);
            tracks.push(((a, sampler), property.and_then(read)));
        }
    }
    tracks
}

/// Returns the largest error of a rotation in radians, or that of a vector.
fn error(old: &KeyTrack, new: &KeyTrack) -> f64 {
    let times: Vec<f64> = old.times.iter().map(|&time| f64::from(time)).collect();
    let between =
        times.windows(2).flat_map(|w| (0..8).map(|i| w[0] + (w[1] - w[0]) * 0.125 * f64::from(i)));
    let at = |time: f64| {
        let (a, b) = (old.at(time), new.at(time));
        if old.is_rotation() { 2.0 * arc(a, nearer(a, b)) } else { distance(a, b) }
    };
    between.chain(times.last().copied()).map(at).fold(0.0, f64::max)
}

/// Packs a scene, compares every track at and between all keys, and returns the packed scene.
fn check(scene: &Scene, meshopt: bool) -> Scene {
    let (bytes, _) = write_compressed_glb(scene, &[], &packing(meshopt)).unwrap();
    let packed =
        read_bytes(&bytes, Format::Glb, &mut |_: &str| None, &ReadOptions::default()).unwrap();
    let (old, new) = (tracks(scene), tracks(&packed));
    assert_eq!(old.len(), new.len());
    let limit = DEGREES.to_radians() * 1.001;
    for ((place, old), (_, new)) in old.into_iter().zip(new) {
        let (Some(old), Some(new)) = (old, new) else { continue };
        let size = old.poses.iter().map(|&pose| distance(pose, [0.0; 4])).fold(0.0, f64::max);
        let limit = if old.is_rotation() { limit } else { limit * size };
        let error = error(&old, &new);
        assert!(error <= limit, "{place:?}: {error} exceeds {limit}");
        assert!(new.times.len() <= old.times.len());
    }
    packed
}

/// Makes a document of two triangles' worth of node with an animation of these samplers.
fn animated(samplers: &[(&str, &str, &[f32], Vec<f32>)]) -> Scene {
    let mut bytes: Vec<u8> = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let mut accessors = vec![
        json!({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}),
    ];
    let mut views = vec![json!({"buffer": 0, "byteLength": 36})];
    let mut array = |values: &[f32], shape: &str, width: usize| {
        views.push(json!({"buffer": 0, "byteOffset": bytes.len(), "byteLength": 4 * values.len()}));
        bytes.extend(values.iter().flat_map(|x| x.to_le_bytes()));
        accessors.push(json!({"bufferView": views.len() - 1, "componentType": 5126, "count": values.len() / width, "type": shape}));
        accessors.len() - 1
    };
    let (mut all, mut channels) = (Vec::new(), Vec::new());
    for (path, interpolation, times, values) in samplers {
        let input = array(times, "SCALAR", 1);
        let (shape, width) = if *path == "rotation" { ("VEC4", 4) } else { ("VEC3", 3) };
        let output = array(values, shape, width);
        channels.push(json!({"sampler": all.len(), "target": {"node": 0, "path": path}}));
        all.push(json!({"input": input, "output": output, "interpolation": interpolation}));
    }
    let text = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "animations": [{"name": "clip", "samplers": all, "channels": channels}],
        "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": bytes.len(), "uri": "b.bin"}],
    });
    let text = serde_json::to_vec(&text).unwrap();
    read_bytes(&text, Format::Gltf, &mut |_: &str| Some(bytes.clone()), &ReadOptions::default())
        .unwrap()
}

fn sampler(scene: &Scene, sampler: usize) -> Value {
    scene.source.as_ref().unwrap().0.json["animations"][0]["samplers"][sampler].clone()
}

/// Rotations about z by these angles in radians.
fn about_z(angles: impl IntoIterator<Item = f64>) -> Vec<f32> {
    let q = |angle: f64| [0.0, 0.0, (0.5 * angle).sin() as f32, (0.5 * angle).cos() as f32];
    angles.into_iter().flat_map(q).collect()
}

#[test]
fn poses_stay_within_the_error_and_needless_keys_go() {
    let times: Vec<f32> = (0..200).map(|i| i as f32 / 24.0).collect();
    let swing = about_z((0..200).map(|i| (f64::from(i) * 0.1).sin()));
    let even = about_z((0..200).map(|i| f64::from(i) * 0.01));
    let line = (0..200).flat_map(|i| [i as f32, 1.0, 0.0]).collect();
    let still = [2.0f32, 2.0, 2.0].repeat(200);
    let jump = (0..200).flat_map(|i| [if i < 100 { 1.0f32 } else { 3.0 }, 1.0, 1.0]).collect();
    let scene = animated(&[
        ("rotation", "LINEAR", &times, swing),
        ("rotation", "LINEAR", &times, even),
        ("translation", "LINEAR", &times, line),
        ("scale", "LINEAR", &times, still),
        ("scale", "STEP", &times, jump),
    ]);
    for meshopt in [false, true] {
        let packed = tracks(&check(&scene, meshopt));
        let counts: Vec<usize> =
            packed.iter().map(|(_, t)| t.as_ref().unwrap().times.len()).collect();
        assert!(counts[0] > 10 && counts[0] < 190, "{counts:?}");
        assert!(counts[1] <= 3 && counts[2] <= 3 && counts[4] <= 3, "{counts:?}");
        assert_eq!(counts[3], 1, "{counts:?}");
    }
}

#[test]
fn a_clip_keeps_its_length_when_nothing_moves() {
    let scene = animated(&[
        ("scale", "LINEAR", &[0.5, 2.0, 7.0], [1.0f32; 9].to_vec()),
        ("translation", "LINEAR", &[0.0, 1.0], [0.0f32; 6].to_vec()),
    ]);
    let packed = tracks(&check(&scene, true));
    let times: Vec<f32> =
        packed.iter().flat_map(|(_, t)| t.as_ref().unwrap().times.clone()).collect();
    assert!(times.contains(&0.0) && times.contains(&7.0), "{times:?}");
}

#[test]
fn half_turns_and_fast_spins_stay_within_the_error() {
    let times: Vec<f32> = (0..40).map(|i| i as f32).collect();
    for step in [3.0, 3.1, std::f64::consts::PI, 1.0] {
        let spin = about_z((0..40).map(|i| f64::from(i) * step));
        check(&animated(&[("rotation", "LINEAR", &times, spin)]), true);
    }
}

#[test]
fn what_is_not_understood_stays_bit_for_bit() {
    let scene = animated(&[
        ("translation", "CUBICSPLINE", &[0.0, 1.0], [1.0f32; 18].to_vec()),
        ("translation", "LINEAR", &[1.0, 1.0], [1.0f32; 6].to_vec()),
        ("translation", "LINEAR", &[0.0, 1.0, 2.0], [1.0f32; 6].to_vec()),
        ("translation", "LINEAR", &[0.0, 1.0], vec![f32::NAN; 6]),
        ("rotation", "LINEAR", &[0.0, 1.0], [0.0f32; 8].to_vec()),
        ("weights", "LINEAR", &[0.0, 1.0], [0.0f32; 6].to_vec()),
    ]);
    let packed = check(&scene, true);
    for at in 0..6 {
        assert_eq!(sampler(&scene, at), sampler(&packed, at));
    }
}

#[test]
fn shared_models_keep_their_poses() {
    for name in ["fox.glb", "cesium-man.glb", "cesium-milk-truck.glb"] {
        let Some(path) = meshlod_fixtures::shared_mesh(name) else {
            eprintln!("skipped: {name} is not there");
            continue;
        };
        let scene = crate::read(&path, &ReadOptions::default()).unwrap();
        check(&scene, true);
        check(&scene, false);
    }
}
