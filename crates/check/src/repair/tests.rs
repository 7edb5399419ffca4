//! Each step on the smallest mesh that needs it, and all steps on triangle soups.

use std::collections::BTreeSet;

use meshlod_fixtures::{cube, fan, grid, hourglass, mesh, moebius, seam_strip, tetrahedron};
use meshlod_mesh::{
    Attributes, Connectivity, FaceId, FaceLayer, FaceLayerKind, Labels, Layer, LayerKind, VertexId,
    WedgeId,
};
use meshlod_samples as samples;
use proptest::prelude::*;

use super::*;
use crate::{CheckOptions, Finding, Kind, Kinds, ObjectsBy, findings, is_clean};

const ERRORS: fn() -> CheckOptions =
    || CheckOptions { kinds: Kinds::errors(), ..CheckOptions::default() };

/// Repairs a mesh and asserts what holds for every result.
fn repaired(mesh: &Mesh) -> (Mesh, Vec<(RepairStep, usize)>) {
    let (repaired, report) = repair(mesh, &RepairOptions::default());
    assert_eq!(repaired.validate(), Ok(()));
    let (again, nothing) = repair(&repaired, &RepairOptions::default());
    assert!(again == repaired && nothing.is_unchanged(), "repaired twice: {nothing:?}");
    (repaired, report.nonzero().collect())
}

fn of_kind(mesh: &Mesh, kind: Kind) -> usize {
    findings(mesh, &CheckOptions { kinds: Kinds::NONE.with(kind), ..CheckOptions::default() }).len()
}

/// Gives each face its own vertices.
fn torn(mesh: &Mesh) -> Mesh {
    let positions = mesh.faces.iter().flatten().map(|v| mesh.positions[v.index()]).collect();
    let faces = (0..mesh.faces.len() as u32).map(|f| [0, 1, 2].map(|k| VertexId(3 * f + k)));
    Mesh::new(positions, faces.collect())
}

fn turn_over(mesh: &mut Mesh, faces: impl IntoIterator<Item = usize>) {
    faces.into_iter().for_each(|f| mesh.faces[f].swap(1, 2));
}

#[test]
fn a_valid_mesh_is_unchanged() {
    for mesh in [cube(), grid(3), seam_strip(), samples::fish(2000), Mesh::default()] {
        let (same, report) = repaired(&mesh);
        assert_eq!((same, report), (mesh, vec![]));
    }
}

#[test]
fn invalid_data_is_removed_first() {
    let mut mesh = tetrahedron();
    mesh.positions[0][0] = f64::NAN;
    mesh.faces.push([1, 2, 99].map(VertexId));
    mesh.objects = Some(Labels { names: vec![], of_face: vec![3] });
    let (left, report) = repaired(&mesh);
    assert_eq!(left.faces, [[0, 1, 2].map(VertexId)]);
    assert_eq!(
        report,
        [(RepairStep::BadAttributes, 1), (RepairStep::BadFaces, 4), (RepairStep::BadVertices, 1),]
    );
}

#[test]
fn mismatched_layers_are_removed_and_others_kept() {
    let mut mesh = seam_strip();
    let attributes = mesh.attributes.as_mut().unwrap();
    let short =
        Layer { kind: LayerKind::Normal, name: "short".into(), width: 3, values: vec![0.0; 5] };
    attributes.layers.insert(0, short);
    // One wedge at two vertices.
    attributes.corners[0][1] = attributes.corners[0][0];
    let (mended, report) = repaired(&mesh);
    assert_eq!(report, [(RepairStep::BadAttributes, 2)]);
    assert_eq!(mended.attributes.unwrap().layers.len(), 1);
}

#[test]
fn an_unbacked_wedge_count_allocates_nothing() {
    let mut mesh = tetrahedron();
    let corners = mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
    mesh.attributes = Some(Attributes { corners, wedge_count: usize::MAX, layers: vec![] });
    assert_eq!(repaired(&mesh).0.attributes.unwrap().wedge_count, 4);
}

#[test]
fn only_duplicates_of_equal_orientation_are_removed() {
    let mut mesh = tetrahedron();
    mesh.faces.push([2, 1, 0].map(VertexId));
    let (left, report) = repaired(&mesh);
    assert_eq!((left, report), (tetrahedron(), vec![(RepairStep::Duplicates, 1)]));
}

