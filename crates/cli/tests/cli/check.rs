//! Findings, exit codes, page and locks of `check`.

use std::path::Path;

use meshlod_fixtures::{shared_broken, shared_mesh};
use serde_json::{Value, json};

use crate::run::{Done, Run};

/// Three faces on one edge.
const BOOK: &str = "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\nf 1 2 3\nf 1 2 4\nf 2 1 5\n";

/// A horizontal square crossed by a vertical triangle, after one unused vertex.
const CROSSING: &str = "v 9 9 9\no floor\nv 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nf 2 3 4\nf 2 4 5\n\
    o blade\nv 2 1 -1\nv 3 1 -1\nv 2.5 1 1\nf 6 7 8\n";

fn write(run: &Run, name: &str, text: &str) {
    std::fs::write(run.path(name), text).unwrap();
}

fn check(run: &Run, arguments: &[&str]) -> Done {
    run.run(&[&["check"], arguments].concat())
}

fn read_json(run: &Run, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(run.path(name)).unwrap()).unwrap()
}

#[test]
fn a_sound_mesh_is_clean() {
    let run = Run::new();
    run.sample("sphere", 500, "in.ply");
    let done = check(&run, &["in.ply", "--deny", "warnings"]);
    assert_eq!((done.code, &done.err[..]), (0, ""), "{done:?}");
    assert!(done.text().ends_with("\nclean\n"), "{done:?}");
    let json = run.json(&["check", "in.ply"]);
    assert_eq!((&json["clean"], &json["findings"]), (&json!(true), &json!([])));
    assert!(json["counts"].as_object().unwrap().values().all(|count| *count == 0));
}

#[test]
fn errors_are_told_and_are_1() {
    let run = Run::new();
    write(&run, "book.obj", BOOK);
    let done = check(&run, &["book.obj"]);
    assert_eq!((done.code, &done.err[..]), (3, ""));
    let line = "  error    non-manifold-edge  1  first: v0 to v1 at 0 0 0.5\n";
    assert!(done.text().contains(line), "{}", done.text());
    let verdict = done.text().lines().nth(1).map(str::to_owned);
    assert_eq!(verdict.as_deref(), Some("1 error, 2 warnings"), "{}", done.text());
    let json = check(&run, &["book.obj", "--json"]);
    assert_eq!(json.code, 3);
    let json = json.json();
    let edge = json["findings"].as_array().unwrap().iter();
    let edge = edge.clone().find(|finding| finding["kind"] == "non-manifold-edge");
    assert_eq!(
        *edge.unwrap(),
        json!({
            "vertices": [0, 1], "faces": [0, 1, 2], "kind": "non-manifold-edge",
            "severity": "error", "place": [0.0, 0.0, 0.5],
        })
    );
}

#[test]
fn warnings_are_0_unless_they_are_denied() {
    let run = Run::new();
    run.sample("terrain", 200, "in.ply");
    assert_eq!(check(&run, &["in.ply"]).code, 0);
    let denied = check(&run, &["in.ply", "--deny", "warnings"]);
    assert_eq!((denied.code, &denied.err[..]), (3, ""));
    assert!(denied.text().contains("boundary-loop  1"), "{}", denied.text());
}

#[test]
fn contacts_are_told_by_the_names_of_objects() {
    let run = Run::new();
    write(&run, "in.obj", CROSSING);
    let json = run.json(&["check", "in.obj"]);
    assert_eq!((&json["objects"], &json["components"]), (&json!(2), &json!(2)));
    let contact = &json["contacts"][0];
    assert_eq!(contact["names"], json!(["floor", "blade"]));
    assert_eq!((&contact["face_pairs"], &contact["crossing"]), (&json!(1), &json!(1)));
    assert_eq!(
        (&contact["deepest"]["depth"], &contact["deepest_faces"]),
        (&json!(1.0), &json!([0, 2]))
    );
    let text = check(&run, &["in.obj"]);
    assert!(text.text().contains("floor – blade"), "{}", text.text());
    let none = run.json(&["check", "in.obj", "--no-intersections"]);
    assert_eq!((&none["counts"]["contact"], &none["contacts"]), (&Value::Null, &json!([])));
}

