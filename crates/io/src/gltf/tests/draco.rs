//! Primitives compressed by Draco: decompressed on reading, or rejected with their location.
//!
//! The files are one torus of ours with seams, compressed by two other programs: gltf-transform
//! 4 (edgebreaker, sequential) and gltf-pipeline 4 (unquantized).

use meshlod_fixtures::own_file;
use meshlod_mesh::{LayerKind, Mesh};
use serde_json::{Value, json};

use super::{assert_valid, json_of, read_alone, read_parts};
use crate::gltf::document::container;
use crate::gltf::{read, write_glb};
use crate::{NoteKind, Scene, Weld};

const DRACO: &str = "KHR_draco_mesh_compression";
const FILES: [&str; 3] = ["edgebreaker.glb", "sequential.glb", "unquantized.glb"];

fn bytes_of(name: &str) -> Vec<u8> {
    std::fs::read(own_file("draco").join(name)).unwrap()
}

/// Returns the document and the buffer of a compressed file.
fn parts_of(name: &str) -> (Value, Vec<u8>) {
    let bytes = bytes_of(name);
    let buffer = container::split(&bytes).unwrap().1.unwrap().to_vec();
    (json_of(&bytes), buffer)
}

fn mesh_of(bytes: &[u8]) -> Mesh {
    read(bytes, &mut |_| None, Weld::Off).unwrap().meshes.remove(0).mesh
}

/// Reads the edgebreaker file after a change to its JSON.
fn spoilt(change: impl FnOnce(&mut Value)) -> Result<Scene, String> {
    let (mut json, buffer) = parts_of("edgebreaker.glb");
    change(&mut json);
    read_parts(&json, &buffer).map_err(|error| error.to_string())
}

/// Values of a wedge: those of its position, then those of every layer.
type Row = Vec<Vec<f64>>;

fn rows(mesh: &Mesh) -> Vec<Row> {
    let attributes = mesh.attributes.as_ref().unwrap();
    let mut rows = vec![Row::new(); attributes.wedge_count];
    for (face, corners) in mesh.faces.iter().zip(&attributes.corners) {
        for (vertex, wedge) in face.iter().zip(corners) {
            let wedge = wedge.0 as usize;
            let layers = attributes.layers.iter().map(|layer| {
                let values = &layer.values[wedge * layer.width..][..layer.width];
                values.iter().map(|&x| f64::from(x)).collect()
            });
            let position = mesh.positions[vertex.0 as usize].to_vec();
            rows[wedge] = [position].into_iter().chain(layers).collect();
        }
    }
    rows
}

