//! Round trips of compressed meshes.

use serde_json::Value;

use crate::run::Run;

const SCHEMES: [&str; 3] = ["parts", "blocks", "lattice"];

pub fn number(report: &Value, field: &str) -> f64 {
    report[field].as_f64().unwrap_or_else(|| panic!("{field} of {report}"))
}

#[test]
fn every_scheme_gives_the_surface_back_as_close_as_asked() {
    let run = Run::new();
    run.sample("gyroid", 20_000, "in.ply");
    for scheme in SCHEMES {
        let packed =
            run.json(&["compress", "in.ply", "in.mlq", "--scheme", scheme, "--bits", "10"]);
        let parts = ["bytes_positions", "bytes_connectivity", "bytes_attributes"];
        let sum: f64 = parts.iter().map(|part| number(&packed, part)).sum();
        let total = std::fs::metadata(run.path("in.mlq")).unwrap().len() as f64;
        assert_eq!(number(&packed, "bytes_total"), total);
        assert!(sum < total && total < sum + 100.0, "{sum} {total}");
        assert_eq!(number(&packed, "bytes_headers"), total - sum);
        assert!(number(&packed, "reduction") > 0.6 && packed["reached"] == true, "{packed}");
        let pieces = if scheme == "parts" { "parts" } else { "blocks" };
        assert!(number(&packed, pieces) > 10.0 && number(&packed, "encode_seconds") > 0.0);

        run.json(&["decompress", "in.mlq", "out.ply"]);
        let [was, is] = ["in.ply", "out.ply"].map(|file| run.json(&["info", file]));
        for field in ["faces", "vertices", "closed", "components"] {
            assert_eq!(was[field], is[field], "{scheme}: {field}");
        }
        let apart = run.json(&["measure", "in.ply", "out.ply"]);
        // A cell is 1/1023 of the longest side, the mean a sixth of it, and the longest side less than the diagonal.
        let mean = number(&apart["forward"], "mean_percent");
        assert!(mean > 0.001 && mean < 100.0 / 1023.0 / 6.0, "{scheme}: {mean}");
    }
}

#[test]
fn attributes_and_seams_come_back() {
    let run = Run::new();
    run.sample("fish", 3_000, "in.glb");
    for scheme in SCHEMES {
        let way = ["compress", "in.glb", "in.mlq", "--scheme", scheme, "--uv-error", "0.001"];
        let packed = run.json(&way);
        let layers = packed["layers"].as_array().unwrap();
        let of_layers: f64 = layers.iter().map(|layer| number(layer, "bytes")).sum();
        // Where there is a scene, two numbers tell that faces have neither materials nor objects.
        assert_eq!(number(&packed, "bytes_attributes"), of_layers + 8.0);
        assert!(layers.iter().all(|layer| number(layer, "max_error") < 0.01), "{packed}");
        let kinds: Vec<_> = layers.iter().map(|layer| layer["kind"].as_str().unwrap()).collect();
        assert_eq!(kinds, ["color0", "normal", "uv0"]);
        run.json(&["decompress", "in.mlq", "out.glb"]);
        let [was, is] = ["in.glb", "out.glb"].map(|file| run.json(&["info", file]));
        assert_eq!([&was["faces"], &was["attributes"]], [&is["faces"], &is["attributes"]]);
    }
}

/// A strip of a seamed quad and two more, in two materials, one of them with a texture.
pub const TEXTURED: &str = "mtllib two.mtl\no strip\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 .5\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt .25 .5\nvn 0 0 1\nvn .6 0 .8\nusemtl sea\n\
    f 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/1\nusemtl sky\nf 2/5/1 5/2/2 6/3/2\nf 2/5/1 6/3/2 3/4/1\n";

