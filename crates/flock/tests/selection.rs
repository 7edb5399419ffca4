//! Every policy: levels exist, budgets hold, nothing depends on threads, and no input makes it
//! panic.

use std::sync::{Arc, OnceLock};

use glam::Vec3;
use meshlod_flock::levels::{ChainOptions, LevelTable, Look, ModelAxes};
use meshlod_flock::select::{Budget, InstanceLevel, PolicyName, Selector};
use meshlod_flock::{Flock, FlockCamera, School};
use meshlod_samples as samples;
use proptest::prelude::*;

fn table() -> &'static Arc<LevelTable> {
    static TABLE: OnceLock<Arc<LevelTable>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let options =
            ChainOptions { axes: ModelAxes::FISH, directions: 6, ..ChainOptions::default() };
        Arc::new(LevelTable::new(&samples::fish(1_500), &Look::default(), &options).unwrap())
    })
}

/// Members strewn in a school's ellipsoid, one after another along a spiral.
fn school(count: usize, radii: Vec3) -> Flock {
    let mut flock = Flock::default();
    for i in 0..count {
        let t = (i as f32 + 0.5) / count as f32;
        let (z, turn) = (1.0 - 2.0 * t, i as f32 * 2.399_963);
        let depth = (0.2 + 0.8 * ((i * 7 % 10) as f32 / 10.0)).cbrt();
        let flat = (1.0 - z * z).sqrt();
        let p = Vec3::new(flat * turn.cos(), flat * turn.sin(), z) * depth * radii;
        let heading = Vec3::new(0.2 * turn.sin(), 0.1 * turn.cos(), 1.0).normalize();
        flock.members.push(p.into(), heading.into());
    }
    let (leader, heading) = (Vec3::ZERO, Vec3::Z);
    flock.schools.push(School { members: 0..count, leader, heading, radii });
    flock
}

fn camera(eye: [f32; 3]) -> FlockCamera {
    FlockCamera::look_at(eye, [0.0; 3], 0.8, [640, 360]).unwrap()
}

fn triangles(levels: &[InstanceLevel]) -> usize {
    let drawn = levels.iter().filter_map(|level| level.level());
    drawn.map(|level| table().triangle_count(level)).sum()
}

#[test]
fn nearer_members_are_finer() {
    let mut flock = Flock::default();
    for z in [0.0, -10.0, -40.0, -160.0] {
        flock.members.push([0.0, 0.0, z], [1.0, 0.0, 0.0]);
    }
    let camera = camera([0.0, 0.0, 4.0]);
    for policy in PolicyName::ALL.into_iter().filter(|policy| *policy != PolicyName::None) {
        // All four are on one line, so `ours` would take the far ones for hidden.
        let budget = Budget { triangles: 2_000, detail: 0.5, ..Budget::default() };
        let mut selector = Selector::new(policy, table().clone());
        let levels = selector.select(&flock, &camera, &budget);
        let counts: Vec<usize> = levels.iter().map(|&level| triangles(&[level])).collect();
        assert!(counts.windows(2).all(|pair| pair[0] >= pair[1]), "{policy:?}: {counts:?}");
        assert!(counts[0] > 2 * counts[3] && counts[3] > 0, "{policy:?}: {counts:?}");
    }
}

#[test]
fn budgets_hold_from_full_detail_down_to_the_coarsest_levels() {
    let flock = school(300, Vec3::new(4.0, 3.0, 8.0));
    let camera = camera([12.0, 2.0, 0.0]);
    for policy in [PolicyName::Budget, PolicyName::Ours] {
        let mut selector = Selector::new(policy, table().clone());
        let mut before = 0;
        for budget in [8_000, 16_000, 40_000, 100_000, 300_000, 1_000_000] {
            let budget = Budget { triangles: budget, detail: 1.0, ..Budget::default() };
            let spent = triangles(selector.select(&flock, &camera, &budget));
            assert!(spent <= budget.triangles, "{policy:?}: {spent} of {}", budget.triangles);
            assert!(spent > before || spent > 250_000, "{policy:?}: {spent} after {before}");
            before = spent;
        }
        let none = Budget { triangles: 0, detail: 1.0, ..Budget::default() };
        let least = triangles(selector.select(&flock, &camera, &none));
        assert!(least > 0 && least < 300 * 40, "all stay in view, as coarse as can be: {least}");
    }
}

#[test]
fn ours_spends_less_on_what_is_hidden() {
    let flock = school(3_000, Vec3::splat(9.0));
    let camera = camera([0.0, 0.0, 30.0]);
    let budget = Budget { triangles: 300_000, detail: 1.0, ..Budget::default() };
    let mut selector = Selector::new(PolicyName::Ours, table().clone());
    let levels = selector.select(&flock, &camera, &budget);
    let mean = |near: bool| {
        let side = (0..3_000).filter(|&i| (flock.members.position(i).z > 0.0) == near);
        let counts: Vec<usize> = side.map(|i| triangles(&levels[i..=i])).collect();
        counts.iter().sum::<usize>() as f64 / counts.len() as f64
    };
    // The middle of the far half is two fifths farther away than that of the near one.
    assert!(mean(true) > 2.0 * mean(false), "{} {}", mean(true), mean(false));
}

