//! Attributes of models that are read: the memory that they take, and their values to the bit.

use meshlod_fixtures as fixtures;
use meshlod_mesh::{Attributes, Layer, Mesh, WedgeId};

use super::{Archive, Storage};
use crate::file::LayerCoding;
use crate::tests::attributes;
use crate::{Forest, Implicit, Query};

fn read_back(forest: &Forest) -> Implicit {
    let file = Archive::write(forest, &Storage::default()).unwrap().0.into_source();
    Archive::open(file).unwrap().read().unwrap().0
}

/// Limits on the bytes of memory that the attributes of each wedge of the input take, beside those of
/// the bare model: up to a tenth more than they took on 2026-11-25.
const MOST: [(&str, f64); 4] = [
    ("duck.glb", 14.0),
    ("spot.obj", 9.6),
    ("fish-bream.obj", 12.2),
    ("flight-helmet/FlightHelmet.gltf", 19.5),
];

/// `cargo test --release -p meshlod-multires --lib memory_of_attributes -- --nocapture` prints the
/// figures.
#[test]
fn the_memory_of_attributes_is_bounded() {
    for (name, most) in MOST {
        let Some(path) = fixtures::shared_mesh(name) else {
            eprintln!("skipped: {name} is missing");
            continue;
        };
        let scene = meshlod_io::read(&path, &meshlod_io::ReadOptions::default()).unwrap();
        let (mut wedges, mut with, mut bare) = (0, 0, 0);
        for mesh in scene.meshes.iter().map(|mesh| &mesh.mesh) {
            let mut forest = Forest::new(mesh, &Default::default()).unwrap();
            with += read_back(&forest).bytes();
            forest.wedges = None;
            bare += read_back(&forest).bytes();
            wedges += mesh.attributes.as_ref().map_or(0, |all| all.wedge_count);
        }
        let each = (with - bare) as f64 / wedges as f64;
        println!("memory of attributes, {name}: {each:.2} bytes for each of {wedges} wedges");
        assert!(each < most, "{name}: {each}");
    }
}

/// Returns the bits of the values at the corners of each face, in an order that does not depend on that
/// of faces and corners.
fn corner_bits(mesh: &Mesh) -> Vec<[Vec<u32>; 3]> {
    let Attributes { corners, layers, .. } = mesh.attributes.as_ref().unwrap();
    let bits = |wedge: WedgeId| {
        let values = layers.iter().flat_map(|layer| layer.of(wedge));
        values.map(|value| value.to_bits()).collect::<Vec<_>>()
    };
    let mut all: Vec<_> = corners.iter().map(|face| face.map(bits)).collect();
    for face in &mut all {
        face.sort_unstable();
    }
    all.sort_unstable();
    all
}

/// Rounds every value of a mesh as a file does.
fn rounded(mesh: &Mesh) -> Mesh {
    let (mut mesh, bounds) = (mesh.clone(), Storage::default().attributes);
    let again = |layer: &Layer| {
        let (coding, mut values) = (LayerCoding::new(layer, Some(&bounds)), Vec::new());
        for wedge in layer.values.chunks(layer.width) {
            let mut numbers = Vec::new();
            coding.encode(wedge, &mut numbers);
            coding.decode(&numbers, &mut values).unwrap();
        }
        Layer { values, ..layer.clone() }
    };
    let attributes = mesh.attributes.as_mut().unwrap();
    attributes.layers = attributes.layers.iter().map(again).collect();
    mesh
}

#[test]
fn values_of_the_finest_cut_are_those_of_the_file_to_the_bit() {
    for (name, mesh) in attributes::meshes() {
        let expected = corner_bits(&rounded(&mesh));
        assert_ne!(expected, corner_bits(&mesh), "{name} is rounded");
        let forest = Forest::new(&mesh, &Default::default()).unwrap();
        let archive = Archive::write(&forest, &Storage::default()).unwrap().0;
        let level = archive.extract(&Query::uniform(0.0)).unwrap().level.mesh();
        assert_eq!(corner_bits(&level), expected, "{name}");
        // Also after the tables for fast extraction are made of it, which go by a forest.
        let model = crate::Model::from_implicit(&archive.read().unwrap().0).unwrap();
        let level = model.extractor().uniform(0.0).unwrap().mesh();
        assert_eq!(corner_bits(&level), expected, "{name}");
    }
}
