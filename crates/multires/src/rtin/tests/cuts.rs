//! Cuts that follow queries: their levels are those of extraction, however they were reached.

use std::collections::BTreeMap;
use std::time::Duration;

use glam::{DVec3, Vec3};
use meshlod_fixtures as fixtures;
use meshlod_mesh::Mesh;
use meshlod_samples as samples;
use meshlod_simplify::Method;
use meshlod_spatial::closest_point;

use super::levels::assert_covers;
use super::{SIZES, Sample};
use crate::query::Region;
use crate::rtin::{HeightField, Rtin, RtinCut, RtinExtractor};
use crate::tests::walks::{Dice, forest, query};
use crate::{
    Archive, CutChange, Focus, HeightPrecision, ModelFile, Patch, Query, SlotMesh, Storage,
    UpdateLimits, ViewCamera,
};

/// A cut, a copy of its triangles that only follows patches, and an extractor.
struct Walk<'m> {
    cut: RtinCut<'m>,
    slots: BTreeMap<u32, [u32; 3]>,
    extractor: RtinExtractor<'m>,
}

impl<'m> Walk<'m> {
    fn new(model: &'m Rtin) -> Self {
        let cut = RtinCut::new(model);
        Self { slots: cut.triangles().collect(), cut, extractor: RtinExtractor::new(model) }
    }

    /// Updates the cut, and checks that the patches say what has changed.
    fn update(&mut self, query: &Query<'_>, limits: &UpdateLimits) -> CutChange {
        let change = self.cut.update(query, limits).unwrap();
        for patch in self.cut.patches() {
            let was = match patch.new {
                Some(nodes) => self.slots.insert(patch.slot, nodes),
                None => self.slots.remove(&patch.slot),
            };
            assert_eq!(was, patch.old);
        }
        assert!(self.cut.triangles().eq(self.slots.iter().map(|(&slot, &nodes)| (slot, nodes))));
        assert_eq!(self.cut.face_count(), self.slots.len());
        change
    }

    /// Updates the cut to the end, and checks that it is the smallest level.
    fn follow(&mut self, query: &Query<'_>) -> CutChange {
        let change = self.update(query, &UpdateLimits::default());
        assert!(change.done);
        self.assert_smallest(query);
        change
    }

    fn assert_smallest(&mut self, query: &Query<'_>) {
        let level = self.cut.level();
        assert_eq!(self.cut.vertex_count(), level.nodes.len());
        let expected = self.extractor.exact(query).unwrap();
        assert_eq!(level.canonical(), expected.canonical(), "{query:?}");
    }
}

fn eye_at(mesh: &Mesh, eye: DVec3) -> ViewCamera {
    let look = mesh.bounds().center();
    ViewCamera { eye: eye.into(), look, up: [0.1, 0.2, 1.0], fov_rad: 0.9, viewport: [300, 200] }
}

#[test]
fn after_any_queries_the_level_is_that_of_extraction() {
    for size in SIZES.into_iter().chain([[33, 33], [40, 23]]) {
        for (up, looks_down) in [(0, false), (1, true)] {
            let sample = Sample { up, looks_down, ..Sample::new(size) };
            let (mesh, model) = (sample.mesh(), sample.model());
            let (mut walk, mut dice) = (Walk::new(&model), Dice(31));
            for _ in 0..60 {
                walk.follow(&query(&mut dice, &mesh));
                assert_covers(&walk.cut.level(), &model, looks_down);
            }
        }
    }
}

#[test]
fn a_camera_may_move_by_any_steps() {
    for size in [[17, 17], [33, 33], [12, 40], [40, 23]] {
        let sample = Sample::new(size);
        let (mesh, model) = (sample.mesh(), sample.model());
        let (mut walk, mut dice) = (Walk::new(&model), Dice(5));
        let diagonal = mesh.bounds().diagonal();
        let mut eye = DVec3::from(mesh.bounds().center());
        let mut pixels = 2.0;
        for step in 0..300 {
            let length = diagonal * (-18.0 * dice.roll()).exp2();
            let to = DVec3::from([0; 3].map(|_| dice.roll() - 0.5)).normalize_or_zero();
            eye += length * to;
            if eye.distance(mesh.bounds().center().into()) > diagonal {
                eye = dice.place(&mesh).into();
            }
            if step % 50 == 49 {
                pixels = (6.0 * dice.roll() - 2.0).exp2();
            }
            walk.follow(&Query::pixels(eye_at(&mesh, eye), pixels));
        }
    }
}

