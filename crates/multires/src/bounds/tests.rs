//! Bounds hold, are monotone, and are reasonably tight.

use meshlod_fixtures as fixtures;
use meshlod_measure::{PreparedSurface, vertex_errors};
use meshlod_mesh::{Mesh, VertexId};
use meshlod_samples as samples;
use meshlod_simplify::Method;

use crate::forest::NONE;
use crate::tests::walks::{Dice, each, forest, query, soup};
use crate::{Cut, ErrorKind, Forest, Implicit, Level, Model, UpdateLimits};

/// Twice the distance that rounding to `f32` moves a vertex of a mesh of diagonal 1.
const ROUNDED: f64 = 2e-7;

fn bounded(mut forest: Forest) -> Forest {
    forest.measure_bounds();
    forest
}

/// Sample points at the corners, on the edges and inside the faces of a mesh, with the face of
/// each.
fn points(mesh: &Mesh) -> (Mesh, Vec<usize>) {
    const STEPS: u32 = 5;
    let (mut points, mut faces) = (Mesh::default(), Vec::new());
    for (f, &face) in mesh.faces.iter().enumerate() {
        let [a, b, c] = mesh.triangle(face);
        for i in 0..=STEPS {
            for j in 0..=STEPS - i {
                let [i, j] = [i, j].map(|steps| f64::from(steps) / f64::from(STEPS));
                points.positions.push((a + (b - a) * i + (c - a) * j).into());
                faces.push(f);
            }
        }
    }
    (points, faces)
}

/// Largest amount by which a level is farther from the mesh than its updates' errors times a
/// factor, or the mesh from it, in diagonals.
fn excess(mesh: &Mesh, mt: &Implicit, level: &Level, factor: f64) -> f64 {
    let diagonal = mesh.bounds().diagonal();
    let found = level.mesh();
    // Two of the smallest samples are reduced to faces without area, which have no surface.
    let (Ok(finest), Ok(coarse)) = (PreparedSurface::new(mesh), PreparedSurface::new(&found))
    else {
        return -1.0;
    };
    let error = |v: u32| {
        let update = mt.update_of(level.nodes[v as usize]);
        update.map_or(0.0, |u| mt.frame().model_length(mt.error(u).get()) * factor)
    };
    let of_face: Vec<f64> =
        level.faces.iter().map(|face| face.map(error).into_iter().fold(0.0, f64::max)).collect();
    let all = of_face.iter().copied().fold(0.0, f64::max);
    let (from_level, faces) = points(&found);
    let here = vertex_errors(&from_level, &finest);
    let here = here.iter().zip(&faces).map(|(off, &face)| off - of_face[face]);
    let there = vertex_errors(&points(mesh).0, &coarse).into_iter().map(|off| off - all);
    here.chain(there).fold(f64::NEG_INFINITY, f64::max) / diagonal
}

#[test]
fn every_triangle_is_within_its_bound_and_the_mesh_within_the_greatest() {
    each(|what, mesh, forest| {
        let mt = Implicit::new(&bounded(forest.clone())).unwrap();
        assert_eq!(mt.error_kind(), ErrorKind::Bound);
        let mut dice = Dice(3);
        let mut cut = Cut::new(&mt);
        for _ in 0..5 {
            let query = query(&mut dice, mesh);
            cut.update(&query, &UpdateLimits::default()).unwrap();
            let excess = excess(mesh, &mt, &cut.level(), 1.0);
            assert!(excess < ROUNDED, "{what} {query:?}: {excess:e}");
        }
    });
    // Meshes that are not manifold, not oriented, or open everywhere.
    let mut dice = Dice(11);
    for mut mesh in (0..10).map(soup).chain([fixtures::moebius(60)]) {
        // Degenerate faces are left out of a simplification from the start.
        mesh.faces.retain(|[a, b, c]| a != b && b != c && c != a);
        for method in [Method::Qem, Method::LeeJang] {
            let mt = Implicit::new(&bounded(forest(&mesh, method))).unwrap();
            let mut cut = Cut::new(&mt);
            for _ in 0..5 {
                cut.update(&query(&mut dice, &mesh), &UpdateLimits::default()).unwrap();
                let excess = excess(&mesh, &mt, &cut.level(), 1.0);
                assert!(excess < ROUNDED, "{} {excess:e}", method.name());
            }
        }
    }
}

