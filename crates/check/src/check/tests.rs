//! Each kind on the smallest mesh that has it.

use meshlod_fixtures::{cube, fan, grid, hourglass, mesh, moebius, tetrahedron, two_objects};
use meshlod_mesh::{Attributes, FaceId, Labels, MeshError, VertexId};
use meshlod_samples as samples;

use super::*;
use crate::finding::Degeneracy;
use crate::summary::Summary;

/// Returns all findings except intersections, which have their own tests.
fn found(mesh: &Mesh) -> Vec<Finding> {
    let meeting = [Kind::SelfIntersection, Kind::Contact, Kind::Crowded];
    let kinds = meeting.into_iter().fold(Kinds::ALL, Kinds::without);
    findings(mesh, &CheckOptions { kinds, ..CheckOptions::default() })
}

fn of_kind(mesh: &Mesh, kind: Kind) -> Vec<Finding> {
    let kinds = Kinds::NONE.with(kind);
    findings(mesh, &CheckOptions { kinds, ..CheckOptions::default() })
}

fn faces<const N: usize>(ids: [u32; N]) -> [FaceId; N] {
    ids.map(FaceId)
}

fn vertices<const N: usize>(ids: [u32; N]) -> [VertexId; N] {
    ids.map(VertexId)
}

#[test]
fn nothing_is_found_where_nothing_is_wrong() {
    for mesh in [tetrahedron(), cube(), samples::torus(500), Mesh::default()] {
        assert_eq!(found(&mesh), []);
    }
}

#[test]
fn a_non_finite_vertex_excludes_its_faces() {
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut mesh = tetrahedron();
        mesh.positions[3][1] = x;
        let hole = Finding::BoundaryLoop { vertices: vertices([0, 2, 1]).to_vec(), closed: true };
        assert_eq!(found(&mesh), [Finding::NonFiniteVertex { vertex: VertexId(3) }, hole]);
    }
}

#[test]
fn a_missing_vertex_excludes_its_face() {
    let mut mesh = tetrahedron();
    mesh.faces[1][2] = VertexId(u32::MAX);
    let bad = Finding::BadIndex { face: FaceId(1), vertex: VertexId(u32::MAX) };
    let hole = Finding::BoundaryLoop { vertices: vertices([0, 3, 1]).to_vec(), closed: true };
    assert_eq!(found(&mesh), [bad, hole]);
    mesh.positions.clear();
    assert_eq!(of_kind(&mesh, Kind::BadIndex).len(), 4);
}

#[test]
fn mismatched_arrays_are_reported() {
    let mut mesh = tetrahedron();
    mesh.attributes = Some(Attributes::default());
    let error = MeshError::BadLength { what: "attribute corners".into(), found: 0, expected: 4 };
    assert_eq!(found(&mesh), [Finding::BadAttributes { error }]);
    mesh.attributes = None;
    mesh.objects = Some(Labels { names: vec![], of_face: vec![7; 4] });
    let error = MeshError::BadLabel { face: FaceId(0), what: "object", label: 7, count: 0 };
    assert_eq!(found(&mesh), [Finding::BadAttributes { error }]);
}

#[test]
fn unused_and_coincident_vertices_are_told_apart() {
    let mut mesh = grid(1);
    mesh.positions.push([0.0; 3]);
    mesh.positions.push([-0.0; 3]);
    mesh.faces[1][0] = VertexId(5);
    let kinds = [Kind::UnusedVertex, Kind::CoincidentVertices].into_iter().collect();
    let options = CheckOptions { kinds, ..CheckOptions::default() };
    let unused = Finding::UnusedVertex { vertex: VertexId(4) };
    let one_place = Finding::CoincidentVertices { vertices: vertices([0, 5]).to_vec() };
    assert_eq!(findings(&mesh, &options), [unused, one_place]);
}

#[test]
fn degenerate_faces_are_found() {
    let mesh = mesh(
        &[[0.0; 3], [1.0; 3], [2.0; 3], [0.0, 1.0, 0.0]],
        &[[0, 1, 3], [0, 1, 2], [1, 3, 1], [3, 3, 3]],
    );
    let degenerate = |face, shape| Finding::DegenerateFace { face: FaceId(face), shape };
    assert_eq!(
        of_kind(&mesh, Kind::DegenerateFace),
        [
            degenerate(1, Degeneracy::ZeroArea),
            degenerate(2, Degeneracy::RepeatedVertex),
            degenerate(3, Degeneracy::RepeatedVertex),
        ]
    );
}

#[test]
fn duplicates_are_found_whichever_way_round() {
    let mut mesh = tetrahedron();
    mesh.faces.push(vertices([1, 0, 2]));
    mesh.faces.push(vertices([1, 2, 0]));
    let double = |face| Finding::DuplicateFace { face: FaceId(face), of: FaceId(0) };
    assert_eq!(of_kind(&mesh, Kind::DuplicateFace), [double(4), double(5)]);
    // Two faces on their own, and the four faces of a closed mesh, no two of which share three
    // vertices.
    mesh.faces = vec![vertices([0, 1, 2]), vertices([0, 2, 1])];
    assert_eq!(of_kind(&mesh, Kind::DuplicateFace).len(), 1);
    assert_eq!(of_kind(&fan(), Kind::DuplicateFace), []);
}

#[test]
fn a_turned_face_disagrees_along_its_three_edges() {
    let mut mesh = tetrahedron();
    mesh.faces[2].swap(0, 1);
    let with =
        |edge, between| Finding::InconsistentEdge { edge: vertices(edge), faces: faces(between) };
    assert_eq!(found(&mesh), [with([1, 2], [0, 2]), with([1, 3], [1, 2]), with([2, 3], [2, 3])]);
}

