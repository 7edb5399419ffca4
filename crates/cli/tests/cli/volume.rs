//! Exact volume, of levels and of cuts.

use serde_json::Value;

use crate::run::Run;

fn volume(run: &Run, file: &str) -> f64 {
    run.json(&["info", file])["volume"].as_f64().unwrap()
}

fn extract(run: &Run, out: &str, arguments: &[&str]) -> Value {
    run.json(&[&["extract", "out.mlod", out], arguments].concat())
}

#[test]
fn exact_volume_is_that_of_the_file() {
    let run = Run::new();
    run.sample("knot", 8_000, "in.ply");
    let exact = ["--ratio", "10%", "--method", "lindstrom-turk", "--exact-volume"];
    for file in ["out.ply", "out.obj", "out.glb", "out.stl"] {
        let report = run.json(&[&["simplify", "in.ply", file], &exact[..]].concat());
        assert!(report["volume_residual"].as_f64().unwrap() <= 1e-12, "{report}");
        let relative = volume(&run, file) / volume(&run, "in.ply") - 1.0;
        assert!(relative.abs() <= 1e-12, "{file}: {relative:e}");
    }
    run.sample("terrain", 1_000, "open.ply");
    let open = run.run(&[&["simplify", "open.ply", "out.ply"], &exact[..]].concat());
    assert!(open.err.contains("is a closed, oriented surface"), "{open:?}");
}

#[test]
fn a_cut_of_exact_volume_has_that_of_the_mesh() {
    let run = Run::new();
    run.sample("knot", 6_000, "in.ply");
    let focus = ["--error", "0.01", "--focus", "sphere=0.9,0,0,0.3", "--exact-volume"];
    let coarse = ["--faces", "1500", "--exact-volume"];
    let off = |of: &str, out: &str, target: &[&str]| {
        let done = extract(&run, out, target);
        assert!(done["volume_residual"].as_f64().unwrap() < 1e-12, "{done}");
        assert!(done["volume_moved"].as_f64().unwrap() < 1e-4, "{done}");
        (volume(&run, out) / volume(&run, of) - 1.0).abs()
    };
    run.json(&["build", "in.ply", "out.mlod", "--exact-volume"]);
    for out in ["out.ply", "out.obj", "out.stl"] {
        for target in [&focus[..], &coarse[..]] {
            assert!(off("in.ply", out, target) < 1e-12, "{out} {target:?}");
        }
    }
    run.json(&["build", "in.ply", "out.mlod"]);
    extract(&run, "finest.ply", &["--error", "0", "--precision", "f64"]);
    assert!(off("finest.ply", "out.ply", &coarse) < 1e-12);
    assert!(off("in.ply", "out.ply", &coarse) > 1e-12, "the vertices in the file are rounded");
    let rounded = run.run(&[&["extract", "out.mlod", "out.ply"], &coarse[..]].concat());
    assert!(rounded.text().contains("build --exact-volume keeps the mesh's"), "{rounded:?}");
}

#[test]
fn a_volume_that_a_cut_cannot_have_is_said() {
    let run = Run::new();
    run.sample("terrain", 800, "terrain.ply");
    run.json(&["build", "terrain.ply", "terrain.mlod", "--model", "right-triangles"]);
    let warned = |arguments: &[&str], what: &str| {
        let done = run.run(arguments);
        assert!(done.code == 0 && done.err.contains(what), "{done:?}");
    };
    let take = ["extract", "terrain.mlod", "out.ply", "--faces", "100", "--exact-volume"];
    warned(&take, "is a closed, oriented surface");
    warned(
        &["build", "terrain.ply", "open.mlod", "--exact-volume"],
        "is a closed, oriented surface",
    );
    run.sample("torus", 2_000, "torus.ply");
    run.json(&["build", "torus.ply", "torus.mlod", "--in-chunk", "64"]);
    let whole = std::fs::read(run.path("torus.mlod")).unwrap();
    std::fs::write(run.path("torus.mlod"), &whole[..whole.len() - 50]).unwrap();
    let take = ["extract", "torus.mlod", "out.ply", "--faces", "100", "--exact-volume"];
    warned(&take, "chunks are there");
    let by_triangles = ["--model", "right-triangles", "--exact-volume"];
    let done = run.run(&[&["build", "terrain.ply", "t.mlod"], &by_triangles[..]].concat());
    assert_eq!(done.code, 2, "{done:?}");
}

#[test]
fn a_lost_volume_is_said_with_what_can_be_done() {
    let run = Run::new();
    let said = |sample: &str, faces: usize, target: &[&str]| {
        run.sample(sample, faces, "in.ply");
        let done = run.run(&[&["simplify", "in.ply", "out.ply"], target].concat());
        done.text().lines().find(|line| line.starts_with("volume: ")).map(str::to_owned)
    };
    let stuck = said("sphere", 2_000, &["--faces", "4", "--topology", "keep"]).unwrap();
    assert!(stuck.ends_with("more than --exact-volume can restore"), "{stuck}");
    // What an open mesh loses encloses nothing.
    assert_eq!(said("terrain", 2_000, &["--faces", "40"]), None);
    assert_eq!(said("knot", 8_000, &["--ratio", "10%"]), None, "what is repaid is not lost");
}