#[test]
fn two_rooms_with_a_wall_on_each_side_come_apart_whole() {
    // Two tetrahedra on one triangle, which both contain: the wall exists in both orientations.
    let two = mesh(
        &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.2, 0.2, 1.0], [0.2, 0.2, -1.0]],
        &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 1, 2], [1, 0, 4], [2, 1, 4], [0, 2, 4]],
    );
    let (apart, report) = repaired(&two);
    assert_eq!(report, [(RepairStep::SplitEdges, 3), (RepairStep::SplitVertices, 3)]);
    let connectivity = Connectivity::new(&apart.faces, apart.positions.len());
    assert!(connectivity.is_closed() && connectivity.pinched_vertices() == 0);
    assert_eq!((apart.faces.len(), of_kind(&apart, Kind::InsideOut)), (8, 0));
}

#[test]
fn a_sheet_with_two_sides_keeps_both() {
    let mut sheet = grid(1);
    let back: Vec<_> = sheet.faces.iter().map(|&[a, b, c]| [c, b, a]).collect();
    sheet.faces.extend(back);
    let (apart, _) = repaired(&sheet);
    assert_eq!(apart.faces.len(), 4);
    assert!(is_clean(&apart, &ERRORS()));
}

#[test]
fn cubes_that_share_an_edge_come_apart_at_it() {
    let mut two = cube();
    let other = cube();
    // The second stands diagonally across; its v0 and v4 are the first's v3 and v7.
    let moved = other.positions.iter().map(|&[x, y, z]| [x + 1.0, y + 1.0, z]);
    two.positions.extend(moved);
    let shared = |v: VertexId| match v.0 {
        0 => VertexId(3),
        4 => VertexId(7),
        v => VertexId(v + 8),
    };
    two.faces.extend(other.faces.iter().map(|face| face.map(shared)));
    let (apart, report) = repaired(&two);
    let steps =
        [(RepairStep::SplitEdges, 1), (RepairStep::SplitVertices, 2), (RepairStep::Unused, 2)];
    assert_eq!(report, steps);
    let connectivity = Connectivity::new(&apart.faces, apart.positions.len());
    assert!(connectivity.is_closed() && connectivity.pinched_vertices() == 0);
}

#[test]
fn a_flag_on_a_wall_is_what_comes_off() {
    // A flat wall of two faces and a third that stands on their edge.
    let wall = mesh(
        &[[0.0; 3], [0.0, 1.0, 0.0], [1.0, 0.5, 0.0], [-1.0, 0.5, 0.0], [0.0, 0.5, 1.0]],
        &[[0, 1, 4], [1, 0, 2], [0, 1, 3]],
    );
    let (apart, _) = repaired(&wall);
    assert_eq!(of_kind(&apart, Kind::BoundaryLoop), 2);
    assert_eq!(apart.faces[1][0], apart.faces[2][1], "the wall is whole");
}

#[test]
fn a_fan_and_an_hourglass_come_apart() {
    let report = repaired(&fan()).1;
    assert_eq!(report, [(RepairStep::SplitEdges, 1), (RepairStep::SplitVertices, 4)]);
    let (two, report) = repaired(&hourglass());
    assert_eq!(report, [(RepairStep::SplitVertices, 1)]);
    assert_eq!(of_kind(&two, Kind::NonManifoldVertex), 0);
}

#[test]
fn split_vertices_have_wedges_of_their_own() {
    let mut mesh = hourglass();
    let corners = mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
    let values = (0..14).map(|x| x as f32).collect();
    let uvs = Layer { kind: LayerKind::Uv(0), name: String::new(), width: 2, values };
    mesh.attributes = Some(Attributes { corners, wedge_count: 7, layers: vec![uvs] });
    let (apart, _) = repaired(&mesh);
    let attributes = apart.attributes.unwrap();
    assert_eq!(attributes.layers[0].of(WedgeId(7)), attributes.layers[0].of(WedgeId(0)));
}

#[test]
fn faces_are_turned_to_agree_with_most() {
    let mut mesh = cube();
    turn_over(&mut mesh, [1, 4, 7]);
    assert_eq!(repaired(&mesh), (cube(), vec![(RepairStep::TurnedFaces, 3)]));
}

