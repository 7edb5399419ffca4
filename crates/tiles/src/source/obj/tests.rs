//! Tests of OBJ in passing: the triangles of scenes, and files that are damaged.

use std::fmt::Write as _;
use std::fs;

use meshlod_io::{Note, ReadOptions};
use meshlod_mesh::LayerKind;
use tempfile::TempDir;

use super::*;
use crate::source::SceneSource;
use crate::source::fixtures::{all, patch};

const LIBRARY: &str = "newmtl stone\nKd .5 .5 .5\nmap_Kd stone.png\nnewmtl grass\nKd 0 1 0\n\
                       newmtl unused\nKd 1 0 0\n";

/// Writes a file and its library into a folder of its own.
fn folder(text: &[u8]) -> (TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    fs::write(&path, text).unwrap();
    fs::write(folder.path().join("a.mtl"), LIBRARY).unwrap();
    fs::write(folder.path().join("stone.png"), b"\x89PNG\r\n\x1a\n0000IHDR").unwrap();
    (folder, path)
}

/// Checks that a file has the same triangles, materials and images in passing and as a scene.
#[track_caller]
fn check_same(text: &[u8], windows: &[usize]) -> usize {
    let (folder, path) = folder(text);
    let scene = meshlod_io::read(&path, &ReadOptions::default()).unwrap();
    let look = |scene: &Scene| (scene.materials.clone(), scene.images.clone());
    let expected_look = look(&scene);
    let expected_notes = notes(&scene);
    let whole = SceneSource::new(scene);
    let expected = all(&whole);
    for &window in windows {
        let (source, own) = ObjSource::open_by(&path, folder.path(), window).unwrap();
        assert_eq!(source.layout(), whole.layout(), "{window}");
        let found = all(&source);
        assert_eq!(found.places, expected.places, "{window}");
        assert_eq!(found.values, expected.values, "{window}");
        assert_eq!(found.materials, expected.materials, "{window}");
        assert_eq!(look(&own), expected_look);
        assert_eq!(notes(&own), expected_notes);
        assert_eq!(source.bounds().unwrap(), whole.bounds().unwrap());
    }
    // Nothing is left in the folder.
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
    expected.places.len()
}

/// Returns the notes of a scene but the one that counts normals at corners of the mesh.
fn notes(scene: &Scene) -> Vec<String> {
    let texts = scene.notes.iter().map(Note::to_string);
    texts.filter(|text| !text.contains("scaled to unit length")).collect()
}

#[track_caller]
fn error(text: &[u8]) -> String {
    let (folder, path) = folder(text);
    let opened = ObjSource::open_by(&path, folder.path(), 16);
    let text = opened.map(drop).unwrap_err().to_string();
    text.split_once("a.obj: ").unwrap().1.to_owned()
}

/// Everything that the format has: forward and negative indices, polygons, continued lines, corners
/// without a texture coordinate, colours of one byte, groups, objects and what is left out.
const ALL: &str = "\u{feff}# all\\\nmtllib a.mtl\ns 1\nf 1 2 3\nv 0 0 0 255 0 0\nv 2 0 0\n\
    v 2 2 \\\n 0 0 128 0\nv 0 2 0 1 2 3\nv 1 .5 0\nvt 0 0\nvt 1 \\\n0\nvt 1 1\nusemtl nowhere\n\
    usemtl stone\no one\nf 1/1 2/2 3/3\nf -5 -4/-1 -2//\nf 1/1 2/2 3/3 4\ng group\nusemtl grass\n\
    f 1 5 2 3 4\nl 1 2\nf 1 2\nusemtl stone\ns off\nf 1/9 \\\n 2/2 3/3\ns odd\nusemtl\nf 1 2 3\n\
    vt .5 .5\nvt nan 1\nvt 0 1\nvt .1 .2\nvt .3 .4\nvt 7 8 9\nv 9 9 9\nf 6 1 2";

