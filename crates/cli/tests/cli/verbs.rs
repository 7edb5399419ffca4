//! Results of the verbs.

use serde_json::{Value, json};

use crate::run::Run;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn info_knows_a_cube() {
    let run = Run::new();
    // A cube of quads with an unused vertex and two objects.
    let obj = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n\
        o sides\nf 2 3 7 6\nf 3 5 9 7\nf 5 4 8 9\nf 4 2 6 8\no caps\nf 2 4 5 3\nf 6 7 9 8\n";
    std::fs::write(run.path("cube.obj"), obj).unwrap();
    let info = run.json(&["info", "cube.obj"]);
    let expected = json!({
        "format": "meshlod-report", "version": 1, "verb": "info",
        "vertices": 9, "unreferenced": 1, "faces": 12, "degenerate_faces": 0, "edges": 18,
        "boundary_edges": 0, "non_manifold_edges": 0, "inconsistent_edges": 0,
        "pinched_vertices": 0, "components": 1, "objects": 2, "closed": true,
        "bounds": { "min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 1.0] }, "diagonal": 3f64.sqrt(),
        "area": 6.0, "volume": 1.0, "wedges": null, "attributes": [], "materials": [],
        "file": "cube.obj", "meshes": 1, "textures": [], "skins": [], "animations": [],
        "morph_targets": 0, "instances": 1, "cameras": 0, "lights": 0, "extensions_used": [],
        "extensions_required": [], "notes": [],
        "bytes": { "file": obj.len(), "geometry": obj.len(), "images": 0, "animation": 0 },
    });
    assert_eq!(info, expected);
    let text = run.run(&["info", "cube.obj"]);
    assert!(text.text().contains("unused  ") && text.err.is_empty(), "{text:?}");
}

#[test]
fn what_a_format_cannot_hold_is_named_and_strictly_refused() {
    let run = Run::new();
    let library = "newmtl red\nmap_Kd gone.png\n";
    std::fs::write(run.path("in.mtl"), library).unwrap();
    let obj = "mtllib in.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
    std::fs::write(run.path("in.obj"), obj).unwrap();
    let simplify = ["simplify", "in.obj", "out.stl", "--faces", "1"];
    let notes = &run.json(&simplify)["notes"];
    let note = |i: usize| {
        let note = &notes[i];
        ["file", "kind", "what"].map(|key| note[key].as_str().unwrap())
    };
    assert_eq!(note(0), ["in.obj", "left out", "image that was not found or cannot be used"]);
    assert_eq!(notes[0]["remedy"], "put an image at gone.png");
    assert_eq!(notes[1]["remedy"], ".glb keeps everything");
    assert_eq!(note(1), ["out.stl", "left out", "material"]);
    assert_eq!(note(2), ["out.stl", "left out", "texture"]);
    std::fs::remove_file(run.path("out.stl")).unwrap();
    let strict = run.run(&[&simplify[..], &["--strict"]].concat());
    assert_eq!(strict.code, 1);
    let reason = "in.obj: left out: 1 image that was not found or cannot be used (gone.png); \
                  put an image at gone.png";
    assert!(strict.only_line().ends_with(reason), "{strict:?}");
    assert!(!run.path("out.stl").exists());
}

#[test]
fn simplify_reaches_a_ratio_and_says_so() {
    let run = Run::new();
    run.sample("knot", 4_000, "in.ply");
    let report = run.json(&["simplify", "in.ply", "out.ply", "--ratio", "10%", "--measured"]);
    assert_eq!((&report["method"], &report["reached"]), (&"lindstrom-turk".into(), &true.into()));
    assert_eq!(report["output_faces"], run.json(&["info", "out.ply"])["faces"]);
    assert!(number(&report["output_faces"]) <= 0.1 * number(&report["input_faces"]));
    assert!(number(&report["simplify_seconds"]) > 0.0 && number(&report["error_estimate"]) > 0.0);
    assert!(report["refusals"]["flip"].is_u64());
    let measured = &report["error_measured"];
    let again = run.json(&["measure", "in.ply", "out.ply"]);
    for field in ["mean", "rms", "max", "max_percent"] {
        // The file holds 32 bits, so the samples differ.
        let (in_report, of_file) = (number(&measured[field]), number(&again[field]));
        assert!((in_report / of_file - 1.0).abs() < 0.02, "{field}: {in_report}, {of_file}");
    }
}

#[test]
fn measure_encloses_the_maximum_when_asked() {
    let run = Run::new();
    run.sample("knot", 4_000, "in.ply");
    run.json(&["simplify", "in.ply", "out.ply", "--ratio", "10%"]);
    let plain = run.json(&["measure", "in.ply", "out.ply"]);
    assert!(plain.get("certified").is_none());
    let apart = run.json(&["measure", "in.ply", "out.ply", "--certified"]);
    let certified = &apart["certified"];
    for way in ["forward", "backward"] {
        let [lower, upper] = ["lower", "upper"].map(|bound| number(&certified[way][bound]));
        assert!(lower <= upper && upper <= 1.0101 * lower, "{certified}");
        assert!(number(&apart[way]["max"]) <= upper, "{apart}");
    }
    assert_eq!(certified["reached"], true);
    let text = run.run(&["measure", "in.ply", "out.ply", "--certified"]);
    assert!(text.text().contains("at most"), "{text:?}");
}

#[test]
fn no_option_changes_the_method_or_drops_attribute_weights() {
    let run = Run::new();
    run.sample("fish", 1_000, "in.obj");
    for rest in [&[][..], &["--vanish-below=5%"], &["--lock-contacts"]] {
        let level = |weight: &str| {
            let arguments =
                ["simplify", "in.obj", "out.obj", "--ratio", "20%", "--weight-uv", weight];
            assert_eq!(run.json(&[&arguments, rest].concat())["method"], "lindstrom-turk");
            std::fs::read(run.path("out.obj")).unwrap()
        };
        assert_ne!(level("0"), level("50"), "{rest:?}");
    }
}

#[test]
fn an_error_bound_holds_where_components_may_vanish_or_vertices_are_tied() {
    let run = Run::new();
    run.sample("fish", 4_000, "in.ply");
    for rest in [&["--vanish-below=0.0001%"][..], &["--lock-contacts"], &["--method", "qem"]] {
        let arguments = ["simplify", "in.ply", "out.ply", "--error", "1%", "--measured"];
        let report = run.json(&[&arguments, rest].concat());
        let measured = number(&report["error_measured"]["max"]);
        assert!(measured <= 0.011 * number(&report["error_measured"]["diagonal"]), "{rest:?}");
    }
}

#[test]
fn simplify_talks_to_people_too() {
    let run = Run::new();
    run.sample("sphere", 1_000, "in.ply");
    let done = run.run(&["simplify", "in.ply", "out.obj", "--faces", "100"]);
    assert_eq!((done.code, &done.err[..]), (0, ""));
    assert!(done.text().lines().any(|line| line.starts_with("simplify_seconds: ")), "{done:?}");
}

#[test]
fn an_error_bound_comes_with_what_was_measured() {
    let run = Run::new();
    run.sample("knot", 4_000, "in.ply");
    let report = run.json(&["simplify", "in.ply", "out.ply", "--error", "0.2%", "--measured"]);
    let bound = 0.002 * number(&report["error_measured"]["diagonal"]);
    assert!((number(&report["error_asked"]) / bound - 1.0).abs() < 1e-12);
    assert!(number(&report["error_estimate"]) <= bound);
    let measured = number(&report["error_measured"]["max"]);
    assert!(measured <= number(&report["error_proved"]) && measured > 0.5 * bound);
    assert!(number(&report["output_faces"]) < 0.5 * number(&report["input_faces"]));
}

#[test]
fn measured_means_that_the_measure_is_within() {
    let run = Run::new();
    run.sample("knot", 20_000, "in.ply");
    let sizes = ["0.1%", "1%"].map(|bound| {
        let report = run.json(&["simplify", "in.ply", "out.ply", "--error", bound, "--measured"]);
        let percent: f64 = bound.trim_end_matches('%').parse().unwrap();
        let max = number(&report["error_measured"]["max_percent"]);
        assert!(report["reached"] == true && max <= percent && max > percent / 2.0, "{report}");
        number(&report["output_faces"])
    });
    assert!(sizes[1] < sizes[0]);
}

#[test]
fn a_target_out_of_reach_is_a_warning_or_strictly_a_failure() {
    let run = Run::new();
    run.sample("torus", 400, "in.ply");
    let arguments = ["simplify", "in.ply", "out.ply", "--faces", "3", "--json"];
    let done = run.run(&arguments);
    assert_eq!((done.code, &done.json()["reached"]), (0, &false.into()));
    assert!(done.only_line().contains("warning: in.ply: target not reached"), "{done:?}");
    let quiet = run.run(&[&arguments[..], &["--quiet"]].concat());
    assert_eq!((quiet.code, &*quiet.err), (0, ""));
    for more in [&["--strict"][..], &["--strict", "--quiet"]] {
        let strict = run.run(&[&arguments[..], more].concat());
        assert_eq!((strict.code, &strict.json()["reached"]), (1, &false.into()));
        let error = "meshlod: in.ply: target not reached";
        assert!(strict.only_line().starts_with(error), "{strict:?}");
    }
    assert_eq!(run.json(&["info", "out.ply"])["closed"], true);
}

#[test]
fn any_number_of_threads_gives_the_same_file() {
    let run = Run::new();
    run.sample("gyroid", 20_000, "in.ply");
    for threads in ["1", "2"] {
        let out = format!("{threads}.ply");
        run.json(&["simplify", "in.ply", &out, "--ratio", "5%", "--threads", threads]);
    }
    let bytes = |name| std::fs::read(run.path(name)).unwrap();
    assert!(bytes("1.ply") == bytes("2.ply"));
}

#[test]
fn precision_f64_keeps_every_bit() {
    let run = Run::new();
    let coordinate = 1.000_000_000_000_1;
    std::fs::write(run.path("in.obj"), format!("v 0 0 0\nv {coordinate} 0 0\nv 0 1 0\nf 1 2 3\n"))
        .unwrap();
    let x = |arguments: &[&str]| {
        run.json(&[&["simplify", "in.obj", "out.ply", "--faces", "1"], arguments].concat());
        number(&run.json(&["info", "out.ply"])["bounds"]["max"][0])
    };
    assert_eq!((x(&["--precision", "f64"]), x(&[])), (coordinate, 1.0));
}

#[test]
fn welding_is_a_choice() {
    let run = Run::new();
    run.sample("sphere", 500, "in.stl");
    let vertices = |arguments: &[&str]| {
        number(&run.json(&[&["info", "in.stl"], arguments].concat())["vertices"])
    };
    let faces = number(&run.json(&["info", "in.stl"])["faces"]);
    assert_eq!((vertices(&["--no-weld"]), vertices(&[])), (3.0 * faces, faces / 2.0 + 2.0));
    assert_eq!(vertices(&["--weld", "100"]), 1.0);
}

#[test]
fn measure_has_both_ways_and_the_seed_counts() {
    let run = Run::new();
    run.sample("sphere", 2_000, "a.ply");
    run.sample("sphere", 200, "b.ply");
    let measure =
        |seed| run.json(&["measure", "a.ply", "b.ply", "--samples", "5000", "--seed", seed]);
    let (first, other) = (measure("1"), measure("2"));
    assert_eq!(first, measure("1"));
    assert_ne!(first["forward"]["mean"], other["forward"]["mean"]);
    for way in ["forward", "backward"] {
        assert!(number(&first[way]["max"]) >= number(&first[way]["rms"]));
        assert_eq!(first[way]["place"]["from"].as_array().map(Vec::len), Some(3));
    }
    assert!(number(&first["volume_b"]) < number(&first["volume_a"]));
    assert!(number(&first["area_b"]) < number(&first["area_a"]));
    assert!(run.run(&["measure", "a.ply", "b.ply"]).text().contains("backward"));
}

#[test]
fn weights_that_a_method_does_not_look_at_are_a_warning() {
    let run = Run::new();
    run.sample("sphere", 200, "in.ply");
    let simplify = |method| {
        let weighted = ["--weight-uv", "2", "--method", method];
        run.run(&[&["simplify", "in.ply", "out.ply", "--ratio", "50%"], &weighted[..]].concat())
    };
    let (spr, qem) = (simplify("spr"), simplify("qem"));
    assert!(spr.code == 0 && spr.only_line().contains("spr ignores attributes"), "{spr:?}");
    assert!(qem.err.is_empty(), "{qem:?}");
}

#[test]
fn a_weight_of_boundaries_is_taken_or_warned_of() {
    let run = Run::new();
    run.sample("terrain", 2_000, "in.ply");
    let simplify = |method, weight| {
        let how = ["--ratio", "10%", "--method", method, "--boundary", weight, "--json"];
        run.run(&[&["simplify", "in.ply", "out.ply"], &how[..]].concat())
    };
    let spr = simplify("spr", "3");
    assert!(spr.code == 0 && spr.err.contains("spr has no boundary weight"), "{spr:?}");
    let [light, heavy] = ["0", "1000"].map(|weight| {
        let done = simplify("lindstrom-turk", weight);
        assert!(done.code == 0 && done.err.is_empty(), "{done:?}");
        std::fs::read(run.path("out.ply")).unwrap()
    });
    assert_ne!(light, heavy);
}

#[test]
fn what_became_of_the_volume_is_told() {
    let run = Run::new();
    run.sample("knot", 2_000, "closed.ply");
    run.sample("terrain", 2_000, "open.ply");
    let sum = |file, method| {
        let report = run.json(&["simplify", file, "o.ply", "--ratio", "20%", "--method", method]);
        let at_boundaries = &report["volume_not_conserved"]["at_boundaries"];
        assert_eq!(at_boundaries["bounds"].is_object(), file == "open.ply", "{report}");
        number(&report["volume_running_sum"]).abs()
    };
    assert!(sum("closed.ply", "lee-jang") < 1e-13 && sum("closed.ply", "qem") > 1e-5);
    sum("open.ply", "lee-jang");
    let says = |method: &str, more: &[&str]| {
        let arguments = ["simplify", "closed.ply", "o.ply", "--ratio", "40%", "--method", method];
        run.run(&[&arguments, more].concat()).text().contains("volume: ")
    };
    assert_eq!([says("lee-jang", &[]), says("qem", &[])], [false, false]);
    let flags: Vec<u32> = (0..999).map(|v| u32::from(v % 4 == 0)).collect();
    let locks = serde_json::json!({
        "format": "meshlod-locks", "version": 1, "meshes": [{ "flags": flags }],
    });
    std::fs::write(run.path("locks.json"), locks.to_string()).unwrap();
    assert!(says("lee-jang", &["--locks", "locks.json"]));
}

#[test]
fn measure_tells_a_change_of_volume_to_the_last_bit() {
    let run = Run::new();
    let cube = |z: f64| {
        format!(
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 {z}\nv 1 0 {z}\nv 0 1 {z}\nv 1 1 {z}\n\
            f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\n"
        )
    };
    let last = "f 2 4 8 6\n";
    std::fs::write(run.path("a.obj"), cube(1.0) + last).unwrap();
    std::fs::write(run.path("b.obj"), cube(1.0 + 4.0 * f64::EPSILON) + last).unwrap();
    std::fs::write(run.path("open.obj"), cube(1.0)).unwrap();
    let measured = run.json(&["measure", "a.obj", "b.obj", "--samples", "10"]);
    assert_eq!(measured["volume_change"], 4.0 * f64::EPSILON);
    let open = run.json(&["measure", "a.obj", "open.obj", "--samples", "10"]);
    assert_eq!((&open["closed_a"], &open["closed_b"]), (&true.into(), &false.into()));
    assert!(open["volume_change"].is_null() && number(&open["area_change"]) < 0.0);
    let text = run.run(&["measure", "a.obj", "open.obj", "--samples", "10"]);
    assert!(
        text.text().contains("B is open: its volume is not that of a closed surface"),
        "{text:?}"
    );
}

#[test]
fn render_draws_in_every_way() {
    let run = Run::new();
    run.sample("fish", 1_000, "fish.obj");
    run.sample("fish", 200, "coarse.obj");
    for options in [
        &[][..],
        &["--wireframe", "--flat"],
        &["--checker", "--view", "top"],
        &["--view", "-1,-0.5,0.2", "--up", "z"],
        &["--heat-against", "coarse.obj"],
    ] {
        let arguments = [&["render", "fish.obj", "out.png", "--size", "64x48"], options].concat();
        let report = run.json(&arguments);
        assert_eq!((&report["width"], &report["height"]), (&64.into(), &48.into()));
        assert_eq!(report["heat_max"].is_number(), options.contains(&"--heat-against"));
        assert!(std::fs::read(run.path("out.png")).unwrap().starts_with(b"\x89PNG"));
    }
}

/// A box with eight squares per side and a smaller one on top, as OBJ.
fn two_boxes() -> String {
    let mut text = String::new();
    let mut start = 1;
    for (n, z) in [(8, 0.0), (4, 8.0)] {
        let mut ids = std::collections::HashMap::new();
        for side in 0..6usize {
            let axis = side / 2;
            let [u, v] = [[1, 2], [2, 1]][side % 2].map(|step| (axis + step) % 3);
            let mut at = |i: i32, j: i32| {
                let mut p = [if side % 2 == 0 { n } else { 0 }; 3];
                (p[u], p[v]) = (i, j);
                let next = start + ids.len();
                *ids.entry(p).or_insert_with(|| {
                    let [x, y, up] = p.map(f64::from);
                    text += &format!("v {x} {y} {}\n", up + z);
                    next
                })
            };
            let mut faces = String::new();
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                faces += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
            }
            text += &faces;
        }
        start += ids.len();
    }
    text
}

