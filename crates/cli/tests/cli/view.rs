<<<<<<< HEAD
//! `view` and `render --gpu`. Without the feature `view` they say how to get it; with it they need a
//! GPU, and are skipped where there is none, unless `MESHLOD_REQUIRE_GPU` is set.

use crate::run::Run;

#[cfg(not(feature = "view"))]
#[test]
fn a_program_without_the_viewer_says_how_to_get_it() {
    let run = Run::new();
    run.sample("sphere", 100, "a.ply");
    for arguments in [&["view", "a.ply"][..], &["render", "--gpu", "a.ply", "a.png"]] {
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
        assert_eq!(done.code, 1, "the processor does not draw it: {done:?}");
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
=======
//! `view`: its options, and the window of a school.

use crate::run::Run;

#[test]
fn options_of_a_school_need_the_flag() {
    let run = Run::new();
    let cases: &[(&[&str], &str)] = &[
        (&["--members", "5"], "--flock"),
        (&["--camera", "far"], "--flock"),
        (&["--model", "a.ply"], "--flock"),
        (&["--flock", "a.ply"], "cannot be used with"),
        (&["--flock", "--script", "a.json", "--out", "b"], "cannot be used with"),
        (&["--flock", "--policy", "best"], "the policies are none, "),
        (&["--flock", "--camera", "top"], "the cameras are ring, inside, far, obstacles, terrain"),
    ];
    for (arguments, reason) in cases {
        let done = run.run(&[&["view"], *arguments].concat());
        assert_eq!((done.code, done.out.len()), (2, 0), "{arguments:?}: {done:?}");
        assert!(done.err.contains(reason), "{done:?}");
    }
}

#[cfg(not(feature = "view"))]
#[test]
fn a_program_without_a_viewer_says_how_to_get_one() {
    let done = Run::new().run(&["view", "--flock"]);
    assert_eq!((done.code, done.only_line().contains("--features view")), (1, true), "{done:?}");
}

#[cfg(feature = "view")]
mod window {
    use std::process::{Command, Output};

    use serde_json::Value;

    use crate::run::Run;

    /// Runs the program on a screen of its own; `None`, with a line that says so, without one.
    fn on_a_screen(run: &Run, arguments: &[&str], without_gpu: bool) -> Option<Output> {
        let mut command = Command::new("timeout");
        command.args(["90", "xvfb-run", "-a", "-s", "-screen 0 640x480x24"]);
        command.arg(env!("CARGO_BIN_EXE_meshlod")).args(arguments);
        command.current_dir(run.folder.path()).env("XDG_DATA_HOME", run.folder.path());
        if without_gpu {
            for name in ["VK_ICD_FILENAMES", "VK_DRIVER_FILES"] {
                command.env(name, "/nonexistent");
            }
            command.env("WGPU_BACKEND", "vulkan");
        }
        let has_screen = Command::new("which").arg("xvfb-run").output();
        let has_screen = has_screen.is_ok_and(|which| which.status.success());
        let has_gpu = without_gpu || meshlod_view::Gpu::headless().is_ok();
        if !(has_screen && has_gpu) {
            eprintln!("skipped: the window needs a GPU and xvfb-run (apt-get install xvfb)");
            return None;
        }
        Some(command.output().expect("the program starts"))
    }

    #[test]
    fn a_school_swims_and_quits() {
        let run = Run::new();
        run.sample("sphere", 100, "small.ply");
        let arguments = ["view", "--flock", "--members", "20", "--schools", "2", "--model"];
        let more = ["small.ply", "--camera", "obstacles", "--policy", "budget"];
        let end = ["--seconds", "1", "--screenshot", "a.png", "--json"];
        let all = [&arguments[..], &more, &end].concat();
        let Some(done) = on_a_screen(&run, &all, false) else { return };
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let report: Value = serde_json::from_slice(&done.stdout).expect("one object");
        assert_eq!((&report["members"], &report["schools"]), (&20.into(), &2.into()));
        assert_eq!(report["camera"], "obstacles");
        assert_eq!(report["policy"], "budget");
        assert_eq!(report["problems"].as_array().map(Vec::len), Some(0), "{report}");
        assert!(report["frames"].as_u64() > Some(2), "{report}");
        let mean = |name: &str| report[name].as_f64().unwrap_or_default();
        assert!(mean("mean_faces") > 0.0, "{report}");
        assert!(mean("mean_faces") < mean("mean_full_faces"), "{report}");
        let png = std::fs::read(run.path("a.png")).expect("a picture");
        assert!(png.starts_with(b"\x89PNG"));
    }

    #[test]
    fn without_a_gpu_one_line_says_so() {
        let run = Run::new();
        let arguments = ["view", "--flock", "--members", "2", "--seconds", "1"];
        let Some(done) = on_a_screen(&run, &arguments, true) else { return };
        let said = String::from_utf8_lossy(&done.stderr);
        assert_eq!((done.status.code(), said.lines().count()), (Some(1), 1), "{said}");
        assert!(said.starts_with("meshlod: no GPU found: install"), "{said}");
>>>>>>> wS
    }
}
