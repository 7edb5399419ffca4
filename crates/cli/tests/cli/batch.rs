//! The verb `batch`: patterns, places of outputs, runs that go on, files that fail.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::Duration;

use crate::run::{Done, Run};

const JOURNAL: &str = ".meshlod-batch.jsonl";

/// Creates a folder of meshes, with one that is broken and a file of another kind.
fn meshes() -> Run {
    let run = Run::new();
    fs::create_dir_all(run.path("in/a/b")).unwrap();
    run.sample("sphere", 500, "in/s.ply");
    run.sample("torus", 800, "in/a/t.obj");
    run.sample("knot", 1000, "in/a/b/k.glb");
    fs::write(run.path("in/a/notes.txt"), "no mesh").unwrap();
    fs::write(run.path("in/.hidden.ply"), "no mesh").unwrap();
    run
}

/// Reads all files below a folder, but for the journal.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        match path.is_dir() {
            true => {
                let inside = contents(&path).into_iter();
                found.extend(inside.map(|(below, bytes)| (format!("{name}/{below}"), bytes)));
            }
            false if name == JOURNAL => {}
            false => drop(found.insert(name, fs::read(&path).unwrap())),
        }
    }
    found
}

fn names(run: &Run, folder: &str) -> Vec<String> {
    contents(&run.path(folder)).into_keys().collect()
}

fn batch(run: &Run, arguments: &[&str]) -> Done {
    run.run(&[&["batch"], arguments].concat())
}

#[test]
fn folders_below_a_pattern_are_kept_and_bytes_are_those_of_simplify() {
    let run = meshes();
    let done = batch(&run, &["in/**/*", "out", "--ratio", "10%", "--report", "r.csv"]);
    assert_eq!((done.code, &*done.err), (0, ""), "{done:?}");
    assert_eq!(names(&run, "out"), ["a/b/k.glb", "a/t.obj", "s.ply"]);
    for file in ["a/b/k.glb", "a/t.obj", "s.ply"] {
        let alone = format!("alone.{}", file.rsplit('.').next().unwrap());
        run.run(&["simplify", &format!("in/{file}"), &alone, "--ratio", "10%"]);
        let there = fs::read(run.path(&format!("out/{file}"))).unwrap();
        assert_eq!(there, fs::read(run.path(&alone)).unwrap(), "{file}");
    }
    let table = fs::read_to_string(run.path("r.csv")).unwrap();
    let rows: Vec<&str> = table.lines().collect();
    assert!(rows[0].starts_with("input,output,status,input_faces,output_faces,"), "{table}");
    assert!(rows[3].starts_with("in/s.ply,out/s.ply,done,500,50,"), "{table}");
    assert_eq!(rows.len(), 4);
}

#[test]
fn bytes_do_not_depend_on_the_number_of_files_at_a_time() {
    let run = meshes();
    for jobs in ["1", "3"] {
        let out = format!("out{jobs}");
        let done = batch(&run, &["in", &out, "--error", "1%", "--format", "glb", "--jobs", jobs]);
        assert_eq!(done.code, 0, "{done:?}");
    }
    assert_eq!(names(&run, "out1"), ["a/b/k.glb", "a/t.glb", "s.glb"]);
    assert_eq!(contents(&run.path("out1")), contents(&run.path("out3")));
}

#[test]
fn what_is_there_is_skipped_until_something_changes() {
    let run = meshes();
    let count = |arguments: &[&str]| {
        let json = run.json(&[&["batch", "in", "out"], arguments].concat());
        [&json["done"], &json["skipped"]].map(|number| number.as_u64().unwrap())
    };
    let ten = ["--ratio", "10%"];
    assert_eq!(count(&ten), [3, 0]);
    assert_eq!(count(&ten), [0, 3]);
    assert_eq!(count(&[&ten[..], &["--jobs", "1", "--threads", "1"]].concat()), [0, 3]);
    fs::remove_file(run.path("out/s.ply")).unwrap();
    assert_eq!(count(&ten), [1, 2], "one is gone");
    fs::write(run.path("out/s.ply"), "half").unwrap();
    assert_eq!(count(&ten), [1, 2], "one is another");
    run.sample("sphere", 700, "in/s.ply");
    assert_eq!(count(&ten), [1, 2], "an input changed");
    assert_eq!(count(&["--ratio", "20%"]), [3, 0], "the recipe changed");
    assert_eq!(count(&[&["--ratio", "20%"][..], &["--force"]].concat()), [3, 0]);
    // The end of the last line is lost, as on a full disk: one file counts as not there.
    let journal = fs::read(run.path("out").join(JOURNAL)).unwrap();
    let newest: Vec<&[u8]> = journal.split_inclusive(|&byte| byte == b'\n').rev().take(3).collect();
    let mut cut: Vec<u8> = newest.concat();
    cut.truncate(cut.len() - 9);
    fs::write(run.path("out").join(JOURNAL), cut).unwrap();
    assert_eq!(count(&["--ratio", "20%"]), [1, 2]);
    assert_eq!(count(&["--ratio", "20%"]), [0, 3], "what follows a line that is cut is read");
}

