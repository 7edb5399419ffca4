use meshlod_fixtures::grid;
use meshlod_mesh::{Connectivity, VertexId};
use meshlod_samples as samples;

use super::*;
use crate::Scene;
use crate::scene::ConditionedScene;

/// Takes a mesh apart into faces with three vertices each.
fn torn(of: &Mesh) -> Mesh {
    let positions = of.faces.as_flattened().iter().map(|v| of.positions[v.index()]).collect();
    let faces = (0..of.faces.len() as u32).map(|f| [0, 1, 2].map(|k| VertexId(3 * f + k)));
    Mesh::new(positions, faces.collect())
}

/// Every face with its back.
fn doubled(mut mesh: Mesh) -> Mesh {
    let back: Vec<_> = mesh.faces.iter().map(|&[a, b, c]| [c, b, a]).collect();
    mesh.faces.extend(back);
    mesh
}

/// A surface and a slightly smaller copy that share every `every`th vertex.
fn pinched(mut mesh: Mesh, every: usize) -> Mesh {
    let count = mesh.positions.len();
    let inner = |v: VertexId| match v.index() % every {
        0 => v,
        _ => VertexId::new(count + v.index()),
    };
    let faces: Vec<_> = mesh.faces.iter().map(|face| face.map(inner)).collect();
    mesh.faces.extend(faces);
    let positions: Vec<_> = mesh.positions.iter().map(|p| p.map(|x| 0.99 * x)).collect();
    mesh.positions.extend(positions);
    mesh
}

fn ratio(mesh: &Mesh, ratio: f64) -> (Mesh, Report) {
    simplify(mesh, Target::Ratio(ratio), &Options::default()).unwrap()
}

#[test]
fn a_torn_mesh_is_simplified_as_the_whole_one() {
    let knot = samples::knot(4_000);
    let (level, report) = ratio(&torn(&knot), 0.1);
    assert!(report.reached && report.input_faces == knot.faces.len());
    let connectivity = Connectivity::new(&level.faces, level.positions.len());
    assert!(connectivity.is_closed() && connectivity.pinched_vertices() == 0);
}

#[test]
fn doubled_and_pinched_meshes_reach_their_target() {
    let ball = samples::sphere(40_000);
    for (what, mesh) in [("doubled", doubled(ball.clone())), ("pinched", pinched(ball, 20))] {
        let (level, report) = ratio(&mesh, 0.01);
        assert!(report.reached, "{what}: {} of {} faces", level.faces.len(), mesh.faces.len());
    }
}

#[test]
fn everything_is_as_it_was_where_nothing_was_contracted() {
    for mesh in [doubled(samples::sphere(500)), meshlod_fixtures::hourglass()] {
        assert_eq!(ratio(&mesh, 1.0).0, mesh);
    }
}

#[test]
fn a_scene_counts_what_it_shows() {
    let mut scene = Scene::from_mesh("", torn(&grid(3)));
    scene.nodes.push(scene.nodes[0].clone());
    scene.roots.push(1);
    let counts = |options: &Options, borders| {
        ConditionedScene::new(&scene, options, borders).unwrap().counts().stitched_edges
    };
    let one = counts(&Options::default(), Borders::Stitch);
    assert!(one > 0 && one.is_multiple_of(2));
    let keep = Options { topology: Topology::Keep, ..Options::default() };
    assert_eq!(counts(&keep, Borders::Stitch), 0);
    assert_eq!(counts(&Options::default(), Borders::Keep), 0);
}

#[test]
fn all_vertices_locked_or_no_faces_wanted_end_at_once() {
    let mesh = doubled(samples::sphere(500));
    let of_vertex = vec![meshlod_mesh::Lock::Locked; mesh.positions.len()];
    let options = Options { locks: Locks { of_vertex, ..Locks::default() }, ..Options::default() };
    let (level, report) = simplify(&mesh, Target::Faces(0), &options).unwrap();
    assert!(!report.reached);
    assert_eq!(level, mesh);
    let (_, report) = simplify(&mesh, Target::Faces(0), &Options::default()).unwrap();
    assert!(report.output_faces < 100);
}