#[test]
fn inward_shells_are_reversed_unless_they_may_be_cavities() {
    let mut inward = cube();
    turn_over(&mut inward, 0..12);
    assert_eq!(repaired(&inward).1, [(RepairStep::TurnedShells, 1)]);
    assert_eq!(of_kind(&repaired(&inward).0, Kind::InsideOut), 0);
    let mut hollow = cube();
    hollow.faces.extend(inward.faces.iter().map(|face| face.map(|v| VertexId(v.0 + 8))));
    hollow.positions.extend(inward.positions.iter().map(|p| p.map(|x| 0.25 + 0.5 * x)));
    assert_eq!(repaired(&hollow).1, []);
}

#[test]
fn normals_are_turned_where_they_agreed_with_the_faces() {
    for sign in [1.0, -1.0] {
        let mut inward = samples::sphere(200);
        let outward: Vec<f32> = inward.positions.iter().flatten().map(|&x| x as f32).collect();
        let all = inward.faces.len();
        turn_over(&mut inward, 0..all);
        let values = outward.iter().map(|x| x * sign).collect();
        let normals = Layer { kind: LayerKind::Normal, name: String::new(), width: 3, values };
        let corners = inward.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
        let wedge_count = inward.positions.len();
        inward.attributes = Some(Attributes { corners, wedge_count, layers: vec![normals] });
        let (turned, _) = repaired(&inward);
        assert_eq!(turned.attributes.unwrap().layers[0].values, outward, "normals by {sign}");
    }
}

#[test]
fn shells_that_cannot_be_oriented_are_reported_and_kept() {
    let (same, report) = repaired(&moebius(8));
    assert_eq!((same, report), (moebius(8), vec![(RepairStep::NotOrientable, 1)]));
}

#[test]
fn a_soup_becomes_the_mesh_it_was() {
    let whole = samples::torus(300);
    let (stitched, report) = repaired(&torn(&whole));
    assert_eq!(report[0], (RepairStep::Stitched, 3 * whole.faces.len() / 2));
    let connectivity = Connectivity::new(&stitched.faces, stitched.positions.len());
    assert!(connectivity.is_closed() && stitched.positions.len() == whole.positions.len());
}

#[test]
fn borders_within_the_tolerance_are_stitched() {
    let mut apart = torn(&samples::torus(300));
    for (i, x) in apart.positions.iter_mut().flatten().enumerate() {
        *x += 1e-7 * ((i % 7) as f64 - 3.0);
    }
    assert_eq!(repaired(&apart).1, []);
    let options = RepairOptions { stitch: Stitch::Within(1e-5), ..RepairOptions::default() };
    let (stitched, _) = repair(&apart, &options);
    assert!(Connectivity::new(&stitched.faces, stitched.positions.len()).is_closed());
}

/// Builds two rows of faces whose boundaries are 1 apart. The last vertex of the second row stays
/// in place, so the face before it loses its area, so its other vertex must stay as well, and so
/// on.
fn unravelling(faces: u32) -> Mesh {
    let places = (0..faces).map(f64::from);
    let above = (0..faces).map(|i| [10.0 * f64::from(i), 1.0, 0.0]);
    let below = (0..=faces).map(|i| [10.0 * f64::from(i), 0.0, 0.0]);
    let tips = places.clone().map(|i| [10.0 * i + 5.0, 50.0, 0.0]);
    // In one line with the vertex above and the next below.
    let ends = places.map(|i| [10.0 * i + 15.0, -0.5, 0.0]);
    let positions = above.chain(below).chain(tips).chain(ends).collect();
    let [v, w, tip, end] =
        [0, faces, 2 * faces + 1, 3 * faces + 1].map(|first| move |i| VertexId(first + i));
    let upper = (0..faces - 1).map(|i| [v(i + 1), v(i), tip(i)]);
    let lower = (0..faces).map(|i| [w(i), w(i + 1), end(i)]);
    Mesh::new(positions, upper.chain(lower).collect())
}

/// Builds two faces, the second starting at a height over the edge of the first.
fn pair_of_faces(height: f64) -> Mesh {
    let first = [[-90.0, 0.0, 0.0], [-80.0, 0.0, 0.0], [-85.0, 9.0, 0.0]];
    let second = [[-90.0, 0.0, height], [-80.0, 0.0, height], [-85.0, -9.0, 0.0]];
    mesh(&[first, second].concat(), &[[0, 1, 2], [4, 3, 5]])
}