#[test]
fn what_is_left_out_is_counted() {
    let run = Run::new();
    let points: String = (0..7).map(|i| format!("v {i} {i} 9\n")).collect();
    write(&run, "in.obj", &(CROSSING.to_owned() + &points));
    let json = run.json(&["check", "in.obj", "--limit", "3"]);
    let unused = |json: &Value| {
        let findings = json["findings"].as_array().unwrap().iter();
        findings.filter(|finding| finding["kind"] == "unused-vertex").count()
    };
    assert_eq!((unused(&json), &json["findings_left_out"]), (3, &json!({ "unused-vertex": 5 })));
    let none = run.json(&["check", "in.obj", "--limit", "0"]);
    assert_eq!((&none["findings"], &none["contacts_left_out"]), (&json!([]), &json!(1)));
}

#[test]
fn locks_are_in_the_order_of_the_file() {
    let run = Run::new();
    write(&run, "in.obj", CROSSING);
    let json = run.json(&["check", "in.obj", "--locks", "locks.json"]);
    assert_eq!(json["written"], json!(["locks.json"]));
    let locks = read_json(&run, "locks.json");
    assert_eq!((&locks["format"], &locks["version"]), (&json!("meshlod-locks"), &json!(1)));
    let mesh = &locks["meshes"][0];
    // The first vertex of the file is unused, and the far corner of the floor is not in the face
    // that is crossed.
    assert_eq!(mesh["flags"], json!([0, 2, 2, 2, 0, 2, 2, 2]));
    assert_eq!(mesh["counts"], json!({ "free": 2, "lock": 0, "protect": 6 }));
    assert_eq!(mesh["ties"], json!([]));
}

#[test]
fn locks_of_stl_are_by_corner_and_tie_rows() {
    let run = Run::new();
    // Two adjacent squares that share no vertices.
    let squares = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\n\
        f 1 2 3\nf 1 3 4\nf 5 6 7\nf 5 7 8\n";
    write(&run, "in.obj", squares);
    run.json(&["check", "in.obj", "--locks", "obj.json", "--lock-boundary"]);
    let flags = |name| read_json(&run, name)["meshes"][0]["flags"].clone();
    assert_eq!(flags("obj.json"), json!([1, 1, 1, 1, 1, 1, 1, 1]), "all are at the boundary");
    run.json(&["check", "in.obj", "--locks", "obj.json"]);
    assert_eq!(read_json(&run, "obj.json")["meshes"][0]["ties"], json!([[1, 4], [2, 7]]));
    // STL welds the shared corners, so there is one component and no contact.
    let done = run.run(&["simplify", "in.obj", "in.stl", "--ratio", "100%"]);
    assert_eq!(done.code, 0, "{done:?}");
    run.json(&["check", "in.stl", "--locks", "stl.json"]);
    assert_eq!(flags("stl.json"), json!(vec![0; 12]));
    assert_eq!(read_json(&run, "stl.json")["meshes"][0]["ties"], json!([]));
}

#[test]
fn locks_of_gltf_say_which_rows_are_of_which_primitive() {
    let Some(path) = shared_mesh("cesium-milk-truck.glb") else {
        println!("skipped: the truck is not there");
        return;
    };
    let run = Run::new();
    check(&run, &[path.to_str().unwrap(), "--locks", "locks.json"]);
    let locks = read_json(&run, "locks.json");
    let meshes = locks["meshes"].as_array().unwrap();
    let mut vertices = 0;
    for mesh in meshes {
        let count = mesh["flags"].as_array().unwrap().len();
        assert_eq!(mesh["vertices"], json!(count));
        let last = mesh["primitives"].as_array().unwrap().last().unwrap();
        assert_eq!(last["first"].as_u64().unwrap() + last["count"].as_u64().unwrap(), count as u64);
        vertices += count;
    }
    assert_eq!(vertices, 2978, "all rows of all accessors");
    let held = |mesh: &&Value| mesh["counts"]["protect"].as_u64() > Some(0);
    assert_eq!(meshes.iter().filter(held).count(), 2, "the wheels, and the truck around them");
}

