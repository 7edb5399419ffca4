//! docs/formats/json.md against what the verbs print.

use std::collections::{BTreeMap, BTreeSet};

use meshlod_fixtures::folding_strip;
use serde_json::{Value, json};

use crate::run::Run;

const PAGE: &str = include_str!("../../../../docs/formats/json.md");

/// Objects whose keys are names of findings, steps or reasons, not of fields, or those of another
/// verb.
const TABLES: [&str; 6] =
    ["counts", "findings_left_out", "steps", "errors_left_by_kind", "refusals", "result"];

/// Documented keys that no line of this test prints.
const NOT_PRINTED: [(&str, &str); 2] = [
    // Of attributes that do not fit the faces, which no reader lets through.
    ("check", "reason"),
    // Of a mesh with millions of intersections.
    ("check", "found"),
];

type Keys<'k> = BTreeSet<&'k str>;

/// Returns the text below a heading of the page, up to the next one of its level or above.
fn section(level: &str, name: &str) -> &'static str {
    let heading = format!("\n{level} {name}\n");
    let start = PAGE.find(&heading).unwrap_or_else(|| panic!("no section {name}"));
    let text = &PAGE[start + heading.len()..];
    let ends = ["\n## ", "\n### "].map(|end| text.find(end));
    let end = if level == "##" { ends[0] } else { ends.into_iter().flatten().min() };
    &text[..end.unwrap_or(text.len())]
}

/// Returns the words of a text in backquotes that may be keys: lower case, digits and underscores.
fn documented(text: &str) -> Keys<'_> {
    let is_key = |word: &&str| {
        !word.is_empty() && word.chars().all(|c| matches!(c, 'a'..='z' | '0'..='9' | '_'))
    };
    text.split('`').skip(1).step_by(2).filter(is_key).collect()
}

/// Returns the names of the shared objects that a text links to, and that these link to.
fn linked(text: &str) -> BTreeSet<&'static str> {
    let shared = section("##", "Shared objects").split("\n### ").skip(1);
    let names: Vec<&str> = shared.map(|object| object.lines().next().unwrap()).collect();
    let mut all = BTreeSet::new();
    for link in text.split("](#").skip(1) {
        let anchor = link.split(')').next().unwrap();
        let name = names.iter().find(|name| name.to_lowercase().replace(' ', "-") == anchor);
        let name = name.unwrap_or_else(|| panic!("no object for the link {anchor}"));
        all.insert(*name);
        all.extend(linked(section("###", name)));
    }
    all
}

/// Adds all keys of an object and of what is in it.
fn add_keys<'v>(value: &'v Value, keys: &mut Keys<'v>) {
    match value {
        Value::Array(values) => values.iter().for_each(|value| add_keys(value, keys)),
        Value::Object(entries) => {
            for (key, value) in entries {
                keys.insert(key);
                // Of the input of a comparison, the counts are fields.
                if !TABLES.contains(&&**key) || value.get("genus").is_some() {
                    add_keys(value, keys);
                }
            }
        }
        _ => {}
    }
}

/// Divides the keys of an answer into those of every verb and its own.
fn keys_of(answer: &Value) -> [Keys<'_>; 2] {
    let mut keys = [Keys::new(), Keys::new()];
    for (key, value) in answer.as_object().unwrap() {
        let is_own = !["format", "version", "verb", "notes", "failure", "exit"].contains(&&**key);
        let keys = &mut keys[usize::from(is_own)];
        keys.insert(key);
        if !TABLES.contains(&&**key) || value.get("genus").is_some() {
            add_keys(value, keys);
        }
    }
    keys
}

/// Keys that were printed, by the shared object whose section has them.
type OfShared<'v> = BTreeMap<&'static str, Keys<'v>>;

/// Compares the keys of all answers of a verb with its section of the page, both ways, and notes
/// those that are of shared objects.
fn compare<'v>(verb: &str, answers: &'v [Value], of_shared: &mut OfShared<'v>) {
    let own = documented(section("##", verb));
    let objects = linked(section("##", verb));
    let of_object = |name: &&str| documented(section("###", name));
    let printed: Keys = answers.iter().flat_map(|answer| keys_of(answer)[1].clone()).collect();
    let on_page: Keys = objects.iter().flat_map(of_object).chain(own.iter().copied()).collect();
    let missing: Vec<_> = printed.difference(&on_page).collect();
    assert!(missing.is_empty(), "{verb}: not on the page: {missing:?}");
    let is_excepted = |key: &&&str| NOT_PRINTED.contains(&(verb, **key));
    let stale: Vec<_> = own.difference(&printed).filter(|key| !is_excepted(key)).collect();
    assert!(stale.is_empty(), "{verb}: on the page and not printed: {stale:?}");
    for name in objects {
        of_shared.entry(name).or_default().extend(&printed);
    }
}

/// Checks that the section of a verb has the keys of an answer, and no others.
pub fn check(verb: &str, answer: &Value) {
    compare(verb, std::slice::from_ref(answer), &mut OfShared::new());
}

/// Faces with findings of every kind that a file can have.
const BROKEN: &str = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 1 -1\nv 1 1 1\nv 2 2 1\nv 9 9 9\nv 9 9 9\n\
    v 20 0 0\nv 21 0 0\nv 20 1 0\nv 20 0 1\nv 19 0 0\nv 20 -1 0\nv 20 0 -1\n\
    o a\nf 1 2 3\nf 1 2 3\nf 1 1 2\no b\nf 4 5 6\n\
    o c\nf 9 10 11\nf 9 11 12\nf 9 12 10\nf 10 12 11\nf 9 13 14\nf 9 14 15\nf 9 15 13\nf 13 15 14\n";

