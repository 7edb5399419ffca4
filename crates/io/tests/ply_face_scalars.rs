//! Scalars of PLY faces: every type, in every encoding, there and back.

use meshlod_io::{Format, Note, Precision, Scene, ply};
use meshlod_mesh::{FaceLayer, FaceLayerKind};

/// Types of PLY with the least and the greatest value, and one that the next narrower type lacks.
const TYPES: [(&str, [f64; 3]); 8] = [
    ("char", [-128.0, 127.0, -1.0]),
    ("uchar", [0.0, 255.0, 128.0]),
    ("short", [-32768.0, 32767.0, -129.0]),
    ("ushort", [0.0, 65535.0, 32768.0]),
    ("int", [-2147483648.0, 2147483647.0, 16777217.0]),
    ("uint", [0.0, 4294967295.0, 2147483648.0]),
    ("float", [f32::MIN as f64, f32::MAX as f64, -0.5]),
    ("double", [f64::MIN, f64::MAX, 0.1]),
];

const FORMATS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

/// Writer of rows in one of the formats.
struct Rows {
    format: &'static str,
    bytes: Vec<u8>,
}

impl Rows {
    fn put(&mut self, kind: &str, value: f64) {
        if self.format == "ascii" {
            return self.bytes.extend(format!("{value} ").bytes());
        }
        let mut raw = match kind {
            "char" => vec![value as i8 as u8],
            "uchar" => vec![value as u8],
            "short" => (value as i16).to_le_bytes().to_vec(),
            "ushort" => (value as u16).to_le_bytes().to_vec(),
            "int" => (value as i32).to_le_bytes().to_vec(),
            "uint" => (value as u32).to_le_bytes().to_vec(),
            "float" => (value as f32).to_le_bytes().to_vec(),
            _ => value.to_le_bytes().to_vec(),
        };
        if self.format == "binary_big_endian" {
            raw.reverse();
        }
        self.bytes.extend(raw);
    }

    fn end(&mut self) {
        if self.format == "ascii" {
            self.bytes.push(b'\n');
        }
    }
}

/// A tetrahedron, of which three faces have the values of every type.
fn file(format: &'static str) -> Vec<u8> {
    let mut header = format!(
        "ply\nformat {format} 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
         property float z\nelement face 3\n"
    );
    TYPES[..4].iter().for_each(|(kind, _)| header += &format!("property {kind} of_{kind}\n"));
    header += "property list uchar int vertex_indices\nproperty list uchar short around\n";
    TYPES[4..].iter().for_each(|(kind, _)| header += &format!("property {kind} of_{kind}\n"));
    header += "end_header\n";
    let mut rows = Rows { format, bytes: header.into_bytes() };
    for x in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
        x.into_iter().for_each(|x| rows.put("float", x));
        rows.end();
    }
    for (i, face) in [[0.0, 2.0, 1.0], [0.0, 1.0, 3.0], [1.0, 2.0, 3.0]].into_iter().enumerate() {
        TYPES[..4].iter().for_each(|(kind, values)| rows.put(kind, values[i]));
        rows.put("uchar", 3.0);
        face.into_iter().for_each(|vertex| rows.put("int", vertex));
        rows.put("uchar", 1.0);
        rows.put("short", 5.0);
        TYPES[4..].iter().for_each(|(kind, values)| rows.put(kind, values[i]));
        rows.end();
    }
    rows.bytes
}

fn read(bytes: &[u8]) -> Scene {
    ply::read_scene(bytes, &mut |_| None).unwrap()
}

fn written(scene: &Scene) -> Vec<u8> {
    let mut bytes = Vec::new();
    ply::write_scene(scene, Precision::Auto, &mut bytes).unwrap();
    bytes
}

fn layers(scene: &Scene) -> &[FaceLayer] {
    &scene.meshes[0].mesh.face_layers
}

fn notes(scene: &Scene) -> Vec<String> {
    scene.notes.iter().map(Note::to_string).collect()
}

#[test]
fn scalars_of_every_type_come_back_from_every_encoding() {
    for format in FORMATS {
        let scene = read(&file(format));
        assert_eq!(notes(&scene), ["1 list of vertices or faces (around)"], "{format}");
        let other = |name: String, values: [f64; 3]| FaceLayer {
            kind: FaceLayerKind::Other,
            name,
            values: values.to_vec(),
        };
        let expected = TYPES.map(|(kind, values)| other(format!("of_{kind}"), values));
        assert_eq!(layers(&scene), expected, "{format}");
        assert!(scene.limits_of(Format::Ply).is_empty(), "{format}");
        let bytes = written(&scene);
        let text = String::from_utf8_lossy(&bytes);
        for (kind, _) in TYPES {
            assert!(text.contains(&format!("\nproperty {kind} of_{kind}\n")), "{format}: {kind}");
        }
        let back = read(&bytes);
        assert_eq!(layers(&back), expected, "{format}");
        assert!(back.notes.is_empty());
        assert_eq!(written(&back), bytes);
    }
}

