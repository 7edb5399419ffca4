//! Strips at any level, and the files they are written to.

use std::collections::BTreeSet;

use meshlod_fixtures::{shared_broken, shared_mesh};
use serde_json::{Value, json};

use crate::run::Run;

/// Checks the figures of every level.
const FIELDS: [&str; 8] = [
    "triangles",
    "vertices_sent",
    "indices_with_restart",
    "strips",
    "swaps",
    "acmr16",
    "acmr32",
    "seconds",
];

pub fn number(level: &Value, field: &str) -> f64 {
    level[field].as_f64().unwrap_or_else(|| panic!("{field} of {level}"))
}

#[test]
fn every_filter_draws_every_level() {
    let run = Run::new();
    run.sample("knot", 2_000, "in.ply");
    let ways: [&[&str]; 8] = [
        &[],
        &["--quality", "best", "--effort", "quick"],
        &["--filter", "none"],
        &["--filter", "stss"],
        &["--filter", "dtff"],
        &["--filter", "repair"],
        &["--filter", "repair", "--effort", "quick"],
        &["--filter", "dtff", "--quality", "best", "--effort", "quick"],
    ];
    for way in ways {
        let levels = ["strip", "in.ply", "--levels", "10%,100%,55%,300", "--verify"];
        let report = run.json(&[&levels[..], way].concat());
        assert_eq!(report["verified"], true);
        let levels = report["levels"].as_array().unwrap();
        let triangles: Vec<_> = levels.iter().map(|level| number(level, "triangles")).collect();
        assert!(
            triangles[0] <= 200.0 && triangles[1] == number(&report, "input_faces"),
            "{triangles:?}"
        );
        for level in levels {
            FIELDS.iter().for_each(|field| assert!(number(level, field) >= 0.0));
            assert!(number(level, "vertices_sent") >= number(level, "triangles") + 2.0);
            assert!(number(level, "indices_with_restart") >= number(level, "vertices_sent"));
            assert_eq!((&level["missing"], &level["extra"]), (&json!(0), &json!(0)));
        }
    }
}

#[test]
fn each_filter_sends_less_than_the_one_before() {
    let run = Run::new();
    run.sample("torus", 2_000, "in.ply");
    let sent = ["none", "stss", "dtff", "repair"].map(|filter| {
        let report = run.json(&["strip", "in.ply", "--level", "20%", "--filter", filter]);
        number(&report["levels"][0], "vertices_sent")
    });
    assert!(sent.is_sorted_by(|more, less| more > less), "{sent:?}");
}

#[test]
fn people_get_a_table() {
    let run = Run::new();
    run.sample("sphere", 500, "in.ply");
    let done = run.run(&["strip", "in.ply", "--levels", "100%,30%", "--verify"]);
    assert_eq!((done.code, &done.err[..]), (0, ""));
    for word in ["ACMR16", "30%", "verified: ", "simplify_seconds: "] {
        assert!(done.text().contains(word), "{word}: {done:?}");
    }
}

#[test]
fn strips_in_gltf_are_read_back() {
    let run = Run::new();
    run.sample("torus", 1_000, "in.ply");
    let levels = ["strip", "in.ply", "--levels", "20%,100%", "--out", "out.gltf"];
    run.json(&levels);
    let document = std::fs::read(run.path("out.gltf")).unwrap();
    let document: Value = serde_json::from_slice(&document).unwrap();
    let modes: Vec<_> = document["meshes"].as_array().unwrap().iter().collect();
    assert_eq!(modes.len(), 2);
    for mesh in modes {
        assert_eq!(mesh["primitives"].as_array().unwrap().len(), 1);
        assert_eq!(mesh["primitives"][0]["mode"], 5);
    }
    assert_eq!(document["extensionsUsed"], json!(["MSFT_lod"]));
    // The finest level is shown, whichever was listed first.
    let [original, back] = ["in.ply", "out.gltf"].map(|file| run.json(&["info", file]));
    for field in ["faces", "edges", "boundary_edges", "area", "volume", "closed"] {
        let [a, b] = [&original[field], &back[field]];
        let is_close = || (number(&original, field) / number(&back, field) - 1.0).abs() < 1e-6;
        assert!(a == b || is_close(), "{field}: {a}, {b}");
    }
    assert_eq!(run.json(&["strip", "out.gltf", "--verify"])["verified"], true);
}

