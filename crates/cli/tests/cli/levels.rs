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
fn the_levels_of_a_page_are_files_beside_a_small_one() {
    let run = Run::new();
    run.sample("fish", 2_000, "in.obj");
    let lods = ["lods", "in.obj", "out/fish.glb", "--levels", "50%,10%", "--layout", "needle"];
    let report = run.json(&lods);
    let files = report["files"].as_array().unwrap();
    let sizes = files.iter().map(|file| {
        let path = run.path("out").join(file["file"].as_str().unwrap());
        assert_eq!(std::fs::metadata(&path).unwrap().len(), file["bytes"].as_u64().unwrap());
        path
    });
    let paths: Vec<_> = sizes.collect();
    assert_eq!(paths.len(), 3, "{report}");
    let json = document(&std::fs::read(&paths[0]).unwrap());
    let own = &json["meshes"][0]["extensions"]["NEEDLE_progressive"];
    let errors = own["lods"].as_array().unwrap().iter().map(|lod| &lod["extras"]["error_measured"]);
    let errors: Vec<_> = errors.chain([&own["extras"]["error_measured"]]).collect();
    let measured = |level: usize| &report["levels"][level]["error_measured"]["max"];
    assert_eq!(errors, [&Value::from(0.0), measured(0), measured(1)]);
    assert_eq!(run.json(&["info", "out/fish.glb"])["faces"], report["levels"][1]["faces"]);
    let text = run.run(&lods);
    assert!(text.text().contains("in fish_levels\n") && text.err.is_empty(), "{text:?}");

    let level = format!("out/{}", files[1]["file"].as_str().unwrap());
    let before = std::fs::read(run.path(&level)).unwrap();
    let refused = run.run(&["lods", &level, "out/fish.glb", "--layout", "needle"]);
    assert!(refused.code == 1 && refused.err.contains("give OUT another name"), "{refused:?}");
    assert_eq!(std::fs::read(run.path(&level)).unwrap(), before);
    let refused = run.run(&["lods", "in.obj", "out.ply", "--layout", "needle"]);
    assert!(refused.code == 2 && refused.err.contains("needs .glb or .gltf"), "{refused:?}");
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
