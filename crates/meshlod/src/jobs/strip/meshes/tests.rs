//! Strips of scenes, written to glTF and read again.

use std::collections::BTreeMap;

use meshlod_fixtures::charted;
use meshlod_io::gltf::{write_glb, write_strips_glb};
use meshlod_io::{Format, Material, Node, ReadOptions, SceneMesh, read_bytes};
use meshlod_mesh::Labels;
use meshlod_samples as samples;
use meshlod_simplify::Target;
use meshlod_strip::{Filter, SkipStrip, StripOptions, stripify};

use super::*;

fn read(glb: &[u8]) -> Scene {
    read_bytes(glb, Format::Glb, &mut |_| None, &ReadOptions::default()).unwrap()
}

/// A scene read from glTF: a torus with charts and two materials, shown twice, once in a mirror;
/// and a sphere without attributes.
fn scene() -> Scene {
    let mut torus = charted(&samples::torus(400));
    let of_face = torus.faces.iter().map(|face| (torus.positions[face[0].index()][1] > 0.0).into());
    let of_face = of_face.collect();
    torus.materials = Some(Labels { names: vec!["low".into(), "high".into()], of_face });
    let meshes = [(torus, vec![Some(0), Some(1)]), (samples::sphere(200), vec![None])];
    let meshes =
        meshes.map(|(mesh, materials)| SceneMesh { mesh, materials, ..SceneMesh::default() });
    let node = |(mesh, scale): (usize, f64)| {
        let mut node = Node { mesh: Some(mesh), ..Node::default() };
        node.transform[0][0] = scale;
        node.transform[3][0] = 8.0 * scale;
        node
    };
    let scene = Scene {
        meshes: meshes.into(),
        nodes: [(0, 1.0), (1, 2.0), (0, -1.0)].map(node).into(),
        roots: vec![0, 1, 2],
        materials: ["red", "blue"]
            .map(|name| Material { name: name.into(), ..Material::default() })
            .into(),
        ..Scene::default()
    };
    read(&write_glb(&scene, &[]).unwrap())
}

type Corner = (Vec<u64>, Vec<u32>, u32);

/// Counts the triangles of a mesh, each by positions, attributes and material, turned to begin with
/// the least corner.
fn triangles(mesh: &Mesh) -> BTreeMap<[Corner; 3], usize> {
    let mut counts = BTreeMap::new();
    let attributes = mesh.attributes.as_ref().unwrap();
    for (face, (vertices, wedges)) in mesh.faces.iter().zip(&attributes.corners).enumerate() {
        let corner = |k: usize| {
            let position = mesh.positions[vertices[k].index()].map(f64::to_bits).to_vec();
            let values = attributes.layers.iter().flat_map(|layer| layer.of(wedges[k]));
            let material = mesh.materials.as_ref().unwrap().of(face);
            (position, values.map(|x| x.to_bits()).collect(), material)
        };
        let turns = [[0, 1, 2], [1, 2, 0], [2, 0, 1]].map(|turn| turn.map(corner));
        *counts.entry(turns.into_iter().min().unwrap()).or_insert(0) += 1;
    }
    counts
}

#[test]
fn strips_in_gltf_draw_the_scene_with_its_attributes() {
    let scene = scene();
    let flat = scene.flatten();
    let tree = MergeTree::record(&flat, Target::Ratio(0.2)).unwrap();
    let strips = stripify(tree.faces(), &StripOptions::default());
    let written = write_strips_glb(&scene, &scene_strips(&scene, &flat, &tree, &[&strips]));
    let back = read(&written.unwrap());
    assert_eq!(triangles(&back.flatten()), triangles(&flat));
    assert_eq!((back.meshes.len(), back.nodes.len()), (3, 3), "the torus is there twice");
}

#[test]
fn levels_are_hidden_and_share_vertices() {
    let scene = scene();
    let flat = scene.flatten();
    let tree = MergeTree::record(&flat, Target::Ratio(0.2)).unwrap();
    let mut skip = SkipStrip::new(tree.clone(), stripify(tree.faces(), &StripOptions::default()));
    let levels = [0, tree.contractions() / 2, tree.contractions()].map(|level| {
        skip.set_level(level);
        (tree.faces_left(level), skip.display(Filter::Dtff))
    });
    let strips = scene_strips(&scene, &flat, &tree, &levels.each_ref().map(|(_, strips)| strips));
    assert_eq!(strips.len(), 3);
    let back = read(&write_strips_glb(&scene, &strips).unwrap());
    assert_eq!(triangles(&back.flatten()), triangles(&flat), "only the finest is shown");
    let faces = |from: usize, to: usize| -> usize {
        back.meshes[from..to].iter().map(|mesh| mesh.mesh.faces.len()).sum()
    };
    let all: usize = levels.iter().map(|(faces, _)| faces).sum();
    assert_eq!(faces(0, back.meshes.len()), all);
    let source = back.source.as_ref().unwrap();
    for mesh in 0..3 {
        let coarser = 3 + 2 * mesh;
        assert_eq!(source.primitive_rows(mesh)[0], source.primitive_rows(coarser)[0]);
        assert_eq!(source.primitive_rows(mesh)[0], source.primitive_rows(coarser + 1)[0]);
    }
}

#[test]
fn strips_of_another_scene_are_refused() {
    let scene = scene();
    assert!(write_strips_glb(&scene, &[]).is_err());
    let wrong = |corner| {
        let levels = vec![vec![vec![corner; 3]]];
        let strips = StripMesh { mesh: samples::sphere(20), levels };
        let strips = StripMesh { mesh: Mesh { faces: Vec::new(), ..strips.mesh }, ..strips };
        write_strips_glb(&scene, &[strips, StripMesh::default(), StripMesh::default()])
    };
    assert!(wrong((VertexId(0), WedgeId(0))).is_ok());
    assert!(wrong((VertexId(999), WedgeId(0))).is_err());
}
