//! `view` and `render --gpu`. Without the feature `view` they say how to get it; with it they need a
//! GPU, and are skipped where there is none, unless `MESHLOD_REQUIRE_GPU` is set.

use crate::run::Run;

#[cfg(not(feature = "view"))]
#[test]
fn a_program_without_the_viewer_says_how_to_get_it() {
    let run = Run::new();
    run.sample("sphere", 100, "a.ply");
    let school = &["view", "--flock"][..];
    for arguments in [school, &["view", "a.ply"], &["render", "--gpu", "a.ply", "a.png"]] {
        let done = run.run(arguments);
        assert_eq!(done.code, 1, "{done:?}");
        assert!(done.err.contains("--features view") && done.err.lines().count() == 1, "{done:?}");
    }
    assert!(!run.path("a.png").exists());
}

#[cfg(feature = "view")]
mod on_a_gpu {
    use serde_json::Value;

    use super::Run;

    /// Returns false, and says so, where there is no GPU.
    fn has_gpu(run: &Run) -> bool {
        run.sample("sphere", 20, "probe.ply");
        let done = run.run(&["render", "--gpu", "probe.ply", "probe.png", "--size", "8x8"]);
        if done.code == 0 {
            return true;
        }
        assert_eq!(done.code, 1, "{done:?}");
        assert!(done.err.contains("mesa-vulkan-drivers"), "it says what to install: {done:?}");
        assert!(std::env::var_os("MESHLOD_REQUIRE_GPU").is_none(), "{done:?}");
        eprintln!("skipped: no GPU");
        false
    }

    #[test]
    fn every_format_has_a_picture() {
        let run = Run::new();
        if !has_gpu(&run) {
            return;
        }
        run.sample("torus", 2_000, "a.ply");
        run.json(&["build", "a.ply", "a.mlod"]);
        run.json(&["compress", "a.ply", "a.mlq"]);
        run.json(&["compress", "a.ply", "a.mlz"]);
        for file in ["a.ply", "a.mlod", "a.mlq", "a.mlz"] {
            let answer = run.json(&["render", "--gpu", file, "a.png", "--size", "64x48"]);
            assert_eq!(answer["width"], 64, "{file}");
            assert!(answer["faces"].as_u64() > Some(50), "{file}: {answer}");
            let png = std::fs::read(run.path("a.png")).unwrap();
            assert!(png.starts_with(b"\x89PNG"), "{file}");
        }
        let done = run.run(&["render", "a.mlq", "b.png"]);
        assert_eq!(done.code, 0, "without a GPU it is decoded: {done:?}");
    }

    #[test]
    fn a_script_films_a_model() {
        let run = Run::new();
        if !has_gpu(&run) {
            return;
        }
        run.sample("torus", 4_000, "a.ply");
        run.json(&["build", "a.ply", "a.mlod"]);
        let script = r#"{ "size": [64, 48], "frames": 3, "keys": [
            { "frame": 0, "yaw": 0, "distance": 4 }, { "frame": 2, "yaw": 20, "distance": 1 }
        ] }"#;
        std::fs::write(run.path("s.json"), script).unwrap();
        let answer = run.json(&["view", "a.mlod", "--script", "s.json", "--out", "film"]);
        assert_eq!(answer["frames"], 3);
        let text = std::fs::read_to_string(run.path("film/frames.jsonl")).unwrap();
        let lines: Vec<Value> = text.lines().map(|l| serde_json::from_str(l).unwrap()).collect();
        assert!(lines[0]["faces"].as_u64() < lines[2]["faces"].as_u64(), "nearer is finer");
        assert!(lines[1]["sent_bytes"].as_u64() > Some(0));
        for frame in 0..3 {
            assert!(run.path(&format!("film/frame_{frame:04}.png")).is_file());
        }
    }

    #[test]
    fn mistakes_leave_nothing_behind() {
        let run = Run::new();
        if !has_gpu(&run) {
            return;
        }
        run.sample("torus", 500, "a.ply");
        std::fs::write(run.path("bad.json"), "{ \"frames\": 0, \"keys\": [] }").unwrap();
        std::fs::write(run.path("bad.mlq"), "meshlodq and then nothing").unwrap();
        std::fs::write(run.path("good.json"), r#"{ "frames": 1, "keys": [{ "frame": 0 }] }"#)
            .unwrap();
        for (arguments, says) in [
            (&["view", "a.ply", "--script", "bad.json", "--out", "film"][..], "frames must be"),
            (&["view", "gone.ply", "--script", "good.json", "--out", "film"], "gone.ply"),
            (&["render", "--gpu", "bad.mlq", "x.png"], "bad.mlq"),
        ] {
            let done = run.run(arguments);
            assert_eq!(done.code, 1, "{arguments:?}: {done:?}");
            let own = |line: &&str| line.starts_with("meshlod: ");
            let lines: Vec<&str> = done.err.lines().filter(own).collect();
            assert!(lines.len() == 1 && lines[0].contains(says), "{arguments:?}: {done:?}");
        }
        assert!(!run.path("x.png").exists() && !run.path("film").exists());
        assert_eq!(run.run(&["view", "--script", "good.json"]).code, 2, "--out is missing");
        let two = ["view", "a.ply", "a.ply", "--script", "good.json", "--out", "film"];
        assert_eq!(run.run(&two).code, 2, "a film shows one file");
    }
}
