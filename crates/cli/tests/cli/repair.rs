//! Repairs of `repair`, its report, and what it leaves alone.

use meshlod_fixtures::shared_mesh;

use crate::run::Run;

/// A cube of two objects without a top, with one flipped, one duplicate and one degenerate face.
const HURT: &str = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n\
    o sides\nf 2 3 7\nf 2 6 7\nf 3 5 9 7\nf 5 4 8 9\nf 4 2 6 8\n\
    o base\nf 2 4 5 3\nf 2 4 5\nf 2 3 3\n";

#[test]
fn every_step_is_a_line_and_a_number() {
    let run = Run::new();
    std::fs::write(run.path("in.obj"), HURT).unwrap();
    let done = run.run(&["repair", "in.obj", "out.obj"]);
    let lines: Vec<&str> = done.text().lines().collect();
    assert_eq!((done.code, &done.err[..]), (0, ""));
    assert_eq!(
        lines[..5],
        [
            "out.obj: 12 faces to 10, 9 vertices to 8",
            "  duplicate-faces   1",
            "  degenerate-faces  1",
            "  turned-faces      1",
            "  unused-vertices   1",
        ]
    );
    assert!(lines[5].starts_with("repair_seconds: ") && lines.len() == 6);
    let mended = run.json(&["info", "out.obj"]);
    assert_eq!((&mended["inconsistent_edges"], &mended["objects"]), (&0.into(), &2.into()));
}

#[test]
fn holes_are_closed_when_asked_for() {
    let run = Run::new();
    std::fs::write(run.path("in.obj"), HURT).unwrap();
    let report = run.json(&["repair", "in.obj", "out.obj", "--holes", "4"]);
    let steps = &report["steps"];
    assert_eq!((&steps["filled-holes"], &steps["filling-faces"]), (&1.into(), &2.into()));
    assert_eq!((&report["changed"], &report["output_faces"]), (&true.into(), &12.into()));
    let whole = run.json(&["info", "out.obj"]);
    assert_eq!((&whole["closed"], &whole["volume"]), (&true.into(), &1.0.into()));
    let again = run.json(&["repair", "out.obj", "again.obj", "--holes", "4"]);
    assert_eq!(again["changed"], false);
    assert!(run.run(&["repair", "out.obj", "again.obj"]).text().contains("nothing to repair"));
}

/// Two tetrahedra that share an edge.
const HINGE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nv 0 0 -1\n\
    f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 1 5 2\nf 1 2 6\nf 1 6 5\nf 2 5 6\n";

#[test]
fn errors_that_come_back_with_the_format_are_told() {
    let run = Run::new();
    std::fs::write(run.path("in.obj"), HINGE).unwrap();
    let obj = run.json(&["repair", "in.obj", "out.obj"]);
    assert_eq!((&obj["steps"]["split-edges"], &obj["errors_left"]), (&1.into(), &0.into()));
    for out in ["out.glb", "out.gltf", "out.stl"] {
        let report = run.json(&["repair", "in.obj", out]);
        let left = &report["errors_left_by_kind"];
        assert_eq!(left, &serde_json::json!({ "non-manifold-edge": 1 }), "{out}");
        let check = run.run(&["check", out, "--json"]);
        assert_eq!((&check.json()["errors"], check.code), (&report["errors_left"], 3), "{out}");
        let done = run.run(&["repair", "in.obj", out]);
        assert!(done.text().contains("  left: non-manifold-edge  1\n"), "{done:?}");
        assert!(
            done.err.contains("has 1 error when it is read back; reading this format"),
            "{done:?}"
        );
        assert_eq!(run.run(&["check", out, "--no-weld"]).code, 0, "{out}");
    }
    let piped = run.run(&["repair", "in.obj", "-", "--format", "glb"]);
    assert!(piped.err.contains("  left: non-manifold-edge  1\n"), "{piped:?}");
}

#[test]
fn what_is_left_is_told_though_nothing_was_done() {
    let run = Run::new();
    std::fs::write(run.path("in.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n")
        .unwrap();
    let steps = ["--no-degenerate", "--no-orient", "--no-split", "--no-stitch"];
    let done = run.run(&[&["repair", "in.obj", "out.obj"][..], &steps].concat());
    assert!(done.text().contains("  nothing repaired\n  left: degenerate-face"), "{done:?}");
    assert_eq!(done.code, 0);
}

#[test]
fn steps_can_be_left_out() {
    let run = Run::new();
    std::fs::write(run.path("in.obj"), HURT).unwrap();
    let all = ["duplicates", "degenerate", "split", "orient", "stitch", "unused"];
    let flags: Vec<String> = all.iter().map(|step| format!("--no-{step}")).collect();
    let flags = flags.iter().map(String::as_str);
    let arguments: Vec<&str> = ["repair", "in.obj", "out.obj"].into_iter().chain(flags).collect();
    assert_eq!(run.json(&arguments)["changed"], false);
}

#[test]
fn what_welds_is_counted() {
    let run = Run::new();
    std::fs::write(
        run.path("in.obj"),
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1.01 0 0\nv 0 1.01 0\nv 1 1 0\n\
        f 1 2 3\nf 5 4 6\n",
    )
    .unwrap();
    let welded = run.json(&["repair", "in.obj", "out.obj", "--weld", "0.1"]);
    assert_eq!(
        (&welded["steps"]["welded-vertices"], &welded["output_vertices"]),
        (&2.into(), &4.into())
    );
    let stitched = run.json(&["repair", "in.obj", "out.obj", "--stitch", "0.1"]);
    assert_eq!(stitched["steps"]["stitched-edges"], 1);
}

#[test]
fn with_no_face_left_nothing_is_written() {
    let run = Run::new();
    std::fs::write(run.path("in.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").unwrap();
    let done = run.run(&["repair", "in.obj", "out.obj"]);
    assert_eq!((done.code, run.files()), (1, vec!["in.obj".to_owned()]));
    assert!(done.only_line().contains("in.obj: no face with an area is left"), "{done:?}");
}

#[test]
fn a_scene_stays_a_scene() {
    let Some(duck) = shared_mesh("duck.glb") else { return };
    let run = Run::new();
    let duck = duck.to_str().unwrap();
    run.json(&["repair", duck, "out.glb"]);
    let [before, after] = [duck, "out.glb"].map(|path| {
        let mut info = run.json(&["info", path]);
        info["file"] = "".into();
        info
    });
    assert_eq!(before, after);
}

#[test]
fn a_scan_that_is_not_manifold_comes_apart_where_it_must() {
    let Some(squirrel) = shared_mesh("squirrel-20k.obj") else { return };
    let run = Run::new();
    let squirrel = squirrel.to_str().unwrap();
    assert_eq!(run.run(&["check", squirrel]).code, 3);
    let steps = run.json(&["repair", squirrel, "out.ply"])["steps"].clone();
    assert_eq!(run.run(&["check", "out.ply"]).code, 0);
    assert_eq!((&steps["split-edges"], &steps["split-vertices"]), (&4.into(), &8.into()));
    let info = run.json(&["info", "out.ply"]);
    assert_eq!((&info["closed"], &info["pinched_vertices"]), (&true.into(), &0.into()));
}
