//! `flock`: frames, figures and recordings.

use meshlod::flock::select::PolicyName;
use serde_json::Value;

use crate::run::{Done, Run};

/// Options that keep a film small.
const SMALL: [&str; 6] = ["--members", "20", "--frames", "2", "--size", "64x48"];

fn flock(run: &Run, more: &[&str]) -> Done {
    run.run(&[&["flock"], &SMALL[..], more].concat())
}

/// Films a model of few faces, unless another is given, and returns the answer.
fn flock_json(run: &Run, more: &[&str]) -> Value {
    let own = more.contains(&"--model");
    if !own && !run.path("small.ply").exists() {
        run.sample("sphere", 100, "small.ply");
    }
    let model: &[&str] = if own { &[] } else { &["--model", "small.ply"] };
    run.json(&[&["flock"], &SMALL[..], model, more].concat())
}

/// Returns the figures of all frames without those that depend on the clock.
fn figures(run: &Run, file: &str) -> Vec<Value> {
    let text = std::fs::read_to_string(run.path(file)).unwrap();
    let timeless = |line: &str| {
        let mut figures: Value = serde_json::from_str(line).unwrap();
        figures.as_object_mut().unwrap().retain(|name, _| !name.ends_with("_ms"));
        figures
    };
    text.lines().map(timeless).collect()
}

#[test]
fn a_film_has_frames_and_figures() {
    let run = Run::new();
    let answer = flock(&run, &["--out", "a/b", "--policy", "screen-error", "--json"]).json();
    let frames = figures(&run, "a/b/frames.jsonl");
    assert_eq!((frames.len(), answer["frames"].as_u64()), (2, Some(2)));
    for (i, frame) in frames.iter().enumerate() {
        assert_eq!(frame["frame"], i);
        let count = |name: &str| frame[name].as_u64().unwrap();
        assert!(count("members_in_view") > 15 && count("members_in_view") <= 20, "{frame}");
        assert_eq!(count("full_triangles"), 3984 * count("members_in_view"));
        assert!(count("triangles") > 0 && count("triangles") < count("full_triangles"), "{frame}");
        let png = std::fs::read(run.path(&format!("a/b/frame_{i:04}.png"))).unwrap();
        assert!(png.starts_with(b"\x89PNG") && png[16..24] == [0, 0, 0, 64, 0, 0, 0, 48]);
    }
    let total: u64 = frames.iter().map(|frame| frame["triangles"].as_u64().unwrap()).sum();
    assert_eq!(answer["total"]["triangles"], total);
    let expected = [
        ("policy", "screen-error"),
        ("camera", "ring"),
        ("out", "a/b"),
        ("figures", "a/b/frames.jsonl"),
    ];
    expected.iter().for_each(|(field, value)| assert_eq!(answer[field], *value));
    assert_eq!(answer["model"]["forward"], "-x");
    assert_eq!((&answer["triangles"], &answer["detail"]), (&Value::Null, &1.0.into()));
    assert_eq!(answer["levels"]["faces"][0], 3984);
}

#[test]
fn every_camera_and_policy_makes_a_film() {
    let run = Run::new();
    for camera in ["ring", "inside", "far", "obstacles", "terrain"] {
        let answer = flock_json(&run, &["--camera", camera, "--out", camera, "--schools", "2"]);
        assert_eq!((&answer["camera"], &answer["schools"]), (&camera.into(), &2.into()));
        assert!(run.path(camera).join("frame_0001.png").exists());
    }
    for policy in PolicyName::ALL.map(PolicyName::name) {
        let answer = flock_json(&run, &["--policy", policy, "--no-pictures", "--out", policy]);
        let share = answer["triangles_share"].as_f64().unwrap();
        assert_eq!(share == 1.0, policy == "none", "{policy}: {share}");
        assert_eq!((&answer["policy"], &answer["pictures"]), (&policy.into(), &0.into()));
        let files: Vec<_> = std::fs::read_dir(run.path(policy)).unwrap().collect();
        assert_eq!(files.len(), 1, "no pictures");
    }
}

