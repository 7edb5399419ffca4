//! An error that `extract` is asked for is kept, and what is said of it is true.

use serde_json::Value;

use crate::models::{CAMERA, bytes, extract, number, pieces, terrain, torus, write};
use crate::run::Run;

/// Builds a knot, and returns the length of its diagonal.
fn knot(run: &Run, options: &[&str]) -> f64 {
    run.sample("knot", 6000, "knot.ply");
    run.json(&[&["build", "knot.ply", "knot.mlod", "--in-chunk", "128"], options].concat());
    apart(run, "knot.ply", "knot.ply")["diagonal"].as_f64().unwrap()
}

fn apart(run: &Run, a: &str, b: &str) -> Value {
    run.json(&["measure", a, b, "--certified", "--samples", "1000"])
}

/// Returns the least that the greatest distance between two meshes can be.
fn farthest(run: &Run, a: &str, b: &str) -> f64 {
    let measured = apart(run, a, b);
    measured["certified"]["lower"].as_f64().unwrap_or_else(|| panic!("{measured}"))
}

fn length(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a length"))
}

#[test]
fn an_error_asked_for_is_kept_and_reported() {
    let run = Run::new();
    let diagonal = knot(&run, &["--estimates"]);
    for (text, part) in [("0.5%", 5e-3), ("0.1%", 1e-3)] {
        let json = extract(&run, "knot.mlod", "cut.ply", &["--error", text]);
        let (error, asked) = (&json["error"], part * diagonal);
        assert!((length(&error["asked"]) / asked - 1.0).abs() < 1e-3, "{error}");
        assert_eq!((&error["kept"], &error["proved"]), (&true.into(), &error["asked"]));
        assert!(number(&error["updates_added"]) > 0 && number(&error["rounds"]) > 0, "{error}");
        assert!(farthest(&run, "knot.ply", "cut.ply") <= asked);
        // What the file says is less than that, and nobody says that it holds.
        let json = extract(&run, "knot.mlod", "cut.ply", &["--error", text, "--unverified"]);
        assert_eq!(
            (&json["error"]["kept"], &json["error"]["proved"]),
            (&Value::Null, &Value::Null)
        );
        assert!(farthest(&run, "knot.ply", "cut.ply") > asked);
    }
    let done = run.run(&["extract", "knot.mlod", "cut.ply", "--error", "0.5%"]);
    assert!(
        done.text().contains("error: at most ") && done.text().contains("verified"),
        "{done:?}"
    );
    let done = run.run(&["extract", "knot.mlod", "cut.ply", "--error", "0.5%", "--unverified"]);
    assert!(done.text().contains("not verified"), "{done:?}");
}

#[test]
fn a_number_of_faces_has_its_error_measured() {
    let run = Run::new();
    knot(&run, &[]);
    let json = extract(&run, "knot.mlod", "cut.ply", &["--faces", "800"]);
    let (proved, rounding) = (length(&json["error"]["proved"]), 1e-4);
    let lower = farthest(&run, "knot.ply", "cut.ply");
    assert!(lower <= proved && proved < 1.03 * lower + 2.0 * rounding, "{lower} {proved}");
    assert_eq!(json["error"]["asked"], Value::Null);
    let json = extract(&run, "knot.mlod", "cut.ply", &["--faces", "800", "--unverified"]);
    assert_eq!(json["error"]["proved"], Value::Null);
}

#[test]
fn less_than_the_rounding_is_warned_of() {
    let run = Run::new();
    let diagonal = knot(&run, &["--rounding", "0.1%"]);
    let ask = ["extract", "knot.mlod", "cut.ply", "--json", "--error"];
    let done = run.run(&[&ask[..], &["0.001%"]].concat());
    let line = done.only_line();
    assert!(line.contains("below the rounding") && line.contains("--lossless"), "{line}");
    let error = &done.json()["error"];
    assert_eq!(error["kept"], false);
    let proved = length(&error["proved"]);
    assert!(proved > 1e-5 * diagonal && farthest(&run, "knot.ply", "cut.ply") <= proved);
    // 0 asks for the finest level, and that is what comes.
    let done = run.run(&[&ask[..], &["0"]].concat());
    let finest = &done.json()["error"];
    assert_eq!(
        (done.err.as_str(), &finest["asked"], &finest["kept"]),
        ("", &0.0.into(), &Value::Null)
    );
    // It may be written as f32s, which counts.
    let more = length(&finest["proved"]) - proved;
    assert!((0.0..1e-6 * diagonal).contains(&more), "{finest}");
    knot(&run, &["--lossless"]);
    let done = run.run(&[&ask[..], &["0.001%"]].concat());
    assert_eq!((done.err.as_str(), &done.json()["error"]["kept"]), ("", &true.into()));
    assert!(farthest(&run, "knot.ply", "cut.ply") <= 1e-5 * diagonal);
}

#[test]
fn a_target_that_is_missed_fails_if_strict_and_is_written() {
    let run = Run::new();
    knot(&run, &["--rounding", "0.1%"]);
    let ways: [&[&str]; 3] =
        [&["--faces", "1"], &["--error", "0.001%"], &["--error", "0.001px", "--camera", CAMERA]];
    for way in ways {
        let out = ["extract", "knot.mlod", "cut.ply", "--json"];
        let loose = run.run(&[&out[..], way].concat());
        let strict = run.run(&[&out[..], way, &["--strict"]].concat());
        assert_eq!((loose.code, strict.code), (0, 1), "{way:?}: {strict:?}");
        assert_eq!(strict.json()["reached"], false);
        assert_eq!(loose.err.replacen("warning: ", "", 1), strict.err);
        assert!(!strict.only_line().is_empty() && run.path("cut.ply").exists());
        std::fs::remove_file(run.path("cut.ply")).unwrap();
    }
    let met = run.run(&["extract", "knot.mlod", "cut.ply", "--error", "1%", "--strict"]);
    assert_eq!(met.code, 0, "{met:?}");
}

