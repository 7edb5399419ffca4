//! Animations: poses at key times and between, and what is damaged is left out with a note.

use glam::{DMat4, DVec3};
use meshlod_fixtures::{folding_strip, ridged_strip, shared_mesh};
use serde_json::{Value, json};

use super::{read_alone, read_parts};
use crate::gltf::document::container;
use crate::gltf::{Animator, Moment};
use crate::{ReadOptions, Scene};

fn animator(scene: &Scene) -> Animator {
    Animator::new(scene).unwrap()
}

fn at(seconds: f64) -> Option<Moment> {
    Some(Moment { animation: 0, seconds })
}

/// Reads a fixture whose JSON is changed first.
fn changed(glb: &[u8], change: impl Fn(&mut Value)) -> Scene {
    let (text, buffer) = container::split(glb).unwrap();
    let mut json = serde_json::from_slice(text).unwrap();
    change(&mut json);
    read_parts(&json, buffer.unwrap()).unwrap()
}

/// Where the second joint takes the end of the strip.
fn end(scene: &Scene, moment: Option<Moment>) -> DVec3 {
    let animator = animator(scene);
    let (pose, skin) = (animator.pose(moment), animator.skin(0).unwrap());
    let bind = DMat4::from_cols_array_2d(&skin.inverse_bind[1]);
    let joint = DMat4::from_cols_array_2d(&pose.worlds[skin.joints[1]]);
    (joint * bind).transform_point3(DVec3::X)
}

#[test]
fn a_joint_turns_by_its_keys_and_evenly_between() {
    let scene = read_alone(&folding_strip(8)).unwrap();
    let half = std::f64::consts::FRAC_1_SQRT_2 / 2.0;
    for (seconds, place) in [
        (-1.0, DVec3::new(1.0, 0.0, 0.0)),
        (0.5, DVec3::new(0.5 + half, 0.0, -half)),
        (1.0, DVec3::new(0.5, 0.0, -0.5)),
        (1.5, DVec3::new(0.5 + half, 0.0, -half)),
        (7.0, DVec3::new(1.0, 0.0, 0.0)),
    ] {
        let found = end(&scene, at(seconds));
        assert!(found.distance(place) < 1e-6, "{seconds}: {found}");
    }
    assert!(end(&scene, None).distance(DVec3::X) < 1e-12);
}

#[test]
fn weights_of_targets_follow_their_keys() {
    let animator = animator(&read_alone(&ridged_strip(8)).unwrap());
    let weights = |moment| animator.pose(moment).weights[0].clone();
    assert_eq!([at(0.25), at(1.0), at(1.5), None].map(weights), [0.25, 1.0, 0.5, 0.0].map(|w| [w]));
}

#[test]
fn moments_are_key_times_and_the_middles_where_there_is_room() {
    let animator = animator(&read_alone(&folding_strip(8)).unwrap());
    let times = |most| animator.moments(most).iter().map(|at| at.seconds).collect::<Vec<_>>();
    assert_eq!(times(64), [0.0, 0.5, 1.0, 1.5, 2.0]);
    assert_eq!(times(4), [0.0, 1.0, 2.0]);
    assert_eq!(times(2), [0.0, 2.0]);
    assert!(times(0).is_empty());
}

#[test]
fn what_is_damaged_is_left_out_with_a_note() {
    type Change = fn(&mut Value);
    let cases: [(&str, Change); 10] = [
        ("do not rise", |json| json["animations"][0]["samplers"][0]["input"] = json!(1)),
        ("interpolation", |json| {
            json["animations"][0]["samplers"][0]["interpolation"] = json!("X")
        }),
        ("no unit quaternion", |json| {
            // Zeros of the first matrix.
            json["accessors"][5]["bufferView"] = json!(4);
            json["accessors"][5]["byteOffset"] = json!(4);
        }),
        ("numbers instead of", |json| json["accessors"][6]["count"] = json!(2)),
        ("accessor 99", |json| json["animations"][0]["samplers"][0]["output"] = json!(99)),
        ("sampler 7 is not there", |json| {
            json["animations"][0]["channels"][0]["sampler"] = json!(7);
        }),
        ("a node that is not there", |json| {
            json["animations"][0]["channels"][0]["target"]["node"] = json!(99);
        }),
        ("moves \"pointer\"", |json| {
            json["animations"][0]["channels"][0]["target"]["path"] = json!("pointer");
        }),
        ("no channels", |json| json["animations"][0]["channels"] = json!(3)),
        ("matrix for each joint", |json| json["accessors"][4]["count"] = json!(1)),
    ];
    for (what, change) in cases {
        let scene = changed(&folding_strip(8), change);
        let animator = animator(&scene);
        assert_eq!(animator.notes.len(), 1, "{what}: {:?}", animator.notes);
        assert!(animator.notes[0].contains(what), "{what}: {:?}", animator.notes);
        assert_eq!(animator.moments(9).is_empty(), what != "matrix for each joint", "{what}");
        assert_eq!(animator.pose(at(1.0)).worlds.len(), scene.nodes.len());
    }
}

#[test]
fn changed_documents_give_poses_or_notes() {
    for glb in [folding_strip(4), ridged_strip(4)] {
        let (text, buffer) = container::split(&glb).unwrap();
        let text = String::from_utf8(text.to_vec()).unwrap();
        let start = text.find("\"nodes\"").unwrap();
        let (mut state, mut posed) = (9u64, 0);
        for _ in 0..3000 {
            let mut changed = text.clone().into_bytes();
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let place = start + (state >> 33) as usize % (text.len() - start);
            changed[place] = b"0123456789-e[]{}\""[(state >> 20) as usize % 17];
            let Ok(json) = serde_json::from_slice::<Value>(&changed) else { continue };
            let Ok(scene) = read_parts(&json, buffer.unwrap()) else { continue };
            let Some(animator) = Animator::new(&scene) else { continue };
            for moment in animator.moments(5).into_iter().map(Some).chain([None]) {
                posed += animator.pose(moment).worlds.len();
            }
        }
        assert!(posed > 1000, "{posed}");
    }
}

#[test]
fn a_shared_model_has_its_animations() {
    let Some(path) = shared_mesh("fox.glb") else {
        println!("skipped: fox.glb is not there");
        return;
    };
    let animator = animator(&crate::read(&path, &ReadOptions::default()).unwrap());
    assert_eq!((animator.animation_count(), animator.notes.len()), (3, 0));
    let moments = animator.moments(63);
    assert_eq!(moments.len(), 63);
    assert!((0..3).all(|clip| moments.iter().any(|at| at.animation == clip)));
}
