use glam::DVec3;
use meshlod_fixtures::grid;
use meshlod_mesh::{Mesh, VertexId};
use meshlod_samples::{cube, sphere};

use super::*;

fn bound(triangle: [[f64; 3]; 3], mesh: &Mesh, most: f64) -> Option<f64> {
    let surface = Bvh::new(mesh).unwrap();
    let mates = Mates::new(mesh, &surface);
    let middle = triangle.into_iter().map(DVec3::from).sum::<DVec3>() / 3.0;
    let start = surface.closest(middle.into(), None).face;
    match Sheet::new(&surface, &mates).cover(triangle, &[start], [0.5 * most, most]) {
        Cover::Within(bound) => Some(bound),
        Cover::High(_) | Cover::Open => None,
    }
}

fn moved(mesh: &Mesh, change: impl Fn(f64) -> f64) -> Mesh {
    let positions = mesh.positions.iter().map(|at| at.map(&change)).collect();
    Mesh::new(positions, mesh.faces.clone())
}

/// The unit square, divided into n by n squares.
fn plane(n: u32) -> Mesh {
    moved(&grid(n), |x| x / f64::from(n))
}

/// A triangle over most of the unit square at this height.
fn over(z: f64) -> [[f64; 3]; 3] {
    [[0.05, 0.05, z], [0.95, 0.1, z], [0.1, 0.95, z]]
}

#[test]
fn faces_that_cover_a_triangle_bound_its_distance_along_the_normal() {
    let mesh = plane(40);
    for height in [0.0, 1e-9, 0.01] {
        let found = bound(over(height), &mesh, 0.011).unwrap();
        assert!((height..height + 0.02 * 0.011 + 1e-12).contains(&found), "{height} {found}");
    }
    assert_eq!(bound(over(0.012), &mesh, 0.011), None);
}

#[test]
fn a_hole_is_not_covered_but_a_seam_and_a_turned_face_are() {
    let whole = plane(9);
    let mut holed = whole.clone();
    let middle = |face: &[VertexId; 3]| {
        face.iter().map(|v| DVec3::from(whole.positions[v.index()])).sum::<DVec3>() / 3.0
    };
    let at = DVec3::new(0.3, 0.3, 0.0);
    let near = |face: &&[VertexId; 3]| middle(face).distance(at);
    let gone = *whole.faces.iter().min_by(|a, b| near(a).total_cmp(&near(b))).unwrap();
    holed.faces.retain(|face| *face != gone);
    assert_eq!(bound(over(0.0), &holed, 0.01), None);
    // Put back with vertices of its own, and turned over.
    let first = holed.positions.len();
    holed.positions.extend(gone.map(|v| whole.positions[v.index()]));
    holed.faces.push([2, 1, 0].map(|i| VertexId::new(first + i)));
    assert!(bound(over(0.0), &holed, 0.01).is_some());
}

#[test]
fn a_fold_does_not_count_twice_and_a_fin_is_no_hole() {
    // A sheet that comes back over itself covers a point as often as it does so, with signs.
    let sheet = |points: &[[f64; 2]], faces: &[[usize; 2]]| {
        let rows = points.iter().flat_map(|&[x, z]| [[x, -1.0, z], [x, 2.0, z]]);
        let quad = |&[a, b]: &[usize; 2]| {
            let [p, q, r, s] = [2 * a, 2 * b, 2 * b + 1, 2 * a + 1].map(VertexId::new);
            [[p, q, r], [p, r, s]]
        };
        Mesh::new(rows.collect(), faces.iter().flat_map(quad).collect())
    };
    let fold = sheet(&[[-1.0, 0.0], [0.5, 0.001], [-1.0, 0.002]], &[[0, 1], [1, 2]]);
    assert_eq!(bound(over(0.0), &fold, 0.01), None, "there and back covers nothing");
    let fin = sheet(&[[-1.0, 0.0], [0.4, 0.0], [2.0, 0.0], [0.4, 3.0]], &[[0, 1], [1, 2], [1, 3]]);
    assert!(bound(over(0.0), &fin, 0.01).is_some());
}

#[test]
fn no_point_is_farther_than_the_bound() {
    let mesh = sphere(3_000);
    let surface = Bvh::new(&mesh).unwrap();
    let mates = Mates::new(&mesh, &surface);
    let coarse = sphere(200);
    let mut sheet = Sheet::new(&surface, &mates);
    let mut count = 0;
    for face in &coarse.faces {
        let [a, b, c] = face.map(|v| DVec3::from(coarse.positions[v.index()]));
        let start = surface.closest(((a + b + c) / 3.0).into(), None).face;
        let triangle = [a, b, c].map(|at| at.to_array());
        let Cover::Within(bound) = sheet.cover(triangle, &[start], [0.15, 0.3]) else { continue };
        count += 1;
        let mut farthest = 0f64;
        for (i, j) in (0..=20).flat_map(|i| (0..=20 - i).map(move |j| (i, j))) {
            let [s, t] = [i, j].map(|k| f64::from(k) / 20.0);
            let at = a + (b - a) * s + (c - a) * t;
            farthest = farthest.max(surface.closest(at.into(), None).distance_squared.sqrt());
        }
        assert!(farthest <= bound && bound < 2.0 * farthest + 0.01, "{farthest} {bound}");
    }
    assert!(2 * count > coarse.faces.len(), "{count}");
}

#[test]
fn beside_an_edge_a_face_is_covered_by_its_own_side() {
    let mesh = moved(&cube(1_000), |x| x + 0.5);
    let side = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
    let found = bound(side, &mesh, 1e-9);
    assert!(found.is_some_and(|found| found <= 1e-9), "{found:?}");
    let by = |offset: f64| moved(&mesh, |x| x + offset);
    assert!(bound(side, &by(1e-10), 1e-9).is_some());
    assert_eq!(bound(side, &by(2e-9), 1e-9), None);
}

#[test]
fn a_surface_that_is_there_twice_covers_as_one() {
    let mut twice = plane(9);
    let behind: Vec<_> = twice.faces.iter().map(|&[a, b, c]| [c, b, a]).collect();
    twice.faces.extend(behind);
    assert!(bound(over(0.0), &twice, 0.01).is_some());
}

#[test]
fn a_hundred_thousand_faces_at_one_point_are_no_trouble() {
    let mut mesh = plane(9);
    let first = mesh.positions.len();
    mesh.positions.extend(std::iter::repeat_n([0.5; 3], 300_000));
    let face = |i: usize| [0, 1, 2].map(|k| VertexId::new(first + 3 * i + k));
    mesh.faces.extend((0..100_000).map(face));
    assert!(bound(over(0.0), &mesh, 0.01).is_some());
    assert!(bound([[0.2, 0.23, 0.0]; 3], &mesh, 0.01).is_some());
    for most in [0.0, -1.0, f64::NAN] {
        assert_eq!(bound(over(0.0), &mesh, most), None);
    }
}
