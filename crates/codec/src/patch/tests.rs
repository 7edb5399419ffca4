use meshlod_fixtures as fixtures;
use meshlod_mesh::Mesh;
use meshlod_samples as samples;

use super::*;
use crate::kd::{BLOCK, blocks_of};

/// Rotates faces to start at their least node, and sorts them.
fn normal(faces: impl IntoIterator<Item = [u32; 3]>) -> Vec<[u32; 3]> {
    let turned = |[a, b, c]: [u32; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
    let mut faces: Vec<_> = faces.into_iter().filter_map(turned).collect();
    faces.sort_unstable();
    faces
}

fn faces_of(mesh: &Mesh) -> Vec<[u32; 3]> {
    mesh.faces.iter().map(|face| face.map(|v| v.0)).collect()
}

/// Rows of 32 vertices that are close together.
fn rows_of(mesh: &Mesh) -> Vec<u32> {
    let mut row_of = vec![0; mesh.positions.len()];
    let vertices = blocks_of(mesh);
    vertices.iter().enumerate().for_each(|(at, v)| row_of[v.index()] = (at / BLOCK) as u32);
    row_of
}

fn all_faces(patches: &Patches) -> Result<Vec<[u32; 3]>, Malformed> {
    let faces: Result<Vec<_>, _> = (0..patches.len()).map(|patch| patches.faces(patch)).collect();
    faces.map(|faces| faces.concat())
}

fn assert_same(faces: &[[u32; 3]], row_of: &[u32], rows_per_patch: usize) -> Patches {
    let rows = row_of.iter().max().map_or(0, |&row| row as usize + 1);
    let (patches, order, _) = Patches::new(faces, row_of, rows, rows_per_patch);
    let mut sorted = order.clone();
    sorted.sort_unstable();
    assert!(sorted.iter().zip(0..row_of.len()).all(|(&node, at)| node as usize == at));
    assert!(order.is_sorted_by_key(|&node| row_of[node as usize]));
    let mut bytes = Vec::new();
    patches.store(&mut bytes);
    assert_eq!(bytes.len(), patches.bytes());
    let mut reader = Reader::new(&bytes);
    let read = Patches::restore(patches.rows.clone(), rows_per_patch, &mut reader).unwrap();
    reader.finish().unwrap();
    let read = all_faces(&read).unwrap();
    let was = read.iter().map(|face| face.map(|at| order[at as usize]));
    assert_eq!(normal(was), normal(faces.iter().copied()));
    patches
}

#[test]
fn every_face_comes_back_as_it_was_turned() {
    for mesh in [samples::sphere(5000), samples::gyroid(3000), samples::terrain(2000)] {
        for rows_per_patch in [1, 4] {
            assert_same(&faces_of(&mesh), &rows_of(&mesh), rows_per_patch);
        }
    }
}

#[test]
fn a_smooth_mesh_takes_less_than_seven_bits_per_face() {
    let mesh = samples::sphere(20_000);
    let patches = assert_same(&faces_of(&mesh), &rows_of(&mesh), 4);
    let bits = 8.0 * patches.bytes() as f64 / mesh.faces.len() as f64;
    assert!(bits < 7.0, "{bits}");
}

#[test]
fn non_manifold_faces_come_back_too() {
    let pinched = [[0, 1, 2], [0, 3, 4], [0, 5, 6]];
    let book = [[0, 1, 2], [0, 1, 3], [1, 0, 4], [0, 1, 5]];
    let odd = [[0, 0, 0], [1, 1, 2], [2, 1, 1], [3, 4, 5], [3, 4, 5], [5, 4, 3], [6, 6, 7]];
    for faces in [&pinched[..], &book, &odd] {
        for rows in [[0; 8], [0, 1, 2, 3, 0, 1, 2, 3], [5, 4, 3, 2, 1, 0, 0, 0]] {
            for rows_per_patch in [1, 2, 8] {
                let nodes = 1 + faces.iter().flatten().max().copied().unwrap_or(0) as usize;
                assert_same(faces, &rows[..nodes], rows_per_patch);
            }
        }
    }
    assert_same(&[], &[], 4);
    assert_same(&[], &[0, 1], 4);
    let moebius = fixtures::moebius(12);
    assert_same(&faces_of(&moebius), &vec![0; moebius.positions.len()], 1);
}

#[test]
fn many_faces_on_one_edge_take_linear_time() {
    let faces: Vec<_> = (2..60_000).map(|c| [0, 1, c]).collect();
    assert_same(&faces, &vec![0; 60_000], 1);
    assert_same(&[[0, 1, 2]; 60_000], &[0; 3], 1);
}

#[test]
fn damaged_bits_are_refused_or_give_other_faces() {
    let mesh = samples::gyroid(3000);
    let row_of = rows_of(&mesh);
    let rows = row_of.iter().max().map_or(0, |&row| row as usize + 1);
    let (patches, _, _) = Patches::new(&faces_of(&mesh), &row_of, rows, 4);
    let mut bytes = Vec::new();
    patches.store(&mut bytes);
    let mut refused = 0;
    for bit in (0..8 * bytes.len()).step_by(13) {
        let mut damaged = bytes.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        let read = Patches::restore(patches.rows.clone(), 4, &mut Reader::new(&damaged));
        let read = read.and_then(|patches| all_faces(&patches));
        refused += usize::from(read.is_err());
        for face in read.unwrap_or_default() {
            assert!(face.iter().all(|&node| (node as usize) < mesh.positions.len()));
        }
    }
    assert!(refused > 100, "{refused}");
}
