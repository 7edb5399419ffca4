//! Levels of detail: what is written, and what is shown.

use meshlod_mesh::{Mesh, WedgeId};
use serde_json::json;

use super::{assert_valid, json_of, read_alone, read_parts, square};

use crate::gltf::{
    Level, LodLayout, StripMesh, write, write_glb, write_lods_glb, write_strips_glb,
};
use crate::{Node, Scene};

/// Levels that each keep the first faces of the one before.
pub(crate) fn levels(scene: &Scene) -> Vec<Level> {
    let level = |faces: usize, screen_coverage| Level {
        meshes: scene
            .meshes
            .iter()
            .map(|mesh| {
                let mut mesh = mesh.mesh.clone();
                mesh.faces.truncate(faces);
                if let Some(labels) = &mut mesh.materials {
                    labels.of_face.truncate(faces);
                }
                if let Some(attributes) = &mut mesh.attributes {
                    attributes.corners.truncate(faces);
                }
                mesh.compact();
                mesh
            })
            .collect(),
        screen_coverage,
    };
    vec![level(1, 0.5), level(0, 0.25)]
}

#[test]
fn levels_are_nodes_linked_to_the_first_which_alone_shows() {
    let (json, buffer) = square();
    let scene = read_parts(&json, &buffer).unwrap();
    let glb = write_glb(&scene, &levels(&scene)).unwrap();
    assert_valid(&glb);
    let json = json_of(&glb);
    let names: Vec<&str> =
        json["nodes"].as_array().unwrap().iter().map(|n| n["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["square_LOD0", "square_LOD1", "square_LOD2"]);
    assert_eq!(json["nodes"][0]["extensions"]["MSFT_lod"]["ids"], json!([1, 2]));
    assert_eq!(json["nodes"][0]["extras"]["MSFT_screencoverage"], json!([0.5, 0.25, 0.0]));
    assert_eq!(json["extensionsUsed"], json!(["MSFT_lod"]));
    let again = read_alone(&glb).unwrap();
    assert_eq!(again.flatten().faces, scene.flatten().faces);
    assert_eq!(again.roots, [0]);
    assert_eq!(again.meshes[1].mesh.faces.len(), 1);
}

#[test]
fn a_node_that_moves_or_has_children_gives_its_mesh_to_a_child() {
    let (mut json, buffer) = square();
    json["nodes"] = json!([
        { "name": "parent", "mesh": 0, "children": [1], "translation": [1, 2, 3] },
        { "name": "leaf", "mesh": 0 },
    ]);
    let scene = read_parts(&json, &buffer).unwrap();
    let glb = write_glb(&scene, &levels(&scene)).unwrap();
    assert_valid(&glb);
    let again = read_alone(&glb).unwrap();
    let (mut new, mut old) = (again.flatten().positions, scene.flatten().positions);
    new.sort_by(|a, b| a.partial_cmp(b).unwrap());
    old.sort_by(|a, b| a.partial_cmp(b).unwrap());
    assert_eq!(new, old);
    let parent: &Node = &again.nodes[0];
    assert_eq!((&parent.name[..], parent.mesh), ("parent", None));
    let held = again.nodes.iter().find(|node| node.name == "parent_LOD0").unwrap();
    assert_eq!((held.mesh, held.transform), (Some(0), Node::default().transform));
}

#[test]
fn levels_side_by_side_are_children_of_the_node_that_had_the_mesh() {
    let (mut json, buffer) = square();
    json["nodes"] = json!([
        { "name": "parent", "children": [1], "translation": [1, 2, 3] },
        { "name": "leaf", "mesh": 0, "scale": [2, 2, 2] },
    ]);
    let scene = read_parts(&json, &buffer).unwrap();
    let glb = write_lods_glb(&scene, &levels(&scene), LodLayout::Siblings).unwrap();
    assert_valid(&glb);
    assert!(json_of(&glb).get("extensionsUsed").is_none());
    let again = read_alone(&glb).unwrap();
    let leaf = &again.nodes[1];
    assert_eq!((&leaf.name[..], leaf.mesh), ("leaf", None));
    let children = leaf.children.iter().map(|&child| &again.nodes[child]);
    let children: Vec<_> = children.map(|node| (&node.name[..], node.mesh.unwrap())).collect();
    assert_eq!(children, [("leaf_LOD0", 0), ("leaf_LOD1", 1), ("leaf_LOD2", 2)]);
    let shown = again.instances();
    assert!(shown.iter().all(|instance| instance.transform[3] == [1.0, 2.0, 3.0, 1.0]));
    assert_eq!(shown.len(), 3);
}

#[test]
fn what_has_no_triangles_has_no_levels() {
    let (mut json, buffer) = square();
    let mut lines = json["meshes"][0].clone();
    for primitive in lines["primitives"].as_array_mut().unwrap() {
        primitive["mode"] = 1.into();
        primitive.as_object_mut().unwrap().remove("indices");
    }
    json["meshes"].as_array_mut().unwrap().push(lines);
    json["nodes"].as_array_mut().unwrap().push(json!({ "name": "wire", "mesh": 1 }));
    json["scenes"] = json!([{ "nodes": [0, 1] }]);
    let scene = read_parts(&json, &buffer).unwrap();
    assert!(scene.meshes[1].mesh.faces.is_empty() && !scene.meshes[0].mesh.faces.is_empty());
    let strip = |scene: &Scene| {
        let mesh = &scene.meshes[0].mesh;
        let [a, b, c] = mesh.faces[0];
        let corners = mesh.attributes.as_ref().map_or([WedgeId(0); 3], |own| own.corners[0]);
        let strip = vec![(a, corners[0]), (b, corners[1]), (c, corners[2])];
        StripMesh { mesh: mesh.clone(), levels: vec![vec![strip]; 2] }
    };
    let bare = StripMesh {
        mesh: Mesh { positions: scene.meshes[1].mesh.positions.clone(), ..Mesh::default() },
        levels: vec![Vec::new(); 2],
    };
    let linked = write_lods_glb(&scene, &levels(&scene), LodLayout::Linked).unwrap();
    let shown = write_lods_glb(&scene, &levels(&scene), LodLayout::Siblings).unwrap();
    let strips = write_strips_glb(&scene, &[strip(&scene), bare]).unwrap();
    for (glb, meshes) in [(linked, 4), (shown, 4), (strips, 3)] {
        assert_valid(&glb);
        let new = json_of(&glb);
        assert_eq!(new["nodes"][1], json["nodes"][1], "{new}");
        assert_eq!(new["meshes"].as_array().unwrap().len(), meshes, "{new}");
    }
}

#[test]
fn levels_of_levels_replace_the_first_ones() {
    let (json, buffer) = square();
    let scene = read_parts(&json, &buffer).unwrap();
    let once = read_alone(&write_glb(&scene, &levels(&scene)).unwrap()).unwrap();
    let twice = write_glb(&once, &levels(&once)).unwrap();
    assert_valid(&twice);
    let nodes = json_of(&twice)["nodes"].clone();
    assert_eq!(nodes[0]["name"], "square_LOD0");
    assert_eq!(nodes.as_array().unwrap().len(), 5);
    assert_eq!(nodes[0]["extensions"]["MSFT_lod"]["ids"], json!([3, 4]));
}

#[test]
fn a_plain_scene_gets_levels_too() {
    let scene = Scene::from_mesh("cube", meshlod_fixtures::cube());
    let written = write(&scene, &levels(&scene), "a b").unwrap();
    let (name, buffer) = written.buffer.unwrap();
    assert_eq!(name, "a b.bin");
    let mut resolve = |asked: &str| (asked == name).then(|| buffer.clone());
    let again = super::read(&written.document, &mut resolve, crate::Weld::Exact).unwrap();
    assert_eq!(again.nodes[0].name, "cube_LOD0");
    assert_eq!(again.flatten().faces, scene.flatten().faces);
}

#[test]
fn levels_that_do_not_match_are_refused() {
    let scene = Scene::from_mesh("cube", meshlod_fixtures::cube());
    let few = Level { meshes: vec![], screen_coverage: 0.5 };
    let nan = Level { meshes: vec![meshlod_fixtures::cube()], screen_coverage: f64::NAN };
    for level in [few, nan] {
        let error = write_glb(&scene, &[level]).unwrap_err().to_string();
        assert!(error.starts_with("level 1"), "{error}");
    }
}