#[test]
fn strips_keep_attributes_skins_and_animations() {
    for name in ["cesium-man.glb", "duck.glb", "cesium-milk-truck.glb"] {
        let Some(path) = shared_mesh(name) else { return };
        let run = Run::new();
        let levels = ["strip", path.to_str().unwrap(), "--levels", "100%,30%", "--verify"];
        let report =
            run.json(&[&levels[..], &["--filter", "repair", "--out", "out.gltf"]].concat());
        assert_eq!(report["verified"], true);
        run.json(&["simplify", path.to_str().unwrap(), "whole.gltf", "--ratio", "1"]);
        let [out, whole] = ["out.gltf", "whole.gltf"].map(|file| -> Value {
            serde_json::from_slice(&std::fs::read(run.path(file)).unwrap()).unwrap()
        });
        for kept in ["skins", "animations", "materials", "textures"] {
            assert_eq!(out[kept].as_array().map(Vec::len), whole[kept].as_array().map(Vec::len));
        }
        let names = |document: &Value| -> BTreeSet<String> {
            let attributes = document["meshes"][0]["primitives"][0]["attributes"].as_object();
            attributes.unwrap().keys().cloned().collect()
        };
        assert_eq!(names(&out), names(&whole));
        let [original, back] =
            [path.to_str().unwrap(), "out.gltf"].map(|file| run.json(&["info", file]));
        assert_eq!(original["faces"], back["faces"]);
        assert_eq!(original["area"], back["area"]);
    }
}

#[test]
fn no_strip_has_two_materials_and_what_is_lost_is_named() {
    let run = Run::new();
    let mtl = "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n";
    std::fs::write(run.path("in.mtl"), mtl).unwrap();
    let mut obj = String::from("mtllib in.mtl\n");
    for y in 0..4 {
        (0..=20).for_each(|x| obj += &format!("v {x} {y} 0\n"));
    }
    for (row, material) in [(0, "red"), (1, "blue"), (2, "red")] {
        obj += &format!("o row{row}\nusemtl {material}\n");
        for x in 0..20 {
            let [a, b] = [row * 21 + x + 1, row * 21 + x + 22];
            obj += &format!("f {a} {} {} {b}\n", a + 1, b + 1);
        }
    }
    std::fs::write(run.path("in.obj"), obj).unwrap();
    let strip = ["strip", "in.obj", "--levels", "100%,50%", "--verify", "--filter", "dtff"];
    let done = run.run(&[&strip[..], &["--out", "out.gltf"]].concat());
    assert_eq!(done.code, 0, "{done:?}");
    assert!(done.err.contains("left out: 3 names of objects"), "{done:?}");
    let document: Value =
        serde_json::from_slice(&std::fs::read(run.path("out.gltf")).unwrap()).unwrap();
    for mesh in document["meshes"].as_array().unwrap() {
        let primitives = mesh["primitives"].as_array().unwrap();
        let materials: Vec<_> = primitives.iter().map(|p| p["material"].clone()).collect();
        assert_eq!(materials, [json!(0), json!(1)]);
        assert!(primitives.iter().all(|primitive| primitive["mode"] == 5));
    }
    let [original, back] = ["in.obj", "out.gltf"].map(|file| run.json(&["info", file]));
    assert_eq!(original["area"], back["area"]);
}

#[test]
fn strips_in_json_are_lists_of_vertices() {
    let run = Run::new();
    run.sample("sphere", 300, "in.ply");
    let report = run.json(&["strip", "in.ply", "--level", "50%", "--out", "out.json"]);
    let lists: Value =
        serde_json::from_slice(&std::fs::read(run.path("out.json")).unwrap()).unwrap();
    let (level, told) = (&lists["levels"][0], &report["levels"][0]);
    let strips = level["strips"].as_array().unwrap();
    let sent: usize = strips.iter().map(|strip| strip.as_array().unwrap().len()).sum();
    assert_eq!(
        (json!(strips.len()), json!(sent)),
        (told["strips"].clone(), told["vertices_sent"].clone())
    );
    assert_eq!(level["triangles"], told["triangles"]);
}

