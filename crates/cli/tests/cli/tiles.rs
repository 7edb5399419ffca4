//! Tiles: whole runs, steps, and runs that are ended and go on.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use crate::run::Run;

/// Runs a command that must succeed.
fn make(run: &Run, arguments: &[&str]) {
    let done = run.run(arguments);
    assert_eq!(done.code, 0, "{arguments:?}: {done:?}");
}

/// Runs a command that must fail, and returns its only line.
fn told(run: &Run, arguments: &[&str], code: i32) -> String {
    let done = run.run(arguments);
    assert_eq!(done.code, code, "{arguments:?}: {done:?}");
    done.only_line().to_owned()
}

/// Bytes of all files in a folder, by their path in it.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(at) = folders.pop() {
        for entry in fs::read_dir(&at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().display().to_string();
                all.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    all
}

#[test]
fn tiles_of_a_scan_meet_at_every_level() {
    let run = Run::new();
    run.sample("terrain", 60_000, "t.ply");
    let report = run.json(&["tiles", "t.ply", "out/tiles", "--tile-faces", "5000"]);
    let levels = report["levels"].as_array().unwrap();
    assert!(levels.len() > 2 && report["unchanged_tiles"] == 0, "{report}");
    assert!(!run.path("out/tiles/.plan").exists());
    let found = run.json(&["check", "out/tiles"]);
    assert_eq!((&found["tiles"], &found["levels"]), (&report["tiles"], &levels.len().into()));
    let done = run.run(&["check", "out/tiles/tileset.json"]);
    assert!(done.text().contains("proved: no crack within a level"), "{done:?}");
    // A tile is a mesh as any other.
    assert!(run.json(&["info", "out/tiles/tiles/0-0-0-0.glb"])["faces"].as_f64().unwrap() > 100.0);
}

#[test]
fn any_number_of_threads_and_steps_make_the_same_bytes() {
    let run = Run::new();
    run.sample("gyroid", 30_000, "in.ply");
    let size = ["--tile-faces", "4000"];
    for (threads, out) in [("1", "one"), ("3", "three")] {
        make(&run, &[&["tiles", "in.ply", out, "--threads", threads], &size[..]].concat());
    }
    let plan = run.json(&[&["tiles", "plan", "in.ply", "plan"], &size[..]].concat());
    let tasks = plan["tasks"].as_u64().unwrap();
    let early = told(&run, &["tiles", "finish", "plan", "steps"], 2);
    assert!(early.contains("is not done"), "{early}");
    for task in 0..tasks {
        make(&run, &["tiles", "task", "plan", &task.to_string()]);
    }
    let beyond = told(&run, &["tiles", "task", "plan", &tasks.to_string()], 2);
    assert!(beyond.contains("there is no task"), "{beyond}");
    make(&run, &["tiles", "finish", "plan", "steps"]);
    let one = files(&run.path("one"));
    assert!(one.len() > 10);
    assert_eq!(one, files(&run.path("three")));
    assert_eq!(one, files(&run.path("steps")));
}

#[test]
fn a_run_that_is_killed_goes_on() {
    let run = Run::new();
    run.sample("knot", 60_000, "in.ply");
    let line = ["tiles", "in.ply", "out", "--tile-faces", "3000"];
    for wait in [50, 200, 400, 800] {
        let mut command = run.command(&line);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(wait));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    make(&run, &line);
    make(&run, &["tiles", "in.ply", "whole", "--tile-faces", "3000"]);
    assert_eq!(files(&run.path("out")), files(&run.path("whole")));
}

#[test]
fn what_cannot_be_tiled_is_told() {
    let run = Run::new();
    run.sample("torus", 1_000, "in.ply");
    for (line, code, reason) in [
        (&["tiles", "in.ply", "in.ply"][..], 1, "is a file; name a folder"),
        (&["tiles", "in.ply", "."], 1, "holds other files"),
        (&["tiles", "in.ply", "-"], 2, "name a folder"),
        (&["tiles", "in.ply", "out", "--tile-faces", "5"], 2, "--tile-faces: must be at least 100"),
        (&["tiles", "in.ply", "out", "--lat", "100", "--lon", "0"], 2, "latitude within 90"),
        (&["tiles", "task", "nowhere", "0"], 2, "no plan of tiles"),
    ] {
        let line_told = told(&run, line, code);
        assert!(line_told.contains(reason), "{line:?}: {line_told}");
    }
    assert!(!run.path("out").exists());
    // Folders with other files are not touched, whatever these are called.
    for folder in ["used/tiles", "used/content"] {
        fs::create_dir_all(run.path(folder)).unwrap();
        fs::write(run.path(folder).join("mine.txt"), "mine").unwrap();
    }
    fs::write(run.path("used/tileset.json"), "{}").unwrap();
    for line in [&["tiles", "in.ply", "used"][..], &["tiles", "plan", "in.ply", "used"]] {
        let done = run.run(line);
        assert!(done.code != 0 && done.err.contains("holds other files"), "{done:?}");
    }
    assert!(files(&run.path("used")).contains_key("tiles/mine.txt"));
    assert!(files(&run.path("used")).contains_key("content/mine.txt"));
    // A model of one tile is a tileset, too.
    let report = run.json(&["tiles", "in.ply", "out"]);
    let found = run.json(&["check", "out"]);
    assert_eq!((&found["tiles"], &found["faces"]), (&1.into(), &report["input_faces"]));
}

#[test]
fn parts_that_tiles_lack_are_named() {
    let run = Run::new();
    std::fs::write(run.path("named.obj"), TWO_OBJECTS).unwrap();
    let done = run.run(&["tiles", "named.obj", "out"]);
    assert_eq!(done.code, 0, "{done:?}");
    assert!(done.only_line().contains("left out: 2 names of objects (left, right)"), "{done:?}");
    let refused = told(&run, &["tiles", "named.obj", "strict", "--strict"], 1);
    assert!(refused.contains("names of objects") && !run.path("strict").exists(), "{refused}");
}

const TWO_OBJECTS: &str = "\
o left
v 0 0 0
v 1 0 0
v 0 1 0
f 1 2 3
o right
v 5 0 0
v 6 0 0
v 5 1 0
f 4 5 6
";
