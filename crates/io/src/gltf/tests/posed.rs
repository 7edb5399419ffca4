//! Compressed skins and morph targets: posed as renderers do it, vertices are where they were.

use std::collections::BTreeMap;

use glam::{DMat4, DVec3};
use meshlod_fixtures::shared_mesh;
use meshlod_mesh::{LayerKind, Mesh, VertexId, WedgeId};
use serde_json::{Value, json};

use super::{json_of, read_alone, read_parts, square};
use crate::gltf::document::Document;
use crate::gltf::{Compression, write_compressed_glb};
use crate::{ReadOptions, Scene};

const BITS: Compression = Compression {
    position_bits: 12,
    normal_bits: 8,
    uv_bits: 12,
    animation_degrees: 0.1,
    meshopt: false,
    grid: None,
};

fn index(value: &Value) -> usize {
    value.as_u64().unwrap() as usize
}

/// Transforms of all nodes to the world, in the pose of the file.
fn worlds(scene: &Scene) -> Vec<DMat4> {
    let mut worlds = vec![DMat4::IDENTITY; scene.nodes.len()];
    let mut stack: Vec<(usize, DMat4)> =
        scene.roots.iter().map(|&root| (root, DMat4::IDENTITY)).collect();
    while let Some((node, parent)) = stack.pop() {
        worlds[node] = parent * DMat4::from_cols_array_2d(&scene.nodes[node].transform);
        stack.extend(scene.nodes[node].children.iter().map(|&child| (child, worlds[node])));
    }
    worlds
}

/// Corners of the faces of the skinned node that shows a mesh, posed by its skin alone.
fn posed(scene: &Scene, node: usize) -> Vec<[DVec3; 3]> {
    let source = &scene.source.as_ref().unwrap().0;
    let document = Document::new(&source.json, &source.buffers).unwrap();
    let skin = &source.json["skins"][index(&source.json["nodes"][node]["skin"])];
    let worlds = worlds(scene);
    let joints = skin["joints"].as_array().unwrap();
    let inverse = skin.get("inverseBindMatrices").map(|at| document.floats(index(at)).unwrap());
    let matrices: Vec<DMat4> = (joints.iter().enumerate())
        .map(|(i, joint)| {
            let own = |read: &crate::gltf::document::accessor::Values| {
                let values: [f32; 16] = read.values[16 * i..][..16].try_into().unwrap();
                DMat4::from_cols_array(&values.map(f64::from))
            };
            worlds[index(joint)] * inverse.as_ref().map_or(DMat4::IDENTITY, own)
        })
        .collect();
    let mesh = &scene.meshes[scene.nodes[node].mesh.unwrap()].mesh;
    pose(mesh, &matrices)
}

/// Poses the corners of a mesh by the matrices of its joints; weights count by their share, as in
/// renderers.
fn pose(mesh: &Mesh, matrices: &[DMat4]) -> Vec<[DVec3; 3]> {
    let attributes = mesh.attributes.as_ref().unwrap();
    let [joints, weights] =
        [LayerKind::Joints(0), LayerKind::Weights(0)].map(|kind| attributes.layer(kind).unwrap());
    let corner = |v: VertexId, w: WedgeId| {
        let place = DVec3::from(mesh.positions[v.index()]);
        let moved = |joint: f32| matrices[joint as usize].transform_point3(place);
        let parts = joints.of(w).iter().zip(weights.of(w));
        let sum: DVec3 = parts.map(|(&joint, &weight)| moved(joint) * f64::from(weight)).sum();
        sum / weights.of(w).iter().map(|&weight| f64::from(weight)).sum::<f64>()
    };
    let faces = mesh.faces.iter().zip(&attributes.corners);
    faces.map(|(vs, ws)| std::array::from_fn(|i| corner(vs[i], ws[i]))).collect()
}

/// Lists the nodes of a scene with a skin.
fn skinned(scene: &Scene) -> Vec<usize> {
    let nodes = scene.source.as_ref().unwrap().0.json["nodes"].as_array().unwrap();
    (0..nodes.len()).filter(|&node| nodes[node].get("skin").is_some()).collect()
}