#[test]
fn attributes_materials_and_textures_come_back_from_both_formats() {
    let run = Run::new();
    let material = "newmtl sky\nKd 0 0 1\nnewmtl sea\nKd 0 1 0\nmap_Kd sea.png\n";
    std::fs::write(run.path("two.mtl"), material).unwrap();
    run.sample("torus", 400, "torus.obj");
    run.json(&["render", "torus.obj", "sea.png", "--size", "60x60"]);
    std::fs::write(run.path("in.obj"), TEXTURED).unwrap();
    let image = std::fs::metadata(run.path("sea.png")).unwrap().len() as f64;
    let mut pictures = Vec::new();
    for file in ["out.mlq", "out.mlz"] {
        let way = ["--uv-error", "1e-3", "--scheme", "lattice"];
        let packed = run.json(&[&["compress", "in.obj", file], &way[..]].concat());
        let layers = packed["layers"].as_array().unwrap();
        assert_eq!(layers.len(), 2, "{packed}");
        for layer in layers {
            assert!(number(layer, "bytes") > 0.0 && number(layer, "max_error") < 0.01, "{packed}");
        }
        assert!(number(&packed, "bytes_attributes") > 0.0);
        let scene = number(&packed, "bytes_scene");
        assert!(scene > image && scene < image + 1000.0, "{packed}");
        let parts = ["positions", "connectivity", "attributes", "scene", "headers"]
            .map(|part| number(&packed, &format!("bytes_{part}")));
        assert_eq!(parts.iter().sum::<f64>(), number(&packed, "bytes_total"));

        run.json(&["decompress", file, "back.glb"]);
        run.json(&["decompress", file, "back.obj"]);
        let [was, is] = ["in.obj", "back.obj"].map(|file| run.json(&["info", file]));
        for key in ["vertices", "faces", "wedges", "attributes", "materials"] {
            assert_eq!(was[key], is[key], "{file}: {key}");
        }
        run.json(&["render", "back.glb", "back.png", "--size", "80x80"]);
        pictures.push(std::fs::read(run.path("back.png")).unwrap());
    }
    // Both round to the same lattice and the same steps.
    assert!(pictures[0] == pictures[1]);
    std::fs::write(run.path("in.obj"), TEXTURED.replace("mtllib two.mtl\n", "")).unwrap();
    run.json(&["compress", "in.obj", "out.mlz", "--scheme", "lattice"]);
    run.json(&["decompress", "out.mlz", "plain.glb"]);
    run.json(&["render", "plain.glb", "plain.png", "--size", "80x80"]);
    assert!(std::fs::read(run.path("plain.png")).unwrap() != pictures[0]);
}

#[test]
fn bounds_on_attributes_are_kept_in_both_formats() {
    let run = Run::new();
    std::fs::write(run.path("in.obj"), TEXTURED.replace("mtllib two.mtl\n", "")).unwrap();
    for file in ["out.mlq", "out.mlz"] {
        let errors = |way: &[&str]| -> Vec<f64> {
            let packed = run.json(&[&["compress", "in.obj", file], way].concat());
            let layers = packed["layers"].as_array().unwrap();
            layers.iter().map(|layer| number(layer, "max_error")).collect()
        };
        let coarse = errors(&["--normal-error", "5", "--uv-error", "0.05"]);
        let fine = errors(&["--normal-error", "0.1", "--uv-error", "1e-5"]);
        for (coarse, fine) in coarse.iter().zip(&fine) {
            assert!(fine <= coarse, "{file}: {fine} {coarse}");
        }
        assert!(fine.iter().all(|&error| error < 0.1f64.to_radians()), "{file}: {fine:?}");
        assert!(coarse.iter().sum::<f64>() > fine.iter().sum(), "{file}");
    }
}

#[test]
fn what_is_sent_comes_back() {
    let run = Run::new();
    run.sample("gyroid", 10_000, "in.ply");
    let ways: [&[&str]; 3] = [&["--bits", "11"], &["--error", "0.01%"], &["--scheme", "lattice"]];
    for way in ways {
        let packed = run.json(&[&["compress", "in.ply", "in.mlz"], way].concat());
        assert!(number(&packed, "bytes_per_triangle") < 3.0 && number(&packed, "blocks") > 10.0);
        run.json(&["decompress", "in.mlz", "out.ply"]);
        let [was, is] = ["in.ply", "out.ply"].map(|file| run.json(&["info", file]));
        for field in ["faces", "vertices", "closed", "components"] {
            assert_eq!(was[field], is[field], "{way:?}: {field}");
        }
        let apart = run.json(&["measure", "in.ply", "out.ply"]);
        assert!(number(&apart["forward"], "mean_percent") < 0.01, "{way:?}: {apart}");
    }
    let mut bytes = std::fs::read(run.path("in.mlz")).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    std::fs::write(run.path("in.mlz"), bytes).unwrap();
    assert_eq!(run.run(&["decompress", "in.mlz", "out.ply"]).code, 1);
}

#[test]
fn gltf_is_read_back_by_itself() {
    let run = Run::new();
    run.sample("torus", 5_000, "in.glb");
    let ways: [&[&str]; 3] =
        [&["--bits", "12"], &["--resident"], &["--scheme", "parts", "--bits", "9"]];
    for way in ways {
        let packed = run.json(&[&["compress", "in.glb", "out.glb"], way].concat());
        assert!(number(&packed, "reduction") > 0.1, "{way:?}: {packed}");
        let apart = run.json(&["measure", "in.glb", "out.glb"]);
        assert!(number(&apart["forward"], "mean_percent") < 0.05, "{way:?}: {apart}");
        let [was, is] = ["in.glb", "out.glb"].map(|file| run.json(&["info", file]));
        assert_eq!(was["faces"], is["faces"]);
    }
}

