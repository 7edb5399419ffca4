//! Properties of vertex blocks that hold for any mesh.

use meshlod_fixtures::mesh;
use meshlod_measure::{DistanceOptions, distance};
use meshlod_mesh::Bounds;
use meshlod_samples as samples;

use super::*;
use crate::test_meshes::meshes;

fn of_bits(mesh: &Mesh, bits: u32) -> (VertexBlocks, BlocksReport) {
    VertexBlocks::new(mesh, Accuracy::Bits(bits)).unwrap()
}

fn decoded(mesh: &Mesh, blocks: &VertexBlocks) -> Mesh {
    let mut decoded = mesh.clone();
    for (vertex, place) in blocks.vertices().iter().zip(blocks.positions()) {
        decoded.positions[vertex.index()] = place;
    }
    decoded
}

fn restored(bytes: &[u8]) -> Result<VertexBlocks, Malformed> {
    let mut reader = Reader::new(bytes);
    let blocks = VertexBlocks::restore(&mut reader)?;
    reader.finish()?;
    Ok(blocks)
}

fn stored(blocks: &VertexBlocks) -> Vec<u8> {
    let mut bytes = Vec::new();
    blocks.store(&mut bytes);
    bytes
}

#[test]
fn each_vertex_decodes_alone_as_its_matrix_says() {
    for mesh in meshes() {
        let (blocks, _) = of_bits(&mesh, 10);
        let places = blocks.positions();
        assert_eq!(places.len(), mesh.positions.len());
        for at in (0..places.len()).step_by(13) {
            assert_eq!(blocks.position(at), places[at]);
            let [u, v, w] = blocks.cell(at).map(|x| x as f32);
            for (k, [a, b, c, d]) in blocks.matrix(at / 32).into_iter().enumerate() {
                let x = f64::from(a * u + b * v + c * w + d);
                assert!((x - places[at][k]).abs() < 1e-5, "{x} {:?}", places[at]);
            }
        }
    }
}

#[test]
fn flipped_and_lost_faces_are_counted_as_they_decode() {
    for mesh in [samples::gyroid(20_000), samples::terrain(20_000)] {
        let (blocks, report) = of_bits(&mesh, 6);
        let decoded = decoded(&mesh, &blocks);
        let normal = |mesh: &Mesh, face: usize| {
            let [a, b, c] = mesh.triangle(mesh.faces[face]);
            (b - a).cross(c - a)
        };
        let is_lost = |&face: &usize| {
            let was = normal(&mesh, face);
            was.dot(normal(&decoded, face)) <= 1e-10 * was.length_squared()
        };
        assert_eq!((0..mesh.faces.len()).filter(is_lost).count(), report.blocks.flips);
    }
}

#[test]
fn surfaces_are_as_close_as_in_cubes_with_no_more_flips() {
    for mesh in [samples::sphere(6000), samples::gyroid(6000), samples::terrain(4000)] {
        for bits in [8, 11] {
            let (blocks, report) = of_bits(&mesh, bits);
            assert!(report.blocks.flips <= report.cubes.flips, "{report:?}");
            assert!(report.blocks.max_estimate <= 2.0 * report.cubes.max_estimate, "{report:?}");
            let low = Bounds::of(&mesh.positions).min;
            let round =
                |x: f64, low: f64| low + ((x - low) / report.cube_side).round() * report.cube_side;
            let mut cubes = mesh.clone();
            for place in &mut cubes.positions {
                *place = [0, 1, 2].map(|k| round(place[k], low[k]));
            }
            let options = DistanceOptions { samples: 20_000, ..Default::default() };
            let [ours, bound] = [&decoded(&mesh, &blocks), &cubes]
                .map(|coarse| distance(&mesh, coarse, &options).unwrap());
            // The estimate by planes is right within a few percent.
            assert!(ours.mean() < 1.03 * bound.mean(), "{} {}", ours.mean(), bound.mean());
            assert!(ours.max() < 2.0 * bound.max(), "{} {}", ours.max(), bound.max());
        }
    }
}

#[test]
fn a_requested_error_is_kept() {
    let mesh = samples::gyroid(6000);
    for error in [1e-2, 1e-4] {
        let (blocks, _) = VertexBlocks::new(&mesh, Accuracy::Error(error)).unwrap();
        let options = DistanceOptions { samples: 20_000, ..Default::default() };
        let mean = distance(&mesh, &decoded(&mesh, &blocks), &options).unwrap().mean();
        assert!((0.5 * error..1.02 * error).contains(&mean), "{mean} for {error}");
    }
}