#[test]
fn interrupted_updates_cover_the_field_and_get_there() {
    let sample = Sample::new([40, 23]);
    let (mesh, model) = (sample.mesh(), sample.model());
    let (mut walk, mut dice) = (Walk::new(&model), Dice(8));
    let limits = [
        UpdateLimits { changes: Some(7), time: None },
        UpdateLimits { changes: None, time: Some(Duration::ZERO) },
    ];
    for step in 0..80 {
        let query = query(&mut dice, &mesh);
        for limits in [&limits[0], &limits[step % 2], &limits[0]] {
            let change = walk.update(&query, limits);
            assert!(change.splits + change.merges <= 7);
            assert_covers(&walk.cut.level(), &model, false);
        }
        // Every other query is left before it is answered.
        if step % 2 == 0 {
            let done = (0..1000).any(|_| walk.update(&query, &limits[0]).done);
            assert!(done, "{query:?}");
            walk.assert_smallest(&query);
        }
    }
}

#[test]
fn what_stays_is_not_inspected() {
    let sample = Sample::new([129, 129]);
    let (mesh, model) = (sample.mesh(), sample.model());
    let mut walk = Walk::new(&model);
    let start = DVec3::from(mesh.bounds().min) + DVec3::Z;
    let at =
        |step: f64| Query::pixels(eye_at(&mesh, start + step * DVec3::new(1.0, 0.7, 0.1)), 4.0);
    let all = walk.follow(&at(0.0)).inspected;
    for step in 1..50 {
        let change = walk.follow(&at(1e-3 * f64::from(step)));
        assert!(change.inspected < all / 10, "{} of {all}", change.inspected);
    }
    walk.follow(&Query::uniform(0.1));
    let again = walk.follow(&Query::uniform(0.1));
    assert_eq!(again, CutChange { done: true, ..CutChange::default() });
}

#[test]
fn a_bad_query_is_an_error_and_changes_nothing() {
    let model = Sample::new([9, 9]).model();
    let mut walk = Walk::new(&model);
    walk.follow(&Query::uniform(0.2));
    assert!(walk.cut.update(&Query::uniform(f64::NAN), &UpdateLimits::default()).is_err());
    assert_eq!(walk.follow(&Query::uniform(0.2)), CutChange { done: true, ..Default::default() });
}

/// Checks that the triangles within a focus are those that a search over all triangles finds. Both
/// may find more where tests are conservative, but what has a corner in the focus is found.
fn assert_within(cut: &RtinCut<'_>, focus: &Focus) {
    let found = cut.level_within(focus).unwrap().canonical();
    let all = cut.level().within(focus).unwrap();
    if !matches!(focus, Focus::Segment(_) | Focus::Frustum(_)) {
        assert_eq!(found, all.canonical(), "{focus:?}");
    }
    let region = Region::new(focus, cut.model().frame());
    let corner = |node: u32| Vec3::from(cut.model().stored_position(node)).as_dvec3();
    let is_sure = |face: &[u32; 3]| face.iter().any(|&node| region.meets_ball(corner(node), 0.0));
    assert!(found.iter().all(|face| all.canonical().contains(face)), "{focus:?}");
    let mut sure = all.canonical().into_iter().filter(is_sure);
    assert!(sure.all(|face| found.contains(&face)), "{focus:?}");
}