#[test]
fn rounding_to_f32_breaks_no_error_that_leaves_room_for_it() {
    let run = Run::new();
    knot(&run, &["--lossless"]);
    let pixels = ["--error", "1px", "--camera", CAMERA];
    for ask in [&["--error", "0.1%"][..], &pixels] {
        let kept = |out: &str| {
            let json = run.run(&[&["extract", "knot.mlod", out, "--json"], ask].concat()).json();
            json["error"].clone()
        };
        let [exact, short] = ["cut.ply", "cut.glb"].map(kept);
        assert_eq!(exact["kept"], true, "{ask:?}");
        assert_eq!(exact, short, "{ask:?}");
    }
    // Bounds in the file, which no check follows, leave as much.
    terrain(&run, 2_000);
    run.json(&["build", "knot.ply", "knot.mlod", "--bounds"]);
    for (file, ask) in
        [("terrain.mlod", &pixels[..]), ("knot.mlod", &pixels), ("knot.mlod", &["--error", "1%"])]
    {
        let json = extract(&run, file, "cut.glb", ask);
        assert_eq!(json["error"]["kept"], true, "{file} {ask:?}: {json}");
    }
    // Decimals are no f32s, and 1e-9 is less than an f32 can tell.
    run.json(&["convert", "knot.ply", "knot.obj"]);
    run.json(&["build", "knot.obj", "knot.mlod", "--lossless"]);
    let ask = ["extract", "knot.mlod", "cut.glb", "--json", "--error", "1e-9"];
    let done = run.run(&ask);
    let error = &done.json()["error"];
    assert!(error["kept"] == false && length(&error["proved"]) > 1e-9, "{error}");
    assert!(done.only_line().contains("rounding to f32 moved coordinates"), "{done:?}");
}

#[test]
fn pixels_below_the_rounding_are_said_to_hold_elsewhere() {
    let run = Run::new();
    knot(&run, &["--rounding", "0.1%"]);
    let ask = ["extract", "knot.mlod", "cut.ply", "--error", "0.001px", "--camera", CAMERA];
    let done = run.run(&ask);
    assert!(done.text().contains("error: at most 0.001px or 0.00"), "{done:?}");
    assert!(done.text().contains("whichever is more"), "{done:?}");
}

#[test]
fn pixels_foci_and_volumes_say_what_holds() {
    let run = Run::new();
    let diagonal = knot(&run, &[]);
    let from = |camera: &str, more: &[&str]| {
        extract(
            &run,
            "knot.mlod",
            "cut.ply",
            &[&["--error", "2px", "--camera", camera], more].concat(),
        )
    };
    let json = from(CAMERA, &["--focus", "frustum"]);
    assert_eq!(json["error"]["proved_px"], 2.0);
    // From inside the model it is fine all around, coarser than the finest level.
    let inside = from("eye=0.6,0.1,0 look=1,0.2,0.1 fov=60 200x100", &[]);
    assert!(number(&inside["faces"]) > 200, "{inside}");
    let nowhere = ["--error", "0", "--focus", "sphere=90,90,90,1"];
    let json = extract(&run, "knot.mlod", "cut.ply", &nowhere);
    assert!(number(&json["faces"]) < 200 && json["error"]["updates_added"] == 0, "{json}");
    let exact = ["--error", "0.5%", "--exact-volume"];
    let json = extract(&run, "knot.mlod", "cut.ply", &exact);
    let (asked, proved) = (5e-3 * diagonal, length(&json["error"]["proved"]));
    let moved = length(&json["volume_moved"]);
    assert!(moved > 0.0 && (proved - asked - moved).abs() < 1e-3 * asked, "{json}");
    assert!(farthest(&run, "knot.ply", "cut.ply") <= proved);
}

#[test]
fn a_truncated_file_and_any_number_of_threads_give_one_answer() {
    let run = Run::new();
    torus(&run);
    let whole = bytes(&run, "torus.mlod");
    let half = pieces(&whole);
    let half = half[half.len() / 2].end;
    for end in [half, whole.len()] {
        write(&run, "part.mlod", &whole[..end]);
        let cut = |threads: &str| {
            let ask = ["extract", "part.mlod", "cut.ply", "--error", "0.2%", "--threads", threads];
            assert_eq!(run.run(&ask).code, 0);
            bytes(&run, "cut.ply")
        };
        assert_eq!(cut("1"), cut("3"));
        let error = &extract(&run, "part.mlod", "cut.ply", &["--error", "0.2%"])["error"];
        assert_eq!(error["proved"].is_null(), end == half, "{error}");
    }
}

#[test]
fn a_focus_bounds_where_the_error_holds() {
    let run = Run::new();
    torus(&run);
    let ask = |focus| {
        let ask = ["extract", "torus.mlod", "cut.ply", "--error", "0.2%", "--json", "--focus"];
        run.run(&[&ask[..], &[focus]].concat())
    };
    let near = ask("sphere=1,0,0,1");
    assert!(near.err.is_empty() && near.json()["error"]["in_focus"] == true, "{near:?}");
    let far = ask("sphere=1000,0,0,1");
    assert!(far.code == 0 && far.only_line().contains("no face intersects the focus"), "{far:?}");
    let everywhere = extract(&run, "torus.mlod", "cut.ply", &["--error", "0.2%"]);
    assert_eq!(everywhere["error"]["in_focus"], false);
}