/// Two nodes with one triangle.
const TWICE: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
    "nodes":[{"mesh":0},{"mesh":0,"translation":[5,0,0]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",
        "min":[0,0,0],"max":[1,1,0]}],
    "bufferViews":[{"buffer":0,"byteLength":36}],
    "buffers":[{"byteLength":36,
        "uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#;

/// Lines to run, in an order in which each has its input.
const LINES: [&str; 60] = [
    "sample knot in.ply --faces 2000",
    "info in.ply",
    "check in.ply --locks locks.json",
    "check broken.obj",
    "repair in.ply repaired.ply",
    "simplify in.ply out.ply -r 10% --measured --exact-volume --fuse",
    "simplify in.ply out.ply -e 1%",
    "simplify in.ply out.ply -r 20%",
    "convert in.ply in.obj",
    "info in.ply in.obj",
    "check in.ply in.obj",
    "lods in.ply levels.glb",
    "lods in.ply page.glb --layout needle",
    "check twice.gltf",
    "build in.ply in.mlod",
    "info in.mlod",
    "check in.mlod",
    "extract in.mlod cut.ply -e 1%",
    "page in.mlod page.html",
    "serve . --port 0 --seconds 0",
    "tiles in.ply tiles --tile-faces 200",
    "tiles plan in.ply plan",
    "tiles task plan 0",
    "tiles finish plan planned",
    "check tiles",
    "strip in.ply --levels 50% --verify",
    "strip in.mlod -e 1%",
    "strip in.mlod --follow 1%,0.5% --verify",
    "compress in.ply in.mlq",
    "info in.mlq",
    "decompress in.mlq decoded.ply",
    "compress in.ply parts.mlq --scheme parts --strips",
    // A scene with colours, normals, texture coordinates and a texture.
    "sample fish fish.obj -f 1000",
    "render fish.obj skin.png --size 16x16",
    "info painted.obj",
    "convert painted.obj painted.stl",
    "compress fish.obj fish.mlq",
    "info fish.mlq",
    "compress fish.obj fish.mlz",
    "info fish.mlz",
    "compress fish.obj fish.glb",
    // A scene with a skin and an animation.
    "info fold.glb",
    "simplify fold.glb folded.glb -r 50%",
    "build fold.glb fold.mlod",
    "check fold.mlod",
    "extract fold.mlod few.glb --faces 30",
    "measure fold.glb few.glb --poses 4 --samples 1000",
    "compress fold.glb fold.mlz",
    // A height field.
    "sample terrain open.ply --faces 800",
    "simplify open.ply fewer.ply -r 50%",
    "build open.ply field.mlod --model right-triangles",
    "info field.mlod",
    "check field.mlod",
    "compare in.ply -r 10% --out compared --no-pictures --methods lee-jang,spr --samples 1000",
    "measure in.ply out.ply --certified --samples 1000",
    "render in.ply heat.png --size 64x64 --heat-against out.ply",
    "flock --members 20 --frames 2 --size 64x64 --out school",
    "batch in.ply more -r 50% --dry-run",
    "completions bash",
    "man pages",
];

#[test]
fn the_page_has_every_key_that_verbs_print_and_no_other() {
    let run = Run::new();
    let write = |name: &str, bytes: &[u8]| std::fs::write(run.path(name), bytes).unwrap();
    write("broken.obj", BROKEN.as_bytes());
    write("twice.gltf", TWICE.as_bytes());
    write("fold.glb", &folding_strip(40));
    write("painted.mtl", b"newmtl skin\nmap_Kd skin.png\n");
    write(
        "painted.obj",
        b"mtllib painted.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl skin\nf 1/1 2/1 3/1\n",
    );
    let mut answers: BTreeMap<&str, Vec<Value>> = BTreeMap::new();
    for line in LINES {
        let words: Vec<&str> = line.split(' ').collect();
        let done = run.run(&[&words[..], &["--json"]].concat());
        let found = if line == "check broken.obj" { 3 } else { 0 };
        assert_eq!(done.code, found, "{line}: {done:?}");
        let json = done.json();
        assert_eq!(
            [&json["format"], &json["version"], &json["verb"]],
            [&json!("meshlod-report"), &json!(1), &json!(words[0])],
            "{line}"
        );
        answers.entry(words[0]).or_default().push(json);
    }
    for more in [&["batch", "in.ply", "many", "-r", "50%", "--json"][..], &["man", "--json"]] {
        answers.get_mut(more[0]).unwrap().push(run.run(more).json());
    }
    let mut of_shared = OfShared::new();
    for (verb, answers) in &answers {
        compare(verb, answers, &mut of_shared);
    }
    for (name, printed) in &of_shared {
        let on_page = documented(section("###", name));
        let stale: Vec<_> = on_page.difference(printed).collect();
        assert!(stale.is_empty(), "{name}: on the page and not printed: {stale:?}");
    }
    let failed = run.run(&["info", "missing.ply", "--json"]).json();
    let all = answers.values().flatten().chain([&failed]);
    let of_every: Keys = all.flat_map(|answer| keys_of(answer)[0].clone()).collect();
    assert_eq!(of_every, documented(section("##", "Every verb")));
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
    assert!(names.iter().all(|name| !section("##", name).is_empty()));
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
}