#[test]
fn levels_and_files_that_are_none_are_wrong_usage() {
    let run = Run::new();
    run.sample("sphere", 100, "in.ply");
    let cases: [&[&str]; 11] = [
        &["--level", "0%"],
        &["--level", "0"],
        &["--level", "101"],
        &["--level", "101%"],
        &["--level", "-1"],
        &["--levels", "50%,x"],
        &["--filter", "magic"],
        &["--quality", "good"],
        &["--effort", "none"],
        &["--out", "out.ply"],
        &["--out", "-"],
    ];
    for case in cases {
        let done = run.run(&[&["strip", "in.ply"], case].concat());
        assert_eq!((done.code, &done.out[..]), (2, &b""[..]), "{case:?}: {done:?}");
        assert!(!done.err.is_empty() && !done.err.contains("panicked"), "{done:?}");
        assert_eq!(run.files(), ["in.ply"]);
    }
}

#[test]
fn a_level_out_of_reach_is_said_and_is_strict_if_asked() {
    let run = Run::new();
    run.sample("sphere", 100, "in.ply");
    let done = run.run(&["strip", "in.ply", "--level", "1"]);
    assert!(
        done.code == 0 && done.only_line().contains("1 face: no further contraction"),
        "{done:?}"
    );
    assert!(
        done.only_line().contains(" faces: strips keep the topology, so ask for more"),
        "{done:?}"
    );
    let done = run.run(&["strip", "in.ply", "--level", "1", "--strict", "--json"]);
    assert!(done.code == 1 && done.json()["levels"][0]["reached"] == false, "{done:?}");
}

#[test]
fn odd_faces_are_counted_and_the_rest_is_drawn() {
    let run = Run::new();
    let off = "OFF\n6 7 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n5 5 5\n3 0 1 2\n3 1 2 0\n3 1 0 3\n\
        3 1 0 4\n3 0 1 3\n3 2 2 1\n3 3 4 5\n";
    std::fs::write(run.path("in.off"), off).unwrap();
    for filter in [&[][..], &["--filter", "repair"]] {
        let report = run.json(&[&["strip", "in.off", "--verify"], filter].concat());
        let counted = ["degenerate_faces", "duplicate_faces", "non_manifold_edges"]
            .map(|field| report[field].as_u64().unwrap());
        assert_eq!(counted, [1, 1, 1], "{report}");
        assert_eq!(report["levels"][0]["triangles"], 5);
        assert_eq!(report["verified"], true);
    }
}

#[test]
fn damaged_files_are_stripped_or_named() {
    for input in shared_broken() {
        let (run, path) = (Run::new(), input.to_str().unwrap());
        let arguments = ["strip", path, "--levels", "100%,50%", "--filter", "repair", "--effort"];
        let done = run.run(&[&arguments[..], &["quick", "--verify", "--json"]].concat());
        match done.code {
            0 => assert_eq!(done.json()["verified"], true, "{path}"),
            _ => assert!(done.code == 1 && done.err.contains(path), "{path}: {done:?}"),
        }
    }
}

#[test]
fn the_papers_figures_are_bettered() {
    // [KY05, table 2]: savings of DTFF against the independent triangles of eight, at 10 % to 50 %.
    const PAPER: [f64; 5] = [18.4, 32.0, 39.9, 45.9, 50.3];
    let Some(path) = shared_mesh("eight.off") else { return };
    let run = Run::new();
    let levels = ["strip", path.to_str().unwrap(), "--levels", "10%,20%,30%,40%,50%"];
    let report = run.json(&[&levels[..], &["--filter", "repair", "--verify"]].concat());
    assert_eq!(report["verified"], true);
    for (level, paper) in report["levels"].as_array().unwrap().iter().zip(PAPER) {
        let each = number(level, "vertices_sent") / number(level, "triangles");
        let saved = 100.0 * (1.0 - each / 3.0);
        assert!(saved > paper + 8.0 && each < 1.28, "{level}");
    }
}