/// Largest distance of a posed corner to the nearest corner of the other pose, both ways, by cells.
fn difference(a: &[[DVec3; 3]], b: &[[DVec3; 3]], cell: f64) -> f64 {
    let key = |p: DVec3| (p / cell).round().to_array().map(|x| x as i64);
    let nearest = |from: &[[DVec3; 3]], to: &[[DVec3; 3]]| {
        let mut cells: BTreeMap<[i64; 3], Vec<DVec3>> = BTreeMap::new();
        to.as_flattened().iter().for_each(|&p| cells.entry(key(p)).or_default().push(p));
        let around = |p: &DVec3| {
            let [x, y, z] = key(*p);
            let near = (0..27).map(|i| [x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1]);
            let near = near.filter_map(|at| cells.get(&at)).flatten();
            near.map(|q| q.distance(*p)).fold(f64::INFINITY, f64::min)
        };
        from.as_flattened().iter().map(around).fold(0.0, f64::max)
    };
    nearest(a, b).max(nearest(b, a))
}

/// Compresses and compares the poses; returns what was written.
fn check(scene: &Scene, what: &str) -> Scene {
    for how in [BITS, Compression { meshopt: true, ..BITS }] {
        let (glb, report) = write_compressed_glb(scene, &[], &how).unwrap();
        assert_eq!(report.kept, [""; 0], "{what}");
        let again = read_alone(&glb).unwrap();
        let (old, new) = (skinned(scene), skinned(&again));
        assert_eq!(old.len(), new.len());
        for (&old, &new) in old.iter().zip(&new) {
            let (a, b) = (posed(scene, old), posed(&again, new));
            let corners = a.as_flattened();
            let low = corners.iter().fold(DVec3::INFINITY, |low, &p| low.min(p));
            let high = corners.iter().fold(DVec3::NEG_INFINITY, |high, &p| high.max(p));
            // Cells and bytes of weights: each is worth a part of the size.
            let most = (high - low).length() * (1.0 / 4095.0 + 2.0 / 255.0);
            let off = difference(&a, &b, most);
            assert!(off <= most, "{what}: {off} off, {most} allowed");
        }
        // Also without its skin the mesh is where it was.
        let [old, new] = [scene, &again].map(|scene| scene.flatten().bounds());
        let off = DVec3::from(old.min).distance(new.min.into());
        assert!(off <= old.diagonal() / 4095.0, "{what}: {off} off without skin");
    }
    read_alone(&write_compressed_glb(scene, &[], &BITS).unwrap().0).unwrap()
}

#[test]
fn shared_skins_pose_their_vertices_where_they_were() {
    for name in ["fox.glb", "cesium-man.glb"] {
        let Some(path) = shared_mesh(name) else {
            println!("skipped: {name} is not there");
            continue;
        };
        let scene = crate::read(&path, &ReadOptions::default()).unwrap();
        let small = check(&scene, name);
        let json = &small.source.as_ref().unwrap().0.json;
        assert_eq!(json["skins"].as_array().unwrap().len(), 1);
        check(&small, name);
    }
}

