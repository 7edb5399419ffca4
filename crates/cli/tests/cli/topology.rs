//! Changes to the topology of a mesh, and how the program reports them.

use meshlod::Mesh;
use meshlod::mesh::VertexId;
use serde_json::{Value, json};

use crate::run::Run;

/// A sphere of some 500 faces and a tetrahedron just off its surface, 0.17 across.
fn sphere_with_a_crumb() -> Mesh {
    let mut mesh = meshlod::samples::sphere(500);
    let first = mesh.positions.len() as u32;
    let corners = [[1.0, 0.0, 0.0], [1.1, 0.0, 0.0], [1.0, 0.1, 0.0], [1.0, 0.0, 0.1]];
    mesh.positions.extend(corners);
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    mesh.faces.extend(faces.map(|face| face.map(|v| VertexId(first + v))));
    mesh
}

/// Takes a mesh apart into faces with three vertices each, which `gap` moves along the z axis.
fn torn(of: &Mesh, gap: f64) -> Mesh {
    let at = |(i, v): (usize, &VertexId)| {
        let [x, y, z] = of.positions[v.index()];
        [x, y, z + gap * (i % 3) as f64]
    };
    let positions = of.faces.as_flattened().iter().enumerate().map(at).collect();
    let faces = (0..of.faces.len() as u32).map(|f| [0, 1, 2].map(|k| VertexId(3 * f + k)));
    Mesh::new(positions, faces.collect())
}

fn write(run: &Run, name: &str, mesh: Mesh) {
    let scene = meshlod::Scene::from_mesh("", mesh);
    meshlod::write(run.path(name), &scene, &meshlod::WriteOptions::default()).unwrap();
}

#[test]
fn small_components_vanish_unless_that_is_ruled_out() {
    let run = Run::new();
    write(&run, "in.obj", sphere_with_a_crumb());
    let vanished = |options: &[&str]| {
        let all = [&["simplify", "in.obj", "a.obj", "--faces", "20"], options].concat();
        run.json(&all)["vanished"].clone()
    };
    assert_eq!(vanished(&[]), 1);
    assert_eq!(vanished(&["--topology", "free"]), 1);
    assert_eq!(vanished(&["--topology", "keep"]), 0);
    assert_eq!(vanished(&["--vanish-below", "0.1"]), 0);
    assert_eq!(vanished(&["--vanish-below", "50%"]), 1);
    for bad in ["-1", "nan", "-3%", "big"] {
        let size = format!("--vanish-below={bad}");
        let done = run.run(&["simplify", "in.obj", "a.obj", "--faces", "4", &size]);
        assert_eq!(done.code, 2, "{size}: {done:?}");
    }
    let both = ["--topology", "keep", "--vanish-below", "5%"];
    let done = run.run(&[&["simplify", "in.obj", "a.obj", "--faces", "4"], &both[..]].concat());
    assert!(done.code == 2 && done.only_line().contains("nothing vanishes"), "{done:?}");
}

#[test]
fn borders_that_lie_on_each_other_are_stitched() {
    let run = Run::new();
    write(&run, "in.obj", torn(&meshlod::samples::sphere(500), 0.0));
    let simplify = ["simplify", "in.obj", "out.obj", "--ratio", "20%"];
    let report = run.json(&simplify);
    let faces = report["input_faces"].as_u64().unwrap();
    assert_eq!(report["stitched_edges"], faces * 3 / 2);
    assert_eq!((&report["reached"], &report["split_vertices"]), (&json!(true), &json!(0)));
    assert_eq!(run.json(&["info", "out.obj"])["closed"], true);
    assert!(run.run(&simplify).text().contains("pairs of boundary edges stitched"));
    for option in [&["--no-stitch"][..], &["--topology", "keep"]] {
        let report = run.json(&[&simplify, option].concat());
        assert_eq!(report["stitched_edges"], 0, "{option:?}");
    }
}

#[test]
fn near_borders_are_named_with_what_would_join_them() {
    let run = Run::new();
    write(&run, "in.obj", torn(&meshlod::samples::sphere(500), 1e-5));
    let simplify = ["simplify", "in.obj", "out.obj", "--ratio", "50%"];
    let done = run.run(&simplify);
    let line = done.err.lines().find(|line| line.contains("--weld")).unwrap_or_default();
    assert!(line.contains("boundary edges lie within 0.0001 of others"), "{done:?}");
    let welded = run.run(&[&simplify, &["--weld", "0.0001"][..]].concat());
    assert!(welded.code == 0 && welded.err.is_empty(), "{welded:?}");
}

