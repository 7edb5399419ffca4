//! Multiresolution files: built, proved, and extracted from.

use std::ops::Range;

use serde_json::Value;

use crate::run::{Done, Run};

/// A camera that sees a sample from the side.
pub const CAMERA: &str = "eye=3,0.5,0.4 look=0,0,0 up=0,0,1 fov=40 640x480";

/// A square of four faces with a vertex in its middle, with texture coordinates.
const TEXTURED: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 0\nvt 0 0\nvt 1 1\n\
    f 1/1 2/2 5/1\nf 2/1 3/2 5/1\nf 3/1 4/2 5/1\nf 4/1 1/2 5/1\n";

/// Number of faces of a torus of about 2000.
pub const TORUS: u64 = 2_016;

/// Builds a torus in chunks of 64 updates.
pub fn torus(run: &Run) {
    run.sample("torus", 2_000, "torus.ply");
    run.json(&["build", "torus.ply", "torus.mlod", "--in-chunk", "64"]);
}

/// Builds a height field as right triangles.
pub fn terrain(run: &Run, faces: usize) {
    run.sample("terrain", faces, "terrain.ply");
    run.json(&["build", "terrain.ply", "terrain.mlod", "--model", "right-triangles"]);
}

pub fn extract(run: &Run, input: &str, out: &str, arguments: &[&str]) -> Value {
    run.json(&[&["extract", input, out], arguments].concat())
}

pub fn number(value: &Value) -> u64 {
    value.as_u64().unwrap_or_else(|| panic!("{value} is not a whole number"))
}

pub fn bytes(run: &Run, name: &str) -> Vec<u8> {
    std::fs::read(run.path(name)).unwrap()
}

pub fn write(run: &Run, name: &str, bytes: &[u8]) {
    std::fs::write(run.path(name), bytes).unwrap();
}

