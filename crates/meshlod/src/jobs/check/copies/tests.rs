use glam::{DMat4, DQuat, DVec3};
use meshlod_check::{CheckOptions, Finding, ObjectsBy};
use meshlod_io::{Node, SceneMesh};
use meshlod_mesh::{Labels, Mesh};
use meshlod_samples as samples;

use super::*;
use crate::jobs::check::check as check_mesh;
use crate::jobs::{ListedFinding, check_scene};

/// A scene of meshes in turn, one for each transform.
fn scene(meshes: Vec<Mesh>, transforms: &[DMat4]) -> Scene {
    let count = meshes.len();
    let meshes = meshes.into_iter().map(|mesh| SceneMesh { mesh, ..SceneMesh::default() });
    let node = |(i, to): (usize, &DMat4)| Node {
        name: if i % 3 == 0 { String::new() } else { format!("copy {i}") },
        mesh: Some(i % count),
        transform: to.to_cols_array_2d(),
        ..Node::default()
    };
    Scene {
        meshes: meshes.collect(),
        nodes: transforms.iter().enumerate().map(node).collect(),
        roots: (0..transforms.len()).collect(),
        ..Scene::default()
    }
}

/// Cells of a lattice of boxes: their shared walls lie on each other.
fn lattice(step: f64) -> Vec<DMat4> {
    let cells = (0..18).map(|i| [i % 3, i / 3 % 3, i / 9].map(f64::from));
    cells.map(|cell| DMat4::from_translation(DVec3::from(cell) * step)).collect()
}

/// A box from 0 to 1 with corners that are exact, some of them twice, a part of its own that touches
/// it, a face twice, an unused vertex and a hole.
fn odd_box() -> Mesh {
    let corner = |i: usize| [0, 1, 2].map(|axis| (i >> axis & 1) as f64);
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let id = |i: usize| VertexId::new(i);
    let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let mut mesh = Mesh::new((0..8).map(corner).collect(), faces.map(|f| f.map(id)).collect());
    mesh.positions.extend([[0.0; 3], [0.5, 0.5, 0.5], [0.25, 0.5, 0.0], [9.0; 3]]);
    mesh.faces.push([8, 9, 10].map(id));
    mesh.faces.push(mesh.faces[3]);
    mesh.faces.remove(6);
    mesh
}

fn check_copies(scene: &Scene, request: &CheckRequest) -> CheckReport {
    let placed = PlacedInstances::of(scene).unwrap().expect("a scene of copies");
    check_within(MOST_SEARCHED, (scene, &placed), request, &()).unwrap()
}

fn assert_as_merged(scene: &Scene, request: &CheckRequest) {
    let own = check_copies(scene, request);
    let merged = check_mesh(&scene.flatten(), request, &()).unwrap();
    assert_eq!(own.to_string(), merged.to_string());
    assert!(own.groups().eq(merged.groups()), "{:?}", own.groups().collect::<Vec<_>>());
    assert_eq!((own.vertices, own.faces), (merged.vertices, merged.faces));
    let [a, b] = [&own, &merged].map(|report| &report.owners.objects);
    assert_eq!((&a.names, a.components), (&b.names, b.components));
    assert_eq!(own.findings.len(), merged.findings.len());
    own.listed().zip(merged.listed()).for_each(|(own, merged)| assert_alike(own, merged));
    assert_eq!(
        [own.contacts.len(), own.contacts.touching()],
        [merged.contacts.len(), merged.contacts.touching()]
    );
    for ((a, own), (b, merged)) in own.contacts.by_size().iter().zip(merged.contacts.by_size()) {
        assert_eq!((*a, own.counts), (b, merged.counts));
        assert!((own.deepest.depth - merged.deepest.depth).abs() < 1e-9);
    }
}

