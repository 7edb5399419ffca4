//! Compressed scenes: every corner reads back within the error that the bits allow.

use glam::DVec3;
use meshlod_fixtures::{cube, seam_strip, shared_mesh, two_objects};
use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh, WedgeId};
use serde_json::{Value, json};

use super::{json_of, levels, read_alone, read_parts, square};
use crate::gltf::{
    Compression, QuantizedPart, write_compressed, write_compressed_glb, write_parts_glb,
};
use crate::{ReadOptions, Scene};

const PLAIN: Compression = Compression {
    position_bits: 12,
    normal_bits: 8,
    uv_bits: 12,
    animation_degrees: 0.1,
    meshopt: false,
    grid: None,
};
const PACKED: Compression = Compression { meshopt: true, ..PLAIN };

/// Numbers all wedges of all meshes, so that they can be identified after reading.
fn numbered(mut scene: Scene) -> Scene {
    let mut numbers = 0..;
    for mesh in scene.meshes.iter_mut().map(|mesh| &mut mesh.mesh) {
        let corners = || mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
        let count = mesh.positions.len();
        let attributes = mesh.attributes.get_or_insert_with(|| Attributes {
            corners: corners(),
            wedge_count: count,
            layers: Vec::new(),
        });
        let values =
            (0..attributes.wedge_count).filter_map(|_| numbers.next()).map(|n| n as f32).collect();
        let name = "_NUMBER".to_owned();
        attributes.layers.push(Layer { kind: LayerKind::Other, name, width: 1, values });
    }
    scene
}

fn number_layer(mesh: &Mesh) -> &Layer {
    let layers = &mesh.attributes.as_ref().unwrap().layers;
    layers.iter().find(|layer| layer.name == "_NUMBER").unwrap()
}

/// Lists the wedge numbers of each face, smallest first, with its corners in world space.
fn faces(scene: &Scene) -> Vec<([u32; 3], [DVec3; 3])> {
    let flat = scene.flatten();
    let numbers = number_layer(&flat);
    let corners = &flat.attributes.as_ref().unwrap().corners;
    let mut faces: Vec<_> = (flat.faces.iter().zip(corners))
        .map(|(&face, wedges)| {
            let number = wedges.map(|w| numbers.of(w)[0] as u32);
            let first = (0..3).min_by_key(|&i| number[i]).unwrap_or(0);
            let turn = |i| (first + i) % 3;
            let places = flat.triangle(face);
            ([0, 1, 2].map(|i| number[turn(i)]), [0, 1, 2].map(|i| places[turn(i)]))
        })
        .collect();
    faces.sort_by_key(|&(numbers, _)| numbers);
    faces
}

/// Returns the values of a layer by wedge number, for a scene with one mesh.
fn values(scene: &Scene, kind: LayerKind) -> Vec<(u32, Vec<f32>)> {
    let mesh = &scene.meshes[0].mesh;
    let layer = mesh.attributes.as_ref().unwrap().layer(kind).unwrap();
    let wedges = (0..mesh.attributes.as_ref().unwrap().wedge_count).map(|w| WedgeId(w as u32));
    let mut all: Vec<_> =
        wedges.map(|w| (number_layer(mesh).of(w)[0] as u32, layer.of(w).to_vec())).collect();
    all.sort_by_key(|&(number, _)| number);
    all.dedup_by_key(|&mut (number, _)| number);
    all
}

/// Writes compressed and reads again; every corner must be within half a cell per axis.
fn check(scene: &Scene, how: &Compression, what: &str) -> Scene {
    let (glb, report) = write_compressed_glb(scene, &[], how).unwrap();
    let again = read_alone(&glb).unwrap();
    let (old, new) = (faces(scene), faces(&again));
    assert_eq!(old.len(), new.len(), "{what}");
    let bounds = |faces: &[([u32; 3], [DVec3; 3])]| {
        let points = faces.iter().flat_map(|(_, places)| places);
        points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)))
    };
    let (low, high) = bounds(&old);
    // Nodes may scale: half a cell of the largest mesh in world space, plus 32-bit rounding.
    let cells = f64::from((1u32 << how.position_bits) - 1);
    let most = (high - low).length() * (0.5 * 3f64.sqrt() / cells + 1e-6)
        + low.abs().max(high.abs()).max_element() * 1e-6;
    // Instances share their numbers; each corner must match one of them.
    let rest = new;
    for (numbers, places) in &old {
        let start = rest.partition_point(|(other, _)| other < numbers);
        let off = |found: &[DVec3; 3]| {
            (0..3).map(|i| (places[i] - found[i]).length()).fold(0.0, f64::max)
        };
        let same = rest[start..].iter().take_while(|(other, _)| other == numbers);
        let nearest = same.map(|(_, found)| off(found)).fold(f64::INFINITY, f64::min);
        assert!(nearest <= most, "{what}: {numbers:?} is {nearest} off, {most} allowed");
    }
    let total = report.positions.stored + report.connectivity.stored + report.attributes.stored;
    let sides = scene.meshes.iter().map(|mesh| mesh.mesh.bounds().diagonal());
    let moved = 0.866_03 / cells * sides.fold(0.0, f64::max);
    assert!(total > 0 && report.max_position_error <= moved, "{what}: {report:?}");
    again
}

