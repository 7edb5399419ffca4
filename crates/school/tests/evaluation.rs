//! The evaluation ranks what is known to be better and worse.

use std::sync::{Arc, OnceLock};

use meshlod::flock::draw::FlockPainter;
use meshlod::flock::levels::{ChainOptions, LevelTable, Look, ModelAxes};
use meshlod::flock::select::{Budget, InstanceLevel, PolicyName};
use meshlod::samples;
use meshlod_school::Footage;
use meshlod_school::evaluate::{Arm, Evaluation, EvaluationOptions, evaluate, over_time};
use meshlod_school::scene::{Scenario, ScenarioName, ScenarioOptions};

fn table() -> &'static Arc<LevelTable> {
    static TABLE: OnceLock<Arc<LevelTable>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let options =
            ChainOptions { axes: ModelAxes::FISH, directions: 8, ..ChainOptions::default() };
        Arc::new(LevelTable::new(&samples::fish(1_500), &Look::default(), &options).unwrap())
    })
}

fn footage() -> &'static Footage {
    static FOOTAGE: OnceLock<Footage> = OnceLock::new();
    FOOTAGE.get_or_init(|| {
        let options =
            ScenarioOptions { members: 30, size: [256, 144], ..ScenarioOptions::default() };
        Scenario::named(ScenarioName::Ring, &options).unwrap().footage(10).unwrap()
    })
}

fn result() -> &'static Evaluation {
    static RESULT: OnceLock<Evaluation> = OnceLock::new();
    RESULT.get_or_init(|| {
        let options = EvaluationOptions {
            arms: vec![
                Arm::Policy(PolicyName::ScreenError),
                Arm::VisibleOnly(PolicyName::Ours),
                Arm::Random,
            ],
            shares: vec![0.05, 0.2, 0.7],
            pairs: 1,
            flips: vec![0.05],
        };
        let footage = std::slice::from_ref(footage());
        evaluate(footage, table(), &Look::default(), &options, &mut |_, _| {}, &mut |_| {}).unwrap()
    })
}

#[test]
fn every_arm_keeps_to_its_share_and_errs_less_with_more() {
    let Evaluation { rows, full_triangles, .. } = result();
    assert_eq!(rows.len(), 9);
    for row in rows {
        let most = row.share * full_triangles[0].1;
        assert!(row.mean_triangles() <= most, "{}: {}", row.arm, row.mean_triangles());
        assert!(row.frames.iter().all(|frame| frame.pixels > 500), "{row:?}");
    }
    for arm in rows.chunks(3) {
        assert!(arm[0].flip() > arm[1].flip() && arm[1].flip() > arm[2].flip(), "{arm:?}");
        assert!(arm[0].ssim() < arm[2].ssim() && arm[0].temporal_error > arm[2].temporal_error);
    }
}

#[test]
fn ours_needs_fewer_triangles_and_random_levels_more() {
    let ratio = |arm: &str| result().ratio(arm, "screen-error", 0.2).unwrap();
    let ours = ratio("ours, occluded skipped").mean;
    assert!(ours < 0.8, "{ours}");
    let random = ratio("control: random").mean;
    assert!(random > 1.3, "{random}");
    let itself = ratio("screen-error");
    assert_eq!((itself.low, itself.mean, itself.high), (1.0, 1.0, 1.0));
    let floor = result().floors[0].1;
    assert!(floor.flip > 0.0 && floor.flip < 0.3 && floor.ssim > 0.8, "{floor:?}");
}

#[test]
fn full_detail_is_like_itself_and_coarser_levels_draw_less() {
    let arms = [Arm::Policy(PolicyName::None), Arm::Policy(PolicyName::Paper)];
    let budget = Budget::default();
    let tracks = over_time(footage(), table(), &Look::default(), &arms, &budget, 5).unwrap();
    assert_eq!(tracks[0].flips, [(0, 0.0), (5, 0.0)]);
    assert!(tracks[1].flips.iter().all(|(_, flip)| *flip > 0.0));
    let triangles = |i: usize| tracks[i].triangles.iter().sum::<usize>();
    assert!(triangles(1) < triangles(0) && tracks[1].triangles.len() == 10);
}

#[test]
fn facing_levels_look_like_those_of_the_whole_chain() {
    let look = Look::default();
    let (flock, camera) = (&footage().flocks[0], &footage().cameras[0]);
    let mut painter = FlockPainter::new(table(), &look, &[]);
    for depth in [0, 4] {
        let facing = |member: usize| {
            let frame = flock.members.frame(member);
            let to_eye = camera.eye() - flock.members.position(member);
            InstanceLevel::drawn(table().facing_level(depth, frame.transpose() * to_eye))
        };
        let whole = vec![InstanceLevel::drawn(depth); flock.members.len()];
        let facing: Vec<_> = (0..flock.members.len()).map(facing).collect();
        let count = |levels: &[InstanceLevel]| {
            levels.iter().map(|l| table().triangle_count(l.level().unwrap())).sum::<usize>()
        };
        assert!(10 * count(&facing) < 9 * count(&whole));
        let [a, b] = [&whole, &facing].map(|levels| painter.draw(flock, levels, camera).unwrap());
        let differ = a.rgba().iter().zip(b.rgba()).filter(|(a, b)| a.abs_diff(**b) > 8).count();
        // Where two members touch the same sample, or a face is seen exactly on edge.
        assert!(differ * 1000 < a.rgba().len(), "depth {depth}: {differ} bytes differ");
    }
}

#[test]
fn a_frame_knows_the_members_of_its_faces() {
    let look = Look::default();
    let flock = &footage().flocks[0];
    let mut painter = FlockPainter::new(table(), &look, &[]);
    let mut levels = vec![InstanceLevel::HIDDEN; flock.members.len()];
    (levels[3], levels[9]) = (InstanceLevel::drawn(0), InstanceLevel::drawn(5));
    let frame = painter.frame(flock, &levels);
    frame.mesh.validate().unwrap();
    let full = table().triangle_count(0);
    assert_eq!([0, full - 1, full].map(|face| frame.member_of(face)), [Some(3), Some(3), Some(9)]);
    assert_eq!(frame.member_of(frame.member_faces), None);
    assert_eq!(frame.mesh.faces.len(), full + table().triangle_count(5));
}