/// Compares findings but for the rounding of lengths.
fn assert_alike(own: ListedFinding<'_>, merged: ListedFinding<'_>) {
    assert_eq!((own.group, own.objects), (merged.group, merged.objects));
    assert_eq!(own.place.is_some(), merged.place.is_some(), "{own:?} {merged:?}");
    let places = own.place.into_iter().flatten().zip(merged.place.into_iter().flatten());
    places.for_each(|(a, b)| assert!((a - b).abs() < 1e-9, "{own:?} {merged:?}"));
    let text = |found: &Finding| match found {
        Finding::Contact { objects, faces, intersection } => {
            format!("{objects:?} {faces:?} {:?}", intersection.kind)
        }
        Finding::SelfIntersection { faces, intersection, .. } => {
            format!("{faces:?} {:?}", intersection.kind)
        }
        Finding::InsideOut { face, volume } => format!("{face} {volume:.9}"),
        other => format!("{other:?}"),
    };
    assert_eq!(text(own.finding), text(merged.finding));
}

#[test]
fn copies_have_the_findings_of_the_merged_mesh() {
    for objects in [ObjectsBy::Auto, ObjectsBy::Names, ObjectsBy::Components] {
        for limit in [0, 3, 100_000] {
            let options = CheckOptions { objects, ..CheckOptions::default() };
            let request = CheckRequest { options, limit };
            assert_as_merged(&scene(vec![odd_box()], &lattice(1.0)), &request);
            let mut labelled = odd_box();
            let of_face = (0..labelled.faces.len()).map(|i| (i / 5) as u32).collect();
            let names = ["a", "", "c"].map(str::to_owned).to_vec();
            labelled.objects = Some(Labels { names, of_face });
            let both = vec![odd_box(), labelled];
            assert_as_merged(&scene(both, &lattice(0.75)), &request);
        }
    }
}

#[test]
fn turned_scaled_and_mirrored_copies_are_as_they_are_shown() {
    let axis = DVec3::new(0.1, 0.7, -0.3).normalize();
    let transforms: Vec<DMat4> = (0..24u8)
        .map(|i| {
            let at = DVec3::new(f64::from(i % 5), f64::from(i % 3), f64::from(i / 6)) * 1.3;
            let turn = DQuat::from_axis_angle(axis, 0.7 * f64::from(i));
            let size = [1.0, 0.5, 2.0][usize::from(i) % 3];
            let scale = DVec3::new(if i % 2 == 0 { -size } else { size }, size, size);
            DMat4::from_scale_rotation_translation(scale, turn, at)
        })
        .collect();
    let mut open = samples::terrain(60);
    let shift = open.positions.len();
    let ball = samples::sphere(60);
    open.positions.extend(ball.positions);
    let moved = ball.faces.iter().map(|face| face.map(|v| VertexId::new(shift + v.index())));
    // Inside out.
    open.faces.extend(moved.map(|[a, b, c]| [a, c, b]));
    let scene = scene(vec![samples::torus(200), open], &transforms);
    let report = check_copies(&scene, &CheckRequest::default());
    assert!(report.summary.count(Kind::Contact) > 100 && report.summary.count(Kind::InsideOut) > 5);
    let request = CheckRequest { limit: 1_000_000, ..CheckRequest::default() };
    assert_as_merged(&scene, &request);
}

#[test]
fn copies_at_one_place_share_all_they_have() {
    let placed = scene(vec![samples::sphere(60)], &[DMat4::IDENTITY; 8]);
    let report = check_copies(&placed, &CheckRequest::default());
    assert_eq!(report.contacts.len(), 28);
    assert_as_merged(&placed, &CheckRequest::default());
}

/// A box with corners that a sine of pi puts beside others, which are there once or twice.
fn seamed_box() -> Mesh {
    let mut mesh = odd_box();
    let corner = |x: f64, y: f64| [x, y, 0.0];
    let first = mesh.positions.len();
    mesh.positions.extend([corner(6e-17, 0.0), corner(0.0, 6e-17), corner(0.0, 6e-17)]);
    mesh.positions.extend([corner(0.5, 2.0), corner(0.5, 2.0 + 4e-16), corner(0.5, 3.0)]);
    let face = |ids: [usize; 3]| ids.map(|i| VertexId::new(first + i));
    mesh.faces.extend([[0, 3, 5], [1, 4, 5], [2, 5, 3]].map(face));
    mesh
}