#[test]
fn shared_scenes_come_back_within_their_cells() {
    for name in [
        "duck.glb",
        "fox.glb",
        "cesium-man.glb",
        "cesium-milk-truck.glb",
        "city.glb",
        "dragon-attenuation.glb",
        "flight-helmet/FlightHelmet.gltf",
    ] {
        let Some(path) = shared_mesh(name) else {
            println!("skipped: {name} is not there");
            continue;
        };
        let scene = numbered(crate::read(&path, &ReadOptions::default()).unwrap());
        for how in [PLAIN, PACKED] {
            check(&scene, &how, name);
        }
    }
}

/// A square with normals, colours and two sets of texture coordinates, one of which repeats.
fn dressed() -> Scene {
    let mut mesh = cube();
    let count = mesh.positions.len();
    let layer = |kind, width, value: fn(usize) -> f32| Layer {
        kind,
        name: String::new(),
        width,
        values: (0..count * width).map(value).collect(),
    };
    let mut normals = layer(LayerKind::Normal, 3, |i| (i as f32 * 1.7).sin());
    for normal in normals.values.as_chunks_mut::<3>().0 {
        let length = normal.iter().map(|x| x * x).sum::<f32>().sqrt();
        *normal = normal.map(|x| x / length);
    }
    mesh.attributes = Some(Attributes {
        corners: mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect(),
        wedge_count: count,
        layers: vec![
            normals,
            layer(LayerKind::Uv(0), 2, |i| i as f32 / 16.3),
            layer(LayerKind::Uv(1), 2, |i| i as f32 / 3.3 - 1.0),
            layer(LayerKind::Color(0), 3, |i| i as f32 / 23.0),
        ],
    });
    numbered(Scene::from_mesh("dressed", mesh))
}

#[test]
fn attributes_come_back_within_their_bits() {
    let scene = dressed();
    for how in [PLAIN, PACKED, Compression { normal_bits: 12, uv_bits: 8, ..PACKED }] {
        let again = check(&scene, &how, "dressed");
        let uv = 0.5 / f64::from(1u32 << how.uv_bits) * 1.01;
        let normal = if how.normal_bits == 8 { 0.012 } else { 0.0012 };
        for (kind, most) in [
            (LayerKind::Normal, normal),
            (LayerKind::Uv(0), uv.max(1e-7)),
            (LayerKind::Uv(1), uv),
            (LayerKind::Color(0), 0.5 / 255.0 + 1e-6),
        ] {
            for (a, b) in values(&scene, kind).iter().zip(values(&again, kind)) {
                assert_eq!(a.0, b.0);
                for (x, y) in a.1.iter().zip(&b.1) {
                    assert!(f64::from((x - y).abs()) <= most, "{kind:?}: {x} became {y}");
                }
            }
        }
    }
}

#[test]
fn what_is_asked_for_is_what_is_in_the_file() {
    let scene = dressed();
    let (plain, a) = write_compressed_glb(&scene, &[], &PLAIN).unwrap();
    let (packed, b) = write_compressed_glb(&scene, &[], &PACKED).unwrap();
    assert_eq!(json_of(&plain)["extensionsRequired"], json!(["KHR_mesh_quantization"]));
    let both = json!(["KHR_mesh_quantization", "EXT_meshopt_compression"]);
    assert_eq!(json_of(&packed)["extensionsRequired"], both);
    assert_eq!(json_of(&packed)["extensionsUsed"], both);
    assert_eq!(json_of(&packed)["buffers"][1].get("uri"), None);
    assert_eq!((a.positions.resident, a.connectivity.resident), (8 * 8, 36 * 2));
    assert_eq!(a.positions.resident, b.positions.resident);
    assert_eq!(a.positions.resident, a.positions.stored);
    assert!(b.connectivity.stored < a.connectivity.stored);
    let (bytes, _) =
        write_compressed_glb(&scene, &[], &Compression { position_bits: 8, ..PLAIN }).unwrap();
    let positions = &json_of(&bytes)["accessors"][0];
    assert_eq!(
        (&positions["componentType"], &positions["max"]),
        (&json!(5121), &json!([255.0, 255.0, 255.0]))
    );
    let (written, _) = write_compressed(&scene, &[], "a b", &PACKED).unwrap();
    assert_eq!(written.buffer.unwrap().0, "a b.bin");
}

