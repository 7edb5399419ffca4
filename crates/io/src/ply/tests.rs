use meshlod_fixtures::{shared_mesh, tetrahedron};
use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh, VertexId, WedgeId};
use proptest::prelude::*;

use super::write::write_scene;
use super::{read, read_scene, write};
use crate::Precision;

const HEAD: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
                    property float z\nelement face 1\nproperty list uchar int vertex_indices\n\
                    end_header\n";
const SQUARE: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

fn message(bytes: impl AsRef<[u8]>) -> String {
    let message = read(bytes.as_ref()).expect_err("this is no mesh").to_string();
    assert!(!message.contains('\n'), "one line: {message}");
    message
}

fn written(mesh: &Mesh, precision: Precision) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(mesh, precision, &mut bytes).expect("memory takes everything");
    bytes
}

/// A header, and a body of numbers in any binary order.
fn binary(big: bool, header: &str, body: &[&[u8]]) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut bytes =
        format!("ply\nformat binary_{order}_endian 1.0\n{header}end_header\n").into_bytes();
    for little in body {
        let mut number = little.to_vec();
        if big {
            number.reverse();
        }
        bytes.extend(number);
    }
    bytes
}

/// The tetrahedron with a layer over wedges, one per vertex or one per corner.
fn with_layer(kind: LayerKind, width: usize, per_corner: bool) -> Mesh {
    let mut mesh = tetrahedron();
    let wedge = |face: usize, corner: usize| match per_corner {
        true => WedgeId::new(3 * face + corner),
        false => WedgeId(mesh.faces[face][corner].0),
    };
    let corners: Vec<_> =
        (0..mesh.faces.len()).map(|face| [0, 1, 2].map(|corner| wedge(face, corner))).collect();
    let wedge_count = if per_corner { 3 * mesh.faces.len() } else { mesh.positions.len() };
    // Multiples of 1/255, which bytes hold.
    let values = (0..wedge_count * width).map(|i| (i % 256) as f32 / 255.0).collect();
    let layer = Layer { kind, name: "heat".into(), width, values };
    mesh.attributes = Some(Attributes { corners, wedge_count, layers: vec![layer] });
    mesh
}

const KINDS: [(LayerKind, usize); 12] = [
    (LayerKind::Normal, 3),
    (LayerKind::Uv(0), 2),
    (LayerKind::Uv(3), 2),
    (LayerKind::Color(0), 3),
    (LayerKind::Color(0), 4),
    (LayerKind::Color(11), 4),
    (LayerKind::Tangent, 4),
    (LayerKind::Joints(0), 4),
    (LayerKind::Weights(1), 4),
    (LayerKind::Other, 1),
    (LayerKind::Other, 2),
    (LayerKind::Other, 7),
];

#[test]
fn every_kind_of_layer_comes_back() {
    for (kind, width) in KINDS {
        let mesh = with_layer(kind, width, false);
        let back = read(&written(&mesh, Precision::F64)).unwrap();
        let (layer, came) =
            (&mesh.attributes.as_ref().unwrap().layers[0], back.attributes.as_ref().unwrap());
        assert_eq!((&back.positions, &back.faces), (&mesh.positions, &mesh.faces));
        assert_eq!(came.layers.len(), 1, "{kind:?}");
        assert_eq!((came.layers[0].kind, came.layers[0].width), (kind, width));
        assert_eq!(came.layers[0].values, layer.values, "{kind:?}");
        if kind == LayerKind::Other {
            assert_eq!(came.layers[0].name, "heat");
        }
    }
}

#[test]
fn seams_are_torn_and_every_corner_keeps_its_place_and_values() {
    let mesh = with_layer(LayerKind::Normal, 3, true);
    let back = read(&written(&mesh, Precision::F64)).unwrap();
    assert_eq!(back.positions.len(), 12);
    let (then, now) = (mesh.attributes.as_ref().unwrap(), back.attributes.as_ref().unwrap());
    for face in 0..mesh.faces.len() {
        assert_eq!(mesh.triangle(mesh.faces[face]), back.triangle(back.faces[face]));
        for corner in 0..3 {
            let value = |a: &Attributes| a.layers[0].of(a.corners[face][corner]).to_vec();
            assert_eq!(value(then), value(now));
        }
    }
}

