//! Chains of levels.

use serde_json::Value;

use crate::run::Run;

/// Returns the JSON document of a GLB.
fn document(bytes: &[u8]) -> Value {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

#[test]
fn a_glb_holds_all_levels() {
    let run = Run::new();
    run.sample("fish", 2_000, "fish.obj");
    let report = run.json(&["lods", "fish.obj", "out.glb", "--levels", "50%,0.2,100"]);
    let levels = report["levels"].as_array().unwrap();
    let of = |field: &str| levels.iter().map(|l| l[field].as_f64().unwrap()).collect::<Vec<_>>();
    let max: Vec<_> = levels.iter().map(|l| l["error_measured"]["max"].as_f64().unwrap()).collect();
    assert!(of("faces").is_sorted_by(|a, b| a > b) && of("faces")[2] <= 100.0, "{report}");
    assert!(max.is_sorted() && max[0] > 0.0, "{max:?}");
    assert!(of("screen_coverage").is_sorted_by(|a, b| a >= b));

    let json = document(&std::fs::read(run.path("out.glb")).unwrap());
    let names: Vec<_> =
        json["nodes"].as_array().unwrap().iter().filter_map(|node| node["name"].as_str()).collect();
    for level in 0..4 {
        assert!(names.iter().any(|name| name.ends_with(&format!("_LOD{level}"))), "{names:?}");
    }
    assert_eq!(json["extensionsUsed"], serde_json::json!(["MSFT_lod"]));
    let shown = run.json(&["info", "out.glb"])["faces"].clone();
    assert_eq!(shown, report["input_faces"], "the finest level is what is shown");
}

#[test]
fn other_formats_get_a_file_a_level() {
    let run = Run::new();
    run.sample("torus", 1_000, "in.ply");
    let report = run.json(&["lods", "in.ply", "t.off", "--levels", "30%,10%"]);
    let files = ["in.ply", "t.lods.json", "t_LOD0.off", "t_LOD1.off", "t_LOD2.off"];
    assert_eq!(run.files(), files);
    assert_eq!(run.json(&["info", "t_LOD0.off"])["faces"], report["input_faces"]);
    for level in report["levels"].as_array().unwrap() {
        assert_eq!(run.json(&["info", level["file"].as_str().unwrap()])["faces"], level["faces"]);
    }
    let text = run.run(&["lods", "in.ply", "t.off", "--levels", "30%,10%"]);
    assert!(text.text().contains("LOD2") && text.err.is_empty(), "{text:?}");
}

#[test]
fn every_layout_has_the_levels_and_a_guide() {
    let run = Run::new();
    run.sample("fish", 2_000, "in.obj");
    for layout in ["msft", "scene", "files"] {
        let out = format!("{layout}.glb");
        let report = run.json(&["lods", "in.obj", &out, "--levels", "50%,10%", "--layout", layout]);
        let guide = std::fs::read(run.path(&format!("{layout}.lods.json"))).unwrap();
        let guide: Value = serde_json::from_slice(&guide).unwrap();
        assert_eq!(guide["layout"], layout);
        let levels = guide["levels"].as_array().unwrap();
        let of = |key: &str| levels.iter().map(|l| l[key].as_f64().unwrap()).collect::<Vec<_>>();
        assert!(
            of("distance").is_sorted() && of("distance")[1] > guide["radius"].as_f64().unwrap()
        );
        assert!(of("screen_height").is_sorted_by(|a, b| a > b), "{guide}");
        assert!(of("error_measured")[0] == 0.0 && of("faces").is_sorted_by(|a, b| a > b));
        let total: f64 = of("faces").iter().sum();
        let shown = |file: &str| run.json(&["info", file])["faces"].as_f64().unwrap();
        match layout {
            "msft" => assert_eq!(shown(&out), of("faces")[0]),
            "scene" => assert_eq!(shown(&out), total),
            _ => {
                let names = levels.iter().map(|level| level["file"].as_str().unwrap());
                assert_eq!(names.map(shown).collect::<Vec<_>>(), of("faces"));
                assert!(!run.path(&out).exists());
            }
        }
        assert_eq!(report["layout"], layout);
    }
    let done = run.run(&["lods", "in.obj", "out.ply", "--layout", "scene"]);
    assert!(done.code == 2 && done.err.contains("needs .glb or .gltf"), "{done:?}");
}

#[test]
fn levels_are_nested() {
    let run = Run::new();
    run.sample("knot", 1_000, "in.ply");
    let endpoint = ["--method", "qem-endpoint", "--precision", "f64"];
    run.json(&[&["lods", "in.ply", "k.obj", "--levels", "50%,20%"], &endpoint[..]].concat());
    let vertices = |name: &str| {
        let text = std::fs::read_to_string(run.path(name)).unwrap();
        text.lines().filter(|l| l.starts_with("v ")).map(String::from).collect::<Vec<_>>()
    };
    let finer = vertices("k_LOD1.obj");
    assert!(vertices("k_LOD2.obj").iter().all(|vertex| finer.contains(vertex)));
}

#[test]
fn a_sequence_gives_every_level_back_to_the_byte() {
    let run = Run::new();
    let exact = ["--precision", "f64"];
    // At the end of a run, lindstrom-turk also repays volume, which sequences do without.
    let method = ["--method", "qem"];
    let simplify =
        |arguments: &[&str]| run.json(&[&["simplify"], arguments, &exact, &method].concat());
    run.json(&["sample", "fish", "in.ply", "--faces", "2000", "--precision", "f64"]);
    simplify(&["in.ply", "base.ply", "--ratio", "5%", "--sequence", "fish.seq"]);
    simplify(&["in.ply", "half.ply", "--ratio", "50%", "--topology", "keep"]);
    let bytes = |name: &str| std::fs::read(run.path(name)).unwrap();
    for (ratio, level) in [("100%", "in.ply"), ("50%", "half.ply"), ("5%", "base.ply")] {
        let done =
            run.json(&[&["replay", "fish.seq", "back.ply", "--ratio", ratio], &exact[..]].concat());
        assert_eq!(done["reached"], true);
        assert!(bytes("back.ply") == bytes(level), "{level}");
    }
    let done = run.run(&["replay", "fish.seq", "back.ply", "--faces", "1"]);
    assert!(done.code == 0 && done.err.contains("coarsest"), "{done:?}");
    let strict = run.run(&["replay", "fish.seq", "back.ply", "--faces", "1", "--strict"]);
    assert_eq!((strict.code, strict.err), (1, done.err.replacen("warning: ", "", 1)));
}

/// Writes a glTF scene of a coloured fish scaled to a hundredth.
fn write_small_fish(run: &Run) {
    run.sample("fish", 1_000, "in.gltf");
    let path = run.path("in.gltf");
    let mut json: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    json["nodes"][0]["scale"] = serde_json::json!([0.01, 0.01, 0.01]);
    let color = serde_json::json!({ "baseColorFactor": [0.8, 0.1, 0.1, 1.0] });
    json["materials"] = serde_json::json!([{ "name": "red", "pbrMetallicRoughness": color }]);
    json["meshes"][0]["primitives"][0]["material"] = 0.into();
    std::fs::write(path, json.to_string()).unwrap();
}

#[test]
fn a_sequence_gives_the_scene_back_that_it_was_made_of() {
    let run = Run::new();
    write_small_fish(&run);
    let qem = ["--method", "qem"];
    let sequence = ["simplify", "in.gltf", "base.glb", "--ratio", "5%", "--sequence", "fish.seq"];
    let warned = run.run(&[&sequence[..], &qem].concat());
    assert!(warned.code == 0 && warned.only_line().contains("--scene in.gltf"), "{warned:?}");
    // A method that owes no volume, which only the level itself repays.
    run.json(&[&["simplify", "in.gltf", "half.glb", "--ratio", "50%"][..], &qem].concat());
    let bytes = |name: &str| std::fs::read(run.path(name)).unwrap();
    for (ratio, level) in [("50%", "half.glb"), ("5%", "base.glb")] {
        run.json(&["replay", "fish.seq", "back.glb", "--ratio", ratio, "--scene", "in.gltf"]);
        assert!(bytes("back.glb") == bytes(level), "{level}");
    }
    let [whole, half] = ["in.gltf", "half.glb"].map(|file| run.json(&["info", file]));
    assert!(whole["materials"] == half["materials"] && whole["materials"][0] == "red", "{half}");
    let through = ["replay", "-", "-", "--ratio", "50%", "--scene", "in.gltf", "--format", "glb"];
    assert!(run.run_with(&through, &bytes("fish.seq")).out == bytes("half.glb"));
}

#[test]
fn a_scene_that_a_sequence_is_not_of_is_refused_in_a_line() {
    let run = Run::new();
    run.sample("torus", 200, "in.ply");
    run.sample("torus", 400, "other.ply");
    run.json(&["simplify", "in.ply", "base.ply", "--ratio", "50%", "--sequence", "torus.seq"]);
    let replay = ["replay", "torus.seq", "out.ply", "--ratio", "50%", "--scene"];
    let done = run.run(&[&replay[..], &["other.ply"]].concat());
    assert!(done.code == 1 && done.only_line().contains("other.ply: is not the"), "{done:?}");
    assert!(!run.path("out.ply").exists());
}

#[test]
fn a_sequence_takes_no_place_of_another_file_and_comes_with_its_mesh() {
    let run = Run::new();
    run.sample("torus", 200, "in.ply");
    std::fs::create_dir(run.path("folder")).unwrap();
    let before = std::fs::read(run.path("in.ply")).unwrap();
    for same in ["in.ply", "folder/../in.ply", "out.ply", "./out.ply"] {
        let arguments = ["simplify", "in.ply", "out.ply", "--ratio", "50%", "--sequence", same];
        assert_eq!(run.run(&arguments).code, 2, "{same}");
    }
    assert!(std::fs::read(run.path("in.ply")).unwrap() == before);
    assert_eq!(run.files(), ["folder", "in.ply"]);
}

#[test]
fn what_is_no_sequence_is_refused_in_a_line() {
    let run = Run::new();
    run.sample("torus", 200, "in.ply");
    let done = run.run(&["replay", "in.ply", "out.ply", "--faces", "10"]);
    assert!(done.code == 1 && done.only_line().contains("in.ply: "), "{done:?}");
    let arguments = ["simplify", "in.ply", "out.ply", "--ratio", "50%", "--sequence", "-"];
    assert_eq!(run.run(&arguments).code, 2);
    assert_eq!(run.files(), ["in.ply"]);
}
