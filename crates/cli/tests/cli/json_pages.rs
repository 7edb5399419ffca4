//! docs/formats/json.md against what the verbs print.

use serde_json::{Value, json};

use crate::run::Run;

const PAGE: &str = include_str!("../../../../docs/formats/json.md");

/// Sections that hold for every verb.
const SHARED: [&str; 2] = ["Every verb", "Shared objects"];

/// Objects whose keys are names of findings, steps or reasons, not of fields, or those of another
/// verb.
const TABLES: [&str; 6] =
    ["counts", "findings_left_out", "steps", "errors_left_by_kind", "refusals", "result"];

/// Returns the text of a section of the page, up to the next one.
fn section(name: &str) -> &str {
    let start = PAGE.find(&format!("\n## {name}\n")).unwrap_or_else(|| panic!("no section {name}"));
    let text = &PAGE[start + 4..];
    text.split("\n## ").next().unwrap()
}

/// Adds all keys of an object and of what is in it.
fn keys<'v>(value: &'v Value, found: &mut Vec<&'v str>) {
    match value {
        Value::Array(values) => values.iter().for_each(|value| keys(value, found)),
        Value::Object(entries) => {
            for (key, value) in entries {
                found.push(key);
                if !TABLES.contains(&&**key) {
                    keys(value, found);
                }
            }
        }
        _ => {}
    }
}

/// Returns the keys that neither the section of the verb nor a shared one has in backquotes.
fn undocumented<'v>(verb: &str, json: &'v Value) -> Vec<&'v str> {
    let text = [SHARED.map(section).concat(), section(verb).to_owned()].concat();
    let mut found = Vec::new();
    keys(json, &mut found);
    found.retain(|key| !text.contains(&format!("`{key}`")));
    found
}

#[test]
fn every_key_that_a_verb_prints_is_on_the_page() {
    let run = Run::new();
    let lines = [
        "sample knot in.ply --faces 2000",
        "info in.ply",
        "check in.ply --locks locks.json",
        "repair in.ply repaired.ply",
        "simplify in.ply out.ply -r 10% --measured --exact-volume --fuse",
        "simplify in.ply out.ply -e 1%",
        "simplify in.ply out.ply -r 20% --sequence steps.bin",
        "replay steps.bin replayed.ply -r 50%",
        "convert in.ply in.obj",
        "lods in.ply levels.glb",
        "build in.ply in.mlod",
        "info in.mlod",
        "check in.mlod",
        "extract in.mlod cut.ply -e 1%",
        "strip in.ply --levels 50% --verify",
        "strip in.mlod -e 1%",
        "strip in.mlod --follow 1%,0.5%",
        "compress in.ply in.mlq",
        "info in.mlq",
        "decompress in.mlq decoded.ply",
        "sample fish fish.obj -f 1000",
        "compress fish.obj fish.mlz",
        "compress fish.obj fish.glb",
        "compare in.ply -r 10% --out compared --no-pictures --methods qem,spr --samples 1000",
        "measure in.ply out.ply --certified --samples 1000",
        "render in.ply heat.png --size 64x64 --heat-against out.ply",
        "flock --members 20 --frames 2 --size 64x64 --out school",
        "batch in.ply many -r 50%",
        "batch in.ply more -r 50% --dry-run",
        "completions bash",
        "man pages",
    ];
    for line in lines {
        let words: Vec<&str> = line.split(' ').collect();
        let json = run.json(&words);
        assert_eq!(
            [&json["format"], &json["version"], &json["verb"]],
            [&json!("meshlod-report"), &json!(1), &json!(words[0])],
            "{line}"
        );
        assert_eq!(undocumented(words[0], &json), [""; 0], "{line}");
    }
}

#[test]
fn every_key_about_a_broken_mesh_is_on_the_page() {
    let run = Run::new();
    let crossing = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 1 -1\nv 1 1 1\nv 2 2 1\nv nan 0 0\nv 9 9 9\n\
        o a\nf 1 2 3\nf 1 2 3\nf 1 1 2\no b\nf 4 5 6\n";
    std::fs::write(run.path("broken.obj"), crossing.replace("v nan 0 0\n", "v 9 9 9\n")).unwrap();
    let done = run.run(&["check", "broken.obj", "--json"]);
    assert_eq!(done.code, 3, "{done:?}");
    let json = done.json();
    assert!(json["findings"].as_array().is_some_and(|found| found.len() > 3), "{json}");
    assert_eq!(undocumented("check", &json), [""; 0]);
}

#[test]
fn every_verb_has_a_section() {
    let run = Run::new();
    let help = run.run(&["--help"]);
    let verbs = help.text().split("Commands:\n").nth(1).unwrap().lines();
    let names = verbs.take_while(|line| !line.is_empty()).filter(|line| line.starts_with("  "));
    let names: Vec<&str> = names
        .filter(|line| !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|&name| name != "help")
        .collect();
    assert!(names.len() > 15, "{names:?}");
    assert!(names.iter().all(|name| !section(name).is_empty()));
}

#[test]
fn a_failure_is_json_too() {
    let run = Run::new();
    std::fs::write(run.path("bad.obj"), "v 0 0 0\nv 1 x 0\n").unwrap();
    let done = run.run(&["info", "bad.obj", "--json"]);
    let line = done.only_line().strip_prefix("meshlod: ").unwrap();
    let expected = json!({
        "format": "meshlod-report", "version": 1, "verb": "info",
        "failure": { "message": line, "file": "bad.obj", "place": "line 2" }, "exit": 1,
    });
    assert_eq!((done.code, done.json()), (1, expected));
    let usage = run.run(&["info", "bad.obj", "--jsonn", "--json"]);
    let json = usage.json();
    assert_eq!((usage.code, &json["exit"], &json["verb"]), (2, &json!(2), &Value::Null));
    let message = json["failure"]["message"].as_str().unwrap();
    assert!(message.contains("--jsonn") && !message.contains('\n'), "{message}");
    assert_eq!(undocumented("info", &json), [""; 0]);
}
