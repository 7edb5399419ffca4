//! Properties of each level: a single sheet over the rectangle, within the tolerance.

use meshlod_fixtures as fixtures;
use meshlod_mesh::{Connectivity, Mesh};

use super::{SIZES, Sample};
use crate::length16::Length16;
use crate::rtin::{HeightField, Rtin, RtinExtractor};
use crate::tests::walks::{Dice, query};
use crate::{Level, Query, ViewCamera};

/// Checks that a level is a disc without folds, exactly over the rectangle of the field: of the
/// same area, with no open edge but along its sides. So there are no T-junctions.
pub(super) fn assert_covers(level: &Level, model: &Rtin, looks_down: bool) {
    let size = model.size();
    let place = |node: u32| [node % size[0], node / size[0]].map(i64::from);
    let mut area = 0;
    let mut nodes: Vec<[u32; 3]> = Vec::new();
    for face in &level.faces {
        let corners = face.map(|v| level.nodes[v as usize]);
        let [[ax, ay], [bx, by], [cx, cy]] = corners.map(place);
        let turn = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
        assert_eq!(turn < 0, looks_down, "a face looks the other way");
        area += turn.abs();
        nodes.push(corners);
    }
    let [right, top] = size.map(|count| i64::from(count) - 1);
    assert_eq!(area, 2 * right * top);
    let mesh = level.mesh();
    let c = Connectivity::new(&mesh.faces, mesh.positions.len());
    let bad = [c.non_manifold_edges(), c.inconsistent_edges(), c.pinched_vertices()];
    assert_eq!(bad, [0; 3]);
    assert_eq!(mesh.positions.len() + mesh.faces.len(), c.edge_count() + 1);
    let mut sides: Vec<[u32; 2]> =
        nodes.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    sides.sort_unstable();
    for &[a, b] in sides.iter().filter(|&&[a, b]| sides.binary_search(&[b, a]).is_err()) {
        let [[ax, ay], [bx, by]] = [a, b].map(place);
        let is_along = |a: i64, b: i64, end: i64| a == b && (a == 0 || a == end);
        assert!(is_along(ax, bx, right) || is_along(ay, by, top), "a crack from {a} to {b}");
    }
}

/// Returns for each face the greatest distance along the axis to the vertices under it, and the
/// least distance from the eye to one of these.
fn distances(level: &Level, field: &HeightField, eye: [f64; 3]) -> Vec<[f64; 2]> {
    let columns = field.size()[0];
    let [across, along, up] = [1, 2, 3].map(|k| (field.axis() + k) % 3);
    let positions = level.mesh().positions;
    let of = |face: &[u32; 3]| {
        let corners = face.map(|v| {
            let node = level.nodes[v as usize];
            [f64::from(node % columns), f64::from(node / columns), positions[v as usize][up]]
        });
        let turn = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        };
        let [a, b, c] = corners;
        let range = |k: usize| {
            let at = corners.map(|p| p[k] as u32);
            at.into_iter().min().unwrap()..=at.into_iter().max().unwrap()
        };
        let mut found = [0f64, f64::INFINITY];
        for (column, row) in range(0).flat_map(|c| range(1).map(move |r| (c, r))) {
            let p = [f64::from(column), f64::from(row), 0.0];
            let parts = [turn(p, b, c), turn(a, p, c), turn(a, b, p)];
            let weights = parts.map(|part| part / turn(a, b, c));
            if weights.iter().any(|&w| w < 0.0) {
                continue;
            }
            let point = field.point(column, row);
            let flat: f64 = weights.iter().zip(corners).map(|(w, corner)| w * corner[2]).sum();
            let [dx, dy, dz] = [across, along, up].map(|k| point[k] - eye[k]);
            found[0] = found[0].max((flat - point[up]).abs());
            found[1] = found[1].min((dx * dx + dy * dy + dz * dz).sqrt());
        }
        found
    };
    level.faces.iter().map(of).collect()
}

fn camera(mesh: &Mesh, dice: &mut Dice) -> ViewCamera {
    let bounds = mesh.bounds();
    let size = bounds.diagonal();
    let eye = bounds.min.map(|x| x + size * (dice.roll() - 0.2));
    let look = bounds.center();
    ViewCamera { eye, look, up: [0.1, 0.2, 1.0], fov_rad: 0.9, viewport: [300, 200] }
}

