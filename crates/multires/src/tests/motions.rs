//! Cuts that follow a moving viewpoint within limits and report their changes.

use std::time::Duration;

use meshlod_mesh::Mesh;
use meshlod_samples as samples;
use meshlod_simplify::Method;

use super::walks::{Dice, cone, forest, topology};
use crate::{Cut, Implicit, Query, SlotMesh, Tolerance, UpdateLimits, ViewCamera};

/// A viewpoint that wanders around a mesh in steps of very different lengths.
struct Wanderer {
    dice: Dice,
    eye: [f64; 3],
}

impl Wanderer {
    fn new() -> Self {
        Self { dice: Dice(11), eye: [2.0, 1.5, 1.0] }
    }

    fn next(&mut self, pixels: f64) -> Query<'static> {
        let step = (-9.0 * self.dice.roll()).exp2();
        // Pulled back towards the mesh.
        self.eye = self.eye.map(|x| 0.97 * x + step * (self.dice.roll() - 0.5));
        let camera = ViewCamera {
            eye: self.eye,
            look: self.eye.map(|x| x + 1.0),
            up: [0.0, 0.0, 1.0],
            fov_rad: 0.8,
            viewport: [640, 480],
        };
        Query::pixels(camera, pixels)
    }
}

fn model(mesh: &Mesh, method: Method) -> Implicit {
    Implicit::new(&forest(mesh, method)).unwrap()
}

#[test]
fn a_thousand_steps_give_the_static_answer() {
    for method in [Method::Qem, Method::LeeJang] {
        let mt = model(&samples::torus(3000), method);
        let (mut cut, mut wanderer) = (Cut::new(&mt), Wanderer::new());
        let (mut looks, mut changes) = (0, 0);
        for step in 0..1000 {
            let query = wanderer.next(1.0);
            let change = cut.update(&query, &UpdateLimits::default()).unwrap();
            assert!(change.done);
            looks += change.inspected;
            changes += change.splits + change.merges;
            if step % 7 == 0 {
                let fresh = Cut::at(&mt, &query).unwrap().level();
                assert_eq!(cut.level().canonical(), fresh.canonical(), "step {step}");
            }
        }
        assert!(changes > 500, "{changes}");
        // Inspecting the whole cut every time would be several hundred thousand.
        assert!(looks < 250_000, "{looks}");
    }
}

#[test]
fn changing_the_kind_of_query_loses_no_update() {
    let mt = model(&samples::torus(3000), Method::Qem);
    let (mut cut, mut wanderer) = (Cut::new(&mt), Wanderer::new());
    for step in 0..600 {
        let query = wanderer.next([1.0, 4.0, 0.5][step / 20 % 3]);
        cut.update(&query, &UpdateLimits::default()).unwrap();
        let fresh = Cut::at(&mt, &query).unwrap().level();
        assert_eq!(cut.level().canonical(), fresh.canonical(), "step {step}");
    }
}

#[test]
fn patches_lead_from_frame_to_frame() {
    for mesh in [samples::gyroid(2000), cone(1500)] {
        let mt = model(&mesh, Method::LindstromTurk);
        let (mut cut, mut wanderer) = (Cut::new(&mt), Wanderer::new());
        cut.update(&wanderer.next(1.0), &UpdateLimits::default()).unwrap();
        let mut known = Mirror::of(&cut);
        for _ in 0..300 {
            let query = wanderer.next(1.0);
            cut.update(&query, &UpdateLimits::default()).unwrap();
            for patch in cut.patches() {
                assert_ne!(patch.old, patch.new);
                known.patch(patch.slot, patch.old, patch.new);
            }
            assert_eq!(known.canonical(), Mirror::of(&cut).canonical());
            let fresh = Cut::at(&mt, &query).unwrap().level();
            assert_eq!(cut.level().canonical(), fresh.canonical());
        }
    }
}

/// A renderer's copy of the triangles.
struct Mirror(std::collections::BTreeMap<u32, [u32; 3]>);

