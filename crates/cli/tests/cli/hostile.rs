//! Damaged files: a valid result, or one line and no result.

use std::path::Path;

use meshlod_fixtures::shared_broken;

use crate::models::refused;
use crate::run::{Done, Run};

/// Runs a verb that writes `out`, and checks that it either succeeded or failed with one line and
/// no output.
fn check(run: &Run, arguments: &[&str], input: &Path, out: &str) -> Done {
    let done = run.run(arguments);
    let name = input.display();
    match done.code {
        0 => assert!(run.path(out).exists(), "{name}"),
        1 => {
            let lines: Vec<&str> =
                done.err.lines().filter(|line| !line.contains(": warning: ")).collect();
            assert!(
                matches!(lines[..], [line] if line.starts_with("meshlod: ")),
                "{name}: {done:?}"
            );
            assert!(done.has_no_answer() && run.files().is_empty(), "{name}: {:?}", run.files());
        }
        code => panic!("{name}: exit code {code}: {done:?}"),
    }
    done
}

#[test]
fn a_scene_without_faces_has_one_answer() {
    let run = Run::new();
    let empty = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{}]}"#;
    std::fs::write(run.path("none.gltf"), empty).unwrap();
    let verbs: [&[&str]; 11] = [
        &["simplify", "none.gltf", "out.ply", "--ratio", "50%"],
        &["lods", "none.gltf", "out.glb", "--levels", "50%"],
        &["build", "none.gltf", "out.mlod"],
        &["strip", "none.gltf"],
        &["strip", "none.gltf", "--out", "out.glb"],
        &["compress", "none.gltf", "out.mlq", "--bits", "12"],
        &["compress", "none.gltf", "out.mlz", "--bits", "12"],
        &["compress", "none.gltf", "out.glb"],
        &["render", "none.gltf", "out.png"],
        &["measure", "none.gltf", "none.gltf"],
        &["compare", "none.gltf", "--ratio", "50%", "--out", "out"],
    ];
    for verb in verbs {
        let done = refused(&run, verb, 1);
        assert_eq!(done.only_line(), "meshlod: none.gltf: the mesh has no faces", "{verb:?}");
    }
    std::fs::write(run.path("flat.obj"), "v 0 0 0\nv 1 0 0\nf 1 2 2\n").unwrap();
    let verbs: [&[&str]; 4] = [
        &["strip", "flat.obj"],
        &["strip", "flat.obj", "--filter", "dtff", "--verify", "--out", "out.gltf"],
        &["build", "flat.obj", "out.mlod"],
        &["simplify", "flat.obj", "out.ply", "--ratio", "50%"],
    ];
    for verb in verbs {
        let line = "meshlod: flat.obj: none of the 1 faces has three different vertices";
        assert_eq!(refused(&run, verb, 1).only_line(), line, "{verb:?}");
    }
}

#[test]
fn every_damaged_file_is_simplified_or_named() {
    for input in shared_broken() {
        let path = input.to_str().unwrap();
        for out in ["out.ply", "out.glb"] {
            let run = Run::new();
            let arguments = ["simplify", path, out, "--ratio", "50%", "--json"];
            let done = check(&run, &arguments, &input, out);
            if done.code == 1 {
                assert!(done.err.contains(path), "{done:?}");
                continue;
            }
            let (report, info) = (done.json(), run.json(&["info", out]));
            assert!(report["output_faces"].as_u64() > Some(0), "{path}");
            if out == "out.ply" {
                assert_eq!(info["faces"], report["output_faces"], "{path}");
            }
        }
    }
}

#[test]
fn every_damaged_file_is_looked_at_or_named() {
    for input in shared_broken() {
        let (run, path) = (Run::new(), input.to_str().unwrap());
        let info = run.run(&["info", path, "--json"]);
        let note = format!("meshlod: warning: {path}: ");
        let is_note = |line: &str| line.starts_with(&note);
        match info.code {
            0 => {
                assert!(info.json()["faces"].is_u64() && info.err.lines().all(is_note), "{info:?}")
            }
            _ => assert!(info.code == 1 && info.only_line().contains(path), "{info:?}"),
        }
        check(&run, &["render", path, "out.png", "--size", "32x32"], &input, "out.png");
    }
}

#[test]
fn every_damaged_file_is_compared_or_named() {
    for input in shared_broken() {
        let (run, path) = (Run::new(), input.to_str().unwrap());
        let options = ["--ratio", "50%", "--out", "out", "--samples", "100", "--no-pictures"];
        let done =
            check(&run, &[&["compare", path], &options[..]].concat(), &input, "out/index.html");
        assert!(done.code == 0 || done.err.contains(path), "{done:?}");
    }
}

#[test]
fn a_result_that_cannot_be_kept_leaves_the_old_one() {
    let run = Run::new();
    run.sample("sphere", 100, "out.ply");
    let before = std::fs::read(run.path("out.ply")).unwrap();
    std::fs::write(run.path("bad.off"), "OFF\n1 1 0\n0 0 0\n3 0 0 7\n").unwrap();
    let done = run.run(&["simplify", "bad.off", "out.ply", "--ratio", "50%"]);
    assert_eq!(done.code, 1, "{done:?}");
    assert_eq!(std::fs::read(run.path("out.ply")).unwrap(), before);
}
