//! `view --flock`: its options, and the window of a school.

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
        (&["--flock", "--policy", "best"], "distance, screen-error, "),
        (
            &["--flock", "--camera", "top"],
            "the scenarios are ring, inside, far, obstacles, terrain",
        ),
    ];
    for (arguments, reason) in cases {
        let done = run.run(&[&["view"], *arguments].concat());
        assert_eq!((done.code, done.out.len()), (2, 0), "{arguments:?}: {done:?}");
        assert!(done.err.contains(reason), "{done:?}");
    }
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
    }
}