#[test]
fn a_moebius_strip_disagrees_once_and_has_one_loop() {
    let summary: Summary = found(&moebius(8)).iter().collect();
    assert_eq!((summary.count(Kind::InconsistentEdge), summary.count(Kind::BoundaryLoop)), (1, 1));
    assert_eq!(summary.total(), 2);
}

#[test]
fn a_fan_of_three_has_an_edge_a_loop_and_a_path() {
    let edge =
        Finding::NonManifoldEdge { edge: vertices([0, 1]), faces: faces([0, 1, 2]).to_vec() };
    let [found_edge] = of_kind(&fan(), Kind::NonManifoldEdge).try_into().unwrap();
    assert_eq!(found_edge, edge);
    let lines = of_kind(&fan(), Kind::BoundaryLoop);
    let line = |ids: &[u32], closed| Finding::BoundaryLoop {
        vertices: ids.iter().map(|&v| VertexId(v)).collect(),
        closed,
    };
    assert_eq!(lines, [line(&[0, 2, 1, 3], true), line(&[0, 4, 1], false)]);
    // Only the edge is reported: the faces at its ends are connected.
    assert_eq!(of_kind(&fan(), Kind::NonManifoldVertex), []);
}

#[test]
fn a_vertex_in_which_shells_only_touch_has_two_fans() {
    let pinched = Finding::NonManifoldVertex { vertex: VertexId(0), fans: 2 };
    assert_eq!(found(&hourglass()), [pinched]);
}

#[test]
fn a_pinched_boundary_is_several_loops() {
    let mut mesh = grid(3);
    // Without the upper left and the lower right quad around vertex 5, two holes meet there.
    mesh.faces.drain(8..10);
    mesh.faces.drain(0..2);
    let loops = of_kind(&mesh, Kind::BoundaryLoop);
    assert!(loops.iter().all(|found| matches!(found, Finding::BoundaryLoop { closed: true, .. })));
    assert_eq!(loops.len(), 2);
}

#[test]
fn only_what_is_closed_and_agrees_can_be_inside_out() {
    let mut mesh = two_objects();
    for face in &mut mesh.faces[4..] {
        face.swap(0, 1);
    }
    let [found] = found(&mesh).try_into().unwrap();
    assert!(matches!(found, Finding::InsideOut { face: FaceId(4), volume }
        if (volume + 1.0 / 6.0).abs() < 1e-15));
    mesh.faces.pop();
    assert_eq!(of_kind(&mesh, Kind::InsideOut), []);
    let mut turned = tetrahedron();
    turned.faces[0].swap(0, 1);
    assert_eq!(of_kind(&turned, Kind::InsideOut), []);
}

#[test]
fn shells_that_touch_are_inside_out_one_by_one() {
    let mut mesh = hourglass();
    for face in &mut mesh.faces[..4] {
        face.swap(0, 1);
    }
    assert_eq!(of_kind(&mesh, Kind::InsideOut).len(), 1);
}

#[test]
fn far_away_outside_is_still_outside() {
    let mut mesh = samples::sphere(500);
    mesh.positions.iter_mut().flatten().for_each(|x| *x += 1e9);
    assert_eq!(of_kind(&mesh, Kind::InsideOut), []);
    mesh.faces.iter_mut().for_each(|face| face.swap(0, 1));
    assert_eq!(of_kind(&mesh, Kind::InsideOut).len(), 1);
}

#[test]
fn two_faces_back_to_back_enclose_nothing() {
    let mut mesh = grid(4);
    let back: Vec<_> = mesh.faces.iter().map(|&[a, b, c]| [b, a, c]).collect();
    mesh.faces = vec![mesh.faces[0], back[0]];
    mesh.positions.iter_mut().for_each(|p| p[2] = 0.1 * p[0] + 0.7 * p[1]);
    assert_eq!(of_kind(&mesh, Kind::InsideOut), []);
}

#[test]
fn kinds_come_in_their_order_and_the_first_ends_it() {
    let mut mesh = fan();
    mesh.positions.push([f64::NAN; 3]);
    mesh.faces.push(vertices([0, 0, 1]));
    let all = findings(&mesh, &CheckOptions::default());
    assert!(all.is_sorted_by_key(Finding::kind) && all.len() > 4);
    assert_eq!(first_finding(&mesh, &CheckOptions::default()).as_ref(), all.first());
    let mut told = 0;
    let _ = check(&mesh, &CheckOptions::default(), &mut |_| {
        told += 1;
        if told == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!(told, 3);
}

#[test]
fn clean_is_what_was_asked_for() {
    let open = grid(2);
    let errors = CheckOptions { kinds: Kinds::errors(), ..CheckOptions::default() };
    assert!(is_clean(&open, &errors) && !is_clean(&open, &CheckOptions::default()));
    assert!(!is_clean(&fan(), &errors));
}

#[test]
fn millions_of_loops_in_one_vertex_are_walked_in_one_go() {
    // Every face is a loop of its own, all pinched at v0.
    const FACES: u32 = 200_000;
    let faces: Vec<_> = (0..FACES).map(|f| [0, 2 * f + 1, 2 * f + 2]).collect();
    let positions: Vec<_> =
        (0..=2 * FACES).map(|v| [f64::from(v), f64::from(v % 7), 1.0]).collect();
    let mesh = mesh(&positions, &faces);
    assert_eq!(of_kind(&mesh, Kind::BoundaryLoop).len(), FACES as usize);
    let pinched = Finding::NonManifoldVertex { vertex: VertexId(0), fans: FACES as usize };
    assert_eq!(of_kind(&mesh, Kind::NonManifoldVertex), [pinched]);
}
