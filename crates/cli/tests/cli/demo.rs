//! Page, pictures and files of the demo.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::LazyLock;

use serde_json::Value;

use crate::json_pages;
use crate::run::Run;

/// Output of a run, with the files it wrote.
struct Demo {
    json: Value,
    files: BTreeMap<String, Vec<u8>>,
}

/// One run shared by all tests. Its folder is already removed, since a static is never dropped.
static DEMO: LazyLock<Demo> = LazyLock::new(|| {
    let run = Run::new();
    let json = run.json(&["demo", "out"]);
    Demo { json, files: files_in(&run, "out") }
});

/// Reads the files of a folder, by their names in `out`.
fn files_in(run: &Run, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(run.path(folder)).unwrap();
    let file = |path: PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap();
        (format!("out/{name}"), std::fs::read(&path).unwrap())
    };
    entries.map(|entry| file(entry.unwrap().path())).collect()
}

fn page() -> &'static str {
    std::str::from_utf8(&DEMO.files["out/index.html"]).unwrap()
}

fn list<'v>(json: &'v Value, field: &str) -> &'v Vec<Value> {
    json[field].as_array().unwrap()
}

fn levels(sample: &Value) -> impl Iterator<Item = &Value> {
    list(sample, "chains").iter().flat_map(|chain| list(chain, "levels"))
}

#[test]
fn the_page_of_json_has_every_key_of_a_demo() {
    json_pages::check("demo", &DEMO.json);
}

#[test]
fn every_promised_picture_is_in_the_page() {
    let page = page();
    for sample in list(&DEMO.json, "samples") {
        let id = format!("<section id=\"{}\"", sample["sample"].as_str().unwrap());
        let section = page.split_once(&id).unwrap().1.split_once("</section>").unwrap().0;
        let of_chain = list(&sample["chains"][0], "levels").len();
        let pictures: Vec<&str> = section.split("<img ").skip(1).collect();
        assert_eq!(pictures.len(), 3 * of_chain + 2, "the input has no error to show");
        for picture in pictures {
            let tag = picture.split_once('>').unwrap().0;
            assert!(tag.contains("src=\"data:image/png;base64,iVBORw0KGgo"), "a PNG");
            assert!(tag.contains(" alt=\"") && !tag.contains(" alt=\"\""));
        }
        assert_eq!(section.matches("role=\"img\"").count(), 1);
        assert_eq!(section.matches("<polyline ").count(), list(sample, "chains").len());
    }
}

#[test]
fn the_page_needs_nothing_else_and_is_not_large() {
    let page = page();
    assert_eq!(DEMO.json["page_bytes"], page.len());
    assert!(page.len() < 7_000_000, "{}", page.len());
    for foreign in ["http:", "https:", "<script", "<link", "url(", "@import"] {
        assert!(!page.contains(foreign), "{foreign}");
    }
}

#[test]
fn the_page_has_the_figures_of_the_json() {
    let page = page();
    let has = |value: &Value| {
        let value = value.as_f64().unwrap_or_else(|| panic!("a number, not {value}"));
        assert!(page.contains(&format!("<data value=\"{value}\">")), "{value}");
    };
    for sample in list(&DEMO.json, "samples") {
        let counts = ["vertices", "faces", "boundary_edges", "components", "area", "volume"];
        counts.iter().for_each(|field| has(&sample[*field]));
        for level in levels(sample) {
            ["mean_percent", "rms_percent", "max_percent"]
                .iter()
                .for_each(|field| has(&level["error_measured"][*field]));
            ["faces", "volume_change_percent", "quality_mean", "simplify_seconds"]
                .iter()
                .for_each(|field| has(&level[*field]));
        }
    }
}

#[test]
fn every_file_is_there_and_holds_the_promised_faces() {
    let Demo { json, files } = &*DEMO;
    let run = Run::new();
    std::fs::create_dir(run.path("out")).unwrap();
    files.iter().for_each(|(name, bytes)| std::fs::write(run.path(name), bytes).unwrap());
    let mut promised = vec![json["page"].as_str().unwrap(), json["picture"].as_str().unwrap()];
    for sample in list(json, "samples") {
        let own = [("file", sample), ("lods", sample)];
        for (field, of) in own.into_iter().chain(levels(sample).map(|level| ("file", level))) {
            let file = of[field].as_str().unwrap();
            assert_eq!(run.json(&["info", file])["faces"], of["faces"], "{file}");
            promised.push(file);
        }
    }
    let steps = list(json, "pipeline").iter().flat_map(|step| list(step, "files"));
    promised.extend(steps.map(|file| file.as_str().unwrap()));
    promised.sort_unstable();
    assert!(files.keys().eq(&promised), "{promised:?} and no other");
    let links = page().split("href=\"").skip(1).map(|rest| rest.split_once('"').unwrap().0);
    for link in links.filter(|link| !link.starts_with('#')) {
        assert!(files.contains_key(&format!("out/{link}")), "{link}");
    }
}