#[test]
fn a_still_picture_keeps_its_levels() {
    let flock = school(200, Vec3::new(4.0, 3.0, 8.0));
    let camera = camera([12.0, 2.0, 0.0]);
    let budget = Budget { triangles: 60_000, detail: 1.0, ..Budget::default() };
    for policy in PolicyName::ALL {
        let mut selector = Selector::new(policy, table().clone());
        selector.select(&flock, &camera, &budget);
        let second = selector.select(&flock, &camera, &budget).to_vec();
        assert_eq!(selector.select(&flock, &camera, &budget), second, "{policy:?}");
    }
}

#[test]
fn threads_change_nothing() {
    let flock = school(40_000, Vec3::splat(30.0));
    let camera = camera([0.0, 0.0, 50.0]);
    let budget = Budget { triangles: 2_000_000, detail: 1.0, ..Budget::default() };
    let with = |threads: usize, policy| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut selector = Selector::new(policy, table().clone());
        pool.install(|| selector.select(&flock, &camera, &budget).to_vec())
    };
    for policy in PolicyName::ALL {
        assert!(with(1, policy) == with(3, policy), "{policy:?}");
    }
}

#[test]
fn what_is_behind_or_beside_the_camera_is_hidden() {
    let mut flock = Flock::default();
    flock.members.push([0.0, 0.0, 20.0], [1.0, 0.0, 0.0]);
    flock.members.push([50.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    flock.members.push([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    for policy in PolicyName::ALL {
        let mut selector = Selector::new(policy, table().clone());
        let levels = selector.select(&flock, &camera([0.0, 0.0, 9.0]), &Budget::default());
        let drawn: Vec<bool> = levels.iter().map(|level| level.level().is_some()).collect();
        assert_eq!(drawn, [false, false, true], "{policy:?}");
        let visible = [true, true, false];
        let levels = selector.select_visible(
            &flock,
            &camera([0.0, 0.0, 9.0]),
            &Budget::default(),
            Some(&visible),
        );
        assert_eq!(levels, [InstanceLevel::HIDDEN; 3], "{policy:?}");
    }
}

#[test]
fn models_of_one_triangle_and_flocks_of_none_work() {
    let v = meshlod_mesh::VertexId;
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let triangle = meshlod_mesh::Mesh::new(positions, vec![[v(0), v(1), v(2)]]);
    let options = ChainOptions { directions: 2, ..ChainOptions::default() };
    let table = Arc::new(LevelTable::new(&triangle, &Look::default(), &options).unwrap());
    assert_eq!((table.depth(), table.triangle_count(0)), (1, 1));
    for policy in PolicyName::ALL {
        let mut selector = Selector::new(policy, table.clone());
        let eye = camera([0.0, 0.0, 9.0]);
        assert!(selector.select(&Flock::default(), &eye, &Budget::default()).is_empty());
        let levels = selector.select(&school(1, Vec3::ZERO), &eye, &Budget::default());
        assert_eq!(levels.len(), 1, "{policy:?}");
    }
}

fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![8 => -20f32..20.0, 1 => Just(0.0), 1 => Just(f32::NAN), 1 => -1e30f32..1e30]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_flock_makes_a_policy_panic(
        places in proptest::collection::vec([coordinate(), coordinate(), coordinate()], 0..40),
        eye in [-20f32..20.0, -20f32..20.0, -20f32..20.0],
        radii in [0f32..10.0, 0f32..10.0, 0f32..10.0],
        triangles in 0usize..100_000,
        detail in prop_oneof![Just(0.0f32), Just(f32::NAN), 1e-6f32..1e6],
    ) {
        let mut flock = Flock::default();
        // The first member is at the eye.
        flock.members.push(eye, [0.0, 1.0, 0.0]);
        for place in &places {
            flock.members.push(*place, [0.0, 0.0, 1.0]);
        }
        let (leader, heading) = (Vec3::from(eye), Vec3::Y);
        let members = 0..flock.members.len() / 2;
        flock.schools.push(School { members, leader, heading, radii: radii.into() });
        prop_assume!(Vec3::from(eye).length() > 1e-3);
        let camera = camera(eye);
        for policy in PolicyName::ALL {
            let mut selector = Selector::new(policy, table().clone());
            let budget = Budget { triangles, detail, ..Budget::default() };
            for _ in 0..2 {
                for level in selector.select(&flock, &camera, &budget) {
                    prop_assert!(level.level().is_none_or(|l| l < table().levels.len()));
                }
            }
        }
    }
}
