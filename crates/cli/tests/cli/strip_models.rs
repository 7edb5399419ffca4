//! Strips of cuts of multiresolution files.

use serde_json::json;

use crate::run::Run;
use crate::strip::number;

#[test]
fn cuts_of_a_model_are_stripped_and_written() {
    let run = Run::new();
    run.sample("terrain", 4_000, "in.glb");
    run.json(&["build", "in.glb", "in.mlod"]);
    let camera = "eye=0,2,0 look=0,0,0.1 fov=45 640x480";
    let ways: [&[&str]; 4] = [
        &["--error", "0.5%"],
        &["--faces", "500"],
        &["--error", "1px", "--camera", camera],
        &["--error", "0", "--focus", "sphere=0,0,0,0.2", "--quality", "best", "--effort", "quick"],
    ];
    for way in ways {
        let query = way.iter().take_while(|word| **word != "--quality").copied();
        let query: Vec<_> = query.collect();
        let taken = run.json(&[&["extract", "in.mlod", "cut.glb"], &query[..]].concat());
        let out = ["strip", "in.mlod", "--verify", "--out", "strips.glb"];
        let report = run.json(&[&out[..], way].concat());
        assert_eq!((&report["verified"], &report["input_faces"]), (&json!(true), &taken["faces"]));
        if !way.contains(&"--faces") {
            assert_eq!(report["error"], taken["error"], "{way:?}");
        }
        let [cut, strips] = ["cut.glb", "strips.glb"].map(|file| run.json(&["info", file]));
        for field in ["faces", "vertices", "edges", "attributes", "materials"] {
            assert_eq!(cut[field], strips[field], "{way:?}: {field}");
        }
    }
}

#[test]
fn followed_cuts_draw_their_faces() {
    let run = Run::new();
    run.sample("knot", 3_000, "in.ply");
    run.json(&["build", "in.ply", "in.mlod"]);
    let walk = ["strip", "in.mlod", "--follow", "2%,0.1%,0,2%,2%", "--verify"];
    let report = run.json(&walk);
    assert_eq!(report["verified"], true);
    let cuts = report["cuts"].as_array().unwrap();
    let all = |field: &str| cuts.iter().map(|cut| number(cut, field)).collect::<Vec<_>>();
    let triangles = all("triangles");
    assert!(triangles[0] < triangles[1] && triangles[1] < triangles[2], "{report}");
    assert_eq!(triangles[0], triangles[4]);
    assert_eq!((all("changed")[0], all("changed")[4]), (triangles[0], 0.0));
    for (entries, indices) in all("entries").iter().zip(all("indices_with_restart")) {
        assert!(*entries >= indices, "{report}");
    }
    let done = run.run(&walk);
    assert!(done.code == 0 && done.text().contains("verified: "), "{done:?}");
}

#[test]
fn a_cut_out_of_reach_is_said_and_is_strict_if_asked() {
    let run = Run::new();
    run.sample("sphere", 400, "in.ply");
    run.json(&["build", "in.ply", "in.mlod"]);
    let ask = ["strip", "in.mlod", "--faces", "1"];
    let done = run.run(&ask);
    assert!(done.code == 0 && done.only_line().contains("--faces 1 is out of reach"), "{done:?}");
    assert_eq!(run.run(&[&ask[..], &["--strict"]].concat()).code, 1);
}

#[test]
fn queries_go_with_models_only() {
    let run = Run::new();
    run.sample("sphere", 400, "in.ply");
    run.json(&["build", "in.ply", "in.mlod"]);
    run.sample("terrain", 400, "field.ply");
    run.json(&["build", "field.ply", "field.mlod", "--model", "right-triangles"]);
    let cases: [&[&str]; 9] = [
        &["in.ply", "--error", "1%"],
        &["in.ply", "--follow", "1%"],
        &["in.mlod"],
        &["in.mlod", "--error", "1%", "--faces", "9"],
        &["in.mlod", "--error", "1px"],
        &["in.mlod", "--error", "1%", "--lock-boundary"],
        &["in.mlod", "--error", "1%", "--weld", "0.1"],
        &["in.mlod", "--follow", "1%", "--out", "out.glb"],
        &["field.mlod", "--follow", "1%"],
    ];
    for case in cases {
        let done = run.run(&[&["strip"], case].concat());
        assert_eq!((done.code, &done.out[..]), (2, &b""[..]), "{case:?}: {done:?}");
    }
    let report = run.json(&["strip", "field.mlod", "--error", "1%", "--verify"]);
    assert_eq!(report["verified"], true);
}