#[test]
fn triangles_are_those_of_a_scene() {
    let windows: Vec<usize> = (1..90).chain([WINDOW]).collect();
    for end in ["\n", "\r\n", "\r"] {
        assert_eq!(check_same(ALL.replace('\n', end).as_bytes(), &windows), 11);
    }
}

#[test]
fn normals_and_colours_of_vertices_are_those_of_a_scene() {
    let normals = "v 0 0 0 .5 .5 .5\nv 1 0 0\nv 0 1 0 1 0 0\nv 1 1 0\nvn 0 0 2\nvn 0 .6 .8\n\
                   f 1//1 2//2 3//1\nf 2//1 4//2 3//-1\n";
    check_same(normals.as_bytes(), &[1, 30, WINDOW]);
    let painted = "v 0 0 0\nv 1 0 0\nv 0 1 0\n#MRGB ffff0000ff00ff00\n#MRGB ff0000ffff000000\n\
                   f 1 2 3\nvt 0 0\n";
    check_same(painted.as_bytes(), &[1, 30, WINDOW]);
}

#[test]
fn many_faces_come_some_at_a_time() {
    let mesh = patch(150_000, &[LayerKind::Uv(0)]);
    let mut text = String::new();
    let mut uvs = Vec::new();
    for (vertex, [x, y, z]) in mesh.positions.iter().enumerate() {
        writeln!(text, "v {x} {y} {z}").unwrap();
        uvs.push(format!("vt {x} {}", vertex % 7));
    }
    text += &(uvs.join("\n") + "\nmtllib a.mtl\n");
    for (face, corners) in mesh.faces.iter().enumerate() {
        if face % 1000 == 0 {
            writeln!(text, "usemtl {}", ["stone", "grass"][face / 1000 % 2]).unwrap();
        }
        let [a, b, c] = corners.map(|v| v.0 + 1);
        writeln!(text, "f {a}/{a} {b}/{c} {c}/{b}").unwrap();
    }
    assert_eq!(check_same(text.as_bytes(), &[1 << 16, WINDOW]), mesh.faces.len());
}

#[test]
fn damage_is_named_by_its_line() {
    let head = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let of = |rest: &str| error((head.to_owned() + rest).as_bytes());
    let missing = "a face refers to vertex 9, but there are only 3";
    assert_eq!(of("f 1 2 9\nf 1 2 3\n"), format!("line 5: {missing}"));
    assert_eq!(
        of("\n\nf 1 2 -4\n"),
        "line 7: a face refers to vertex -4, but there are only 3 so far"
    );
    assert_eq!(
        of("f 1/1 2 3\n"),
        "line 5: a face refers to texture coordinate 1, but there is none"
    );
    assert_eq!(of("v 1 nan 0\n"), "line 5: \"nan\" is not a finite number");
    assert_eq!(of("v 1 2"), "line 5: a vertex needs three coordinates");
    assert_eq!(of("f 1 2 3\nf 1 2 x"), "line 6: \"x\" is not an integer");
    assert!(of("#\0").starts_with("byte 33: a zero byte"), "{}", of("#\0"));
    assert_eq!(error(b"v 0 0 0\n"), "line 1: the file ends without faces (1 vertices)");
    assert_eq!(error(b""), "byte 0: the file is empty");
    let long = format!("f{}\n", " 1".repeat(70_000));
    assert!(of(&long).starts_with("line 5: a face of 70000 corners is too large"), "{}", of(&long));
}

#[test]
fn a_change_to_the_file_has_no_effect() {
    let (folder, path) = folder(ALL.as_bytes());
    let (source, _) = ObjSource::open(&path, folder.path()).unwrap();
    let before = all(&source);
    fs::write(&path, "v").unwrap();
    assert!(all(&source) == before);
}

#[test]
fn a_folder_that_is_not_there_is_named() {
    let (folder, path) = folder(ALL.as_bytes());
    let gone = folder.path().join("gone");
    let error = ObjSource::open(&path, &gone).map(drop).unwrap_err().to_string();
    assert!(error.starts_with(&format!("{}: ", gone.display())), "{error}");
}
