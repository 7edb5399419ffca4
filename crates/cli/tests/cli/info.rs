//! The verb `info` on scenes and on our own files, which every verb reads.

use meshlod_fixtures::shared_mesh;

use crate::models::{number, torus};
use crate::run::Run;

#[test]
fn our_own_files_are_read_like_meshes() {
    let run = Run::new();
    torus(&run);
    let faces = run.json(&["info", "torus.ply"])["faces"].clone();
    run.json(&["compress", "torus.ply", "torus.mlq"]);
    run.json(&["compress", "torus.ply", "torus.mlz"]);
    for (file, key) in
        [("torus.mlod", "base_faces"), ("torus.mlq", "position_bytes"), ("torus.mlz", "blocks")]
    {
        let info = run.json(&["info", file]);
        assert_eq!(info["faces"], faces, "{file}");
        assert!(number(&info["stored"][key]) > 0, "{info}");
        assert!(run.run(&["info", file]).text().contains("stored as\n"), "{file}");
        let measured = run.json(&["measure", "torus.ply", file]);
        assert!(measured.is_object(), "{measured}");
        assert_eq!(run.run(&["render", file, "out.png"]).code, 0, "{file}");
        let half = run.json(&["simplify", file, "half.ply", "--ratio", "0.5"]);
        assert!(number(&half["output_faces"]) < number(&faces), "{half}");
    }
    let refused = run.run(&["info", "torus.mlq", "--weld", "0.1"]);
    assert_eq!(refused.code, 1);
    assert!(refused.only_line().contains("torus.mlq: --weld"), "{refused:?}");
}

#[test]
fn a_damaged_file_of_our_own_is_one_line() {
    let run = Run::new();
    for file in ["a.mlod", "a.mlq", "a.mlz"] {
        std::fs::write(run.path(file), b"meshlodz and nothing").unwrap();
        for verb in [&["info", file][..], &["render", file, "out.png"]] {
            let done = run.run(verb);
            assert!(done.code == 1 && done.only_line().contains(file), "{done:?}");
        }
    }
}

#[test]
fn what_a_scene_has_is_listed() {
    let Some(fox) = shared_mesh("fox.glb") else { return };
    let run = Run::new();
    let bytes = std::fs::read(&fox).unwrap();
    // The suffix of avatars is another name of GLB.
    std::fs::write(run.path("fox.vrm"), &bytes).unwrap();
    let info = run.json(&["info", "fox.vrm"]);
    let animations = info["animations"].as_array().unwrap();
    let names: Vec<_> = animations.iter().map(|of| of["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["Survey", "Walk", "Run"]);
    assert!(animations.iter().all(|of| of["seconds"].as_f64().unwrap() > 0.5), "{info}");
    assert_eq!(info["skins"][0]["joints"], 24);
    let texture = &info["textures"][0];
    assert_eq!(texture["format"], "PNG");
    assert!(number(&texture["width"]) > 0 && number(&texture["height"]) > 0, "{texture}");
    let kinds = ["geometry", "images", "animation"].map(|kind| number(&info["bytes"][kind]));
    assert!(kinds.iter().all(|&bytes| bytes > 0), "{info}");
    assert!(kinds.iter().sum::<u64>() < number(&info["bytes"]["file"]), "{info}");
    let text = run.run(&["info", "fox.vrm"]);
    for line in ["  textures  ", "  skins  ", "  animations  ", "  bytes  "] {
        assert!(text.text().contains(line), "{line}: {text:?}");
    }
    run.json(&["simplify", "fox.vrm", "small.vrm", "--ratio", "0.5"]);
    assert_eq!(run.json(&["info", "small.vrm"])["skins"], info["skins"]);
}