/// Largest difference of the values of two rows, by position and layer.
fn differences(a: &Row, b: &Row) -> Vec<f64> {
    let of = |(a, b): (&Vec<f64>, &Vec<f64>)| {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    a.iter().zip(b).map(of).collect()
}

/// Returns the faces as rows of `of`, sorted, where `row` gives the row of a wedge.
fn faces(mesh: &Mesh, row: impl Fn(usize) -> usize) -> Vec<[usize; 3]> {
    let corners = &mesh.attributes.as_ref().unwrap().corners;
    let face = |corners: &[meshlod_mesh::WedgeId; 3]| {
        let mut face = corners.map(|wedge| row(wedge.0 as usize));
        let least = (0..3).min_by_key(|&k| face[k]).unwrap();
        face.rotate_left(least);
        face
    };
    let mut faces: Vec<_> = corners.iter().map(face).collect();
    faces.sort_unstable();
    faces
}

/// Largest difference that a layer may show after the programs' default quantization.
fn tolerance(kind: Option<LayerKind>) -> f64 {
    let half_step = |range: f64, bits: i32| range / (2f64.powi(bits) - 1.0) / 2.0 * 1.001;
    match kind {
        None => half_step(6.0, 14),
        // Cells of the octahedron at 10 bits; they are up to three halves as large on the sphere.
        Some(LayerKind::Normal) => 1.5 * 2.0 / 1023.0,
        Some(LayerKind::Uv(_)) => half_step(1.0, 12),
        Some(LayerKind::Tangent) => half_step(2.0, 12),
        Some(LayerKind::Weights(_)) => half_step(1.0, 12),
        Some(_) => 0.0,
    }
}

#[test]
fn what_is_decoded_is_the_original_within_the_quantization() {
    let plain = mesh_of(&bytes_of("plain.glb"));
    let originals = rows(&plain);
    let layers = &plain.attributes.as_ref().unwrap().layers;
    for name in FILES {
        let decoded = mesh_of(&bytes_of(name));
        let names = |mesh: &Mesh| -> Vec<String> {
            mesh.attributes.as_ref().unwrap().layers.iter().map(|l| l.name.clone()).collect()
        };
        assert_eq!(names(&decoded), names(&plain), "{name}");
        let found = rows(&decoded);
        assert_eq!(found.len(), originals.len(), "{name}");
        let nearest = |row: &Row| {
            let distance = |k: usize| differences(row, &originals[k]).iter().sum::<f64>();
            (0..originals.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap()
        };
        let origin: Vec<usize> = found.iter().map(nearest).collect();
        for (row, &of) in found.iter().zip(&origin) {
            let kinds = [None].into_iter().chain(layers.iter().map(|layer| Some(layer.kind)));
            for (difference, kind) in differences(row, &originals[of]).into_iter().zip(kinds) {
                let most = if name == "unquantized.glb" { 0.0 } else { tolerance(kind) };
                assert!(difference <= most, "{name}: {kind:?} differs by {difference} > {most}");
            }
        }
        assert_eq!(faces(&decoded, |wedge| origin[wedge]), faces(&plain, |wedge| wedge), "{name}");
    }
}

#[test]
fn what_is_written_is_plain() {
    for name in FILES {
        let (_, stream) = parts_of(name);
        let scene = read_alone(&bytes_of(name)).unwrap();
        let note = scene.notes.iter().find(|note| note.what.contains("Draco")).unwrap();
        assert_eq!((note.kind, note.count), (NoteKind::Changed, 1), "{name}");
        let glb = write_glb(&scene, &[]).unwrap();
        assert_valid(&glb);
        let written = json_of(&glb);
        assert!(!written.to_string().contains("draco"), "{name}: {written}");
        assert!(written.get("extensionsRequired").is_none(), "{name}");
        let buffer = container::split(&glb).unwrap().1.unwrap();
        let carried = buffer.windows(32).any(|part| part == &stream[..32]);
        assert!(!carried, "{name}: the stream is in the file");
        assert_eq!(read_alone(&glb).unwrap().meshes[0].mesh, scene.meshes[0].mesh, "{name}");
    }
}

#[test]
fn primitives_may_share_a_stream_and_accessors() {
    let scene = spoilt(|json| {
        let primitives = json["meshes"][0]["primitives"].as_array_mut().unwrap();
        let mut strip = primitives[0].clone();
        strip["mode"] = 5.into();
        primitives.extend([primitives[0].clone(), strip]);
        // The same indices, of another attribute under the name.
        let mut swapped = primitives[0].clone();
        let weights = swapped["extensions"][DRACO]["attributes"]["WEIGHTS_0"].clone();
        swapped["extensions"][DRACO]["attributes"]["TANGENT"] = weights;
        primitives.push(swapped);
    });
    let mesh = &scene.unwrap().meshes[0].mesh;
    let layer = |name: &str| {
        let layers = &mesh.attributes.as_ref().unwrap().layers;
        layers.iter().find(|layer| layer.name == name).unwrap().values.as_slice()
    };
    let (tangents, weights) = (layer("TANGENT"), layer("WEIGHTS_0"));
    let one = mesh.faces.len() / 4;
    assert_eq!(mesh.faces[..one], mesh.faces[one..2 * one]);
    assert_eq!(mesh.faces[..one], mesh.faces[2 * one..3 * one]);
    assert_ne!(tangents[..tangents.len() / 2], weights[..tangents.len() / 2]);
    assert_eq!(tangents[tangents.len() / 2..], weights[tangents.len() / 2..]);
}

#[test]
fn faults_are_told_with_their_place() {
    fn extension(json: &mut Value) -> &mut Value {
        &mut json["meshes"][0]["primitives"][0]["extensions"][DRACO]
    }
    type Change = fn(&mut Value);
    let faults: [(&str, &str, Change); 12] = [
        ("accessor 0", "declares 300 elements", |j| j["accessors"][0]["count"] = 300.into()),
        ("mesh 0, primitive 0", "room for 1", |j| j["accessors"][0]["count"] = 3.into()),
        ("accessor 1", "declares 7 elements", |j| j["accessors"][1]["count"] = 7.into()),
        ("mesh 0, primitive 0", "VEC2", |j| j["accessors"][1]["type"] = "VEC2".into()),
        ("mesh 0, primitive 0", "cannot hold", |j| {
            j["accessors"][1]["componentType"] = 5121.into()
        }),
        ("mesh 0, primitive 0", "no attribute 9", |j| {
            extension(j)["attributes"]["NORMAL"] = 9.into()
        }),
        ("mesh 0, primitive 0", "has _X, but", |j| extension(j)["attributes"]["_X"] = 0.into()),
        ("mesh 0, primitive 0", "not an object", |j| *extension(j) = json!([])),
        ("mesh 0, primitive 0", "bufferView", |j| *extension(j) = json!({})),
        ("bufferView 9", "does not exist", |j| extension(j)["bufferView"] = 9.into()),
        ("bufferView 0", "exceed", |j| j["bufferViews"][0]["byteLength"] = json!(u64::MAX)),
        ("mesh 0, primitive 0", "only triangles", |j| {
            j["meshes"][0]["primitives"][0]["mode"] = 1.into();
        }),
    ];
    assert!(spoilt(|_| {}).is_ok());
    for (place, reason, change) in faults {
        let error = spoilt(change).unwrap_err();
        assert!(error.starts_with(&format!("{place}:")), "{place}: {error}");
        assert!(error.contains(reason) && !error.contains('\n'), "{reason}: {error}");
    }
}

#[test]
fn damaged_streams_are_errors_or_meshes() {
    let mut errors = 0;
    for name in FILES {
        let (json, stream) = parts_of(name);
        for at in 0..stream.len() {
            for change in [1, 0x80, 0xff] {
                let mut damaged = stream.clone();
                damaged[at] ^= change;
                match read_parts(&json, &damaged) {
                    Ok(scene) => scene.meshes[0].mesh.validate().unwrap(),
                    Err(error) => {
                        assert!(!error.to_string().contains('\n'), "{error}");
                        errors += 1;
                    }
                }
            }
        }
    }
    assert!(errors > 1000, "most damage to connectivity is found, not {errors} times");
}
