//! Tests of PLY in passing: the triangles of scenes, and files that are damaged.

use std::fs;

use meshlod_io::{Format, Precision, ReadOptions, read_bytes};
use meshlod_mesh::LayerKind;
use tempfile::TempDir;

use super::*;
use crate::source::SceneSource;
use crate::source::fixtures::{all, patch};

/// Writes a file into a folder of its own, which goes with the first part of the result.
fn file(bytes: &[u8]) -> (TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    fs::write(&path, bytes).unwrap();
    (folder, path)
}

/// Checks that a file has the same triangles in passing and as a scene; returns their number.
#[track_caller]
fn check_same(bytes: &[u8]) -> usize {
    let (_folder, path) = file(bytes);
    let streamed = PlySource::open(&path).unwrap().unwrap();
    let scene = read_bytes(bytes, Format::Ply, &mut |_| None, &ReadOptions::default()).unwrap();
    let scene = SceneSource::new(scene);
    let (own, expected) = (all(&streamed), all(&scene));
    assert!(own == expected);
    assert_eq!(streamed.layout(), scene.layout());
    assert_eq!(streamed.bounds().unwrap(), scene.bounds().unwrap());
    own.places.len()
}

/// Returns the error of the first pass over a file, without its path.
#[track_caller]
fn error(bytes: &[u8]) -> String {
    let (_folder, path) = file(bytes);
    let source = PlySource::open(&path).and_then(|source| {
        let mut count = 0;
        source.unwrap().triangles(&mut |some| {
            count += some.places.len();
            Ok(())
        })
    });
    let text = source.unwrap_err().to_string();
    text.split_once(": ").unwrap().1.to_owned()
}

#[test]
fn triangles_are_those_of_a_scene() {
    let color = LayerKind::Color(0);
    let kinds: [&[LayerKind]; 4] =
        [&[], &[color], &[LayerKind::Normal, LayerKind::Uv(0)], &[LayerKind::Normal, color]];
    for kinds in kinds {
        // More than are handed on at a time, and more vertices than a page has.
        for (faces, precision) in [(200_000, Precision::F32), (200, Precision::F64)] {
            let mesh = patch(faces, kinds);
            let mut bytes = Vec::new();
            meshlod_io::ply::write(&mesh, precision, &mut bytes).unwrap();
            assert_eq!(check_same(&bytes), mesh.faces.len());
        }
    }
}

/// Returns a big-endian file of polygons with a number of corners around a circle each, and
/// properties that are skipped on all sides.
fn polygons(corners: u16, count: u16) -> Vec<u8> {
    let vertices = u32::from(corners) * u32::from(count);
    let mut bytes = format!(
        "ply\nformat binary_big_endian 1.0\nelement camera 1\nproperty short f\n\
         element vertex {vertices}\nproperty ushort quality\nproperty double x\nproperty float y\n\
         property short z\nproperty float nx\nproperty float ny\nproperty float nz\n\
         element face {count}\nproperty float area\nproperty list ushort uint64 vertex_index\n\
         property list char uchar tags\nend_header\n"
    )
    .into_bytes();
    bytes.extend([0; 2]);
    for vertex in 0..vertices {
        let angle = f64::from(vertex) * std::f64::consts::TAU / f64::from(corners);
        bytes.extend((vertex as u16).to_be_bytes());
        bytes.extend(angle.cos().to_be_bytes());
        bytes.extend((angle.sin() as f32).to_be_bytes());
        bytes.extend(((vertex / u32::from(corners)) as i16).to_be_bytes());
        [0.0f32, 0.0, 2.0].iter().for_each(|x| bytes.extend(x.to_be_bytes()));
    }
    for face in 0..u64::from(count) {
        bytes.extend([9; 4]);
        bytes.extend(corners.to_be_bytes());
        let first = face * u64::from(corners);
        (first..first + u64::from(corners)).for_each(|v| bytes.extend(v.to_be_bytes()));
        bytes.extend([2, 7, 7]);
    }
    bytes
}

#[test]
fn polygons_are_cut_as_in_a_scene() {
    for (corners, count) in [(3, 5), (4, 300), (7, 9), (20_000, 12)] {
        let triangles = usize::from(corners - 2) * usize::from(count);
        assert_eq!(check_same(&polygons(corners, count)), triangles);
    }
}

#[test]
fn truncated_files_say_where_they_end() {
    let bytes = polygons(5, 4);
    // The end of the last line may be missing.
    let body = bytes.windows(11).position(|part| part == b"end_header\n").unwrap() + 10;
    for end in 1..bytes.len() {
        let message = error(&bytes[..end]);
        let expected = match end < body {
            true => "line ",
            false => &format!("byte {end}: the file ends inside "),
        };
        assert!(message.starts_with(expected), "{end}: {message}");
    }
}

#[test]
fn damaged_faces_are_named_by_their_byte() {
    let triangle = |list: &str, body: &[u8]| {
        let head = format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty char x\n\
             property char y\nproperty char z\nelement face 1\n\
             property list {list} vertex_indices\nend_header\n"
        );
        let at = head.len() + 9;
        (at, error(&[head.as_bytes(), &[0; 9], body].concat()))
    };
    let (at, message) = triangle("uchar char", &[3, 0, 1, 3]);
    let reason = "refers to vertex 3, but there are only 3, counted from 0";
    assert_eq!(message, format!("byte {at}: face 0 of 1 {reason}"));
    let (_, message) = triangle("uchar char", &[3, 0, 1, 0xFF]);
    assert!(message.contains("refers to vertex -1"), "{message}");
    let (_, message) = triangle("uchar float", &[3, 0, 0, 0, 0, 0, 0, 0x80, 0x3F, 0, 0, 0, 0x3F]);
    assert!(message.contains("refers to vertex 0.5"), "{message}");
    let (at, message) = triangle("char char", &[0xFF, 0, 1, 2]);
    assert_eq!(message, format!("byte {at}: face 0 of 1 has a list of negative length -1"));
    let (at, message) = triangle("uint64 double", &[0xFF; 40]);
    assert_eq!(message, format!("byte {}: the file ends inside face 0 of 1", at + 40));
    let long = [&(1u32 << 20).to_le_bytes()[..], &vec![0; 1 << 20]].concat();
    let (at, message) = triangle("uint char", &long);
    let expected = format!("byte {at}: face 0 of 1 is too long to be read in passing");
    assert!(message.starts_with(&expected), "{message}");
}

#[test]
fn coordinates_that_are_not_finite_are_named() {
    let mut bytes = Vec::new();
    let mesh = patch(50, &[]);
    meshlod_io::ply::write(&mesh, Precision::F32, &mut bytes).unwrap();
    let body = bytes.windows(11).position(|part| part == b"end_header\n").unwrap() + 11;
    bytes[body + 24..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let message = error(&bytes);
    let expected =
        format!("byte {}: vertex 2 has a coordinate that is not finite: [NaN", body + 24);
    assert!(message.starts_with(&expected), "{message}");
}