#[test]
fn every_level_covers_the_field_once() {
    for size in SIZES {
        for (up, looks_down) in [(0, false), (1, true), (2, true)] {
            let sample = Sample { up, looks_down, ..Sample::new(size) };
            let (mesh, model) = (sample.mesh(), sample.model());
            let mut extractor = RtinExtractor::new(&model);
            let mut dice = Dice(11);
            for faces in 0..40 {
                let query = query(&mut dice, &mesh);
                assert_covers(extractor.exact(&query).unwrap(), &model, looks_down);
                assert_covers(extractor.saturated(&query).unwrap(), &model, looks_down);
                let level = extractor.at_most(10 * faces, &query).unwrap();
                assert_covers(level, &model, looks_down);
            }
            let finest = extractor.exact(&Query::uniform(0.0)).unwrap();
            assert!(finest.faces.len() <= model.full_faces());
        }
    }
}

#[test]
fn triangles_are_within_the_tolerance() {
    for size in [[9, 9], [12, 17], [40, 23]] {
        let sample = Sample::new(size);
        let (mesh, field, model) = (sample.mesh(), sample.field(), sample.model());
        assert_eq!(model.fit().rounded, 0.0);
        let mut extractor = RtinExtractor::new(&model);
        let mut dice = Dice(3);
        for step in 0..30 {
            let tolerance = 3.0 * dice.roll() * dice.roll();
            let camera = camera(&mesh, &mut dice);
            let slope = tolerance * camera.pixel();
            for (query, floor, slope) in [
                (Query::uniform(tolerance), tolerance, 0.0),
                (Query::pixels(camera, tolerance), 0.0, slope),
            ] {
                let exact = extractor.exact(&query).unwrap().clone();
                for level in [&exact, extractor.saturated(&query).unwrap()] {
                    for [off, distance] in distances(level, &field, camera.eye) {
                        let most = floor + slope * distance + 1e-6;
                        assert!(off <= most, "{off} is too far, step {step}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_budget_is_kept_and_used_up() {
    let sample = Sample::new([33, 33]);
    let model = sample.model();
    let mut extractor = RtinExtractor::new(&model);
    let query = Query::uniform(0.0);
    let full = extractor.exact(&query).unwrap().clone();
    for faces in [2, 3, 10, 100, 500, 1000, full.faces.len()] {
        let found = extractor.at_most(faces, &query).unwrap().faces.len();
        assert!(found <= faces && found + 2 > faces, "{found} of {faces}");
    }
    assert_eq!(extractor.at_most(usize::MAX, &query).unwrap().canonical(), full.canonical());
    // The level at one tolerance is the best of its size.
    for tolerance in [0.2, 0.7, 1.5] {
        let level = extractor.exact(&Query::uniform(tolerance)).unwrap().clone();
        let same = extractor.at_most(level.faces.len(), &query).unwrap();
        assert_eq!(same.canonical(), level.canonical());
    }
}

#[test]
fn certification_finds_every_reduced_error_and_radius() {
    for size in [[9, 9], [12, 17]] {
        let model = Sample::new(size).model();
        assert_eq!(model.certify().unwrap() + corners(&model), model.grid.count());
        for index in 0..model.grid.count() {
            if model.grid.diamond(model.grid.place(index)).is_none() {
                continue;
            }
            let mut other = model.clone();
            let vertex = &mut other.vertices[index];
            if vertex.error > Length16(0) {
                vertex.error.0 -= 1;
                assert!(other.certify().is_err(), "the error of {index}");
            }
            let mut other = model.clone();
            other.vertices[index].radius.0 -= 30;
            assert!(other.certify().is_err(), "the radius of {index}");
            let mut other = model.clone();
            other.radii[index].0 -= 1;
            assert!(other.certify().is_err(), "the own radius of {index}");
        }
    }
}

/// Returns how many corners of the square are in the field.
fn corners(model: &Rtin) -> usize {
    let all = (0..model.grid.count()).map(|index| model.grid.place(index));
    all.filter(|&place| model.grid.diamond(place).is_none()).count()
}

/// Skips with a note if the shared meshes are missing.
#[test]
fn the_shared_terrain_if_there_keeps_its_tolerances() {
    let Some(path) = fixtures::shared_mesh("terrain-jacksboro.ply") else {
        return eprintln!("skipped: no terrain-jacksboro.ply");
    };
    let mesh = meshlod_io::ply::read(&std::fs::read(path).unwrap()).unwrap();
    let field = HeightField::from_mesh(&mesh).unwrap();
    let model = Rtin::new(&field);
    model.certify().unwrap();
    assert_eq!((model.full_faces(), model.fit().rounded), (mesh.faces.len(), 0.0));
    let mut extractor = RtinExtractor::new(&model);
    for tolerance in [200.0, 20.0, 2.0, 0.5] {
        let level = extractor.exact(&Query::uniform(tolerance)).unwrap();
        assert_covers(level, &model, false);
        let off = distances(level, &field, [0.0; 3]).iter().map(|d| d[0]).fold(0.0, f64::max);
        assert!(off <= tolerance + 1e-3, "{off} of {tolerance}");
    }
}