pub fn word(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

/// Returns the offsets of the index, the coarsest mesh and each chunk in a file of contractions
/// (docs/formats/mlod.md).
pub fn pieces(bytes: &[u8]) -> Vec<Range<usize>> {
    let index = 88 + 44 * word(bytes, 36);
    let sizes = std::iter::once(28).chain((88..index).step_by(44)).map(|at| word(bytes, at));
    let ends = sizes.scan(0..index, |at, size| {
        *at = at.end..at.end + size;
        Some(at.clone())
    });
    std::iter::once(0..index).chain(ends).collect()
}

/// Runs a command that must fail: one line, no answer on standard output, nothing written.
pub fn refused(run: &Run, arguments: &[&str], code: i32) -> Done {
    let before = run.files();
    let done = run.run(arguments);
    assert!(done.code == code && done.has_no_answer(), "{arguments:?}: {done:?}");
    assert!(!done.err.contains("panicked"), "{done:?}");
    assert_eq!(run.files(), before, "{arguments:?}");
    done
}

#[test]
fn all_levels_of_a_mesh_are_in_one_file() {
    let run = Run::new();
    run.sample("torus", 2_000, "in.ply");
    let built = run.json(&["build", "in.ply", "out.mlod", "--in-chunk", "100"]);
    assert_eq!((&built["model"], &built["file"]), (&"contractions".into(), &"out.mlod".into()));
    assert_eq!(built["bytes"], bytes(&run, "out.mlod").len());
    assert_eq!(built["certificate"]["sound"], built["updates"], "{built}");
    assert_eq!(number(&built["updates"]) * 2 + number(&built["base_faces"]), TORUS);
    assert!(built["rounding"].as_f64().unwrap() > 0.0);
    assert!(built["bytes_per_vertex"].as_f64().is_some_and(|size| size < 20.0), "{built}");

    let proved = run.json(&["check", "out.mlod"]);
    for field in ["model", "updates", "base_faces", "certificate", "rounding"] {
        assert_eq!(proved[field], built[field], "{field}");
    }
    assert_eq!((&proved["faces"], &proved["chunks"]), (&TORUS.into(), &proved["chunks_there"]));
    assert!(number(&proved["chunks"]) > 5, "{proved}");

    let finest = extract(&run, "out.mlod", "back.ply", &["--error", "0"]);
    assert_eq!((&finest["faces"], &finest["chunks_read"]), (&TORUS.into(), &finest["chunks"]));
    assert_eq!(finest["bytes_read"], built["bytes"]);
    let far = run.json(&["measure", "in.ply", "back.ply"])["max"].as_f64();
    assert!(far.is_some() && far <= built["rounding"].as_f64(), "{far:?}");
}

/// A hilly field far from the origin, as an OBJ file with coordinates that `f32` cannot hold.
fn far_hills() -> String {
    hills([431_234.1, 5_412_345.7], |x| x)
}

fn hills(at: [f64; 2], exact: impl Fn(f64) -> f64) -> String {
    const SIDE: usize = 20;
    let vertex = |i: usize| {
        let (x, y) = ((i % SIDE) as f64 / 3.0, (i / SIDE) as f64 / 7.0);
        let height = if i.is_multiple_of(31) { -0.0 } else { (x + 2.0 * y).sin() };
        let [x, y, height] = [at[0] + x, at[1] + y, height].map(&exact);
        format!("v {x} {y} {height}\n")
    };
    let face = |i: usize| {
        let [a, b, c, d] = [i, i + 1, i + SIDE, i + SIDE + 1].map(|v| v + 1);
        format!("f {a} {b} {d}\nf {a} {d} {c}\n")
    };
    let cells = (0..SIDE * (SIDE - 1)).filter(|i| (i + 1) % SIDE != 0);
    (0..SIDE * SIDE).map(vertex).chain(cells.map(face)).collect()
}

/// Returns the faces of an OBJ file as the bits of their corners, each starting at its smallest.
fn by_bits(text: &str) -> Vec<[[u64; 3]; 3]> {
    let of = |key: &str| {
        let rows = text.lines().filter_map(|line| line.strip_prefix(key));
        let words = |row: &str| -> [String; 3] {
            let words: Vec<String> = row.split_whitespace().map(str::to_owned).collect();
            words.try_into().expect("three words")
        };
        rows.map(words).collect::<Vec<_>>()
    };
    let bits = |word: &String| word.parse::<f64>().unwrap().to_bits();
    let places: Vec<_> = of("v ").iter().map(|row| row.each_ref().map(bits)).collect();
    let corner = |word: &String| places[word.parse::<usize>().unwrap() - 1];
    let mut faces: Vec<_> = of("f ").iter().map(|row| row.each_ref().map(corner)).collect();
    for face in &mut faces {
        let least = (0..3).min_by_key(|&k| face[k]).unwrap();
        face.rotate_left(least);
    }
    faces.sort_unstable();
    faces
}

#[test]
fn a_lossless_file_gives_the_mesh_back_to_the_bit() {
    let run = Run::new();
    let text = far_hills();
    write(&run, "in.obj", text.as_bytes());
    let built = run.json(&["build", "in.obj", "out.mlod", "--lossless", "--in-chunk", "100"]);
    assert_eq!((&built["lossless"], built["rounding"].as_f64()), (&true.into(), Some(0.0)));
    let proved = run.json(&["check", "out.mlod"]);
    assert_eq!((&proved["lossless"], proved["rounding"].as_f64()), (&true.into(), Some(0.0)));
    for goal in [["--error", "0"], ["--faces", "100000"]] {
        extract(&run, "out.mlod", "back.obj", &goal);
        let back = String::from_utf8(bytes(&run, "back.obj")).unwrap();
        assert!(by_bits(&back) == by_bits(&text), "{goal:?}");
    }
    // Vertices that remain in a level have not moved.
    extract(&run, "out.mlod", "part.obj", &["--faces", "400"]);
    let part = String::from_utf8(bytes(&run, "part.obj")).unwrap();
    let all = by_bits(&text);
    let is_old = |corner: &[u64; 3]| all.as_flattened().contains(corner);
    let kept = by_bits(&part).as_flattened().iter().filter(|&corner| is_old(corner)).count();
    assert!(kept > 300 && kept < 3 * 400, "{kept}");
    let told = run.run(&["build", "in.obj", "again.mlod", "--lossless"]);
    assert!(told.code == 0 && told.text().contains("; lossless; vertices of coarser"), "{told:?}");
    let plain = run.json(&["build", "in.obj", "plain.mlod"]);
    assert!(plain["lossless"] == false && plain["rounding"].as_f64().unwrap() > 0.0);
}

#[test]
fn a_lossless_file_gives_text_files_to_the_bit_and_says_what_others_round() {
    let run = Run::new();
    // For thirds, the shortest decimal of an `f32` is a different `f64`.
    let text = hills([0.0; 2], |x| f64::from(x as f32));
    write(&run, "in.obj", text.as_bytes());
    run.json(&["build", "in.obj", "out.mlod", "--lossless"]);
    extract(&run, "out.mlod", "back.obj", &["--error", "0"]);
    assert!(by_bits(&String::from_utf8(bytes(&run, "back.obj")).unwrap()) == by_bits(&text));
    write(&run, "far.obj", far_hills().as_bytes());
    for (options, is_far) in
        [(&["--lossless"][..], true), (&[], true), (&["--rounding", "1"], false)]
    {
        run.json(&[&["build", "far.obj", "far.mlod"], options].concat());
        let taken = run.run(&["extract", "far.mlod", "far.stl", "--error", "0"]);
        let is_told = taken.err.contains("far.stl: rounding to f32 moved coordinates by up to 0.2");
        assert!(taken.code == 0 && is_told == is_far, "{options:?} {taken:?}");
        let taken = run.run(&["extract", "far.mlod", "far.ply", "--error", "0"]);
        assert!(taken.code == 0 && taken.err.is_empty(), "{options:?} {taken:?}");
    }
}

#[test]
fn what_is_left_out_is_said() {
    let run = Run::new();
    write(&run, "in.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\nf 2 3 1\nf 1 1 2\n");
    let built = run.run(&["build", "in.obj", "out.mlod"]);
    assert_eq!(built.code, 0, "{built:?}");
    assert!(
        built.err.contains("left out: 1 unused vertex, 2 degenerate or duplicate faces"),
        "{built:?}"
    );
    assert!(built.text().contains("all levels of 1 face in"), "{built:?}");
}

#[test]
fn words_say_what_json_says() {
    let run = Run::new();
    run.sample("torus", 500, "in.ply");
    let built = run.run(&["build", "in.ply", "out.mlod"]);
    assert!(built.code == 0 && built.err.is_empty(), "{built:?}");
    assert!(
        built.text().contains("all levels of 500 faces in ") && built.text().contains("proved")
    );
    let proved = run.run(&["check", "out.mlod"]);
    assert!(proved.code == 0 && proved.text().contains("no cut of "), "{proved:?}");
    let taken = run.run(&["extract", "out.mlod", "a.ply", "--error", "0"]);
    assert!(taken.code == 0 && taken.text().contains("500 faces"), "{taken:?}");
    assert!(taken.text().contains("read 1 of 1 chunk, "), "{taken:?}");
}

#[test]
fn a_height_field_comes_back_as_right_triangles() {
    let run = Run::new();
    run.sample("terrain", 800, "in.ply");
    let build = ["build", "in.ply", "out.mlod", "--model", "right-triangles", "--rounding", "0"];
    let built = run.json(&build);
    let grid = [0, 1].map(|k| number(&built["grid"][k]));
    assert_eq!(grid[0] * grid[1], number(&built["input_vertices"]), "{built}");
    let proved = run.json(&["check", "out.mlod"]);
    assert_eq!((&proved["model"], &proved["grid"]), (&built["model"], &built["grid"]));
    assert!(number(&proved["certificate"]["sound"]) > 0);
    let finest = extract(&run, "out.mlod", "back.ply", &["--error", "0"]);
    assert_eq!(
        (&finest["vertices"], &finest["error_kind"]),
        (&built["input_vertices"], &"bound".into())
    );
    let few = extract(&run, "out.mlod", "few.ply", &["--faces", "100"]);
    assert!((50..=100).contains(&number(&few["faces"])), "{few}");
    let done = refused(&run, &["build", "in.ply", "in.ply/out.mlod"], 1);
    assert!(done.only_line().contains("in.ply/out.mlod: its folder"), "{done:?}");
    run.sample("torus", 100, "torus.ply");
    let done = refused(&run, &["build", "torus.ply", "t.mlod", "--model", "right-triangles"], 1);
    assert!(done.only_line().starts_with("meshlod: torus.ply: "), "{done:?}");
}

/// Three by three heights with texture coordinates.
fn heights_with_uvs() -> String {
    let corner = |at: usize| format!("{at}/{at}");
    let row = |at: usize| [at / 3, at % 3].map(|x| x as f64 / 2.0);
    let vertices = (0..9).map(row).map(|[x, y]| format!("v {x} {} {y}\nvt {x} {y}\n", x * y));
    let squares = [1, 2, 4, 5].map(|at| [at, at + 1, at + 4, at + 3].map(corner).join(" "));
    vertices.chain(squares.map(|square| format!("f {square}\n"))).collect()
}

#[test]
fn what_a_file_has_no_room_for_is_told() {
    let run = Run::new();
    write(&run, "in.obj", heights_with_uvs().as_bytes());
    let done = run.run(&["build", "in.obj", "out.mlod", "--json", "--model", "right-triangles"]);
    assert!(done.code == 0 && done.only_line().contains("1 vertex attribute (tex"), "{done:?}");
    write(&run, "none.gltf", br#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{}]}"#);
    let done = refused(&run, &["build", "none.gltf", "none.mlod"], 1);
    assert!(done.only_line().contains("none.gltf: the mesh has no faces"), "{done:?}");
}

#[test]
fn attributes_and_materials_come_back() {
    let run = Run::new();
    let material = "newmtl sky\nKd 0 0 1\nnewmtl sea\nKd 0 1 0\nmap_Kd sea.png\n";
    write(&run, "two.mtl", material.as_bytes());
    run.sample("torus", 400, "torus.obj");
    run.json(&["render", "torus.obj", "sea.png", "--size", "300x300"]);
    let lines =
        TEXTURED.replace("f 3/1", "usemtl sea\nf 3/1").replace("f 1/1", "usemtl sky\nf 1/1");
    write(&run, "in.obj", format!("mtllib two.mtl\n{lines}").as_bytes());
    run.json(&["build", "in.obj", "out.mlod", "--lossless"]);
    extract(&run, "out.mlod", "back.obj", &["--error", "0"]);
    let [before, after] = ["in.obj", "back.obj"].map(|file| run.json(&["info", file]));
    for key in ["vertices", "faces", "wedges", "attributes", "materials"] {
        assert_eq!(before[key], after[key], "{key}");
    }
    extract(&run, "out.mlod", "back.glb", &["--error", "0"]);
    run.json(&["render", "in.obj", "before.png"]);
    run.json(&["render", "back.glb", "after.png"]);
    assert_eq!(bytes(&run, "before.png"), bytes(&run, "after.png"));
    // Without the last byte, the image is a preview.
    let all = bytes(&run, "out.mlod");
    write(&run, "out.mlod", &all[..all.len() - 1]);
    let done = run.run(&["extract", "out.mlod", "back.glb", "--error", "0"]);
    assert!(done.code == 0 && done.err.contains("smaller version"), "{done:?}");
    run.json(&["render", "back.glb", "preview.png"]);
    assert_ne!(bytes(&run, "preview.png"), bytes(&run, "after.png"));
}

#[test]
fn a_larger_error_takes_fewer_faces() {
    let run = Run::new();
    torus(&run);
    for step in [["0", "0.05%", "1%", "100%"], ["0", "0.002", "0.03", "3"]] {
        let by = |more: &[&str]| {
            step.map(|error| {
                extract(&run, "torus.mlod", "out.ply", &[&["--error", error], more].concat())
            })
        };
        let faces = by(&[]).map(|taken| number(&taken["faces"]));
        assert!(faces.is_sorted_by(|a, b| a > b), "{faces:?}");
        // Without a check only what the result needs is read.
        let taken = by(&["--unverified"]);
        let of = |field: &str| taken.iter().map(|t| number(&t[field])).collect::<Vec<_>>();
        assert!(of("faces").is_sorted_by(|a, b| a > b), "{:?}", of("faces"));
        assert!(of("bytes_read").is_sorted_by(|a, b| a >= b) && of("chunks_read")[3] == 0);
        assert_eq!(run.json(&["info", "out.ply"])["closed"], true);
    }
    let pixels = ["16px", "4px", "0.5px"].map(|error| {
        number(&extract(&run, "torus.mlod", "out.ply", &["--error", error, "--camera", CAMERA])["faces"])
    });
    assert!(pixels.is_sorted_by(|a, b| a < b), "{pixels:?}");
}

#[test]
fn a_focus_is_fine_and_the_rest_coarse() {
    let run = Run::new();
    torus(&run);
    terrain(&run, 2_000);
    for file in ["torus.mlod", "terrain.mlod"] {
        let all = number(&extract(&run, file, "all.ply", &["--error", "0"])["faces"]);
        let info = run.json(&["info", "all.ply"]);
        let at = |corner: &str| [0, 1, 2].map(|k| info["bounds"][corner][k].as_f64().unwrap());
        let (low, high) = (at("min"), at("max"));
        let list = |place: [f64; 3]| place.map(|x| x.to_string()).join(",");
        let middle = [0, 1, 2].map(|k| 0.5 * (low[k] + high[k]));
        let one = [high[0], middle[1], middle[2]];
        let focuses = [
            format!("point={}", list(one)),
            format!("segment={},{}", list(middle), list(high)),
            format!("box={},{}", list(middle), list(high)),
            format!("sphere={},{}", list(one), 0.4 * (high[0] - low[0])),
            "frustum".into(),
        ];
        let far = "eye=9,0.3,0.2 look=0.6,0.3,0 up=0,0,1 fov=5 640x480";
        for focus in &focuses {
            let arguments = ["--error", "0", "--focus", focus, "--camera", far];
            let some = number(&extract(&run, file, "some.ply", &arguments)["faces"]);
            assert!(some < all && some > 4, "{file} {focus}: {some} of {all}");
            let arguments = [&arguments[..], &["--only"]].concat();
            let done =
                run.run(&[&["extract", file, "only.ply", "--json"], &arguments[..]].concat());
            if focus.starts_with("point") || focus.starts_with("segment") {
                // So small a region may contain no face.
                assert!(
                    done.code == 0 || done.only_line().contains("no face intersects"),
                    "{done:?}"
                );
                continue;
            }
            let only = number(&done.json()["faces"]);
            assert!(only > 0 && only < some, "{file} {focus}: {only} of {some}");
        }
    }
}

#[test]
fn so_many_faces_are_the_most() {
    let run = Run::new();
    torus(&run);
    for most in ["300", "301", "1999"] {
        let all_sides = number(&extract(&run, "torus.mlod", "a.ply", &["--faces", most])["faces"]);
        let arguments = ["--faces", most, "--camera", CAMERA];
        let seen = number(&extract(&run, "torus.mlod", "b.ply", &arguments)["faces"]);
        let most: u64 = most.parse().unwrap();
        assert!((most - 4..=most).contains(&all_sides), "{all_sides} of {most}");
        assert!((most - 4..=most).contains(&seen), "{seen} of {most}");
        assert_ne!(bytes(&run, "a.ply"), bytes(&run, "b.ply"));
    }
    let few = extract(&run, "torus.mlod", "a.ply", &["--faces", "300"]);
    assert!(number(&few["chunks_read"]) < number(&few["chunks"]), "{few}");
    let near = ["--faces", "500", "--focus", "box=0,0,-9,9,9,9"];
    assert!(number(&extract(&run, "torus.mlod", "a.ply", &near)["faces"]) <= 500);
    let all = extract(&run, "torus.mlod", "a.ply", &["--faces", "1000000"]);
    assert_eq!(all["faces"], TORUS);
}

#[test]
fn no_level_is_coarser_than_the_coarsest() {
    let run = Run::new();
    torus(&run);
    let base = run.json(&["check", "torus.mlod"])["base_faces"].clone();
    for arguments in [&["--faces", "1"][..], &["--faces", "0", "--camera", CAMERA]] {
        let extract = [&["extract", "torus.mlod", "a.ply", "--json"], arguments].concat();
        let done = run.run(&extract);
        assert_eq!((done.code, &done.json()["faces"]), (0, &base), "{done:?}");
        assert_eq!(done.json()["reached"], false);
        assert!(done.only_line().contains("is out of reach: the coarsest level has "), "{done:?}");
    }
}

#[test]
fn a_mesh_comes_out_of_a_file_through_a_pipe() {
    let run = Run::new();
    torus(&run);
    let extract = ["extract", "torus.mlod", "-", "--format", "ply", "--error", "0"];
    let taken = run.run(&extract);
    assert!(taken.code == 0 && taken.err.contains("2,016 faces"));
    let info = run.run_with(&["info", "-", "--format", "ply", "--json"], &taken.out).json();
    assert_eq!(info["faces"], TORUS);
    let mesh = bytes(&run, "torus.ply");
    let built = run.run_with(&["build", "-", "again.mlod", "--format", "ply", "--json"], &mesh);
    assert_eq!((built.code, &built.json()["input_faces"]), (0, &TORUS.into()));
}

#[test]
fn wrong_questions_are_2_and_write_nothing() {
    let run = Run::new();
    torus(&run);
    terrain(&run, 200);
    let short = "eye=1,2 look=0,0,0 fov=40 640x480";
    let blind = "eye=1,2,3 look=1,2,3 fov=40 640x480";
    let wide = "eye=1,2,3 look=0,0,0 fov=180 640x480";
    let questions: &[&[&str]] = &[
        &[],
        &["--error", "1px"],
        &["--error", "-1"],
        &["--error", "nan"],
        &["--error", "1pixel"],
        &["--error", "0", "--faces", "10"],
        &["--faces", "-1"],
        &["--faces", "1.5"],
        &["--error", "0", "--focus", "frustum"],
        &["--error", "0", "--focus", "everywhere"],
        &["--error", "0", "--focus", "box=0,0,0,1,1"],
        &["--error", "0", "--focus", "box=1,1,1,0,0,0"],
        &["--error", "0", "--focus", "sphere=0,0,0,-1"],
        &["--error", "0", "--focus", "point=0,0,inf"],
        &["--error", "0", "--only"],
        &["--error", "0", "--focus", "sphere=0,0,0,1", "--only", "--exact-volume"],
        &["--error", "1px", "--camera", "here"],
        &["--error", "1px", "--camera", short],
        &["--error", "1px", "--camera", blind],
        &["--error", "1px", "--camera", wide],
        &["--faces", "10", "--camera", blind],
        &["--error", "0", "--precision", "f16"],
    ];
    for input in ["torus.mlod", "terrain.mlod"] {
        for question in questions {
            refused(&run, &[&["extract", input, "out.ply"], *question].concat(), 2);
        }
        for out in ["out", "out.mlod", "out.xyz", input, "-"] {
            refused(&run, &["extract", input, out, "--error", "0"], 2);
        }
    }
    refused(&run, &["extract", "torus.mlod", "-", "--format", "ply", "--error", "0", "--json"], 2);
    refused(&run, &["extract", "-", "out.ply", "--format", "ply", "--error", "0"], 2);
    refused(&run, &["check", "torus.mlod", "--locks", "a.json"], 2);
    refused(&run, &["check", "torus.mlod", "--out", "page"], 2);
}

#[test]
fn wrong_builds_are_2_and_write_nothing() {
    let run = Run::new();
    run.sample("torus", 100, "in.ply");
    let builds: &[&[&str]] = &[
        &["in.ply"],
        &["in.ply", "out.ply"],
        &["in.ply", "out"],
        &["in.ply", "-"],
        &["-", "out.mlod"],
        &["in.ply", "out.mlod", "--method", "magic"],
        &["in.ply", "out.mlod", "--model", "left-triangles"],
        &["in.ply", "out.mlod", "--rounding", "-1"],
        &["in.ply", "out.mlod", "--lossless", "--rounding", "0"],
        &["in.ply", "out.mlod", "--lossless", "--rounding", "0.005%"],
        &["in.ply", "out.mlod", "--lossless", "--model", "right-triangles"],
        &["in.ply", "out.mlod", "--rounding", "much"],
        &["in.ply", "out.mlod", "--in-chunk", "0"],
        &["in.ply", "out.mlod", "--in-chunk", "-5"],
    ];
    for arguments in builds {
        refused(&run, &[&["build"], *arguments].concat(), 2);
    }
    std::fs::create_dir(run.path("folder.mlod")).unwrap();
    let done = refused(&run, &["build", "in.ply", "folder.mlod"], 1);
    assert!(done.only_line().contains("folder.mlod: is a folder"), "{done:?}");
}

/// Returns the bytes of the first block of hexadecimal lines in docs/formats/mlod.md.
fn test_vector() -> Vec<u8> {
    let page = include_str!("../../../../docs/formats/mlod.md");
    let section = page.split_once("## A test vector").unwrap().1;
    let block = section.split("```text").nth(1).unwrap().split("```").next().unwrap();
    let words = block.lines().flat_map(|line| line.split_whitespace().skip(1));
    let hex: String = words.collect();
    let byte = |at: usize| u8::from_str_radix(&hex[at..at + 2], 16).unwrap();
    (0..hex.len()).step_by(2).map(byte).collect()
}

#[test]
fn the_test_vector_of_the_page_is_what_is_written() {
    let run = Run::new();
    run.sample("terrain", 30, "t.ply");
    run.json(&["build", "t.ply", "t.mlod", "--rounding", "1%"]);
    let written = std::fs::read(run.path("t.mlod")).unwrap();
    assert!(written == test_vector(), "{} bytes", written.len());
    let finest = run.json(&["extract", "t.mlod", "f.ply", "--error", "0"]);
    assert_eq!([&finest["vertices"], &finest["faces"]], [25, 32]);
}