#[test]
fn stitching_that_unravels_step_by_step_is_given_up() {
    // Falling back to edges at equal positions leaves apart those that are only near.
    for (faces, height, expected) in [(40, 1.0, 1), (400, 1.0, 0), (400, 0.0, 1)] {
        let mut mesh = unravelling(faces);
        append(&mut mesh, &pair_of_faces(height));
        assert_eq!(stitch::stitch(&mut mesh, 1.5), expected, "{faces} faces, {height} apart");
    }
}

fn append(mesh: &mut Mesh, other: &Mesh) {
    let first = mesh.positions.len() as u32;
    mesh.faces.extend(other.faces.iter().map(|face| face.map(|v| VertexId(first + v.0))));
    mesh.positions.extend_from_slice(&other.positions);
}

#[test]
fn seams_stay_where_values_differ_and_go_where_they_do_not() {
    let strip = seam_strip();
    let uvs = strip.attributes.as_ref().unwrap();
    let mut apart = torn(&strip);
    let values = uvs.corners.iter().flatten().flat_map(|&w| uvs.layers[0].of(w)).copied().collect();
    let layer = Layer { values, ..uvs.layers[0].clone() };
    let corners = apart.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
    let wedge_count = apart.positions.len();
    apart.attributes = Some(Attributes { corners, wedge_count, layers: vec![layer] });
    let (stitched, _) = repaired(&apart);
    assert_eq!(stitched.positions.len(), strip.positions.len());
    assert_eq!(stitched.attributes.unwrap().wedge_count, uvs.wedge_count);
}

#[test]
fn borders_of_two_objects_stay_apart() {
    let mut apart = torn(&grid(1));
    let names = vec!["a".to_owned(), "b".to_owned()];
    apart.objects = Some(Labels { names, of_face: vec![0, 1] });
    assert_eq!(repaired(&apart).1, []);
    apart.objects = None;
    assert_eq!(repaired(&apart).1[0], (RepairStep::Stitched, 1));
}

#[test]
fn stitching_stops_where_it_would_make_duplicates() {
    // Two faces back to back with vertices of their own: stitched they would be duplicates.
    let card = mesh(
        &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        &[[0, 1, 2], [3, 5, 4]],
    );
    assert_eq!(repaired(&card).1, []);
}

#[test]
fn a_sliver_gives_its_place_to_its_neighbour_s_halves() {
    // A square whose lower edge has a face of zero area: v4 lies on the edge.
    let mut square = mesh(
        &[[0.0; 3], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0], [1.0, 0.0, 0.0]],
        &[[0, 1, 2], [0, 2, 3], [1, 0, 4]],
    );
    let corners = square.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
    let values = square.positions.iter().flat_map(|p| [p[0] as f32, p[1] as f32]).collect();
    let uvs = Layer { kind: LayerKind::Uv(0), name: String::new(), width: 2, values };
    square.attributes = Some(Attributes { corners, wedge_count: 5, layers: vec![uvs] });
    let (mended, report) = repaired(&square);
    assert_eq!(report, [(RepairStep::FlippedEdges, 1)]);
    assert_eq!(mended.faces.len(), 3);
    // With a seam along the edge the middle corner gets the neighbour's values there.
    let attributes = square.attributes.as_mut().unwrap();
    attributes.corners[2] = [5, 6, 4].map(WedgeId);
    attributes.wedge_count = 7;
    attributes.layers[0].values.extend([9.0, 9.0, 9.0, 9.0]);
    attributes.layers[0].values[8] = 7.0;
    let (mended, _) = repaired(&square);
    let attributes = mended.attributes.unwrap();
    let middle = mended.faces.as_flattened().iter().position(|v| v.0 == 4).unwrap();
    let wedge = attributes.corners.as_flattened()[middle];
    assert_eq!(attributes.layers[0].of(wedge), [1.0, 0.0]);
}