#[test]
fn objects_that_cross_are_fused_and_keep_their_names() {
    let run = Run::new();
    run.sample("sphere", 500, "ball.obj");
    let text = std::fs::read_to_string(run.path("ball.obj")).unwrap();
    let numbers = |of: &str| -> Vec<f64> {
        of.split(' ').map(|x| x.split('/').next().unwrap().parse().unwrap()).collect()
    };
    let places: Vec<_> = text.lines().filter_map(|line| line.strip_prefix("v ")).collect();
    let faces: Vec<_> = text.lines().filter_map(|line| line.strip_prefix("f ")).collect();
    let mut balls = String::new();
    for (name, x, base) in [("first", 0.0, 0), ("second", 1.0, places.len())] {
        balls += &format!("o {name}\n");
        for at in places.iter().map(|at| numbers(at)) {
            balls += &format!("v {} {} {}\n", at[0] + x, at[1] + x / 10.0, at[2]);
        }
        for face in faces.iter().map(|face| numbers(face)) {
            let [a, b, c] = [0, 1, 2].map(|k| face[k] as usize + base);
            balls += &format!("f {a} {b} {c}\n");
        }
    }
    std::fs::write(run.path("balls.obj"), balls).unwrap();
    let before = run.json(&["info", "balls.obj"]);
    assert_eq!((&before["components"], &before["closed"]), (&json!(2), &json!(true)));
    let fused = run.json(&["repair", "balls.obj", "one.obj", "--fuse"]);
    assert!(fused["fused"]["buried_faces"].as_u64() > Some(100), "{fused}");
    assert_eq!(fused["errors_left"], json!(0));
    let after = run.json(&["info", "one.obj"]);
    assert_eq!((&after["components"], &after["closed"]), (&json!(1), &json!(true)));
    assert!(after["volume"].as_f64() < before["volume"].as_f64());
    // The ratio refers to the faces before fusing, and both objects are still there.
    let level =
        ["simplify", "balls.obj", "level.obj", "--ratio", "20%", "--fuse", "--lock-contacts"];
    let level = run.json(&level);
    let most = before["faces"].as_u64().unwrap() / 5;
    assert!(level["output_faces"].as_u64().is_some_and(|faces| faces <= most && faces + 4 > most));
    let text = std::fs::read_to_string(run.path("level.obj")).unwrap();
    assert!(text.contains("first") && text.contains("second"));
    let plain = run.json(&["simplify", "balls.obj", "plain.obj", "--ratio", "20%"]);
    assert_eq!(plain["fused"], Value::Null);
}

