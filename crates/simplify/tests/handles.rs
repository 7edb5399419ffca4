//! Handles close where that costs least, and nowhere else.

mod common;

use meshlod_fixtures::shape::{TopologyCounts, topology};
use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh, VertexId, WedgeId};
use meshlod_samples as samples;
use meshlod_simplify::{HandleCounts, Observe, Options, Simplifier, Target, Topology, contract_to};

use crate::common::kernel_methods;

/// Fewest faces of a torus.
const FLOOR_OF_TORUS: usize = 14;

/// Tori of these sizes in a row.
fn tori(sizes: &[f64]) -> Mesh {
    let mut all = Mesh::default();
    for (i, &size) in sizes.iter().enumerate() {
        let mesh = samples::torus(1000);
        let start = all.positions.len() as u32;
        let moved =
            mesh.positions.iter().map(|p| [p[0] * size + 4.0 * i as f64, p[1] * size, p[2] * size]);
        all.positions.extend(moved);
        all.faces.extend(mesh.faces.iter().map(|face| face.map(|v| VertexId(v.0 + start))));
    }
    all
}

/// The mesh with its positions as colours.
fn colored(mesh: Mesh) -> Mesh {
    let values = mesh.positions.iter().flatten().map(|&x| x as f32).collect();
    let kind = LayerKind::Color(0);
    let layer = Layer { kind, name: String::new(), width: 3, values };
    let corners = mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
    let wedge_count = mesh.positions.len();
    Mesh { attributes: Some(Attributes { corners, wedge_count, layers: vec![layer] }), ..mesh }
}

/// Returns the Euler number and the number of components of a level, which must be closed, manifold
/// and oriented.
fn shape(level: &Mesh) -> (i64, usize) {
    level.validate().unwrap();
    let TopologyCounts { components, euler, is_closed, non_manifold_edges, inconsistent_edges } =
        topology(level);
    assert!(is_closed && non_manifold_edges == 0 && inconsistent_edges == 0);
    (euler, components)
}

/// An observer that asks for the surface, and does nothing with it.
struct Watching;

impl Observe for Watching {}

#[test]
fn a_torus_becomes_a_ball_unless_its_topology_is_kept() {
    for method in kernel_methods() {
        for mesh in [tori(&[1.0]), colored(tori(&[1.0]))] {
            let options = Options { method, ..Options::default() };
            let (level, report) = contract_to(&mesh, Target::Faces(8), &options).unwrap();
            assert!(report.reached, "{method:?}: {}", report.refusals);
            assert_eq!(report.handles, Some(HandleCounts { before: 1, closed: 1 }));
            assert_eq!(report.output_faces, level.faces.len());
            assert_eq!(shape(&level), (2, 1), "{method:?}");

            let options = Options { topology: Topology::Keep, ..options };
            let (level, report) = contract_to(&mesh, Target::Faces(8), &options).unwrap();
            assert_eq!(report.handles, None);
            assert!(!report.reached && level.faces.len() >= FLOOR_OF_TORUS);
            assert_eq!(shape(&level), (0, 1), "{method:?}");
        }
    }
}

#[test]
fn handles_of_components_that_vanish_are_no_obstacle() {
    let mesh = tori(&[1.0, 0.02, 0.9, 0.03, 0.04]);
    for method in kernel_methods() {
        let options = Options { method, ..Options::default() };
        let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
        for faces in (8..300).rev().step_by(4) {
            let report = simplifier.run(Target::Faces(faces), &mut ()).unwrap();
            let level = simplifier.level();
            assert_eq!(report.output_faces, level.faces.len());
            shape(&level);
            let HandleCounts { before, closed } = report.handles.unwrap();
            assert!(before == 5 && closed <= 5);
        }
        let report = simplifier.run(Target::Faces(8), &mut ()).unwrap();
        assert!(report.reached && report.vanished >= 3);
    }
}

#[test]
fn levels_with_tunnels_stay_manifold() {
    let mesh = samples::gyroid(20_000);
    for mesh in [mesh.clone(), colored(mesh)] {
        let (level, report) = contract_to(&mesh, Target::Faces(60), &Options::default()).unwrap();
        level.validate().unwrap();
        let found = topology(&level);
        assert!(found.non_manifold_edges == 0 && found.inconsistent_edges == 0, "{found:?}");
        assert!(report.handles.is_some_and(|all| all.closed > 0), "{:?}", report.handles);
    }
}

#[test]
fn an_observer_may_come_after_a_handle_has_closed() {
    for mesh in [tori(&[1.0, 1.0]), colored(tori(&[1.0, 1.0]))] {
        let mut simplifier = Simplifier::new(&mesh, &Options::default()).unwrap();
        let report = simplifier.run(Target::Faces(20), &mut ()).unwrap();
        assert!(report.handles.is_some_and(|all| all.closed > 0));
        let before = simplifier.live_faces();
        simplifier.run(Target::Faces(12), &mut Watching).unwrap();
        assert!(simplifier.live_faces() < before);
        let level = simplifier.level();
        shape(&level);
        let alive = simplifier.surface().live_faces();
        assert_eq!([level.faces.len(); 2], [simplifier.live_faces(), alive]);
    }
}