#[test]
fn locks_need_files_and_their_own_vertices() {
    let run = Run::new();
    write(&run, "in.obj", CROSSING);
    for arguments in [
        &["in.obj", "--locks", "l.json", "--weld", "0.1"][..],
        &["in.obj", "--locks", "in.obj"],
        &["in.obj", "--locks", "-"],
        &["-", "--format", "obj", "--locks", "l.json"],
        &["in.obj", "--lock-boundary"],
        &["in.obj", "--locks", "l.json", "--no-intersections"],
        &["in.obj", "--locks", "one", "--out", "one"],
        &["in.obj", "--locks", "index.html", "--out", "."],
    ] {
        let done = check(&run, arguments);
        assert_eq!((done.code, &done.out[..]), (2, &b""[..]), "{arguments:?}: {done:?}");
        assert_eq!(run.files(), ["in.obj"], "{arguments:?}");
    }
}

#[test]
fn locks_from_a_file_are_those_of_the_mesh() {
    let run = Run::new();
    write(&run, "in.obj", CROSSING);
    run.json(&["check", "in.obj", "--locks", "l.json"]);
    let simplify = |options: &[&str]| {
        run.json(&[&["simplify", "in.obj", "out.obj", "--ratio", "10%"], options].concat())
    };
    let [by_file, by_contacts] = [&["--locks", "l.json"][..], &["--lock-contacts"]].map(simplify);
    assert_eq!(by_file["held"], json!({ "locked": 0, "protected": 6, "tied": 0 }));
    for field in ["held", "output_faces", "refusals"] {
        assert_eq!(by_file[field], by_contacts[field], "{field}");
    }
}

#[test]
fn locks_of_another_mesh_are_refused() {
    let run = Run::new();
    write(&run, "in.obj", CROSSING);
    run.sample("sphere", 100, "ball.ply");
    run.json(&["check", "ball.ply", "--locks", "ball.json"]);
    write(&run, "list.json", "[]");
    write(&run, "cut.json", "{\"format\": \"meshlod-locks\"");
    let file = |version: u32, mesh: &str| {
        format!("{{\"format\":\"meshlod-locks\",\"version\":{version},\"meshes\":[{mesh}]}}")
    };
    write(&run, "new.json", &file(2, ""));
    write(&run, "none.json", &file(1, ""));
    write(&run, "flag.json", &file(1, "{\"flags\":[0,0,7,0,0,0,0,0]}"));
    let ties = |ties: &str| file(1, &format!("{{\"flags\":[0,0,0,0,0,0,0,0],\"ties\":[{ties}]}}"));
    write(&run, "tie.json", &ties("[1,99]"));
    write(&run, "one.json", &ties("[1,1],[99]"));
    write(&run, "torn.json", &ties("[2,2],[3,3,5]"));
    // The same number of vertices at other positions.
    write(&run, "moved.obj", &CROSSING.replace("v 4 0 0", "v 4 0 1"));
    run.json(&["check", "moved.obj", "--locks", "moved.json"]);
    for (name, reason) in [
        ("ball.json", "vertices, but the input has 8"),
        ("list.json", "is not a lock file"),
        ("cut.json", "EOF"),
        ("new.json", "version 2"),
        ("none.json", "has locks for 0 meshes, but the input has 1"),
        ("flag.json", "flag 2 is 7"),
        ("tie.json", "tie 0 names vertex 99"),
        ("one.json", "tie 1 has 1 vertices"),
        ("torn.json", "tie 1 has vertices at different positions: 3 and 5"),
        ("moved.json", "mesh 0: the locks are for vertices at other positions"),
    ] {
        let arguments = ["simplify", "in.obj", "out.obj", "--ratio", "50%", "--locks", name];
        let done = run.run(&arguments);
        assert!(done.code == 1 && done.only_line().contains(reason), "{name}: {done:?}");
        assert!(!run.path("out.obj").exists());
    }
}