#[test]
fn bare_meshes_have_no_attributes_and_unused_vertices_stay() {
    let mut mesh = tetrahedron();
    mesh.positions.push([9.0; 3]);
    assert_eq!(read(&written(&mesh, Precision::F32)).unwrap(), mesh);
}

#[test]
fn precision_is_kept_or_rounded_as_asked() {
    let mut mesh = tetrahedron();
    mesh.positions[0] = [0.1, 1e-300, 123_456_789.123];
    assert_eq!(read(&written(&mesh, Precision::F64)).unwrap(), mesh);
    let rounded = read(&written(&mesh, Precision::F32)).unwrap();
    assert_eq!(rounded.positions[0], mesh.positions[0].map(|x| f64::from(x as f32)));
}

#[test]
fn what_cannot_be_written_is_refused_before_anything_is() {
    let refused = |mesh: &Mesh| {
        let mut out = Vec::new();
        let error = write(mesh, Precision::F32, &mut out).unwrap_err().to_string();
        assert!(out.is_empty());
        error
    };
    let mut large = tetrahedron();
    large.positions[2][1] = 1e39;
    assert!(refused(&large).starts_with("vertex 2 at"));
    let mut bad = tetrahedron();
    bad.faces[1][0] = VertexId(4);
    assert_eq!(refused(&bad), "face f1 names vertex v4, but there are only 4 vertices");
    let mut shared = with_layer(LayerKind::Uv(0), 2, true);
    shared.attributes.as_mut().unwrap().corners[0] = [WedgeId(0); 3];
    assert!(refused(&shared).contains("uses wedge w0 at"));
}

#[test]
fn text_and_both_byte_orders_hold_the_same_mesh() {
    let header = "element vertex 3\nproperty double z\nproperty double x\nproperty float heat\n\
                  property double y\nelement face 1\nproperty uchar flag\n\
                  property list ushort short vertex_index\n";
    let floats = [[3f64, 1.0, 2.0], [6.0, 4.0, 5.0], [9.0, 7.0, 8.5]];
    let zxy = floats.map(|v| v.map(f64::to_le_bytes));
    let heat = 0.25f32.to_le_bytes();
    let mut body: Vec<&[u8]> = Vec::new();
    for [z, x, y] in &zxy {
        body.extend([&z[..], x, &heat, y]);
    }
    body.extend([&[7u8][..], &[3, 0], &[0, 0], &[1, 0], &[2, 0]]);
    let text = format!(
        "ply\nformat ascii 1.0\n{header}end_header\n3 1 .25 2\n6 4 .25 5\n9 7 0.25 8.5\n7 3 0 1 2\n"
    );
    let mesh = read(text.as_bytes()).unwrap();
    assert_eq!(mesh.positions, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.5, 9.0]]);
    assert_eq!(mesh.attributes.as_ref().unwrap().layers[0].values, [0.25; 3]);
    assert_eq!(read(&binary(false, header, &body)).unwrap(), mesh);
    assert_eq!(read(&binary(true, header, &body)).unwrap(), mesh);
}

#[test]
fn quick_and_careful_ways_agree_in_both_byte_orders() {
    // A second property of the face keeps the quick way out.
    let vertex = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    let face = "element face 1\nproperty list uchar int vertex_indices\n";
    let flag = "property uchar flag\n";
    let coordinates = [1f32, 2.0, 3.0, -4.0, 5.0, 6.0, 7.0, 8.0, 1e-9].map(f32::to_le_bytes);
    let indices = [2u32, 0, 1].map(u32::to_le_bytes);
    let mut body: Vec<&[u8]> = coordinates.iter().map(|x| &x[..]).collect();
    body.push(&[3]);
    body.extend(indices.iter().map(|i| &i[..]));
    let quick = read(&binary(false, &[vertex, face].concat(), &body)).unwrap();
    assert_eq!(read(&binary(true, &[vertex, face].concat(), &body)).unwrap(), quick);
    body.push(&[1]);
    let mut careful = read(&binary(false, &[vertex, face, flag].concat(), &body)).unwrap();
    assert_eq!(careful.face_layers.pop().unwrap().values, [1.0]);
    assert_eq!(careful, quick);
    assert_eq!(quick.faces, [[VertexId(2), VertexId(0), VertexId(1)]]);
    assert_eq!(quick.positions[1], [-4.0, 5.0, 6.0]);
}