#[test]
fn primitives_that_met_still_meet() {
    let scene = numbered(Scene::from_mesh("two", two_objects()));
    let how = Compression { position_bits: 3, ..PACKED };
    let (glb, _) = write_compressed_glb(&scene, &[], &how).unwrap();
    let again = read_alone(&glb).unwrap();
    let mut places = std::collections::BTreeMap::new();
    for ((_, old), (_, new)) in faces(&scene).iter().zip(faces(&again)) {
        for (old, new) in old.iter().zip(new) {
            let bits = |p: DVec3| p.to_array().map(f64::to_bits);
            assert_eq!(*places.entry(bits(*old)).or_insert(bits(new)), bits(new));
        }
    }
}

/// Numbered square after a change to its JSON.
fn square_with(change: impl FnOnce(&mut Value)) -> Scene {
    let (mut json, buffer) = square();
    change(&mut json);
    numbered(read_parts(&json, &buffer).unwrap())
}

#[test]
fn nodes_that_are_more_than_a_place_give_the_mesh_to_a_child() {
    type Change = fn(&mut Value);
    let changes: [Change; 4] = [
        |j| j["nodes"] = json!([{ "mesh": 0, "children": [1] }, { "mesh": 0, "scale": [2, 1, 1] }]),
        |j| j["nodes"][0]["rotation"] = json!([0.0, 0.6, 0.0, 0.8]),
        |j| j["nodes"][0]["matrix"] = json!([1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]),
        |j| {
            j["animations"] = json!([{
                "samplers": [{ "input": 1, "output": 0 }],
                "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }],
            }]);
        },
    ];
    for change in changes {
        let scene = square_with(change);
        let again = check(&scene, &PACKED, "square");
        assert!(again.nodes.len() > scene.nodes.len());
        assert_eq!(again.nodes[0].transform, scene.nodes[0].transform);
        check(&again, &PACKED, "square once more");
    }
    let free = check(&square_with(|_| {}), &PACKED, "free");
    assert_eq!(free.nodes.len(), 1);
}

#[test]
fn meshes_that_no_node_can_scale_keep_their_floats_and_the_report_says_so() {
    type Change = fn(&mut Value);
    let changes: [(&str, Change); 4] = [
        ("points or lines", |j| {
            let lines = json!({ "mode": 1, "attributes": { "POSITION": 0 } });
            j["meshes"][0]["primitives"].as_array_mut().unwrap().push(lines);
        }),
        ("its skin", |j| {
            j["nodes"][0]["skin"] = 0.into();
            j["skins"] = json!([{ "joints": [0], "inverseBindMatrices": 0 }]);
        }),
        ("an extension", |j| {
            j["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": {} })
        }),
        ("with thickness", |j| {
            j["materials"] = json!([{ "extensions": { "KHR_materials_volume": {} } }]);
            j["meshes"][0]["primitives"][0]["material"] = 0.into();
        }),
    ];
    for (why, change) in changes {
        let scene = square_with(change);
        let (glb, report) = write_compressed_glb(&scene, &[], &PACKED).unwrap();
        assert!(
            report.kept[0].starts_with("mesh 0: ") && report.kept[0].contains(why),
            "{report:?}"
        );
        assert_eq!(report.max_position_error, 0.0);
        assert_eq!(faces(&read_alone(&glb).unwrap()), faces(&scene));
    }
}

#[test]
fn levels_lie_on_the_grid_of_their_mesh() {
    let scene = numbered(Scene::from_mesh("strip", seam_strip()));
    let levels = levels::levels(&scene);
    let (glb, _) = write_compressed_glb(&scene, &levels, &PACKED).unwrap();
    let json = json_of(&glb);
    let nodes = json["nodes"].as_array().unwrap();
    assert!(nodes.len() > levels.len());
    assert!(nodes.iter().all(|node| node["scale"] == nodes[0]["scale"]));
    assert_eq!(faces(&read_alone(&glb).unwrap()).len(), faces(&scene).len());
}

