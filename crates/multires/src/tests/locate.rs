//! Spatial queries on a cut, compared with a search over all triangles.

use glam::{DVec3, Vec3};
use meshlod_samples as samples;
use meshlod_spatial::closest_point;

use super::walks::{Dice, each, forest, query};
use crate::{Cut, Focus, Implicit, SlotMesh, UpdateLimits};

#[test]
fn triangles_within_a_focus_are_found() {
    each(|what, mesh, forest| {
        let mt = Implicit::new(forest).unwrap();
        let (mut cut, mut dice) = (Cut::new(&mt), Dice(17));
        for _ in 0..30 {
            cut.update(&query(&mut dice, mesh), &UpdateLimits::default()).unwrap();
            let focus = query(&mut dice, mesh).focus;
            let found = cut.level_within(&focus).unwrap();
            let expected = cut.level().within(&focus).unwrap();
            assert_eq!(found.canonical(), expected.canonical(), "{what} {focus:?}");
            // Points on the surface are in at least one triangle.
            let is_on_it = matches!(focus, Focus::Point(_) | Focus::Segment(_));
            assert!(!is_on_it || cut.face_count() < mt.full_faces() || !found.faces.is_empty());
        }
    });
}

#[test]
fn the_closest_triangle_is_found() {
    each(|what, mesh, forest| {
        let mt = Implicit::new(forest).unwrap();
        let (mut cut, mut dice) = (Cut::new(&mt), Dice(29));
        let corner = |node: u32| Vec3::from(mt.stored_position(node)).as_dvec3();
        for step in 0..60 {
            cut.update(&query(&mut dice, mesh), &UpdateLimits::default()).unwrap();
            // On the surface, close to it, and far away.
            let away = [0.0, 0.1, 10.0][step % 3] * mesh.bounds().diagonal();
            let point = dice.place(mesh).map(|x| x + away * (dice.roll() - 0.5));
            let at = mt.frame().local(point);
            let distance = |nodes: [u32; 3]| closest_point(at, &nodes.map(corner)).distance(at);
            let least = cut.triangles().map(|(_, nodes)| distance(nodes)).fold(f64::MAX, f64::min);
            let found = cut.locate(point).unwrap();
            assert_eq!(distance(found.nodes), least, "{what} {point:?}");
            assert!(cut.triangles().any(|triangle| triangle == (found.slot, found.nodes)));
            let apart = DVec3::from(point).distance(found.closest.into());
            assert!((apart - found.distance).abs() <= 1e-9 * (1.0 + apart), "{what} {found:?}");
        }
        assert_eq!(cut.locate([f64::NAN; 3]), None);
    });
}

#[test]
fn a_small_focus_gives_few_faces() {
    let mt = Implicit::new(&forest(&samples::torus(5000), Default::default())).unwrap();
    let cut = Cut::at(&mt, &crate::Query::uniform(0.0)).unwrap();
    let at = mt.position(cut.triangles().next().unwrap().1[0]);
    let faces = |focus: Focus| cut.level_within(&focus).unwrap().faces.len();
    let point = faces(Focus::Point(at));
    assert!((3..=12).contains(&point), "the star of a vertex: {point}");
    let sphere = faces(Focus::Sphere { center: at, radius: 0.05 });
    assert!(point < sphere && sphere < 200, "{sphere}");
    assert_eq!(faces(Focus::Everything), cut.face_count());
    assert!(cut.level_within(&Focus::Box([[1.0; 3], [0.0; 3]])).is_err());
}