#[test]
fn a_front_and_its_back_are_both_simplified() {
    let run = Run::new();
    let mut leaf = meshlod::samples::sphere(2_000);
    leaf.faces.extend(leaf.faces.clone().into_iter().map(|[a, b, c]| [c, b, a]));
    let vertices = leaf.positions.len();
    write(&run, "in.obj", leaf);
    let report = run.json(&["simplify", "in.obj", "out.obj", "--ratio", "5%"]);
    assert_eq!((&report["reached"], &report["split_vertices"]), (&json!(true), &json!(vertices)));
    let text = run.run(&["simplify", "in.obj", "out.obj", "--ratio", "5%"]);
    assert!(text.text().contains("non-manifold vertices split"), "{text:?}");
    let kept = run.run(&["simplify", "in.obj", "out.obj", "--ratio", "5%", "--topology", "keep"]);
    assert!(kept.only_line().contains("--topology free would"), "{kept:?}");
}

#[test]
fn a_level_that_is_the_same_as_the_one_before_is_not_written() {
    let run = Run::new();
    let mut tetrahedra = sphere_with_a_crumb();
    tetrahedra.faces.drain(..tetrahedra.faces.len() - 4);
    tetrahedra.compact();
    write(&run, "in.obj", tetrahedra);
    let keep = ["--topology", "keep"];
    let lods = [&["lods", "in.obj", "out.obj", "--levels", "50%,25%"], &keep[..]].concat();
    let report = run.json(&lods);
    assert_eq!(run.files(), ["in.obj", "out.lods.json", "out_LOD0.obj"]);
    for level in report["levels"].as_array().unwrap() {
        assert_eq!((&level["reached"], &level["file"]), (&json!(false), &json!(null)));
    }
    let done = run.run(&lods);
    assert!(done.code == 0 && done.text().contains("50%: not written, the same"), "{done:?}");
    assert_eq!(done.err.matches("not written").count(), 2);
    assert_eq!(run.run(&[&lods[..], &["--strict"]].concat()).code, 1);
    // A level that was asked for and is the input is written.
    run.json(&[&["lods", "in.obj", "out.obj", "--levels", "100%,50%"], &keep[..]].concat());
    let files = ["in.obj", "out.lods.json", "out_LOD0.obj", "out_LOD1.obj"];
    assert_eq!(run.files(), files);
    run.json(&[&["lods", "in.obj", "out.glb", "--levels", "100%,50%"], &keep[..]].concat());
    assert_eq!(run.json(&["info", "out.glb"])["faces"], 4);
}

#[test]
fn compare_takes_the_topology_too() {
    let run = Run::new();
    write(&run, "in.obj", sphere_with_a_crumb());
    let compare = ["compare", "in.obj", "--faces", "20", "--methods", "lindstrom-turk"];
    let folder = ["--no-pictures", "--samples", "1000", "--out", "out"];
    let components = |topology: &str| {
        run.json(&[&compare[..], &folder, &["--topology", topology]].concat());
        let page = std::fs::read(run.path("out/compare.json")).unwrap();
        let page: Value = serde_json::from_slice(&page).unwrap();
        page["methods"][0]["levels"][0]["components"].clone()
    };
    assert_eq!((components("keep"), components("free")), (json!(2), json!(1)));
}

#[test]
fn holes_and_meshes_that_stay_are_named() {
    let run = Run::new();
    // Two tubes of eight sides, each an object.
    let mut text = String::new();
    for tube in 0..2u32 {
        text += &format!("o tube{tube}\n");
        for k in 0..16u32 {
            let (sin, cos) = (f64::from(k % 8) * std::f64::consts::FRAC_PI_4).sin_cos();
            text += &format!("v {} {sin} {}\n", cos + f64::from(9 * tube), k / 8);
        }
        for k in 0..8 {
            let at = |i: u32, end: u32| 16 * tube + (k + i) % 8 + 8 * end + 1;
            text += &format!("f {} {} {} {}\n", at(0, 0), at(1, 0), at(1, 1), at(0, 1));
        }
    }
    std::fs::write(run.path("in.obj"), text).unwrap();
    run.json(&["convert", "in.obj", "in.glb"]);
    for verb in [
        &["simplify", "in.glb", "out.glb", "--faces", "1"][..],
        &["lods", "in.glb", "out.glb", "--levels", "1"],
    ] {
        let done = run.run(verb);
        for part in ["2 holes stay: repair --holes N", "each of 2 meshes keeps a face"] {
            assert!(done.err.contains(part), "{part}: {done:?}");
        }
    }
    let merged = run.run(&["simplify", "in.obj", "out.ply", "--faces", "1"]);
    assert!(merged.err.contains("1 hole stays"), "one tube has vanished: {merged:?}");
}