#[test]
fn smooth_meshes_shrink_to_less_than_a_fifth() {
    let (blocks, _) = of_bits(&samples::sphere(40_000), 11);
    assert!(blocks.reduction() > 0.82, "{}", blocks.reduction());
}

#[test]
fn stored_data_comes_back_and_has_the_reported_size() {
    for mesh in meshes().into_iter().chain([Mesh::default()]) {
        let (blocks, _) = of_bits(&mesh, 11);
        let bytes = stored(&blocks);
        assert_eq!(bytes.len(), blocks.bytes());
        let back = restored(&bytes).unwrap();
        assert_eq!(back.positions(), blocks.positions());
        assert!(back.vertices().iter().zip(0..).all(|(&v, at)| v == VertexId(at)));
        assert_eq!(stored(&back), bytes);
    }
}

#[test]
fn damaged_bytes_do_no_harm() {
    let bytes = stored(&of_bits(&samples::gyroid(3000), 9).0);
    for length in (0..bytes.len()).step_by(7) {
        assert!(restored(&bytes[..length]).is_err());
    }
    let mut state = 1u64;
    let mut is_well = [0, 0];
    for turn in 0..4000 {
        let mut bytes = bytes.clone();
        for _ in 0..=turn % 3 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            // Half of the changes are in the parameters that all blocks share.
            let most = if turn % 2 == 0 { 80 } else { bytes.len() };
            let at = (state >> 33) as usize % most;
            bytes[at] = (state >> 24) as u8;
        }
        let blocks = restored(&bytes);
        is_well[usize::from(blocks.is_ok())] += 1;
        if let Ok(blocks) = blocks {
            assert!(blocks.positions().iter().flatten().all(|x| x.is_finite()));
        }
    }
    assert!(is_well[0] > 500 && is_well[1] > 500, "{is_well:?}");
}

#[test]
fn vertices_may_be_in_any_order_within_a_block() {
    let mesh = samples::sphere(3000);
    let mut ordered = blocks_of(&mesh);
    ordered.chunks_mut(BLOCK).for_each(<[_]>::reverse);
    let blocks = VertexBlocks::from_blocks(&mesh, &ordered, Accuracy::Bits(11)).unwrap();
    let plain = of_bits(&mesh, 11).0.bytes() as f64;
    assert!((blocks.bytes() as f64 / plain - 1.0).abs() < 0.02);
}

#[test]
fn impossible_requests_are_refused() {
    let far = |x: f64| mesh(&[[x, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
    let ask = |x: f64, target| VertexBlocks::new(&far(x), target).err();
    for bits in [0, 1, 25, 64, u32::MAX] {
        assert_eq!(ask(0.0, Accuracy::Bits(bits)), Some(BlocksError::Bits(bits)));
    }
    for error in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(ask(0.0, Accuracy::Error(error)), Some(BlocksError::Error(error)));
    }
    assert!(matches!(ask(0.0, Accuracy::Error(f64::NAN)), Some(BlocksError::Error(_))));
    assert!(matches!(ask(0.0, Accuracy::Error(1e-30)), Some(BlocksError::TooFine(_))));
    for x in [f64::NAN, f64::INFINITY, 1e300] {
        assert_eq!(ask(x, Accuracy::Bits(11)), Some(BlocksError::NotFinite(VertexId(0))));
    }
}

#[test]
fn flat_tiny_and_far_meshes_stay_where_they_are() {
    let targets =
        [Accuracy::Bits(2), Accuracy::Bits(11), Accuracy::Bits(24), Accuracy::Error(1e300)];
    for (scale, from) in
        [(1.0, 0.0), (1e30, 0.0), (1e-30, 0.0), (1.0, 1e6), (0.0, 5.0), (0.0, 1e30)]
    {
        let place = |x: f64, y: f64| [from + scale * x, from + scale * y, from];
        let corners = [place(0.0, 0.0), place(1.0, 0.0), place(0.0, 1.0)];
        let mesh = mesh(&corners, &[[0, 1, 2]]);
        for target in targets {
            let blocks = VertexBlocks::new(&mesh, target).unwrap().0;
            let most = if target == Accuracy::Bits(11) { scale / 256.0 } else { scale };
            for (vertex, is) in blocks.vertices().iter().zip(blocks.positions()) {
                for (is, was) in is.iter().zip(corners[vertex.index()]) {
                    assert!((is - was).abs() <= most, "{is} for {was}, {target:?}");
                }
            }
        }
    }
}