#[test]
fn slivers_on_each_other_are_mended_in_turns() {
    // Four points on the lower edge of a triangle, connected by three slivers.
    let positions = [[0.0; 3], [4.0, 0.0, 0.0], [2.0, 3.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    let slivers = mesh(&positions, &[[0, 1, 2], [1, 0, 3], [1, 3, 4]]);
    let (mended, report) = repaired(&slivers);
    assert_eq!((mended.faces.len(), report), (3, vec![(RepairStep::FlippedEdges, 2)]));
}

fn holes(edges: usize) -> RepairOptions {
    RepairOptions { holes: Some(HoleLimits { edges, length: None }), ..RepairOptions::default() }
}

#[test]
fn holes_within_the_limits_are_closed() {
    let mut open = cube();
    open.faces.drain(0..2);
    let (closed, report) = repair(&open, &holes(4));
    assert_eq!(report.count(RepairStep::FillingFaces), 2);
    assert!(Connectivity::new(&closed.faces, closed.positions.len()).is_closed());
    assert!(closed.faces.len() == 12 && is_clean(&closed, &CheckOptions::default()));
    let (same, report) = repair(&open, &holes(3));
    assert!(same == open && report.is_unchanged());
    let short = RepairOptions {
        holes: Some(HoleLimits { edges: 100, length: Some(3.9) }),
        ..RepairOptions::default()
    };
    assert_eq!(repair(&open, &short).0, open);
}

#[test]
fn a_hole_is_left_open_if_the_filling_would_intersect_something() {
    let mut open = cube();
    open.faces.drain(2..4);
    let spike = tetrahedron();
    // A spike through the open top.
    open.faces.extend(spike.faces.iter().map(|face| face.map(|v| VertexId(v.0 + 8))));
    open.positions
        .extend(spike.positions.iter().map(|&[x, y, z]| [0.3 + 0.2 * x, 0.3 + 0.2 * y, 0.8 + z]));
    let (same, report) = repair(&open, &holes(10));
    assert_eq!((same, report.count(RepairStep::HolesLeft)), (open, 1));
}

#[test]
fn a_lone_face_has_no_hole_behind_it() {
    let lone = mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
    let (same, report) = repair(&lone, &holes(10));
    assert_eq!((same, report.count(RepairStep::HolesLeft)), (lone, 1));
}

/// Builds tall cones in a row, open below, with the given numbers of faces.
fn cones(edges: &[u32]) -> Mesh {
    let mut cones = Mesh::default();
    for (i, &edges) in edges.iter().enumerate() {
        let first = cones.positions.len() as u32;
        let x = 3.0 * i as f64;
        cones.positions.push([x, 0.0, 4.0]);
        cones.positions.extend((0..edges).map(|k| {
            let (sin, cos) = (f64::from(k) / f64::from(edges) * std::f64::consts::TAU).sin_cos();
            [x + cos, sin, 0.0]
        }));
        let rim = |k: u32| VertexId(first + 1 + k % edges);
        cones.faces.extend((0..edges).map(|k| [VertexId(first), rim(k), rim(k + 1)]));
    }
    cones
}

#[test]
fn beyond_the_budget_the_largest_holes_are_left() {
    let edges = [9, 5, 9, 4, 9];
    let filled = |most_weighed| {
        let mut mesh = cones(&edges);
        let limits = HoleLimits { edges: 10, length: None };
        let filled = holes::fill(&mut mesh, &limits, most_weighed);
        assert_eq!(filled.left, 0);
        let open = findings(
            &mesh,
            &CheckOptions {
                kinds: Kinds::NONE.with(Kind::BoundaryLoop),
                ..CheckOptions::default()
            },
        );
        let first = |found: &Finding| match found {
            Finding::BoundaryLoop { vertices, .. } => vertices[0].0,
            _ => unreachable!(),
        };
        (filled.untried, open.iter().map(first).collect::<Vec<_>>())
    };
    let weighed = |edges: &[usize]| edges.iter().map(|&n| triangulate::triangles_weighed(n)).sum();
    // The first vertices of the rims: 1, 11, 17, 27, 32.
    assert_eq!(filled(weighed(&[9, 5, 9, 4, 9])), (0, vec![]));
    assert_eq!(filled(weighed(&[9, 5, 9, 4, 9]) - 1), (1, vec![32]));
    assert_eq!(filled(weighed(&[4, 5, 9])), (2, vec![17, 32]));
    assert_eq!(filled(weighed(&[4])), (4, vec![1, 11, 17, 32]));
}

#[test]
fn faces_connected_far_away_may_touch_a_filling() {
    let mut cone = cones(&[4]);
    // A face below, with its own vertices at both ends of the edge that halves the hole.
    let below = [cone.positions[1], cone.positions[3], [0.0, 0.0, -1.0]];
    cone.positions.extend(below);
    cone.faces.push([5, 6, 7].map(VertexId));
    let limits = HoleLimits { edges: 4, length: None };
    let filled = |mesh: &Mesh| holes::fill(&mut mesh.clone(), &limits, usize::MAX).holes;
    assert_eq!(filled(&cone), 0, "another component");
    let around =
        [[9.0, 9.0, -2.0], [9.0, -9.0, -2.0], [9.0, 9.0, 9.0], [9.0, 8.0, 9.0], [0.0, 5.0, 9.0]];
    cone.positions.extend(around);
    cone.faces.extend([[7, 8, 9], [8, 10, 11], [10, 0, 12]].map(|face| face.map(VertexId)));
    assert_eq!(filled(&cone), 1, "the same, by way of faces that are not near");
}

#[test]
fn holes_beyond_the_budget_are_reported_as_left() {
    let mut report = RepairReport::default();
    report.add(RepairStep::HolesUntried, 3);
    assert!(report.is_unchanged());
}

#[test]
fn welding_is_off_by_default() {
    let mut near = tetrahedron();
    near.positions.push([1e-9, 0.0, 0.0]);
    near.faces[1][0] = VertexId(4);
    let options = RepairOptions { weld: Some(1e-6), ..RepairOptions::default() };
    let (welded, report) = repair(&near, &options);
    assert_eq!((welded, report.count(RepairStep::Welded)), (tetrahedron(), 1));
}

/// Generates faces over few vertices on a small lattice, where nearly every defect occurs.
fn soup() -> impl Strategy<Value = Mesh> {
    let point = prop::array::uniform3(-2..3_i8).prop_map(|p| p.map(f64::from));
    let points = prop::collection::vec(point, 4..24);
    let faces = prop::collection::vec(prop::array::uniform3(0..24_u32), 0..40);
    (points, faces).prop_map(|(points, faces)| {
        let count = points.len() as u32;
        let faces = faces.into_iter().map(|face| face.map(|v| VertexId(v % count))).collect();
        Mesh::new(points, faces)
    })
}

/// Gives each face its number, as a layer and as its material.
fn numbered(mesh: &Mesh) -> Mesh {
    let faces = 0..mesh.faces.len() as u32;
    let names = faces.clone().map(|face| face.to_string()).collect();
    let materials = Some(Labels { names, of_face: faces.clone().collect() });
    let (kind, name) = (FaceLayerKind::Other, "number".to_owned());
    let layer = FaceLayer { kind, name, values: faces.map(f64::from).collect() };
    Mesh { materials, face_layers: vec![layer], ..mesh.clone() }
}

proptest! {
    #[test]
    fn numbers_of_faces_stay_with_their_faces(soup in soup()) {
        let (mended, _) = repair(&numbered(&soup), &holes(20));
        let expected = mended.materials.unwrap().of_face.into_iter().map(f64::from);
        prop_assert_eq!(&mended.face_layers[0].values, &expected.collect::<Vec<_>>());
    }

    #[test]
    fn a_repaired_soup_has_no_errors_and_stays(soup in soup()) {
        let (mended, report) = repaired(&soup);
        let left = findings(&mended, &ERRORS());
        let told = |step| report.iter().any(|&(told, _)| told == step);
        let excused = |found: &Finding| {
            found.kind() == Kind::InconsistentEdge && told(RepairStep::NotOrientable)
        };
        prop_assert!(left.iter().all(excused), "{left:?}");
        let (closed, _) = repair(&soup, &holes(20));
        prop_assert_eq!(closed.validate(), Ok(()));
        let left = findings(&closed, &ERRORS());
        prop_assert!(left.iter().all(excused), "with holes closed: {left:?}");
    }

    #[test]
    fn what_meets_the_last_faces_is_found_as_among_all(soup in soup(), old in 0..40_usize) {
        let first = old.min(soup.faces.len());
        let found: BTreeSet<FaceId> = intersecting::intersecting(&soup, first).unwrap().into_iter().collect();
        let kinds = Kinds::NONE.with(Kind::SelfIntersection).with(Kind::Contact);
        let by_components = CheckOptions { kinds, objects: ObjectsBy::Components, ..CheckOptions::default() };
        let pairs = findings(&soup, &by_components).into_iter().map(|found| match found {
            Finding::SelfIntersection { faces, .. } | Finding::Contact { faces, .. } => faces,
            _ => unreachable!(),
        });
        let all: BTreeSet<FaceId> = pairs.flatten().filter(|face| face.index() >= first).collect();
        prop_assert_eq!(found, all);
    }
}