#[test]
fn what_touches_is_held_where_contacts_are_locked() {
    let run = Run::new();
    std::fs::write(run.path("boxes.obj"), two_boxes()).unwrap();
    let plain = run.json(&["simplify", "boxes.obj", "a.obj", "--ratio", "10%"]);
    assert_eq!(number(&plain["held"]["tied"]) + number(&plain["held"]["locked"]), 0.0);
    let held = run.json(&["simplify", "boxes.obj", "b.obj", "--ratio", "10%", "--lock-contacts"]);
    assert!(number(&held["held"]["tied"]) + number(&held["held"]["locked"]) >= 50.0, "{held}");
    let text = run.run(&["simplify", "boxes.obj", "b.obj", "--ratio", "10%", "--lock-contacts"]);
    let text = String::from_utf8(text.out).unwrap();
    assert!(text.contains("vertices tied to others") || text.contains("vertices locked"), "{text}");
}

#[test]
fn an_error_limit_bounds_what_vanishes() {
    let run = Run::new();
    std::fs::write(run.path("boxes.obj"), two_boxes()).unwrap();
    let within = |error: &str| {
        let report = run.json(&["simplify", "boxes.obj", "a.obj", "--error", error]);
        let error: f64 = error.parse().unwrap();
        number(&report["error_estimate"]) <= error && report["vanished"] == 0
    };
    assert!(within("0.01") && within("0.1"));
}