#[test]
fn a_file_that_fails_does_not_stop_the_others() {
    let run = meshes();
    fs::write(run.path("in/bad.ply"), "ply\n").unwrap();
    let arguments = ["in", "out", "--ratio", "10%", "--report", "r.json"];
    let done = batch(&run, &arguments);
    assert!(
        done.code == 1 && done.only_line().starts_with("meshlod: in/bad.ply: line 1: "),
        "{done:?}"
    );
    assert_eq!(names(&run, "out"), ["a/b/k.glb", "a/t.obj", "s.ply"]);
    let report: serde_json::Value =
        serde_json::from_slice(&fs::read(run.path("r.json")).unwrap()).unwrap();
    let bad = report.as_array().unwrap().iter().find(|row| row["input"] == "in/bad.ply").unwrap();
    assert_eq!(bad["status"], "failed");
    assert!(done.err.contains(bad["error"].as_str().unwrap()), "{bad}");
    let again = batch(&run, &arguments);
    assert!(again.code == 1 && again.text().contains("3 there already, 1 failed"), "{again:?}");
}

#[test]
fn any_verb_with_an_input_and_an_output_takes_many_files() {
    let run = meshes();
    let cases = [
        ("{\"verb\": \"build\", \"format\": \"mlod\"}", "mlod"),
        ("{\"verb\": \"compress\", \"bits\": 10, \"format\": \"mlq\"}", "mlq"),
        ("{\"verb\": \"convert\", \"format\": \"stl\"}", "stl"),
        ("{\"verb\": \"repair\", \"format\": \"off\"}", "off"),
        ("{\"verb\": \"render\", \"size\": \"32x32\", \"format\": \"png\"}", "png"),
    ];
    for (recipe, suffix) in cases {
        let done = batch(&run, &["in/*.ply", suffix, "--recipe", recipe]);
        assert_eq!(done.code, 0, "{done:?}");
        assert_eq!(names(&run, suffix), [format!("s.{suffix}")]);
    }
}

#[test]
fn nothing_is_done_where_outputs_collide() {
    let run = meshes();
    run.sample("sphere", 100, "in/a/t.ply");
    fs::create_dir(run.path("other")).unwrap();
    run.sample("sphere", 100, "other/s.ply");
    let cases: [(&[&str], &str); 6] = [
        (&["in/a/*", "out", "--format", "off"], "out/a/t.off: would be the output of both"),
        (&["in/*.ply", "other/*.ply", "out"], "out/s.ply: would be the output of both"),
        (&["in/*.ply", "in"], "in/s.ply: would overwrite the input in/s.ply"),
        (&["none/*.ply", "out"], "none/*.ply: no file of a format that is read"),
        (&["in/none.ply", "out"], "in/none.ply: there is no such file or folder"),
        (&["in/a***b", "out"], "in/a***b: "),
    ];
    for (arguments, reason) in cases {
        let base = if arguments[0] == "in/a/*" { "in/**/*" } else { arguments[0] };
        let arguments = [&[base], &arguments[1..], &["--ratio", "10%"]].concat();
        let done = batch(&run, &arguments);
        assert!(done.code == 1 && done.only_line().contains(reason), "{arguments:?}: {done:?}");
        assert!(!run.path("out").exists(), "{arguments:?}");
    }
}

#[test]
fn wrong_usage_of_a_batch_is_2() {
    let run = meshes();
    let cases: [&[&str]; 7] = [
        &["in", "out"],
        &["in"],
        &["in", "out", "--ratio", "10"],
        &["in", "out", "--ratio", "10%", "--jobs", "0"],
        &["in", "out", "--ratio", "10%", "--report", "r.txt"],
        &["in", "out", "--ratio", "10%", "--recipe", "r.toml"],
        &["in", "out", "--ratio", "10%", "--format", "docx"],
    ];
    for arguments in cases {
        let done = batch(&run, arguments);
        assert_eq!((done.code, &done.out[..]), (2, &b""[..]), "{arguments:?}: {done:?}");
        assert_eq!(run.files(), ["in"], "{arguments:?}");
    }
    let done = batch(&run, &["in", "out", "--recipe", "{\"verb\": \"info\"}"]);
    assert!(done.code == 1 && done.only_line().contains("takes verbs with IN and OUT"), "{done:?}");
}

#[test]
fn outputs_below_the_inputs_are_not_taken_for_inputs() {
    let run = meshes();
    for done in [3, 0] {
        let json = run.json(&["batch", "in", "in/out", "--ratio", "10%"]);
        assert_eq!((&json["files"], &json["done"]), (&3.into(), &done.into()));
    }
}

#[test]
fn a_dry_run_writes_nothing() {
    let run = meshes();
    let done = batch(&run, &["in", "out", "--ratio", "10%", "--dry-run"]);
    assert!(done.code == 0 && done.text().contains("in/s.ply -> out/s.ply"), "{done:?}");
    assert_eq!(run.files(), ["in"]);
}

#[test]
fn a_batch_that_was_killed_goes_on() {
    let run = Run::new();
    fs::create_dir(run.path("in")).unwrap();
    for at in 0..40 {
        run.sample("torus", 400 + 40 * at, &format!("in/{at}.ply"));
    }
    let arguments = ["batch", "in", "out", "--ratio", "20%", "--jobs", "2"];
    for pause_ms in [5, 20, 40] {
        let mut child = run.command(&arguments).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(pause_ms));
        // It may have ended by itself.
        let _ = child.kill();
        child.wait().unwrap();
    }
    // As of a process that was killed while it wrote.
    fs::create_dir_all(run.path("out")).unwrap();
    fs::write(run.path("out/.7.ply.4194305-4"), "half").unwrap();
    fs::write(run.path("out/.meshlod-tried"), "").unwrap();
    fs::remove_file(run.path("out/7.ply")).unwrap_or_default();
    let json = run.json(&arguments);
    assert_eq!(json["files"], 40, "{json}");
    run.json(&["batch", "in", "fresh", "--ratio", "20%"]);
    assert_eq!(contents(&run.path("out")), contents(&run.path("fresh")));
}