#[test]
fn locks_without_a_mark_of_positions_are_taken() {
    let run = Run::new();
    write(&run, "in.obj", CROSSING);
    let flags =
        "{\"format\":\"meshlod-locks\",\"version\":1,\"meshes\":[{\"flags\":[0,1,0,0,0,0,0,0]}]}";
    write(&run, "own.json", flags);
    let report =
        run.json(&["simplify", "in.obj", "out.obj", "--ratio", "90%", "--locks", "own.json"]);
    assert_eq!(report["held"]["locked"], 1);
}

#[test]
fn a_real_model_is_checked_and_held_together() {
    let Some(fish) = shared_mesh("fish-clown.obj") else {
        println!("skipped: the fish is not there");
        return;
    };
    let run = Run::new();
    let fish = fish.to_str().unwrap();
    let found = run.json(&["check", fish]);
    assert_eq!((&found["components"], &found["errors"]), (&json!(10), &json!(0)));
    // PLY would split vertices at seams.
    let locks = ["--lock-contacts", "--topology", "keep"];
    let held = run.json(&[&["simplify", fish, "f.obj", "--ratio", "10%"], &locks[..]].concat());
    assert!(held["held"]["protected"].as_u64() > Some(0), "{held}");
    let info = run.json(&["info", "f.obj"]);
    assert_eq!((&info["closed"], &info["components"]), (&json!(true), &json!(10)));
}

#[test]
fn both_broad_phases_find_the_same() {
    let run = Run::new();
    let Some(fish) = shared_mesh("fish-clown.obj") else {
        println!("skipped: the fish is not there");
        return;
    };
    let fish = fish.to_str().unwrap();
    let with = |option, method| run.json(&["check", fish, option, method, "--limit", "9999"]);
    let by_tree = with("--broad-phase", "tree");
    assert_eq!(by_tree, with("--broad-phase", "octree"));
    // The former names still work.
    assert_eq!(by_tree, with("--net", "cubes"));
}

#[test]
fn the_page_has_pictures_a_legend_and_the_tables() {
    let run = Run::new();
    write(&run, "in.obj", CROSSING);
    let json = run.json(&["check", "in.obj", "--out", "out/page"]);
    assert_eq!(json["written"], json!(["out/page/index.html"]));
    let page = std::fs::read_to_string(run.path("out/page/index.html")).unwrap();
    assert_eq!(page.matches("data:image/png").count(), 8, "four sides, whole and marked");
    for words in ["crosses or overlaps another object", "boundary-loop", "floor – blade"] {
        assert!(page.contains(words), "{words}");
    }
    run.sample("sphere", 100, "ball.ply");
    run.json(&["check", "ball.ply", "--out", "out"]);
    let page = std::fs::read_to_string(run.path("out/index.html")).unwrap();
    assert_eq!(page.matches("data:image/png").count(), 4, "there is nothing to mark");
    assert!(page.contains("--rows: 2"), "no row is empty below the pictures");
    assert!(page.contains("No findings in"));
}

/// Two closed tetrahedra that share the place of one corner.
const TOUCHING: &str = "o left\nv 0 0 0\nv -1 0 0\nv -1 1 0\nv -1 0 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\n\
    f 2 4 3\no right\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 1 0 1\nf 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n";

#[test]
fn objects_that_touch_are_no_warning() {
    let run = Run::new();
    write(&run, "in.obj", TOUCHING);
    let json = run.json(&["check", "in.obj", "--deny", "warnings", "--out", "page"]);
    assert_eq!(
        (&json["errors"], &json["warnings"], &json["touches"]),
        (&json!(0), &json!(0), &json!(2))
    );
    let findings = json["findings"].as_array().unwrap();
    assert_eq!(findings.len(), 2, "one place is shared, and the objects meet there: {json}");
    assert!(findings.iter().all(|finding| finding["severity"] == "touch"), "{json}");
    let done = check(&run, &["in.obj"]);
    assert!(done.text().contains("\n0 errors, 0 warnings; 2 places where objects touch\n"));
    let contacts = "1 pair of objects that only touch\n                face pairs  vertex\n  \
                    left – right           1       1\n";
    assert!(done.text().ends_with(contacts), "columns without figures go: {}", done.text());
    let page = std::fs::read_to_string(run.path("page/index.html")).unwrap();
    assert!(page.contains("objects touch, as parts may") && page.contains("May be meant"));
    assert!(!page.contains("To look at") && !page.contains("<span class=\"chip warning\">"));
    // What passes through is still one.
    write(&run, "in.obj", CROSSING);
    assert_eq!(check(&run, &["in.obj", "--deny", "warnings"]).code, 3);
    run.json(&["check", "in.obj", "--out", "page"]);
    let page = std::fs::read_to_string(run.path("page/index.html")).unwrap();
    assert!(page.contains("To look at") && page.contains("<span class=\"chip warning\">cross"));
}

