//! Table, page and files of `compare`.

use serde_json::Value;

use crate::run::{Done, Run};

/// Runs a quick comparison with `options`, to the folder `out`.
fn compare(run: &Run, options: &[&str]) -> Done {
    run.run(&[&["compare"], options, &["--out", "out", "--samples", "5000"]].concat())
}

fn compared(run: &Run, options: &[&str]) -> Value {
    let done = compare(run, &[options, &["--json"]].concat());
    assert_eq!(done.code, 0, "{done:?}");
    done.json()
}

fn list<'v>(json: &'v Value, field: &str) -> &'v Vec<Value> {
    json[field].as_array().unwrap()
}

fn levels(json: &Value) -> impl Iterator<Item = &Value> {
    list(json, "methods").iter().flat_map(|method| list(method, "levels"))
}

fn page(run: &Run) -> String {
    std::fs::read_to_string(run.path("out/index.html")).unwrap()
}

fn in_out(run: &Run) -> Vec<String> {
    let entries = std::fs::read_dir(run.path("out")).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// A curved sheet: open, without attributes.
fn write_sheet(run: &Run, name: &str) {
    let mut obj = String::new();
    for (x, y) in (0..12).flat_map(|y| (0..12).map(move |x| (x, y))) {
        obj += &format!("v {x} {y} {}\n", (x * x + y) as f64 / 30.0);
    }
    for (x, y) in (0..11).flat_map(|y| (0..11).map(move |x| (x, y))) {
        let v = 12 * y + x + 1;
        obj += &format!("f {v} {} {} {}\n", v + 1, v + 13, v + 12);
    }
    std::fs::write(run.path(name), obj).unwrap();
}

#[test]
fn every_method_has_every_level_as_figures_as_a_picture_and_as_a_file() {
    let run = Run::new();
    run.sample("knot", 1_000, "in.ply");
    let json = compared(&run, &["in.ply", "--ratio", "10%,50%"]);
    let methods = list(&json, "methods");
    assert!(methods.len() > 1 && methods.iter().all(|method| method["failed"].is_null()));
    let page = page(&run);
    for method in methods {
        let sizes: Vec<_> = list(method, "levels").iter().map(|level| &level["size"]).collect();
        assert_eq!(sizes, ["50%", "10%"], "the finest first");
        let name = method["method"].as_str().unwrap();
        let alts = page.matches(&format!(" by {name}\"")).count();
        assert_eq!(alts, 2 * 3, "shaded, with edges, as a heat map: {name}");
    }
    assert_eq!(page.matches("<img ").count(), 2 * (2 + 3 * methods.len()));
    for level in levels(&json) {
        for (field, of) in [
            ("mean_percent", &level["error_measured"]),
            ("max_percent", &level["error_measured"]),
            ("volume_change_percent", level),
            ("faces", level),
            ("flip", level),
            ("simplify_seconds", level),
        ] {
            let value = of[field].as_f64().unwrap();
            assert!(page.contains(&format!("<data value=\"{value}\">")), "{field} {value}");
        }
    }
    let files = in_out(&run);
    let written = |level: &Value| files.contains(&level["file"].as_str().unwrap().to_owned());
    assert!(levels(&json).all(written) && files.len() == 2 + levels(&json).count(), "{files:?}");
}

/// Returns the method of the least figure of the first level, which a method may not have.
fn winner(json: &Value, figure: fn(&Value) -> &Value) -> String {
    let of = |method: &&Value| figure(&method["levels"][0]).as_f64().unwrap();
    let methods = list(json, "methods").iter();
    let least = methods.min_by(|a, b| of(a).total_cmp(&of(b))).unwrap();
    least["method"].as_str().unwrap().to_owned()
}

#[test]
fn the_page_opens_with_who_came_closest_and_who_was_fastest() {
    let run = Run::new();
    run.sample("knot", 2_000, "in.ply");
    let methods = "qem-endpoint,lee-jang,lindstrom-turk";
    let json = compared(&run, &["in.ply", "--ratio", "20%", "--methods", methods]);
    let verdict = &json["verdicts"][0];
    let closest = winner(&json, |level| &level["error_measured"]["rms_percent"]);
    let fastest = winner(&json, |level| &level["simplify_seconds"]);
    assert_eq!((&verdict["closest"]["method"], &verdict["size"]), (&closest.into(), &"20%".into()));
    assert_eq!(verdict["fastest"]["method"], fastest);
    let page = page(&run);
    let opening = page.split_once("<section").unwrap().0;
    let sentence = verdict["sentence"].as_str().unwrap();
    assert!(opening.contains(sentence), "{sentence}");
    assert_eq!(page.matches("lindstrom-turk <span class=\"chip\">default</span>").count(), 1);
    assert_eq!(page.matches("<span class=\"chip\">default</span>").count(), 2);
}

#[test]
fn a_verdict_for_each_size_and_none_for_one_that_nobody_reached() {
    let run = Run::new();
    run.sample("torus", 400, "in.ply");
    let options = ["in.ply", "--faces", "200,3", "--methods", "qem", "--no-pictures"];
    let json = compared(&run, &options);
    let sentence = |size: usize| json["verdicts"][size]["sentence"].as_str().unwrap();
    assert!(sentence(0).starts_with("At 200 faces, qem has an RMS error of "), "{json}");
    assert_eq!(sentence(1), "At 3 faces, no method reached the size.");
    assert!(json["verdicts"][1]["closest"].is_null() && json["verdicts"][1]["fastest"].is_null());
    let done = compare(&run, &options);
    let text = done.text();
    assert!(text.contains("\nAt 200 faces, qem has ") && text.contains(sentence(1)), "{text}");
}

#[test]
fn every_picture_is_enlarged_without_a_script() {
    let run = Run::new();
    run.sample("sphere", 500, "in.ply");
    compared(&run, &["in.ply", "--ratio", "30%", "--methods", "qem"]);
    let page = page(&run);
    let pictures = page.matches("<img ").count();
    assert_eq!(page.matches("<details class=\"zoom\"").count(), pictures);
    assert_eq!(page.matches("<summary><img ").count(), pictures);
    assert!(page.contains(".zoom[open] summary {\n  position: fixed;"));
    for script in ["<script", "onclick", "onload", "javascript:"] {
        assert!(!page.contains(script), "{script}");
    }
}

#[test]
fn a_level_measures_the_same_again() {
    let run = Run::new();
    run.sample("knot", 1_000, "in.ply");
    let json = compared(&run, &["in.ply", "--faces", "300", "--no-pictures"]);
    assert!(!page(&run).contains("<img "));
    for level in levels(&json) {
        let file = format!("out/{}", level["file"].as_str().unwrap());
        assert!(file.ends_with("-300-faces.ply"), "{file}");
        let again = run.json(&["measure", "in.ply", &file, "--samples", "5000"]);
        for field in ["mean", "rms", "max", "diagonal"] {
            assert_eq!(again[field], level["error_measured"][field], "{field} of {file}");
        }
        assert_eq!(again["volume_b"], level["volume"]);
    }
}

#[test]
fn the_file_says_what_json_says_and_needs_no_other_page() {
    let run = Run::new();
    run.sample("sphere", 500, "in.ply");
    let mut json = compared(&run, &["in.ply", "--ratio", "30%"]);
    for key in ["format", "version", "verb", "notes"] {
        json.as_object_mut().unwrap().remove(key);
    }
    let file = std::fs::read(run.path("out/compare.json")).unwrap();
    assert_eq!(serde_json::from_slice::<Value>(&file).unwrap(), json);
    for foreign in ["http:", "https:", "<script", "<link", "url(", "@import"] {
        assert!(!page(&run).contains(foreign), "{foreign}");
    }
}

#[test]
fn an_open_mesh_has_no_volume_to_change() {
    let run = Run::new();
    write_sheet(&run, "in.obj");
    let json = compared(&run, &["in.obj", "--ratio", "30%", "--no-pictures"]);
    assert!(levels(&json).all(|level| level["volume_change_percent"].is_null()));
    assert!(levels(&json).all(|level| level["file"].as_str().unwrap().ends_with(".ply")));
    assert!(page(&run).contains("The input is open and encloses no volume"));
    let text = compare(&run, &["in.obj", "--ratio", "30%", "--no-pictures"]);
    assert!(text.text().contains("The input is open") && !text.text().contains("  volume"));
}

#[test]
fn what_a_file_has_its_levels_have() {
    let run = Run::new();
    run.sample("fish", 1_000, "fish.obj");
    run.sample("fish", 1_000, "fish.glb");
    for input in ["fish.obj", "fish.glb"] {
        let options = [input, "--ratio", "30%", "--methods", "qem", "--no-pictures"];
        let json = compared(&run, &options);
        let file = format!("out/{}", levels(&json).next().unwrap()["file"].as_str().unwrap());
        let attributes = |file: &str| run.json(&["info", file])["attributes"].clone();
        assert_eq!(attributes(&file), attributes(input));
        assert!(attributes(&file).as_array().unwrap().len() > 1, "{file}");
    }
}

#[test]
fn a_size_out_of_reach_is_a_mark() {
    let run = Run::new();
    run.sample("torus", 400, "in.ply");
    let done = compare(&run, &["in.ply", "--faces", "3", "--methods", "qem", "--json"]);
    assert_eq!((done.code, &levels(&done.json()).next().unwrap()["reached"]), (0, &false.into()));
    assert!(done.only_line().contains("warning: in.ply: qem, 3 faces: target not reached"));
    assert_eq!(page(&run).matches("not reached").count(), 2, "below the picture, in the table");
}

#[test]
fn people_get_a_table_with_the_best_marked_and_the_page_last() {
    let run = Run::new();
    run.sample("knot", 1_000, "in.ply");
    let done = compare(&run, &["in.ply", "--ratio", "20%", "--methods", "qem-endpoint,qem,qem"]);
    assert_eq!((done.code, &done.err[..]), (0, ""));
    let text = done.text();
    let row = |name: &str| text.lines().find(|line| line.starts_with(&format!("{name} "))).unwrap();
    assert!(row("qem").contains('*') && !row("qem").contains("* *"), "{text}");
    assert_eq!(text.lines().filter(|line| line.starts_with("qem-endpoint ")).count(), 1);
    assert!(text.ends_with("out/index.html\n"));
    assert_eq!(
        page(&run).matches("<td class=\"best\">").count(),
        text.matches("* ").count() - 1 + text.matches("*\n").count()
    );
    let alone = compare(&run, &["in.ply", "--ratio", "20%", "--methods", "qem"]);
    assert_eq!(alone.text().matches('*').count(), 1, "alone it is no best: {alone:?}");
}

#[test]
fn any_number_of_threads_gives_the_same_figures() {
    let run = Run::new();
    run.sample("gyroid", 2_000, "in.ply");
    let figures = |threads| {
        let options = ["in.ply", "--ratio", "20%", "--methods", "qem,lindstrom-turk"];
        let mut json = compared(&run, &[&options[..], &["--threads", threads]].concat());
        json["threads"].take();
        for method in json["methods"].as_array_mut().unwrap() {
            method["levels"][0]["simplify_seconds"].take();
        }
        for field in ["fastest", "sentence"] {
            json["verdicts"][0][field].take();
        }
        json
    };
    assert_eq!(figures("1"), figures("2"));
}

#[test]
fn what_cannot_be_compared_leaves_nothing() {
    let run = Run::new();
    std::fs::write(run.path("none.obj"), "v 0 0 0\n").unwrap();
    std::fs::write(run.path("flat.obj"), "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n").unwrap();
    for (input, ratio, code) in [
        ("none.obj", "1%", 1),
        ("flat.obj", "1%", 1),
        ("not-there.ply", "1%", 1),
        ("none.obj", "2", 2),
    ] {
        let done = compare(&run, &[input, "--ratio", ratio]);
        assert_eq!((done.code, done.out.len()), (code, 0), "{done:?}");
        assert!(code == 2 || done.only_line().contains(input), "{done:?}");
        assert!(!run.path("out").exists());
    }
    let done = compare(&run, &["none.obj", "--ratio", "1%", "--methods", "qem,best"]);
    assert!(
        done.code == 2 && done.err.contains("best") && done.err.contains("the methods are qem")
    );
    std::fs::write(run.path("out"), "mine").unwrap();
    let done = compare(&run, &["flat.obj", "--ratio", "1%"]);
    assert_eq!(done.only_line(), "meshlod: out: is a file; name a folder to write to");
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_takes_no_file_is_found_before_the_work() {
    let run = Run::new();
    run.sample("sphere", 500, "in.ply");
    let done = run.run(&["compare", "in.ply", "--ratio", "1%", "--out", "/proc"]);
    assert!(done.code == 1 && done.only_line().starts_with("meshlod: /proc: "), "{done:?}");
}