#[test]
fn other_formats_count_and_name_them() {
    let scene = read(&file("ascii"));
    for (_, format) in Format::ALL.into_iter().filter(|&(_, format)| format != Format::Ply) {
        let lost: Vec<String> = scene.limits_of(format).iter().map(Note::to_string).collect();
        let names =
            "(of_char, of_double, of_float, of_int, of_short, of_uchar, of_uint, of_ushort)";
        assert_eq!(lost, [format!("8 properties of faces {names}")], "{format:?}");
    }
}

/// A file of two squares, a polygon each, and a strip, with these properties and values.
fn polygons(face: &str, strip: &str, rows: [&str; 3]) -> Vec<u8> {
    let [a, b, c] = rows;
    let points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 0\n2 1 0\n0 2 0\n1 2 0\n";
    format!(
        "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n\
         property float z\nelement face 2\nproperty list uchar int vertex_indices\n{face}\
         element tristrips 1\nproperty list int int vertex_indices\n{strip}end_header\n{points}\
         4 0 1 2 3 {a}\n4 1 4 5 2 {b}\n4 3 2 6 7 {c}\n"
    )
    .into_bytes()
}

#[test]
fn every_triangle_of_a_polygon_or_strip_has_its_values() {
    let scalar = |kind: &str, name: &str| format!("property {kind} {name}\n");
    let (uchar, double) = (scalar("uchar", "a"), scalar("double", "a") + &scalar("int", "b"));
    let scene = read(&polygons(&uchar, &double, ["7", "9", "0.25 -3"]));
    let found: Vec<_> = layers(&scene).iter().map(|l| (&*l.name, &*l.values)).collect();
    let expected =
        [("a", &[7.0, 7.0, 9.0, 9.0, 0.25, 0.25][..]), ("b", &[0.0, 0.0, 0.0, 0.0, -3.0, -3.0])];
    assert_eq!(found, expected);
    // Bytes do not hold the values of the strip.
    let bytes = written(&scene);
    assert!(String::from_utf8_lossy(&bytes).contains("\nproperty float a\nproperty int b\n"));
    assert_eq!(layers(&read(&bytes)), layers(&scene));
}

#[test]
fn numbers_that_are_none_are_zero_and_noted() {
    let scene = read(&polygons("property double a\n", "", ["nan", "-inf", ""]));
    assert_eq!(layers(&scene)[0].values, [0.0; 6]);
    assert_eq!(notes(&scene), ["2 values of faces that are not finite read as 0"]);
}

#[test]
fn names_that_other_properties_need_are_changed() {
    let mut scene = read(&polygons("property int label\n", "", ["1", "2", ""]));
    let names = ["texnumber", "label", "two words", "two_words"];
    scene.meshes[0].mesh.face_layers = names
        .map(|name| FaceLayer {
            kind: FaceLayerKind::Other,
            name: name.to_owned(),
            values: vec![0.5; 6],
        })
        .to_vec();
    let back = read(&written(&scene));
    let found: Vec<&str> = layers(&back).iter().map(|layer| &*layer.name).collect();
    assert_eq!(found, ["texnumber_", "label_", "two_words", "two_words_"]);
    assert_eq!(back.meshes[0].mesh.objects, scene.meshes[0].mesh.objects);
}

#[test]
fn polygons_of_many_corners_do_not_multiply_the_file() {
    // A polygon of 20,000 corners with 100 values would be 2 million.
    let corners = 20_000;
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {corners}\nproperty float x\nproperty float y\n\
         property float z\nelement face 1\nproperty list int int vertex_indices\n"
    );
    (0..100).for_each(|i| text += &format!("property uchar a{i}\n"));
    text += "end_header\n";
    for i in 0..corners {
        let angle = f64::from(i) / f64::from(corners) * std::f64::consts::TAU;
        text += &format!("{} {} 0\n", angle.cos(), angle.sin());
    }
    text += &format!("{corners}");
    (0..corners).for_each(|i| text += &format!(" {i}"));
    text += &" 1".repeat(100);
    let scene = read(text.as_bytes());
    assert!(layers(&scene).is_empty());
    let note = "100 properties of faces whose polygons have too many corners (a0, a1, ";
    assert!(notes(&scene)[0].starts_with(note), "{:?}", notes(&scene));
}