#[test]
fn files_of_both_forms_are_written_by_path() {
    let folder = tempfile::tempdir().unwrap();
    let scene = dressed();
    for name in ["a.glb", "a.gltf"] {
        let path = folder.path().join(name);
        let report = crate::write_compressed(&path, &scene, &PACKED).unwrap();
        assert!(report.connectivity.stored < report.connectivity.resident);
        let again = crate::read(&path, &ReadOptions::default()).unwrap();
        assert_eq!(faces(&again).len(), faces(&scene).len());
    }
    let error = crate::write_compressed(folder.path().join("a.ply"), &scene, &PACKED).unwrap_err();
    assert!(error.to_string().contains("use one of those"), "{error}");
}

#[test]
fn bits_that_cannot_be_are_refused() {
    for how in [
        Compression { position_bits: 0, ..PLAIN },
        Compression { position_bits: 17, ..PLAIN },
        Compression { normal_bits: 1, ..PLAIN },
        Compression { uv_bits: u32::MAX, ..PLAIN },
    ] {
        let error = write_compressed_glb(&dressed(), &[], &how).unwrap_err();
        assert!(error.to_string().contains("to 16"), "{error}");
    }
}

#[test]
fn a_mesh_without_faces_and_no_mesh_at_all_are_written() {
    for scene in [Scene::default(), Scene::from_mesh("none", Mesh::default())] {
        for how in [PLAIN, PACKED] {
            let (glb, _) = write_compressed_glb(&scene, &[], &how).unwrap();
            read_alone(&glb).unwrap();
        }
    }
}

#[test]
fn parts_are_where_their_matrices_put_them() {
    let part = |x: f32| QuantizedPart {
        matrix: [[0.5, 0.0, 0.0, x], [0.0, 0.5, 0.0, 0.0], [0.0, 0.0, 0.5, -1.0]],
        positions: vec![[0, 0, 0], [255, 0, 0], [0, 255, 3]],
        faces: vec![[0, 1, 2]],
    };
    let empty = QuantizedPart::default();
    let glb = write_parts_glb(&[part(0.0), empty.clone(), part(127.5)]).unwrap();
    let scene = read_alone(&glb).unwrap();
    assert_eq!(scene.meshes.len(), 2);
    let flat = scene.flatten();
    let corners: Vec<DVec3> = flat.faces.iter().flat_map(|&face| flat.triangle(face)).collect();
    assert_eq!(corners[1], DVec3::new(127.5, 0.0, -1.0));
    assert_eq!(corners[5], DVec3::new(127.5, 127.5, 0.5));
    read_alone(&write_parts_glb(&[empty]).unwrap()).unwrap();
    for wrong in [QuantizedPart { faces: vec![[0, 1, 3]], ..part(0.0) }, part(f32::NAN)] {
        let error = write_parts_glb(&[part(0.0), wrong]).unwrap_err();
        assert!(error.to_string().starts_with("part 1: "), "{error}");
    }
}

#[test]
fn bytes_per_triangle_of_the_bunny() {
    let Some(path) = shared_mesh("bunny.ply") else {
        return println!("skipped: bunny.ply is not there");
    };
    let scene = crate::read(&path, &ReadOptions::default()).unwrap();
    let faces = scene.meshes[0].mesh.faces.len() as f64;
    let per_face = |how: &Compression| {
        let (_, report) = write_compressed_glb(&scene, &[], how).unwrap();
        let [p, c] = [report.positions, report.connectivity].map(|b| b.stored as f64 / faces);
        println!("bunny, {how:?}: {p:.3} + {c:.3} bytes a triangle");
        p + c
    };
    let how = Compression::default();
    assert!(per_face(&Compression { meshopt: false, ..how }) < 10.1);
    // gltfpack -cc: 3.025.
    assert!(per_face(&how) < 3.2);
    per_face(&PACKED);
}

#[test]
fn materials_have_one_side_unless_they_say_otherwise() {
    let (mut json, buffer) = super::square();
    let sides = [json!({}), json!({ "doubleSided": false }), json!({ "doubleSided": true })];
    json["materials"] = sides.to_vec().into();
    let scene = super::read_parts(&json, &buffer).unwrap();
    let is_double: Vec<bool> = scene.materials.iter().map(|m| m.is_double_sided).collect();
    assert_eq!(is_double, [false, false, true]);
    json["materials"] = json!([{ "doubleSided": "both" }]);
    assert!(super::read_parts(&json, &buffer).is_err());
}