#[test]
fn triangles_behind_a_polygon_keep_their_order() {
    let text = HEAD.replace("face 1", "face 4") + SQUARE + "3 0 1 2\n4 0 1 2 3\n2 0 1\n3 2 3 0\n";
    let mesh = read(text.as_bytes()).unwrap();
    assert_eq!(mesh.faces.len(), 4);
    assert_eq!(mesh.faces[3], [VertexId(2), VertexId(3), VertexId(0)]);
}

#[test]
fn strips_turn_every_second_triangle_and_begin_anew_after_a_restart() {
    let head = HEAD.replace("element face", "element tristrips");
    let text = head + SQUARE + "9 0 1 2 3 3 -1 1 2 3\n";
    let ids = [[0, 1, 2], [2, 1, 3], [1, 2, 3]].map(|face| face.map(VertexId));
    assert_eq!(read(text.as_bytes()).unwrap().faces, ids);
}

#[test]
fn faces_may_stand_before_the_vertices_and_other_elements_anywhere() {
    let text = "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\n\
                element camera 2\nproperty list uchar float view\nproperty int id\n\
                element nothing 1000000000000\n\
                element vertex 4\nproperty float x\nproperty float y\nproperty float z\nend_header\n\
                4 0 1 2 3\n2 0.5 0.5 7\n0 8\n";
    let mesh = read((text.to_owned() + SQUARE).as_bytes()).unwrap();
    assert_eq!((mesh.positions.len(), mesh.faces.len()), (4, 2));
}

#[test]
fn bytes_become_colours_from_0_to_1() {
    let head = HEAD.replace(
        "property float z\n",
        "property float z\nproperty uchar red\nproperty uchar green\nproperty ushort blue\n",
    );
    let square = SQUARE.replace('\n', " 255 51 65535\n");
    let mesh = read((head + &square + "3 0 1 2\n").as_bytes()).unwrap();
    let color = mesh.attributes.unwrap().layer(LayerKind::Color(0)).unwrap().values[..3].to_vec();
    assert_eq!(color, [1.0, 0.2, 1.0]);
}

#[test]
fn rows_may_wrap_and_lines_may_be_blank_or_end_in_cr() {
    let text = HEAD.to_owned() + "0 0\n0\n\n" + &SQUARE[6..] + "3 0 1 2";
    let mesh = read(text.as_bytes()).unwrap();
    assert_eq!(read(text.replace('\n', "\r\n").as_bytes()).unwrap(), mesh);
    assert_eq!(read(text.replace('\n', "\r").as_bytes()).unwrap(), mesh);
}

#[test]
fn errors_in_text_name_the_line_and_the_row() {
    let with = |body: &str| message(HEAD.to_owned() + body);
    let cases = [
        ("0 0 0\n1 0\n", "line 12: the file ends inside vertex 1 of 4"),
        ("0 0 zero\n", "line 10: vertex 0 of 4: \"zero\" is not a number"),
        (
            "0 0 0\n0 nan 0\n",
            "line 11: vertex 1 has a coordinate that is not finite: [0.0, NaN, 0.0]",
        ),
        (
            "0 0 0 1\n",
            "line 10: too many numbers after vertex 0 of 4: this line or the one before it \
             does not match the properties in the header",
        ),
    ];
    for (body, expected) in cases {
        assert_eq!(with(body), expected);
    }
    let faces = [
        (
            "3 0 1 4\n",
            "line 14: face 0 of 1 refers to vertex 4, but there are only 4, counted from 0",
        ),
        (
            "3 0 1 -1\n",
            "line 14: face 0 of 1 refers to vertex -1, but there are only 4, counted from 0",
        ),
        ("300 0 1 2\n", "line 14: face 0 of 1: \"300\" is not an integer from 0 to 255"),
        (
            "99 0 1 2\n",
            "line 14: face 0 of 1 has a list of 99 values, but the file ends before that",
        ),
        ("2 0 1\n", "header: no faces: no face has three corners"),
        ("", "line 14: the file ends inside face 0 of 1"),
    ];
    for (body, expected) in faces {
        assert_eq!(with(&(SQUARE.to_owned() + body)), expected);
    }
}