#[test]
fn vertices_that_collapse_where_an_instance_is_count_as_in_the_merged_mesh() {
    let (close, apart) = (lattice(1.0), lattice(16.0));
    let turned: Vec<DMat4> =
        lattice(5.0).iter().map(|to| *to * DMat4::from_rotation_z(0.5)).collect();
    for transforms in [close, apart, turned, vec![DMat4::from_translation(DVec3::splat(3.0)); 5]] {
        // Faces along the seam cross others in the mesh, but not once they have collapsed.
        let kinds = Kinds::NONE.with(Kind::CoincidentVertices);
        for limit in [0, 2, 100_000] {
            let options = CheckOptions { kinds, ..CheckOptions::default() };
            let request = CheckRequest { options, limit };
            assert_as_merged(&scene(vec![seamed_box()], &transforms), &request);
        }
    }
}

#[test]
fn small_scenes_are_merged() {
    let scene = scene(vec![odd_box()], &lattice(1.0));
    let report = check_scene(scene.clone(), &CheckRequest::default(), &()).unwrap();
    assert_eq!(report.owners.objects.of_face.len(), report.faces, "only a merged mesh has owners");
    assert!(check_copies(&scene, &CheckRequest::default()).owners.objects.of_face.is_empty());
}

#[test]
fn a_search_that_is_not_complete_finds_nothing_clean() {
    let scene = scene(vec![samples::sphere(60)], &lattice(0.9));
    let placed = PlacedInstances::of(&scene).unwrap().unwrap();
    let kinds = Kinds::NONE.with(Kind::CoincidentVertices);
    let options = CheckOptions { kinds, ..CheckOptions::default() };
    let request = CheckRequest { options, limit: 0 };
    let report = check_within(10, (&scene, &placed), &request, &()).unwrap();
    assert_eq!((report.summary.total(), report.is_clean()), (0, false));
    assert!(report.not_compared > 0);
    assert!(check_copies(&scene, &request).is_clean());
}

#[test]
fn what_may_be_missing_is_told_by_kind() {
    let text = |kinds: &[Kind]| incomplete([5_380, 6_000], kinds.iter().copied().collect());
    let (contacts, vertices) = (Kind::Contact, Kind::CoincidentVertices);
    let start = "5,380 of 6,000 instances were not compared: too many faces lie close together.";
    for (kinds, missing) in [
        (&[contacts, vertices][..], "Contacts and coincident vertices"),
        (&[contacts], "Contacts"),
        (&[vertices], "Coincident vertices"),
    ] {
        assert_eq!(text(kinds), format!("{start} {missing} may be missing."));
    }
}

#[test]
fn instances_of_a_crowded_batch_are_not_compared() {
    let scene = scene(vec![samples::sphere(60)], &[DMat4::IDENTITY; 220]);
    let report = check_copies(&scene, &CheckRequest::default());
    assert_eq!((report.not_compared, report.summary.count(Kind::Crowded)), (219, 1));
    // As many faces take less work in one mesh.
    let placed = PlacedInstances::of(&scene).unwrap().unwrap();
    assert_eq!(check(&scene, &placed, &CheckRequest::default(), &()).unwrap(), None);
}

#[test]
fn instances_that_are_not_compared_are_counted() {
    let scene = scene(vec![odd_box()], &lattice(1.0));
    let placed = PlacedInstances::of(&scene).unwrap().unwrap();
    let request = CheckRequest::default();
    let report = check_within(200, (&scene, &placed), &request, &()).unwrap();
    let all = check_copies(&scene, &request);
    let contacts = [&report, &all].map(|report| report.summary.count(Kind::Contact));
    assert!(contacts[0] > 0 && contacts[0] < contacts[1], "{contacts:?}");
    assert_eq!([&report, &all].map(|report| report.summary.count(Kind::Crowded)), [1, 0]);
    assert!((1..18).contains(&report.not_compared) && all.not_compared == 0);
}