#[test]
fn the_budget_is_kept() {
    let run = Run::new();
    for policy in ["budget", "ours"] {
        let budget = ["--policy", policy, "--triangles", "1500", "--no-pictures"];
        let answer = flock_json(&run, &budget);
        assert_eq!(answer["triangles"], 1500);
        for frame in figures(&run, "flock/frames.jsonl") {
            assert!(frame["triangles"].as_u64().unwrap() <= 1500, "{policy}: {frame}");
        }
    }
}

#[test]
fn a_film_is_the_same_again_with_any_number_of_threads() {
    let run = Run::new();
    for (out, threads) in [("one", "1"), ("two", "2")] {
        flock_json(&run, &["--out", out, "--record", out, "--threads", threads]);
    }
    assert_eq!(figures(&run, "one/frames.jsonl"), figures(&run, "two/frames.jsonl"));
    for entry in std::fs::read_dir(run.path("one")).unwrap() {
        let name = entry.unwrap().file_name();
        if name != "frames.jsonl" {
            let [one, two] =
                ["one", "two"].map(|out| std::fs::read(run.path(out).join(&name)).unwrap());
            assert!(one == two, "{name:?}");
        }
    }
    flock_json(&run, &["--out", "other", "--seed", "2"]);
    assert_ne!(figures(&run, "one/frames.jsonl"), figures(&run, "other/frames.jsonl"));
}

#[test]
fn a_recording_holds_what_was_filmed() {
    let run = Run::new();
    let answer = flock_json(&run, &["--record", "tape", "--no-pictures", "--camera", "obstacles"]);
    assert_eq!(answer["recording"], "tape");
    let scene: Value =
        serde_json::from_slice(&std::fs::read(run.path("tape/scene.json")).unwrap()).unwrap();
    let expected = [("frames", 2), ("members", 20), ("seed", 1), ("version", 1)];
    expected.iter().for_each(|(field, value)| assert_eq!(scene[field], *value));
    assert_eq!((&scene["model"], &scene["scenario"]), (&"small.ply".into(), &"obstacles".into()));
    let positions = std::fs::read(run.path("tape/positions.npy")).unwrap();
    assert!(String::from_utf8_lossy(&positions[..128]).contains("'shape': (2, 20, 3)"));
    assert_eq!(positions.len(), 128 + 2 * 20 * 3 * 4);
    let levels: Value =
        serde_json::from_slice(&std::fs::read(run.path("tape/levels.json")).unwrap()).unwrap();
    let selection = std::fs::read(run.path("tape/selection.npy")).unwrap();
    let drawn = |frame: usize| -> u64 {
        let chosen = selection[128 + frame * 40..][..40].chunks(2);
        let levels = chosen
            .map(|pair| &levels["levels"][usize::from(u16::from_le_bytes([pair[0], pair[1]]))]);
        levels.filter_map(|level| level["triangles"].as_u64()).sum()
    };
    for (i, frame) in figures(&run, "flock/frames.jsonl").iter().enumerate() {
        assert_eq!(frame["triangles"], drawn(i));
    }
}

#[test]
fn models_of_files_swim_with_their_heads_first() {
    let run = Run::new();
    run.sample("fish", 500, "fish.glb");
    run.sample("sphere", 200, "ball.ply");
    let forward = |more: &[&str]| {
        let answer = flock_json(&run, &[&["--no-pictures"], more].concat());
        let model = &answer["model"];
        (model["forward"].as_str().unwrap().to_owned(), model["forward_guessed"] == true)
    };
    assert_eq!(forward(&["--model", "fish.glb"]), ("-x".into(), true));
    assert_eq!(forward(&["--model", "ball.ply"]), ("+z".into(), true));
    assert_eq!(forward(&["--model", "ball.ply", "--up", "z"]), ("-y".into(), true));
    assert_eq!(forward(&["--model", "ball.ply", "--forward", "-z"]), ("-z".into(), false));
    // The sample's own frames are those of its file.
    run.sample("fish", 4000, "sample.ply");
    flock(&run, &["--out", "own"]);
    flock(&run, &["--out", "read", "--model", "sample.ply"]);
    let [own, read] = ["own", "read"].map(|out| figures(&run, &format!("{out}/frames.jsonl")));
    let members = |frames: &[Value]| frames[1]["members_in_view"].clone();
    assert_eq!(members(&own), members(&read));
}