#[test]
fn every_step_has_a_picture_a_figure_and_commands() {
    let section = page().split_once("<section id=\"pipeline\"").unwrap().1;
    let section = section.split_once("</section>").unwrap().0;
    let cards: Vec<&str> = section.split("<li>").skip(1).collect();
    let steps = list(&DEMO.json, "pipeline");
    assert_eq!((steps.len(), cards.len()), (6, 6));
    for (step, card) in steps.iter().zip(cards) {
        let figure = step["figure"].as_f64().unwrap();
        assert!(card.contains(&format!("<data value=\"{figure}\">")), "{step}");
        assert_eq!(card.matches("<img ").count(), 1, "{step}");
        for command in list(step, "commands") {
            let shown = command.as_str().unwrap().replace('"', "&quot;");
            assert!(card.contains(&format!("<code>{shown}</code>")), "{command}");
        }
    }
    let figure = |step: usize| steps[step]["figure"].as_f64().unwrap();
    assert!(figure(0) > 100.0 && figure(1) == 0.0, "all that is broken is repaired");
}

#[test]
fn the_commands_of_the_steps_write_the_same_files_again() {
    let Demo { json, files } = &*DEMO;
    let run = Run::new();
    for name in ["fish.ply", "fish-broken.ply"] {
        std::fs::write(run.path(name), &files[&format!("out/{name}")]).unwrap();
    }
    for step in list(json, "pipeline") {
        for command in list(step, "commands") {
            // Every second part is between quotes and is one word.
            let parts = command.as_str().unwrap().split('"').enumerate();
            let words: Vec<&str> = parts
                .flat_map(|(i, part)| match i % 2 {
                    0 => part.split_whitespace().collect(),
                    _ => vec![part],
                })
                .collect();
            let done = run.run(&words[1..]);
            let found =
                if words.contains(&"fish-broken.ply") && words[1] == "check" { 3 } else { 0 };
            assert_eq!((done.code, &done.err[..]), (found, ""), "{command}: {done:?}");
        }
        for file in list(step, "files").iter().map(|file| file.as_str().unwrap()) {
            let again = std::fs::read(run.path(file.strip_prefix("out/").unwrap())).unwrap();
            assert!(again == files[file], "{file} differs");
        }
    }
}

#[test]
fn tables_scroll_in_boxes_of_their_own_and_pictures_fit_their_columns() {
    let page = page();
    let tables: Vec<&str> = page.split("<table").collect();
    assert!(tables.len() > 3);
    for before in &tables[..tables.len() - 1] {
        let parent = before.rsplit_once("<div class=\"").unwrap().1;
        assert!(parent.starts_with("scroll\""), "{parent}");
    }
    for rule in [".scroll { overflow-x: auto; }", "img { display: block; width: 100%;"] {
        assert!(page.contains(rule), "{rule}");
    }
}

#[test]
fn levels_are_as_small_as_asked_for_and_as_whole_as_the_input() {
    for sample in list(&DEMO.json, "samples") {
        for level in levels(sample) {
            let wanted = level["ratio"].as_f64().unwrap() * sample["faces"].as_f64().unwrap();
            assert!(level["faces"].as_f64().unwrap() <= wanted && level["reached"] == true);
            for field in ["closed", "components"] {
                assert_eq!(level[field], sample[field], "{field} of {}", level["file"]);
            }
            // Handles may close.
            assert!(level["genus"].as_f64() <= sample["genus"].as_f64(), "{}", level["file"]);
        }
    }
}

/// The second run of the demo, as people start it, and the last: each takes seconds.
#[test]
fn with_one_thread_people_get_a_table_and_the_same_files() {
    let run = Run::new();
    let done = run.run(&["demo", "--threads", "1", "--", "-new/folder"]);
    assert_eq!((done.code, done.err.as_str()), (0, ""));
    assert!(done.text().ends_with("-new/folder/index.html\n"), "{}", done.text());
    assert!(done.text().contains("  Repair: 0 defects are left\n"), "{}", done.text());
    let again = files_in(&run, "-new/folder");
    assert!(again.keys().eq(DEMO.files.keys()));
    for (name, bytes) in &DEMO.files {
        let is_same = match name.ends_with(".html") {
            true => timeless(page()) == timeless(std::str::from_utf8(&again[name]).unwrap()),
            false => *bytes == again[name],
        };
        assert!(is_same, "{name} differs");
    }
}

/// Returns a page without its figures in seconds.
fn timeless(page: &str) -> String {
    let parts = page.split("<data value=\"").map(|part| match part.split_once("</data>") {
        Some((figure, rest)) if figure.ends_with(" s") || figure.ends_with(" ms") => rest,
        _ => part,
    });
    parts.collect()
}

#[test]
fn a_file_is_no_folder() {
    let run = Run::new();
    std::fs::write(run.path("out"), "mine").unwrap();
    let done = run.run(&["demo", "out"]);
    assert_eq!((done.code, done.out.len()), (1, 0));
    assert_eq!(done.only_line(), "meshlod: out: is a file; name a folder to write to");
    assert_eq!(std::fs::read(run.path("out")).unwrap(), b"mine");
    let done = run.run(&["demo", "out/inner"]);
    assert!(done.code == 1 && done.only_line().contains("out"), "{done:?}");
}