#[test]
fn spatial_queries_find_what_a_search_over_all_triangles_finds() {
    for size in SIZES.into_iter().chain([[33, 33], [40, 23]]) {
        let sample = Sample::new(size);
        let (mesh, model) = (sample.mesh(), sample.model());
        let (mut cut, mut dice) = (RtinCut::new(&model), Dice(29));
        let corner = |node: u32| Vec3::from(model.stored_position(node)).as_dvec3();
        for step in 0..60 {
            cut.update(&query(&mut dice, &mesh), &UpdateLimits::default()).unwrap();
            let focus = query(&mut dice, &mesh).focus;
            assert_within(&cut, &focus);
            // On the surface, close to it, and far away.
            let away = [0.0, 0.1, 10.0][step % 3] * mesh.bounds().diagonal();
            let point = dice.place(&mesh).map(|x| x + away * (dice.roll() - 0.5));
            let at = model.frame().local(point);
            let distance = |nodes: [u32; 3]| closest_point(at, &nodes.map(corner)).distance(at);
            let least = cut.triangles().map(|(_, nodes)| distance(nodes)).fold(f64::MAX, f64::min);
            let found = cut.locate(point).unwrap();
            assert_eq!(distance(found.nodes), least, "{size:?} {point:?}");
            assert_eq!(cut.triangle(found.slot), Some(found.nodes));
            let apart = DVec3::from(point).distance(found.closest.into());
            assert!((apart - found.distance).abs() <= 1e-9 * (1.0 + apart), "{found:?}");
        }
        assert_eq!(cut.locate([f64::NAN; 3]), None);
        assert!(cut.level_within(&Focus::Box([[1.0; 3], [0.0; 3]])).is_err());
    }
}

#[test]
fn cuts_of_any_file_whole_or_truncated_answer_as_the_file_does() {
    let terrain = Sample::new([40, 23]);
    let field = terrain.field().to_file(HeightPrecision::Exact).unwrap().0;
    let torus = samples::torus(2000);
    let storage = Storage { updates_per_chunk: 64, ..Storage::default() };
    let archive = Archive::write(&forest(&torus, Method::Qem), &storage).unwrap().0.into_source();
    for (mesh, bytes) in [(&terrain.mesh(), &field), (&torus, &archive)] {
        for part in [1.0, 0.8, 0.6] {
            let there = &bytes[..(part * bytes.len() as f64) as usize];
            let file = ModelFile::open(there.to_vec()).unwrap();
            let levels = file.read().unwrap();
            let (mut cut, mut dice) = (levels.cut(), Dice(2));
            let mut slots: BTreeMap<_, _> = cut.slot_mesh().triangles().collect();
            for _ in 0..10 {
                let query = query(&mut dice, mesh);
                cut.update(&query, &UpdateLimits::default()).unwrap();
                for Patch { slot, new, .. } in cut.slot_mesh().patches() {
                    match new {
                        Some(nodes) => slots.insert(slot, nodes),
                        None => slots.remove(&slot),
                    };
                }
                assert!(
                    cut.slot_mesh()
                        .triangles()
                        .eq(slots.iter().map(|(&slot, &nodes)| (slot, nodes)))
                );
                let expected = file.extract(&query).unwrap().level.mesh();
                assert_eq!(cut.slot_mesh().face_count(), expected.faces.len(), "{part} {query:?}");
                let found = cut.locate(dice.place(mesh)).unwrap();
                let corners = found.nodes.map(|node| DVec3::from(levels.position(node)));
                let at = DVec3::from(found.closest);
                assert!(closest_point(at, &corners).distance(at) < 1e-5);
                assert!(
                    cut.slot_mesh().face_count() <= levels.most_faces()
                        && slots.contains_key(&found.slot)
                );
            }
        }
    }
}

/// Skips with a note if the shared meshes are missing.
#[test]
fn the_shared_terrain_if_there_is_followed() {
    let Some(path) = fixtures::shared_mesh("terrain-jacksboro.ply") else {
        return eprintln!("skipped: no terrain-jacksboro.ply");
    };
    let mesh = meshlod_io::ply::read(&std::fs::read(path).unwrap()).unwrap();
    let model = Rtin::new(&HeightField::from_mesh(&mesh).unwrap());
    let mut walk = Walk::new(&model);
    let (min, size) = (DVec3::from(mesh.bounds().min), mesh.bounds().diagonal());
    for step in 0..40 {
        let turn = 0.002 * f64::from(step * step);
        let eye = min + size * DVec3::new(0.3 + 0.2 * turn.sin(), 0.3 + 0.1 * turn.cos(), 0.05);
        walk.follow(&Query::pixels(eye_at(&mesh, eye), 0.5));
    }
}