impl Mirror {
    fn of(cut: &Cut<'_>) -> Self {
        Self(cut.triangles().collect())
    }

    fn patch(&mut self, place: u32, out: Option<[u32; 3]>, into: Option<[u32; 3]>) {
        assert_eq!(self.0.remove(&place), out);
        into.into_iter().for_each(|triangle| _ = self.0.insert(place, triangle));
    }

    fn canonical(&self) -> Vec<(u32, [u32; 3])> {
        self.0.iter().map(|(&place, &triangle)| (place, triangle)).collect()
    }
}

#[test]
fn an_interrupted_update_is_a_mesh_and_finishes_later() {
    for method in [Method::QemEndpoint, Method::LeeJang] {
        let mesh = samples::terrain(800);
        let mt = model(&mesh, method);
        let expected = topology(&mesh);
        let (mut cut, mut wanderer) = (Cut::new(&mt), Wanderer::new());
        let mut query = wanderer.next(0.5);
        for step in 1..400 {
            if step % 20 == 0 {
                query = wanderer.next(0.5);
            }
            let few = UpdateLimits { changes: Some(step % 7), time: None };
            let change = cut.update(&query, &few).unwrap();
            assert!(change.splits + change.merges <= step % 7);
            assert_eq!(topology(&cut.level().mesh()), expected, "step {step}");
        }
        assert!(cut.update(&query, &UpdateLimits::default()).unwrap().done);
        let fresh = Cut::at(&mt, &query).unwrap().level();
        assert_eq!(cut.level().canonical(), fresh.canonical());
    }
}

#[test]
fn updates_without_time_finish_piece_by_piece() {
    let mesh = samples::terrain(3000);
    let mt = model(&mesh, Method::Qem);
    let expected = topology(&mesh);
    let mut wanderer = Wanderer::new();
    let none = UpdateLimits { changes: None, time: Some(Duration::ZERO) };
    for step in 0..20 {
        let mut cut = Cut::at(&mt, &Query::uniform(1e-4)).unwrap();
        let (fine, mut looks) = (cut.face_count(), 0);
        let mut query = wanderer.next(2.0);
        for _ in 0..step {
            // In half of the runs the viewpoint stands still.
            if step % 2 == 0 {
                query = wanderer.next(2.0);
            }
            let change = cut.update(&query, &none).unwrap();
            assert!(change.inspected <= 256 && change.splits + change.merges == 0);
            looks += change.inspected;
        }
        assert_eq!((cut.face_count(), topology(&cut.level().mesh())), (fine, expected));
        let change = cut.update(&query, &UpdateLimits::default()).unwrap();
        let fresh = Cut::at(&mt, &query).unwrap().level();
        assert!(change.done && cut.level().canonical() == fresh.canonical(), "step {step}");
        assert!(step < 2 || looks > 300, "it goes on where it stopped: {looks}");
    }
}

#[test]
fn hysteresis_lies_between_two_answers() {
    let mt = model(&samples::knot(3000), Method::Qem);
    let (mut cut, mut still) = (Cut::new(&mt), Cut::new(&mt));
    cut.set_hysteresis(Some(0.5)).unwrap();
    assert!(cut.set_hysteresis(Some(-1.0)).is_err());
    assert!(cut.set_hysteresis(Some(f64::NAN)).is_err());
    let mut wanderer = Wanderer::new();
    let (mut trembling, mut calm) = (0, 0);
    for _ in 0..300 {
        let query = wanderer.next(1.0);
        let Tolerance::Pixels { camera, pixels } = query.tolerance else { unreachable!() };
        let finer = Query::pixels(camera, pixels / 1.5);
        let change = cut.update(&query, &UpdateLimits::default()).unwrap();
        let least = still.update(&query, &UpdateLimits::default()).unwrap();
        calm += change.splits + change.merges;
        trembling += least.splits + least.merges;
        let most = Cut::at(&mt, &finer).unwrap();
        assert!(still.face_count() <= cut.face_count() && cut.face_count() <= most.face_count());
    }
    assert!(calm < trembling, "{calm} changes with, {trembling} without");
}
