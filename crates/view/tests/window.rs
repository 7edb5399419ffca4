//! The viewer in a window: it starts, loads, follows the pointer, takes a picture and quits.
//!
//! A window needs the main thread, so this program has no test harness: it starts itself again as
//! the viewer, on a screen of its own where `xvfb-run` is there.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Output};

use meshlod::jobs::{BuildRequest, build};
use meshlod::{Scene, WriteOptions, samples, write};
use meshlod_view::viewer::{ViewerOptions, run};

/// Files to open, for the program that is the viewer.
const FILES: &str = "MESHLOD_WINDOW_FILES";

fn main() -> ExitCode {
    match std::env::var(FILES) {
        Ok(files) => view(&files),
        Err(_) => {
            test();
            ExitCode::SUCCESS
        }
    }
}

/// Is the viewer, and prints its report.
fn view(files: &str) -> ExitCode {
    let number = |name: &str| std::env::var(name).ok().and_then(|value| value.parse().ok());
    let path = |name: &str| std::env::var_os(name).map(PathBuf::from);
    let options = ViewerOptions {
        files: files.split(':').filter(|name| !name.is_empty()).map(PathBuf::from).collect(),
        seconds: number("MESHLOD_WINDOW_SECONDS"),
        screenshot: path("MESHLOD_WINDOW_PICTURE"),
        memory: path("MESHLOD_WINDOW_MEMORY"),
        ..ViewerOptions::default()
    };
    match run(options) {
        Ok(report) => {
            println!("{}", serde_json::to_string(&report).unwrap());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn test() {
    // Lists of tests are asked for by tools.
    if std::env::args().any(|argument| argument == "--list") {
        println!("window: test");
        return;
    }
    let has = |program: &str| {
        Command::new("which").arg(program).output().is_ok_and(|o| o.status.success())
    };
    if !has("xvfb-run") || meshlod_view::Gpu::headless().is_err() {
        eprintln!("skipped: the window needs a GPU and xvfb-run (apt-get install xvfb)");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let knot = folder.path().join("knot.ply");
    let levels = folder.path().join("knot.mlod");
    let scene = Scene::from_mesh("knot", samples::knot(3_000));
    write(&knot, &scene, &WriteOptions::default()).unwrap();
    let (built, _) = build(scene.clone(), &BuildRequest::default(), &()).unwrap();
    std::fs::write(&levels, built).unwrap();

    takes_a_picture_and_quits(folder.path(), &knot, scene.meshes[0].mesh.faces.len());
    survives_pointer_keys_and_sizes(folder.path(), &[&knot, &levels], has("xdotool"));
    says_what_cannot_be_opened(folder.path());
}

fn takes_a_picture_and_quits(folder: &Path, file: &Path, faces: usize) {
    let picture = folder.join("picture.png");
    let report = window(folder, &[file], &[("MESHLOD_WINDOW_PICTURE", &picture)], "");
    assert_eq!(report["faces"].as_u64(), Some(faces as u64), "{report}");
    assert!(report["first_picture_ms"].as_f64().is_some(), "{report}");
    assert!(std::fs::read(&picture).unwrap().starts_with(b"\x89PNG"));
    println!("test takes_a_picture_and_quits ... ok");
}

fn survives_pointer_keys_and_sizes(folder: &Path, files: &[&Path], has_xdotool: bool) {
    if !has_xdotool {
        eprintln!("skipped: pointer and keys need xdotool (apt-get install xdotool)");
        return;
    }
    let script = "sleep 2
        xdotool mousemove 400 300 mousedown 2 mousemove_relative 80 30 mouseup 2
        xdotool mousemove 400 300 mousedown 1 mousemove_relative -- -50 20 mouseup 1
        xdotool mousemove 400 300 click 4 click 5
        for key in 1 3 7 Home z Tab n n c question Escape; do xdotool key $key; done
        window=$(xdotool search --name meshlod | tail -1)
        xdotool windowsize $window 1 1; sleep 0.3
        xdotool windowsize $window 900 600; sleep 0.3";
    let seconds = Path::new("5");
    let report = window(folder, files, &[("MESHLOD_WINDOW_SECONDS", seconds)], script);
    assert_eq!(report["problems"].as_array().map(Vec::len), Some(0), "{report}");
    assert!(report["frames"].as_u64() > Some(10), "{report}");
    println!("test survives_pointer_keys_and_sizes ... ok");
}

fn says_what_cannot_be_opened(folder: &Path) {
    let missing = folder.join("missing.ply");
    let seconds = Path::new("1");
    let report = window(folder, &[&missing], &[("MESHLOD_WINDOW_SECONDS", seconds)], "");
    let problems = report["problems"].as_array().unwrap();
    assert!(problems[0].as_str().unwrap().contains("missing.ply"), "{report}");
    println!("test says_what_cannot_be_opened ... ok");
}

/// Runs the viewer on a screen of its own while a script acts, and returns its report.
fn window(
    folder: &Path,
    files: &[&Path],
    settings: &[(&str, &Path)],
    script: &str,
) -> serde_json::Value {
    let this = std::env::current_exe().unwrap();
    let names: Vec<_> = files.iter().map(|path| path.display().to_string()).collect();
    let shell = format!("'{}' & viewer=$!\n{script}\nwait $viewer", this.display());
    let mut command = Command::new("timeout");
    command.args(["90", "xvfb-run", "-a", "-s", "-screen 0 1280x800x24", "sh", "-c", &shell]);
    command.env(FILES, names.join(":")).env("MESHLOD_WINDOW_MEMORY", folder.join("memory.ron"));
    for (name, value) in settings {
        command.env(name, value);
    }
    let Output { status, stdout, stderr } = command.output().unwrap();
    let said = String::from_utf8_lossy(&stderr);
    assert!(status.success(), "{status}: {said}");
    let lines = String::from_utf8_lossy(&stdout);
    let report = lines.lines().find(|line| line.starts_with('{'));
    serde_json::from_str(report.unwrap_or_else(|| panic!("no report: {said}"))).unwrap()
}