#[test]
fn people_read_what_became_of_it() {
    let run = Run::new();
    run.sample("sphere", 2_000, "in.ply");
    let done = run.run(&["compress", "in.ply", "in.mlq"]);
    assert_eq!((done.code, &done.err[..]), (0, ""));
    for word in ["per triangle", "less than f32", "blocks", "encode_seconds: "] {
        assert!(done.text().contains(word), "{word}: {done:?}");
    }
    assert!(run.run(&["decompress", "in.mlq", "out.ply"]).text().contains("decode_seconds: "));
    assert!(run.json(&["info", "in.mlq"])["stored"]["position_bytes"].as_u64().unwrap() > 0);
}

#[test]
fn a_reduction_that_is_out_of_reach_is_met_as_far_as_it_goes() {
    let run = Run::new();
    run.sample("sphere", 20, "in.ply");
    for scheme in SCHEMES {
        let way = ["compress", "in.ply", "in.mlq", "--scheme", scheme, "--reduction", "95%"];
        let done = run.run(&way);
        assert_eq!(done.code, 0);
        assert!(done.err.contains("out of reach"), "{done:?}");
        assert_eq!(run.run(&[&way[..], &["--strict"]].concat()).code, 1);
    }
}

#[test]
fn what_is_asked_wrongly_is_wrong_usage() {
    let run = Run::new();
    run.sample("sphere", 100, "in.ply");
    let cases: [&[&str]; 11] = [
        &["--bits", "0"],
        &["--bits", "25"],
        &["--bits", "-1"],
        &["--error", "0"],
        &["--error", "-1"],
        &["--error", "x%"],
        &["--reduction", "0%"],
        &["--reduction", "100%"],
        &["--bits", "11", "--error", "0.1%"],
        &["--scheme", "magic"],
        &["--normal-error", "-1"],
    ];
    for case in cases {
        let done = run.run(&[&["compress", "in.ply", "out.mlq"], case].concat());
        assert_eq!((done.code, &done.out[..]), (2, &b""[..]), "{case:?}: {done:?}");
    }
    for out in ["out.ply", "out", "-"] {
        assert_eq!(run.run(&["compress", "in.ply", out]).code, 2);
    }
    let cases: [&[&str]; 14] = [
        &["out.mlq", "--strips"],
        &["out.mlq", "--strips", "--scheme", "blocks"],
        &["out.glb", "--strips", "--scheme", "parts"],
        &["out.mlz", "--normal-error", "-1"],
        &["out.glb", "--color-error", "0.1"],
        &["out.glb", "--scheme", "parts", "--uv-error", "0.1"],
        &["out.mlz", "--scheme", "parts"],
        &["out.mlz", "--reduction", "70%"],
        &["out.mlz", "--bits", "0"],
        &["out.mlz", "--error", "0"],
        &["out.glb", "--scheme", "blocks"],
        &["out.glb", "--bits", "17"],
        &["out.glb", "--error", "0.1%"],
        &["out.mlq", "--resident"],
    ];
    for case in cases {
        let done = run.run(&[&["compress", "in.ply"], case].concat());
        assert_eq!((done.code, &done.out[..]), (2, &b""[..]), "{case:?}: {done:?}");
    }
    assert_eq!(run.files(), ["in.ply"]);
}

#[test]
fn coordinates_that_f32_cannot_hold_are_written_in_f64_or_named() {
    let run = Run::new();
    let far = "v 4500000 0 0\nv 4500001 0 0\nv 4500000.3 1 0\nf 1 2 3\n";
    std::fs::write(run.path("in.obj"), far).unwrap();
    run.json(&["compress", "in.obj", "in.mlq", "--scheme", "lattice", "--bits", "16"]);
    let done = run.run(&["decompress", "in.mlq", "out.obj"]);
    assert_eq!((done.code, &done.err[..]), (0, ""), "written as f64");
    assert!(std::fs::read_to_string(run.path("out.obj")).unwrap().contains("4500000.3"));
    let done = run.run(&["decompress", "in.mlq", "out.glb"]);
    assert_eq!((done.code, &done.err[..]), (0, ""), "written relative to a centre");
    run.json(&["convert", "out.glb", "back.obj"]);
    assert!(std::fs::read_to_string(run.path("back.obj")).unwrap().contains("4500000.30000"));
    let done = run.run(&["decompress", "in.mlq", "out.stl"]);
    assert!(done.code == 0 && done.only_line().contains("rounded by up to 2.0e-1"), "{done:?}");
}