#[test]
fn one_member_and_one_triangle_make_a_film() {
    let run = Run::new();
    std::fs::write(run.path("one.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let alone = ["--members", "1", "--frames", "2", "--size", "32x32", "--model", "one.obj"];
    let answer = run.json(&[&["flock", "--policy", "none"], &alone[..]].concat());
    assert_eq!((&answer["total"]["triangles"], &answer["members"]), (&2.into(), &1.into()));
}

#[test]
fn people_get_lines_that_name_the_figures() {
    let run = Run::new();
    let done = flock(&run, &["--record", "tape", "--out", "film"]);
    assert_eq!((done.code, &done.err[..]), (0, ""));
    let text = done.text();
    assert!(text.starts_with("film: 2 frames of 64 x 48, camera ring, policy ours\n"), "{text}");
    assert!(text.contains("20 members of fish: 3,984 faces, swims towards -x\n"), "{text}");
    assert!(text.ends_with("film/frames.jsonl\ntape\n"), "{text}");
    let shorter =
        run.run(&["flock", "--members", "2", "--frames", "1", "--size", "9x9", "--out", "film"]);
    let warning = "meshlod: warning: film: 1 frame of an earlier film is still there\n";
    assert_eq!((shorter.code, &shorter.err[..]), (0, warning));
}

#[test]
fn wrong_values_are_named_and_write_nothing() {
    let run = Run::new();
    std::fs::write(run.path("ball.ply"), "mine").unwrap();
    let cases: &[(&[&str], i32, &str)] = &[
        (&["--members", "0"], 2, "at least 1"),
        (&["--members", "-3"], 2, "at least 1"),
        (&["--members", "5000001"], 2, "at most 5,000,000"),
        (&["--schools", "21", "--members", "20"], 2, "1 to 20 schools, not 21"),
        (&["--policy", "best"], 2, "distance, screen-error, "),
        (&["--camera", "top"], 2, "the scenarios are ring, inside, far, obstacles, terrain"),
        (&["--frames", "0"], 2, "at least 1"),
        (&["--fps", "0"], 2, "between 0.1 and 1000"),
        (&["--fps", "nan"], 2, "not a number"),
        (&["--size", "0x9"], 2, "a size like 640x480"),
        (&["--size", "99999x9"], 2, "a size like 640x480"),
        (&["--detail", "0"], 2, "between 0.000001"),
        (&["--triangles", "0"], 2, "at least 1"),
        (&["--forward", "left"], 2, "+x, -x, +y, -y, +z or -z, or auto"),
        (&["--forward", "+y"], 2, "--forward +y and --up +y must be along two axes"),
        (&["--method", "magic"], 2, "the methods are "),
        (&["--record", "tape", "--members", "5000000"], 2, "--record: "),
        (&["--record", "ball.ply"], 1, "ball.ply: is a file; name a folder"),
        (&["--out", "ball.ply"], 1, "ball.ply: is a file; name a folder"),
        (&["--out", "ball.ply/inner"], 1, "ball.ply/inner: "),
        (&["--model", "none.ply"], 1, "none.ply: "),
        (&["--model", "ball.ply"], 1, "ball.ply: "),
        (&["--model", "ball.abc"], 1, "ball.abc: unknown suffix"),
    ];
    for (arguments, code, reason) in cases {
        let done = run.run(&[&["flock"], *arguments].concat());
        assert_eq!((done.code, done.out.len()), (*code, 0), "{arguments:?}: {done:?}");
        assert!(done.err.contains(reason) && !done.err.contains("panicked"), "{done:?}");
        assert_eq!(run.files(), ["ball.ply"], "{arguments:?}");
    }
    let none = "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n";
    let flat = "OFF\n3 1 0\n1 1 1\n1 1 1\n1 1 1\n3 0 1 2\n";
    for (text, reason) in [(none, "no faces"), (flat, "the model has no extent")] {
        std::fs::write(run.path("bad.off"), text).unwrap();
        let done = flock(&run, &["--model", "bad.off"]);
        assert_eq!((done.code, done.out.len()), (1, 0), "{done:?}");
        assert!(done.only_line().starts_with("meshlod: bad.off: "), "{done:?}");
        assert!(done.err.contains(reason) && run.files() == ["bad.off", "ball.ply"], "{done:?}");
    }
}