#[test]
fn smaller_ones_would_not_hold() {
    let mesh = samples::torus(4000);
    let estimates = forest(&mesh, Method::Qem);
    let bounds = bounded(estimates.clone());
    let worst = |forest: &Forest, factor: f64| {
        let model = Model::new(forest).unwrap();
        let mut extractor = model.extractor();
        let tolerances = [0.001, 0.003, 0.01, 0.03];
        let worst = tolerances.map(|tolerance| {
            excess(&mesh, model.implicit(), extractor.uniform(tolerance).unwrap(), factor)
        });
        worst.into_iter().fold(f64::NEG_INFINITY, f64::max)
    };
    assert!(worst(&bounds, 1.0) < ROUNDED);
    assert!(worst(&bounds, 0.7) > 10.0 * ROUNDED, "{:e}", worst(&bounds, 0.7));
    assert!(worst(&estimates, 1.0) > 10.0 * ROUNDED, "estimates are no bounds");
}

#[test]
fn bounds_never_grow_along_needs() {
    each(|what, _, forest| {
        let forest = bounded(forest.clone());
        let parents = forest.parents();
        for (u, update) in forest.updates.iter().enumerate() {
            let up = forest.ring(u).iter().copied().chain([forest.node(u) as u32]);
            for need in up.map(|node| parents[node as usize]).filter(|&need| need != NONE) {
                let needed = forest.updates[need as usize].error;
                assert!(needed >= update.error, "{what}: {u} needs {need}");
            }
        }
    });
}

/// The boundary moves inwards by a little and no more, because placement is pulled to the midpoints
/// of edges.
#[test]
fn what_is_flat_costs_nothing() {
    let estimates = forest(&fixtures::grid(16), Method::Qem);
    let bounds = bounded(estimates.clone());
    let mut free = 0;
    for (bound, estimate) in bounds.updates.iter().zip(&estimates.updates) {
        if estimate.error.get() < 1e-5 {
            free += 1;
            assert!(bound.error.get() < 2e-5, "{bound:?}");
        }
    }
    assert!(free > 250, "{free}");
}

#[test]
fn bounds_of_a_smooth_surface_are_a_few_times_what_is_measured() {
    let mesh = samples::torus(4000);
    let model = Model::new(&bounded(forest(&mesh, Method::Qem))).unwrap();
    let mut extractor = model.extractor();
    for (tolerance, most) in [(0.01, 2.0), (0.03, 3.0), (0.1, 4.0)] {
        let found = extractor.uniform(tolerance).unwrap().mesh();
        let (finest, coarse) =
            (PreparedSurface::new(&mesh).unwrap(), PreparedSurface::new(&found).unwrap());
        let here = vertex_errors(&points(&found).0, &finest).into_iter().fold(0.0, f64::max);
        let there = vertex_errors(&points(&mesh).0, &coarse).into_iter().fold(0.0, f64::max);
        let ratio = tolerance / here.max(there);
        assert!((1.0..most).contains(&ratio), "{tolerance}: {ratio}");
    }
}

#[test]
fn a_face_that_is_all_keeps_a_bound() {
    let two = fixtures::two_objects();
    let mut single = fixtures::tetrahedron();
    single.faces.truncate(1);
    single.faces[0] = [0, 1, 2].map(VertexId);
    for mesh in [two, single] {
        let forest = bounded(forest(&mesh, Method::Qem));
        assert!(forest.updates.iter().all(|u| u.error.get().is_finite()));
    }
}