#[test]
fn spoilt_files_are_told_and_nothing_is_written() {
    let run = Run::new();
    run.sample("torus", 1_000, "in.ply");
    run.json(&["compress", "in.ply", "in.mlq"]);
    let whole = std::fs::read(run.path("in.mlq")).unwrap();
    let mut spoilt = vec![b"PNG?".to_vec(), Vec::new(), whole[..whole.len() - 1].to_vec()];
    for at in [4, 10, 60, whole.len() - 9] {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x10;
        spoilt.push(bytes);
    }
    for bytes in spoilt {
        std::fs::write(run.path("spoilt.mlq"), bytes).unwrap();
        let done = run.run(&["decompress", "spoilt.mlq", "out.ply"]);
        assert_eq!(done.code, 1);
        assert!(done.only_line().contains("spoilt.mlq: byte "), "{done:?}");
    }
    assert_eq!(run.files(), ["in.mlq", "in.ply", "spoilt.mlq"]);
}

#[test]
fn odd_meshes_have_clear_outcomes() {
    let run = Run::new();
    let off = |scale: f64, faces: &str| {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        let points = points.map(|p| format!("{} {} {}\n", p[0] * scale, p[1] * scale, p[2]));
        format!("OFF\n4 {} 0\n{}{faces}", faces.lines().count(), points.concat())
    };
    let two = "3 0 1 2\n3 1 3 2\n";
    let meshes = [
        ("flat", off(1.0, two), 0),
        ("huge", off(1e30, two), 0),
        ("tiny", off(1e-30, two), 0),
        ("point", off(0.0, two), 0),
        ("one face", off(1.0, "3 0 1 2\n"), 0),
        ("none", off(1.0, ""), 1),
        ("beyond f32", off(1e300, two), 1),
    ];
    for (name, text, code) in meshes {
        std::fs::write(run.path("in.off"), text).unwrap();
        for scheme in SCHEMES {
            let done = run.run(&["compress", "in.off", "out.mlq", "--scheme", scheme]);
            // A lattice is limited only by its cells.
            if (name, scheme) == ("beyond f32", "lattice") {
                continue;
            }
            assert_eq!(done.code, code, "{name}, {scheme}: {done:?}");
            if code == 0 {
                assert_eq!(run.run(&["decompress", "out.mlq", "out.off"]).code, 0);
                std::fs::remove_file(run.path("out.mlq")).unwrap();
            }
            assert!(!run.path("out.mlq").exists() || code == 0);
        }
    }
}

#[test]
fn an_error_bound_that_a_stray_value_breaks_is_noted() {
    let run = Run::new();
    let uvs = [[0.1, 0.2], [0.3, 0.2], [0.3, 0.4], [1e9, 0.4]];
    let mut text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n".to_owned();
    uvs.iter().for_each(|[u, v]| text += &format!("vt {u} {v}\n"));
    std::fs::write(run.path("in.obj"), text + "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n").unwrap();
    for to in ["in.mlz", "in.mlq"] {
        let done = run.run(&["compress", "in.obj", to]);
        assert_eq!(done.code, 0, "{done:?}");
        assert!(done.err.contains("left out: 1 error bound of an attribute"), "{done:?}");
        std::fs::remove_file(run.path(to)).unwrap();
        assert_eq!(run.run(&["compress", "in.obj", to, "--strict"]).code, 1);
        assert!(!run.path(to).exists());
    }
}

#[test]
fn vertices_that_few_bits_put_at_one_place_are_counted() {
    let run = Run::new();
    run.sample("gyroid", 10_000, "in.ply");
    for file in ["out.mlq", "out.mlz"] {
        let count = |bits: &str| {
            let packed = run.json(&["compress", "in.ply", file, "--bits", bits]);
            packed["vertices_coinciding"].as_u64().unwrap()
        };
        assert_eq!(count("14"), 0, "{file}");
        let coarse = count("4");
        assert!(coarse > 10, "{file}: {coarse}");
        // Also those that are at one place as the file is read.
        run.json(&["decompress", file, "back.ply"]);
        let [was, is] = ["in.ply", "back.ply"].map(|mesh| {
            let mesh = meshlod::read(run.path(mesh), &meshlod::ReadOptions::default()).unwrap();
            let places = mesh.into_mesh().positions.into_iter().map(|at| at.map(f64::to_bits));
            places.collect::<std::collections::BTreeSet<_>>().len()
        });
        assert_eq!(was - is, coarse as usize, "{file}");
        let told = run.run(&["compress", "in.ply", file, "--bits", "4"]);
        let text = String::from_utf8_lossy(&told.out);
        assert!(text.contains("vertices are rounded to the places of others"), "{told:?}");
    }
    let packed = run.json(&["compress", "in.ply", "out.glb"]);
    assert!(packed.get("vertices_coinciding").is_none());
}
