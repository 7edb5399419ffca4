//! Contents of the shared glTF files, and that they are carried through.

use std::path::{Path, PathBuf};

use meshlod_fixtures::shared_mesh;

use super::{assert_valid, round_trip};
use crate::{ReadOptions, Scene, Weld, WriteOptions, gltf};

/// File, vertices and faces over its meshes without instances, as stored.
///
/// strip-mode5 has 412 primitives that share 54 accessors of positions, which count once here.
const COUNTS: [(&str, usize, usize); 9] = [
    ("city.glb", 7240, 5550),
    ("duck.glb", 2399, 4212),
    ("fox.glb", 1728, 576),
    ("cesium-man.glb", 3273, 4672),
    ("cesium-milk-truck.glb", 2978, 2856),
    ("dragon-attenuation.glb", 139_379, 134_995),
    ("strip-mode5.gltf", 3610, 2786),
    ("mountains.gltf", 6561, 12_800),
    ("flight-helmet/FlightHelmet.gltf", 55_392, 94_722),
];

fn read(path: &Path, weld: Weld) -> Scene {
    crate::read(path, &ReadOptions { weld }).unwrap()
}

fn for_each_shared(mut check: impl FnMut(&Path, usize, usize)) {
    for (name, vertices, faces) in COUNTS {
        match shared_mesh(name) {
            Some(path) => check(&path, vertices, faces),
            None => println!("skipped: {name} is not there"),
        }
    }
}

#[test]
fn counts_are_those_of_the_file() {
    for_each_shared(|path, vertices, faces| {
        let count = |scene: &Scene| {
            let sum = |of: fn(&meshlod_mesh::Mesh) -> usize| {
                scene.meshes.iter().map(|mesh| of(&mesh.mesh)).sum::<usize>()
            };
            (sum(|mesh| mesh.positions.len()), sum(|mesh| mesh.faces.len()))
        };
        assert_eq!(count(&read(path, Weld::Off)), (vertices, faces), "{}", path.display());
        let welded = read(path, Weld::Exact);
        let (fewer, same) = count(&welded);
        assert!(fewer <= vertices && same == faces, "{}: {fewer} {same}", path.display());
        for mesh in &welded.meshes {
            mesh.mesh.validate().unwrap();
        }
        welded.flatten().validate().unwrap();
    });
}

#[test]
fn rows_of_primitives_are_the_vertices_that_were_not_welded() {
    for_each_shared(|path, _, _| {
        let scene = read(path, Weld::Off);
        let source = scene.source.as_ref().unwrap();
        for (i, mesh) in scene.meshes.iter().enumerate() {
            let mesh = &mesh.mesh;
            let rows = source.primitive_rows(i);
            let end = rows.iter().flatten().map(|rows| rows.vertices.end).max();
            assert_eq!(end, Some(mesh.positions.len()), "{}, mesh {i}", path.display());
            let labels = mesh.materials.as_ref().unwrap();
            for (face, &label) in mesh.faces.iter().zip(&labels.of_face) {
                let rows = rows[label as usize].as_ref().unwrap();
                assert!(face.iter().all(|v| rows.vertices.contains(&v.index())));
            }
        }
        assert!(source.primitive_rows(scene.meshes.len()).is_empty());
    });
}

#[test]
fn unchanged_scenes_come_back_the_same_through_both_forms() {
    for_each_shared(|path, _, _| {
        let folder = tempfile::tempdir().unwrap();
        let scene = read(path, Weld::Exact);
        let write = |name: &str, scene: &Scene| -> PathBuf {
            let path = folder.path().join(name);
            crate::write(&path, scene, &WriteOptions::default()).unwrap();
            assert_valid(&std::fs::read(&path).unwrap());
            path
        };
        let glb = read(&write("one.glb", &scene), Weld::Exact);
        let gltf = read(&write("two.gltf", &glb), Weld::Exact);
        assert!(glb.flatten() == scene.flatten(), "{} as GLB", path.display());
        assert!(gltf.flatten() == scene.flatten(), "{} as glTF", path.display());
        let bytes = |scene: &Scene| -> Vec<Vec<u8>> {
            scene.images.iter().map(|image| image.bytes.clone()).collect()
        };
        assert!(bytes(&gltf) == bytes(&scene), "images of {}", path.display());
        assert!(scene.images.iter().all(|image| !image.bytes.is_empty()));
    });
}

#[test]
fn meshes_that_changed_are_written_and_nothing_else_is() {
    for_each_shared(|path, _, _| {
        let mut scene = read(path, Weld::Exact);
        for mesh in &mut scene.meshes {
            for position in &mut mesh.mesh.positions {
                position[1] += 1.0;
                *position = position.map(|x| f64::from(x as f32));
            }
            mesh.mesh.compact();
        }
        let again = round_trip(&scene);
        let (new, old) = (again.flatten(), scene.flatten());
        assert_eq!(new.faces.len(), old.faces.len(), "{}", path.display());
        let corners = |mesh: &meshlod_mesh::Mesh| -> Vec<[glam::DVec3; 3]> {
            mesh.faces.iter().map(|&face| mesh.triangle(face)).collect()
        };
        // Faces may come in another order where primitives take turns.
        if scene.meshes.iter().all(|mesh| mesh.materials.len() == 1) {
            assert!(corners(&new) == corners(&old), "{}", path.display());
        }
        assert_eq!(again.nodes, scene.nodes);
        assert_eq!(again.materials, scene.materials);
    });
}

#[test]
fn nothing_of_the_old_geometry_stays_in_the_buffer() {
    let Some(path) = shared_mesh("dragon-attenuation.glb") else {
        return println!("skipped: dragon-attenuation.glb is not there");
    };
    let mut scene = read(&path, Weld::Exact);
    let whole = gltf::write_glb(&scene, &[]).unwrap().len();
    let images: usize = scene.images.iter().map(|image| image.bytes.len()).sum();
    for mesh in &mut scene.meshes {
        let mesh = &mut mesh.mesh;
        mesh.faces.truncate(2);
        mesh.materials.as_mut().unwrap().of_face.truncate(2);
        mesh.attributes.as_mut().unwrap().corners.truncate(2);
    }
    let small = gltf::write_glb(&scene, &[]).unwrap();
    assert_valid(&small);
    assert!(whole > 6_000_000 && small.len() < images + 10_000, "{} bytes", small.len());
}
