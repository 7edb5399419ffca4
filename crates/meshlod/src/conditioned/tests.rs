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

#[test]
fn a_number_of_faces_near_what_flats_leave_moves_nothing() {
    let steps = samples::stairs(5_000);
    let volume = meshlod_measure::volume(&steps);
    let to = |faces| simplify(&steps, Target::Faces(faces), &Options::default()).unwrap();
    for faces in [100, 130, 399] {
        let (level, report) = to(faces);
        assert!(report.reached && report.contractions.edges == 0, "{report:?}");
        assert_eq!(level.faces.len(), 100);
        assert!((meshlod_measure::volume(&level) - volume).abs() < 1e-12);
    }
    // Runs by themselves.
    assert_eq!(to(400).0.faces.len(), 400);
    let (level, report) = to(90);
    assert!(level.faces.len() <= 90 && report.contractions.edges > 300);
    let torus = samples::torus(1_000);
    assert_eq!(
        simplify(&torus, Target::Faces(300), &Options::default()).unwrap().0.faces.len(),
        300
    );
}

#[test]
fn flats_of_two_sheets_on_the_same_vertices_go() {
    let to = |mesh: &Mesh, target| simplify(mesh, target, &Options::default()).unwrap();
    let card = doubled(grid(12));
    let (level, report) = to(&card, Target::Error(0.0));
    assert!(report.reached && report.error_estimate == 0.0);
    assert_eq!((level.faces.len(), level.positions.len()), (4, 4));
    let (level, report) = to(&card, Target::Faces(5));
    assert_eq!((level.faces.len(), report.contractions.edges), (4, 0));
    let cube = samples::cube(600);
    let cube = Mesh::new(cube.positions, cube.faces);
    assert_eq!(to(&doubled(cube.clone()), Target::Error(0.0)).0.faces.len(), 24);
    // The same sheet twice is one.
    let twice = Mesh::new(cube.positions, cube.faces.repeat(2));
    assert_eq!(to(&twice, Target::Error(0.0)).0.faces.len(), 12);
}

#[test]
fn flats_far_from_the_origin_take_no_more_of_an_error_than_rounding() {
    // A sheet that is slightly bent, by less than the error.
    let mut sheet = grid(40);
    for place in &mut sheet.positions {
        let bend = 1e-4 * place[0] * place[0];
        *place = [1e7 + 1e-3 * place[0], 1e7 + 1e-3 * place[1], 1e7 + 1e-3 * bend];
    }
    let mut ready = ConditionedMesh::new(&sheet, Options::default(), None);
    let error = 1e-3;
    ready.flatten_within(error);
    assert!(ready.moved() <= FLAT * sheet.bounds().diagonal(), "{}", ready.moved());
}
