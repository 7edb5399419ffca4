//! `simplify --error`: what is written keeps the error, and the report says what is proved.

use std::fmt::Write;

use serde_json::Value;

use crate::run::Run;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Checks that a report proves an error, and that the bounds of the distance between the two files
/// agree.
fn check(run: &Run, report: &Value, files: [&str; 2]) {
    let [asked, proved] = ["error_asked", "error_proved"].map(|field| number(&report[field]));
    assert!(report["reached"] == true && proved <= asked * (1.0 + 1e-9), "{report}");
    let measured = run.json(&["measure", files[0], files[1], "--certified", "--samples", "10"]);
    let [lower, upper] =
        ["lower", "upper"].map(|bound| number(&measured["certified"][bound]) / asked);
    assert!(lower <= 1.0 && upper <= 1.02, "between {lower} and {upper} of {asked}");
}

#[test]
fn what_is_written_keeps_the_error() {
    let run = Run::new();
    let mut mended = 0.0;
    for (sample, out, rest) in [
        ("fish", "out.glb", &[][..]),
        ("terrain", "out.stl", &[]),
        ("gyroid", "out.ply", &["--method", "qem"]),
        ("fish", "out.obj", &["--lock-boundary", "--topology", "keep"]),
        ("knot", "out.ply", &["--method", "qem-endpoint"]),
    ] {
        run.sample(sample, 3_000, "in.ply");
        let arguments = ["simplify", "in.ply", out, "--error", "0.3%"];
        let report = run.json(&[&arguments, rest].concat());
        assert!(number(&report["output_faces"]) < number(&report["input_faces"]));
        check(&run, &report, ["in.ply", out]);
        mended += number(&report["error_rounds"]);
    }
    assert!(mended > 0.0, "nothing had to be mended");
}

#[test]
fn the_same_bytes_come_from_any_number_of_threads() {
    let run = Run::new();
    run.sample("gyroid", 6_000, "in.ply");
    let written = ["1", "3"].map(|threads| {
        let arguments = ["simplify", "in.ply", "out.ply", "--error", "0.2%", "--threads", threads];
        let report = run.json(&arguments);
        assert!(number(&report["error_rounds"]) > 0.0, "nothing had to be mended");
        std::fs::read(run.path("out.ply")).unwrap()
    });
    assert!(written[0] == written[1]);
}

#[test]
fn rounding_far_from_the_origin_takes_64_bits() {
    let run = Run::new();
    let mut obj = String::new();
    for i in 0..400 {
        let [x, y] = [i / 20, i % 20].map(f64::from);
        let z = (x * 0.7).sin() + (y * 0.9).cos();
        writeln!(obj, "v {} {y} {z}", 1e7 + x).unwrap();
    }
    for i in (0..19).flat_map(|x| (1..20).map(move |y| 20 * x + y)) {
        writeln!(obj, "f {} {} {}", i, i + 20, i + 21).unwrap();
        writeln!(obj, "f {} {} {}", i, i + 21, i + 1).unwrap();
    }
    std::fs::write(run.path("in.obj"), obj).unwrap();
    let report = run.json(&["simplify", "in.obj", "out.obj", "--error", "0.1"]);
    check(&run, &report, ["in.obj", "out.obj"]);
    let done = run.run(&["simplify", "in.obj", "out.stl", "--error", "0.1", "--json"]);
    let report = done.json();
    assert!(done.code == 0 && report["reached"] == false, "{report}");
    assert!(number(&report["error_proved"]) > 0.1 && done.err.contains("--error 0.1: only"));
    let strict = ["simplify", "in.obj", "out.stl", "--error", "0.1", "--strict"];
    assert_eq!(run.run(&strict).code, 1);
}

#[test]
fn a_level_of_exact_volume_keeps_the_error() {
    let run = Run::new();
    run.sample("knot", 3_000, "in.ply");
    let exact = ["simplify", "in.ply", "out.ply", "--error", "0.3%", "--exact-volume"];
    check(&run, &run.json(&exact), ["in.ply", "out.ply"]);
}

#[test]
fn a_surface_without_area_proves_nothing() {
    let run = Run::new();
    std::fs::write(run.path("in.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").unwrap();
    let done = run.run(&["simplify", "in.obj", "out.obj", "--error", "1%", "--json"]);
    assert_eq!(done.code, 0, "{done:?}");
    assert!(done.json()["error_proved"].is_null() && done.only_line().contains("no area"));
}

#[test]
fn an_error_of_zero_is_proved_where_nothing_changes() {
    let run = Run::new();
    run.sample("knot", 3_000, "in.ply");
    let done = run.run(&["simplify", "in.ply", "out.ply", "--error", "0", "--json", "--strict"]);
    let report = done.json();
    assert!(done.code == 0 && done.err.is_empty() && report["reached"] == true, "{done:?}");
    assert!(report["error_rounds"] == 0 && report["error_asked"] == 0.0, "{report}");
    assert!(report["error_proved"] == 0.0, "{report}");
}

#[test]
fn faces_of_flats_are_counted() {
    let run = Run::new();
    run.sample("boxes", 20_000, "in.ply");
    let exact = ["simplify", "in.ply", "out.ply", "--error", "0"];
    let report = run.json(&exact);
    let counts = ["input_faces", "output_faces", "flat_faces", "needed_faces"];
    let counted = |report: &Value| counts.map(|count| report[count].as_u64());
    assert_eq!(counted(&report), [21_600, 2_400, 19_200, 2_400].map(Some));
    let done = run.run(&exact);
    let line = "flats: 19,200 faces went; the shape needs 2,400 faces\n";
    assert!(done.text().contains(line), "{}", done.text());
    // Those of a number of faces near it, and no others.
    let to = |faces| run.json(&["simplify", "in.ply", "out.ply", "--faces", faces]);
    assert_eq!(counted(&to("3000")), [21_600, 2_400, 19_200, 2_400].map(Some));
    assert_eq!(counted(&to("12000")), [Some(21_600), Some(12_000), None, None]);
    // A sphere has none.
    run.sample("sphere", 500, "in.ply");
    let done = run.run(&exact);
    assert!(done.text().contains("flats: none; the shape needs "), "{}", done.text());
}