/// Two squares of different sizes with one skin, of two joints that are rotated and moved.
fn squares() -> (Value, Vec<u8>) {
    let (mut json, mut buffer) = square();
    buffer.extend([0u8, 1, 0, 0].repeat(4));
    let weights = [1.0f32, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0].repeat(2);
    buffer.extend(weights.iter().flat_map(|x| x.to_le_bytes()));
    let corners = [[3.0f32, 0.0, 5.0], [9.0, 1.0, 0.0], [0.0, 4.0, 7.0], [1.0, 8.0, 0.5]];
    buffer.extend(corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    for (offset, length) in [(60, 16), (76, 64), (140, 48)] {
        let view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
        json["bufferViews"].as_array_mut().unwrap().push(view);
    }
    for (view, component, shape) in [(2, 5121, "VEC4"), (3, 5126, "VEC4"), (4, 5126, "VEC3")] {
        let accessor =
            json!({ "bufferView": view, "componentType": component, "count": 4, "type": shape });
        json["accessors"].as_array_mut().unwrap().push(accessor);
    }
    json["buffers"][0]["byteLength"] = buffer.len().into();
    let mesh = |position| {
        let attributes = json!({ "POSITION": position, "JOINTS_0": 2, "WEIGHTS_0": 3 });
        json!({ "primitives": [{ "attributes": attributes, "indices": 1 }] })
    };
    json["meshes"] = json!([mesh(0), mesh(4)]);
    json["nodes"] = json!([
        { "mesh": 0, "skin": 0 }, { "mesh": 1, "skin": 0 },
        { "translation": [5, 0, 1], "children": [3] }, { "rotation": [0.0, 0.6, 0.0, 0.8] },
    ]);
    json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    json["skins"] = json!([{ "joints": [2, 3] }]);
    (json, buffer)
}

#[test]
fn meshes_that_share_a_skin_get_one_each() {
    let (json, buffer) = squares();
    let small = check(&read_parts(&json, &buffer).unwrap(), "squares");
    let json = &small.source.as_ref().unwrap().0.json;
    assert_eq!(json["skins"].as_array().unwrap().len(), 2);
    assert_ne!(json["skins"][0], json["skins"][1]);
    assert_eq!(json["skins"][0]["joints"], json["skins"][1]["joints"]);
}

#[test]
fn a_skin_that_stays_for_another_mesh_keeps_its_matrices() {
    let (mut json, buffer) = squares();
    let points = json!({ "mode": 0, "attributes": { "POSITION": 0 } });
    json["meshes"][0]["primitives"].as_array_mut().unwrap().push(points);
    let scene = read_parts(&json, &buffer).unwrap();
    let (glb, report) = write_compressed_glb(&scene, &[], &BITS).unwrap();
    assert_eq!(report.kept.len(), 1);
    let json = json_of(&glb);
    assert_eq!(json["skins"][0], json!({ "joints": [2, 3] }));
    assert_eq!((&json["nodes"][0]["skin"], &json["nodes"][1]["skin"]), (&json!(0), &json!(1)));
}

#[test]
fn morph_targets_move_vertices_as_far_as_they_did() {
    let scene = super::carried::rich();
    let mut json = scene.source.as_ref().unwrap().0.json.clone();
    json["meshes"][0]["primitives"].as_array_mut().unwrap().remove(0);
    let buffer = &scene.source.as_ref().unwrap().0.buffers.held(0);
    let scene = read_parts(&json, buffer).unwrap();
    let (glb, report) = write_compressed_glb(&scene, &[], &BITS).unwrap();
    assert_eq!(report.kept, [""; 0]);
    let written = json_of(&glb);
    let target = &written["meshes"][0]["primitives"][0]["targets"][0]["POSITION"];
    let accessor = &written["accessors"][index(target)];
    assert_eq!(accessor["componentType"], 5122);
    let again = read_alone(&glb).unwrap();
    let shown = again.instances()[0].mesh;
    let layers = &again.meshes[shown].mesh.attributes.as_ref().unwrap().layers;
    let deltas = layers.iter().find(|layer| layer.name == "target 0 POSITION").unwrap();
    let cell = written["nodes"].as_array().unwrap().iter().find_map(|n| n["scale"][0].as_f64());
    let cell = cell.unwrap();
    for delta in deltas.values.as_chunks::<3>().0 {
        let moved = delta.map(|x| f64::from(x) * cell);
        assert!(moved[0] == 0.0 && moved[1] == 0.0, "{moved:?}");
        assert!((moved[2] - 0.5).abs() <= 0.5 * cell, "{moved:?}");
    }
}

#[test]
fn a_target_far_larger_than_its_mesh_keeps_floats() {
    let (mut json, mut buffer) = square();
    buffer.extend([1e30f32; 12].iter().flat_map(|x| x.to_le_bytes()));
    json["buffers"][0]["byteLength"] = buffer.len().into();
    let view = json!({ "buffer": 0, "byteOffset": 60, "byteLength": 48 });
    json["bufferViews"].as_array_mut().unwrap().push(view);
    let accessor = json!({ "bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC3",
                           "min": [1e30, 1e30, 1e30], "max": [1e30, 1e30, 1e30] });
    json["accessors"].as_array_mut().unwrap().push(accessor);
    json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 2 }]);
    let scene = read_parts(&json, &buffer).unwrap();
    let (_, report) = write_compressed_glb(&scene, &[], &BITS).unwrap();
    assert!(report.kept[0].contains("morph target"), "{report:?}");
}