#[test]
fn errors_in_binary_name_the_byte_and_the_row() {
    let mut whole = written(&tetrahedron(), Precision::F32);
    let end = whole.len();
    assert_eq!(
        message(&whole[..end - 1]),
        format!(
            "byte {}: face 3 of 4 has a list of 3 values, but the file ends before that",
            end - 13
        )
    );
    let vertices = end - 4 * 13 - 4 * 12;
    assert_eq!(
        message(&whole[..vertices + 13]),
        format!("byte {}: the file ends inside vertex 1 of 4", vertices + 13)
    );
    whole[end - 4] = 4;
    assert!(
        message(&whole).starts_with(&format!("byte {}: face 3 of 4 refers to vertex 4,", end - 13))
    );
    whole[end - 1] = 0x80;
    assert!(
        message(&whole).starts_with(&format!("byte {}: face 3 of 4 refers to vertex -", end - 13))
    );
    whole[vertices + 12..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    assert!(message(&whole).starts_with(&format!("byte {}: vertex 1 has a coord", vertices + 12)));
}

#[test]
fn claims_take_no_memory() {
    for format in ["ascii", "binary_little_endian"] {
        for (vertices, faces) in
            [("1000000000000", "1"), ("4000000000", "1"), ("0", "18446744073709551615")]
        {
            let head =
                HEAD.replace("ascii", format).replace("vertex 4", &format!("vertex {vertices}"));
            message(head.replace("face 1", &format!("face {faces}")) + "0 0 0 0 0 0 0 0");
        }
    }
    let list = HEAD.replace("ascii", "binary_big_endian").replace("list uchar", "list int");
    let list = list.replace("vertex 4", "vertex 0");
    let mut bytes = list.into_bytes();
    bytes.extend(i32::MAX.to_be_bytes());
    assert!(message(&bytes).contains("has a list of 2147483647 values, but the file ends"));
    let end = bytes.len() - 4;
    bytes[end..].copy_from_slice(&(-5i32).to_be_bytes());
    assert!(message(&bytes).contains("has a list of negative length -5"));
}

#[test]
fn what_is_missing_is_named() {
    assert_eq!(
        message(HEAD.replace("float y", "float why")),
        "header: element vertex has no scalar property y"
    );
    assert_eq!(
        message(HEAD.replace("vertex_indices", "corners") + SQUARE),
        "header: element face has no list vertex_indices"
    );
    let headless = HEAD.replace("element face 1\n", "");
    assert!(message(headless).contains("a line \"element face\""));
}

#[test]
fn attributes_that_are_not_finite_are_read_as_0_and_counted() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nproperty double heat\nproperty float nx\nproperty float ny\n\
        property float nz\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0 1 0 0 1\n1 0 0 1e60 0 nan 1\n0 1 0 nan 0 0 1\n3 0 1 2\n2 0 1\n";
    let scene = read_scene(text.as_bytes(), &mut |_| None).unwrap();
    let notes: Vec<String> = scene.notes.iter().map(|note| note.to_string()).collect();
    assert_eq!(
        notes,
        [
            "1 face of fewer than three corners",
            "2 values of attributes that are not finite read as 0",
        ]
    );
    let layers = scene.into_mesh().attributes.unwrap().layers;
    assert_eq!(layers[0].values, [1.0, 0.0, 0.0]);
    assert_eq!(layers[1].values, [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn integers_of_64_bits_are_read_and_written_as_such() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nproperty int64 label\nproperty uint64 lab\nelement face 1\n\
        property list uint64 int64 vertex_indices\nproperty int64 number\nend_header\n\
        0 0 0 -1 1\n1 0 0 7 2\n0 1 0 7 3\n3 0 1 2 9007199254740993\n";
    let scene = read_scene(text.as_bytes(), &mut |_| None).unwrap();
    let notes: Vec<String> = scene.notes.iter().map(|note| note.to_string()).collect();
    assert_eq!(notes, ["1 64-bit integer rounded to 53 bits"]);
    let mut file = Vec::new();
    write_scene(&scene, Precision::Auto, &mut file).unwrap();
    let back = read_scene(&file, &mut |_| None).unwrap();
    let header = String::from_utf8_lossy(&file).into_owned();
    assert!(header.contains("property int64 label\nproperty uint64 lab\n"), "{header}");
    let kinds: Vec<LayerKind> =
        back.meshes[0].mesh.attributes.as_ref().unwrap().layers.iter().map(|l| l.kind).collect();
    assert_eq!(kinds, [LayerKind::Label, LayerKind::Other]);
    assert_eq!(back.into_mesh().attributes, scene.into_mesh().attributes);
}

#[test]
fn colours_of_other_names_keep_their_type() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nproperty float r\nproperty float g\nproperty float b\nelement face 1\n\
        property list uchar int vertex_indices\nproperty uchar diffuse_red\n\
        property uchar diffuse_green\nproperty uchar diffuse_blue\nend_header\n\
        0 0 0 .3 0 1\n1 0 0 .7 0 1\n0 1 0 .001 0 1\n3 0 1 2 255 0 51\n";
    let scene = read_scene(text.as_bytes(), &mut |_| None).unwrap();
    assert!(scene.notes[0].to_string().contains("colour of a face, as vertices have colours"));
    let mut file = Vec::new();
    write_scene(&scene, Precision::Auto, &mut file).unwrap();
    let header = String::from_utf8_lossy(&file).into_owned();
    assert!(header.contains("property float red\nproperty float green\n"), "{header}");
    let at_faces = text.replace("property float r\n", "property float k\n");
    let mesh = read_scene(at_faces.as_bytes(), &mut |_| None).unwrap().into_mesh();
    let attributes = mesh.attributes.unwrap();
    let color = attributes.layer(LayerKind::Color(0)).unwrap();
    assert_eq!(color.of(attributes.corners[0][0]), [1.0, 0.0, 0.2]);
}

#[test]
fn shared_meshes_have_the_counts_of_their_table() {
    let table = [
        ("armadillo-173k.ply", 86_488, 172_972),
        ("armadillo-52k.ply", 26_002, 52_000),
        ("buddha-100k.ply", 49_950, 100_000),
        ("bunny-closed.ply", 37_706, 75_408),
        ("bunny-zipper-ascii.ply", 35_947, 69_451),
        ("bunny.ply", 35_947, 69_451),
        ("dolphins.ply", 855, 1689),
        ("dragon-100k.ply", 50_000, 100_000),
        ("dragon.ply", 437_645, 871_414),
        ("fandisk-32k.ply", 15_843, 31_682),
        ("feline.ply", 49_864, 99_732),
        ("fish-blub.ply", 10_786, 21_568),
        ("horse-97k.ply", 48_485, 96_966),
        ("horse.ply", 19_851, 39_698),
        ("igea-tristrips.ply", 134_345, 268_686),
        ("igea.ply", 134_345, 268_686),
        ("lucy-100k.ply", 49_987, 99_970),
        ("nefertiti.ply", 49_971, 99_938),
        ("terrain-jacksboro.ply", 138_632, 275_772),
        ("xyzrgb-dragon-28k.ply", 14_101, 28_198),
        ("broken/binary-crlf-header.ply", 8, 12),
        // Six quads.
        ("broken/binary-data-starts-with-newline.ply", 8, 12),
        ("broken/cow-flipped-edges.ply", 2903, 5804),
        ("broken/shark.ply", 468, 734),
    ];
    for (name, vertices, faces) in table {
        let Some(path) = shared_mesh(name) else { continue };
        let mesh = read(&std::fs::read(path).unwrap()).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!((mesh.positions.len(), mesh.faces.len()), (vertices, faces), "{name}");
        mesh.validate().unwrap();
    }
}

#[test]
fn the_same_mesh_as_strips_and_faces_and_as_text_and_binary() {
    let load = |name| Some(read(&std::fs::read(shared_mesh(name)?).unwrap()).unwrap());
    if let (Some(strips), Some(faces)) = (load("igea-tristrips.ply"), load("igea.ply")) {
        assert_eq!(strips, faces);
    }
    if let (Some(text), Some(binary)) = (load("bunny-zipper-ascii.ply"), load("bunny.ply")) {
        assert_eq!((&text.positions, &text.faces), (&binary.positions, &binary.faces));
        let layers = text.attributes.unwrap().layers;
        let names: Vec<_> = layers.iter().map(|layer| layer.name.as_str()).collect();
        assert_eq!(names, ["confidence", "intensity"]);
    }
}

#[test]
fn broken_files_give_one_clear_line() {
    let table = [
        ("zero-bytes.ply", "byte 0: the file is empty"),
        ("bad-header.ply", "line 7: unknown type"),
        ("header-only.ply", "header: the file declares no element vertex"),
        ("no-elements-binary.ply", "header: no faces: no face has three corners"),
        ("issue623.ply", "header: no faces: the list vertex_indices belongs to the element vertex"),
        ("cow-newline-damaged-big-endian.ply", "byte "),
    ];
    for (name, beginning) in table {
        let Some(path) = shared_mesh(&format!("broken/{name}")) else { continue };
        let message = message(std::fs::read(path).unwrap());
        assert!(message.starts_with(beginning), "{name}: {message}");
    }
}

prop_compose! {
    fn any_mesh()(
        positions in prop::collection::vec(prop::array::uniform3(-1e30f64..1e30), 1..20),
    )(
        faces in prop::collection::vec(prop::array::uniform3(0..positions.len() as u32), 1..30),
        (kind, width) in prop::sample::select(&KINDS[..]),
        bytes in prop::collection::vec(0u8..=255, 20 * 7),
        positions in Just(positions),
    ) -> Mesh {
        let wedge_count = positions.len();
        let values = bytes[..wedge_count * width].iter().map(|&b| f32::from(b) / 255.0).collect();
        let layer = Layer { kind, name: "heat".into(), width, values };
        let corners = faces.iter().map(|face| face.map(WedgeId)).collect();
        let mut mesh = Mesh::new(positions, faces.iter().map(|f| f.map(VertexId)).collect());
        mesh.attributes = Some(Attributes { corners, wedge_count, layers: vec![layer] });
        mesh
    }
}

proptest! {
    #[test]
    fn any_mesh_comes_back(mesh in any_mesh()) {
        let mut back = read(&written(&mesh, Precision::F64)).unwrap();
        // Names of the known kinds are free.
        back.attributes.as_mut().unwrap().layers[0].name = "heat".into();
        prop_assert_eq!(back, mesh);
    }

    #[test]
    fn changed_bytes_give_a_mesh_or_a_line(
        mesh in any_mesh(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        kept in any::<prop::sample::Index>(),
    ) {
        let mut bytes = written(&mesh, Precision::F32);
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        for bytes in [&bytes[..], &bytes[..kept.index(bytes.len())]] {
            match read(bytes) {
                Ok(mesh) => prop_assert_eq!(mesh.validate(), Ok(())),
                Err(error) => prop_assert!(!error.to_string().contains('\n')),
            }
        }
    }

    #[test]
    fn changed_text_gives_a_mesh_or_a_line(
        changes in prop::collection::vec((any::<prop::sample::Index>(), prop::sample::select(&b" \n-0.9exply"[..])), 1..6),
    ) {
        let mut bytes = (HEAD.to_owned() + SQUARE + "4 0 1 2 3\n").into_bytes();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        match read(&bytes) {
            Ok(mesh) => prop_assert_eq!(mesh.validate(), Ok(())),
            Err(error) => prop_assert!(!error.to_string().contains('\n')),
        }
    }
}

#[test]
fn bytes_behind_the_last_row_are_counted_and_white_space_is_not() {
    let notes = |bytes: &[u8]| -> Vec<String> {
        let scene = super::read_scene(bytes, &mut |_| None).unwrap();
        scene.notes.iter().map(ToString::to_string).collect()
    };
    let text = format!("{HEAD}{SQUARE}3 0 1 2\n\n");
    assert_eq!(notes(text.as_bytes()), [""; 0]);
    let behind = ["9 bytes behind the last row"];
    assert_eq!(notes(format!("{text}5 6\n7 8 9\n").as_bytes()), behind);
    let mesh = tetrahedron();
    assert_eq!(notes(&[&written(&mesh, Precision::F32)[..], b"\r\n"].concat()), [""; 0]);
    assert_eq!(notes(&[&written(&mesh, Precision::F32)[..], b"not a row"].concat()), behind);
}
