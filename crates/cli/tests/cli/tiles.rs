//! Tiles: whole runs, steps, and runs that are ended and go on.

use std::fs;
use std::process::Stdio;
use std::time::Duration;

use meshlod_fixtures::folder_files as files;

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
fn an_archive_has_the_files_of_a_folder() {
    let run = Run::new();
    run.sample("knot", 20_000, "in.ply");
    let size = ["--tile-faces", "2000"];
    let folder = run.json(&[&["tiles", "in.ply", "out"], &size[..]].concat());
    let archive = run.json(&[&["tiles", "in.ply", "out", "--zip"], &size[..]].concat());
    assert_eq!((&archive["file"], &archive["bytes"]), (&"out.3tz".into(), &folder["bytes"]));
    let named = run.json(&[&["tiles", "in.ply", "named.3tz"], &size[..]].concat());
    assert_eq!(named["tiles"], folder["tiles"]);
    make(&run, &[&["tiles", "plan", "in.ply", "plan"], &size[..]].concat());
    for task in 0..folder["tiles"].as_u64().unwrap() {
        make(&run, &["tiles", "task", "plan", &task.to_string()]);
    }
    make(&run, &["tiles", "finish", "plan", "steps", "--zip"]);
    let bytes = ["out.3tz", "named.3tz", "steps.3tz"].map(|name| fs::read(run.path(name)).unwrap());
    assert!(bytes[0] == bytes[1] && bytes[0] == bytes[2]);
    // Nothing is left beside them.
    let mut names: Vec<_> = fs::read_dir(run.path("."))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, ["in.ply", "named.3tz", "out", "out.3tz", "steps.3tz"]);
    let found = run.json(&["check", "out.3tz"]);
    assert_eq!((&found["tiles"], &found["file"]), (&folder["tiles"], &"out.3tz".into()));
    for (end, reason) in [(0, "not a 3tz archive"), (bytes[0].len() / 2, "not a 3tz archive")] {
        fs::write(run.path("half.3tz"), &bytes[0][..end]).unwrap();
        let told = told(&run, &["check", "half.3tz"], 1);
        assert!(told.contains("half.3tz") && told.contains(reason), "{told}");
    }
}

#[test]
fn an_image_that_cannot_be_decoded_is_counted() {
    let run = Run::new();
    fs::write(run.path("skin.mtl"), "newmtl skin\nmap_Kd skin.png\n").unwrap();
    fs::write(run.path("skin.png"), b"\x89PNG\r\n\x1a\nno picture").unwrap();
    let text = "mtllib skin.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n\
                usemtl skin\nf 1/1 2/2 3/3\n";
    fs::write(run.path("in.obj"), text).unwrap();
    let done = run.run(&["tiles", "in.obj", "out", "--json"]);
    assert_eq!((done.code, &done.json()["lost_images"]), (0, &1.into()), "{done:?}");
    assert!(done.err.contains("cannot be decoded, left out: 1 image (skin.png)"), "{done:?}");
}

#[test]
fn the_finest_level_of_a_file_of_levels_is_tiled() {
    let run = Run::new();
    run.sample("knot", 2_000, "in.ply");
    make(&run, &["build", "in.ply", "in.mlod"]);
    let report = run.json(&["tiles", "in.mlod", "out", "--tile-faces", "500"]);
    assert_eq!(report["input_faces"], run.json(&["info", "in.ply"])["faces"]);
    assert_eq!(run.json(&["check", "out"])["findings"].as_array().unwrap().len(), 0);
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
        (&["tiles", "finish", "nowhere", "out"], 2, "no plan of tiles"),
    ] {
        let line_told = told(&run, line, code);
        assert!(line_told.contains(reason), "{line:?}: {line_told}");
    }
    let both = run.run(&["tiles", "in.ply", "out", "--ecef", "--up", "z"]);
    assert!(both.code == 2 && both.err.contains("cannot be used with"), "{both:?}");
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