#[test]
fn the_page_lists_places_and_what_to_do() {
    let run = Run::new();
    write(&run, "in.obj", CROSSING);
    run.json(&["check", "in.obj", "--out", "page"]);
    let page = std::fs::read_to_string(run.path("page/index.html")).unwrap();
    for cell in ["f0 and f2", "floor – blade", "2.5 1 0", "crossing, 1 deep", "v0", "9 9 9"] {
        let is_there = |tag: &str| page.contains(&format!(">{cell}</{tag}>"));
        assert!(is_there("td") || is_there("th"), "{cell}");
    }
    for command in ["repair --fuse", "simplify --lock-contacts", "repair --holes N", "--weld EPS"] {
        assert!(page.contains(&format!("<code>{command}</code>")), "{command}");
    }
    // As many as are asked for, then their number.
    let points: String = (0..40).map(|i| format!("v {i} 0 9\n")).collect();
    write(&run, "in.obj", &(CROSSING.to_owned() + &points));
    run.json(&["check", "in.obj", "--out", "page"]);
    let page = std::fs::read_to_string(run.path("page/index.html")).unwrap();
    assert!(page.contains("And 16 more, which"), "41 unused vertices, 25 of them listed");
}

#[test]
fn text_says_what_to_do_about_every_kind() {
    let run = Run::new();
    write(&run, "book.obj", BOOK);
    let done = check(&run, &["book.obj"]);
    let text = done.text();
    let advice = text.split_once("what to do\n").unwrap().1;
    for line in ["  non-manifold-edge (error): repair ", "  boundary-loop (warning): "] {
        assert!(advice.contains(line), "{text}");
    }
    assert!(!text.contains('`'), "{text}");
}

#[test]
fn every_file_is_checked_or_named() {
    let run = Run::new();
    let mut files = shared_broken();
    let whole = ["fish-clown.obj", "city.glb", "suzanne.obj", "pig.stl", "slope.smf", "bunny.ply"];
    files.extend(whole.into_iter().filter_map(shared_mesh));
    for file in files {
        let done = check(&run, &[file.to_str().unwrap(), "--json", "--out", "page"]);
        assert!(matches!(done.code, 0 | 1 | 3), "{}: {done:?}", file.display());
        if done.code == 1 {
            assert!(done.has_no_answer(), "{done:?}");
            assert!(done.only_line().contains(file.to_str().unwrap()), "{done:?}");
            continue;
        }
        let json = done.json();
        let code = if json["errors"].as_u64() > Some(0) { 3 } else { 0 };
        assert_eq!(done.code, code, "{}", file.display());
        let note = format!("meshlod: warning: {}: ", file.display());
        assert!(done.err.lines().all(|line| line.starts_with(&note)), "{done:?}");
    }
}

#[test]
fn every_shared_file_is_0_or_3() {
    let Some(folder) =
        shared_mesh("bunny.ply").and_then(|bunny| bunny.parent().map(Path::to_owned))
    else {
        return;
    };
    let run = Run::new();
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    for file in files.filter(|path| path.is_file()) {
        let done = check(&run, &[file.to_str().unwrap(), "--json"]);
        let is_said = ["unknown suffix", "is not read: "].iter().any(|why| done.err.contains(why));
        let is_unknown = done.code == 1 && is_said;
        assert!(is_unknown || matches!(done.code, 0 | 3), "{}: {done:?}", file.display());
    }
}
