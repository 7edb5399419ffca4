use meshlod_mesh::{Labels, LayerKind, Mesh, VertexId};

use super::read;
use crate::Scene;

fn scene(text: &str) -> Scene {
    read(text.as_bytes(), &mut |_| None).unwrap()
}

fn mesh(text: &str) -> Mesh {
    let mesh = scene(text).meshes.remove(0).mesh;
    assert_eq!(mesh.validate(), Ok(()));
    mesh
}

fn error(text: &str) -> String {
    read(text.as_bytes(), &mut |_| None).unwrap_err().to_string()
}

fn labels(names: &[&str], of_face: &[u32]) -> Option<Labels> {
    let names = names.iter().map(|&name| name.to_owned()).collect();
    Some(Labels { names, of_face: of_face.to_vec() })
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn positions_alone_are_a_bare_mesh() {
    let mesh = mesh(&format!("{SQUARE}f 1 2 3 4"));
    assert_eq!(mesh.positions[2], [1.0, 1.0, 0.0]);
    assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3]].map(|face| face.map(VertexId)));
    assert_eq!((mesh.attributes, mesh.materials, mesh.objects), (None, None, None));
}

#[test]
fn blanks_comments_and_line_ends_do_not_matter() {
    let expected = mesh(&format!("{SQUARE}f 1 2 3"));
    for text in [
        "# a\nv 0 0 0 # b\r\n\tv\t1 0\t0\r\n\r\n  v 1 1 0  \nv 0 1 0\n s off\nf 1 2 3# c",
        "\u{feff}v 0. 0e0 -0\rv 1.0 0 0\rv 1 1 0\rv 0 1 0\rf 1 2 3\r",
        "v 0 \\\n0 0\nv 1 0 0\nv 1 1 \\\r\n  0\nv 0 1 0\nf 1 2\\\n 3\n# end \\\n",
        "v 0 0 0 1.0\nv 1 0 0\nvp 1\nv 1 1 0\nv 0 1 0\nl 1 2\np 1\nf +1 02 -2\n",
    ] {
        assert_eq!(mesh(text), expected, "{text}");
    }
}

#[test]
fn negative_indices_count_back_from_where_they_stand() {
    let text = format!("{SQUARE}vt 0 0\nf -4/-1 -3/-1 -2/-1\nv 5 5 5\nf -1 1 2\n");
    assert_eq!(mesh(&text).faces, [[0, 1, 2], [4, 0, 1]].map(|face| face.map(VertexId)));
}

#[test]
fn faces_may_name_what_comes_later() {
    let dart = "v 0 0 0\nv 4 2 0\nv 0 4 0\nv 1 2 0\nvt 0 0\nvt 1 1\n";
    let faces = "f 1/1 2/2 3/1 4/1\nf 1//1 2 3\n";
    let normal = "vn 0 0 1\n";
    let first = mesh(&format!("{dart}{normal}{faces}"));
    assert_eq!(mesh(&format!("{faces}{normal}{dart}")), first);
    assert_eq!(first.faces[0], [0, 1, 3].map(VertexId), "the dart is split at its reflex corner");
    assert_eq!(
        error(&format!("f 1 2 3\nf 1 2 9\n{SQUARE}")),
        "line 2: a face refers to vertex 9, but there are only 4"
    );
}

#[test]
fn wedges_are_one_where_the_values_are() {
    let text = format!(
        "{SQUARE}vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0 0\nvt 0.5 0.5\nvn 0 0 1\nvn 0 0 1\n\
         f 1/1/1 2/2/1 3/3/1\nf 1/5/2 3/6/2 4/4/2\n"
    );
    let mesh = mesh(&text);
    let attributes = mesh.attributes.as_ref().unwrap();
    let corners: Vec<u32> = attributes.corners.as_flattened().iter().map(|w| w.0).collect();
    assert_eq!((attributes.wedge_count, corners[0]), (5, corners[3]));
    let uvs = attributes.layer(LayerKind::Uv(0)).unwrap();
    assert_eq!(uvs.of(attributes.corners[1][1]), [0.5, 0.5]);
    assert_eq!(uvs.of(attributes.corners[0][2]), [1.0, 1.0]);
    assert_eq!(
        attributes.layer(LayerKind::Normal).unwrap().of(attributes.corners[1][2]),
        [0.0, 0.0, 1.0]
    );
}

#[test]
fn corners_without_what_others_have_get_zeros_or_normals_of_faces() {
    let text = format!("{SQUARE}vt 1 1\nvn 0 0 -1\nf 1 2 3\nf 1/1 3//1 4/1/1\nf 1/ 2// 3/1/\n");
    let attributes = mesh(&text).attributes.unwrap();
    let uvs = attributes.layer(LayerKind::Uv(0)).unwrap();
    let normals = attributes.layer(LayerKind::Normal).unwrap();
    let at = |face: usize, corner: usize| {
        let wedge = attributes.corners[face][corner];
        (uvs.of(wedge)[0], normals.of(wedge)[2])
    };
    assert_eq!(
        [at(0, 0), at(1, 0), at(1, 1), at(1, 2)],
        [(0., 1.), (1., 1.), (0., -1.), (1., -1.)]
    );
    assert_eq!([at(2, 0), at(2, 1), at(2, 2)], [(0., 1.), (0., 1.), (1., 1.)]);
}

#[test]
fn colours_belong_to_vertices() {
    let text = "v 0 0 0\nv 1 0 0 1 0 0.5\nv 0 1 0 0 nan 0\nv 1 1 0\nf 1 2 3\n";
    let attributes = mesh(text).attributes.unwrap();
    assert_eq!(attributes.layers[0].kind, LayerKind::Color(0));
    assert_eq!(attributes.layers[0].values, [1., 1., 1., 1., 0., 0.5, 0., 0., 0., 1., 1., 1.]);
    let text = "v 0 0 0 255 0 51 255\nv 1 0 0 0 0 0 255\nv 0 1 0 0 0 0 255\nf 1 2 3\n";
    assert_eq!(mesh(text).attributes.unwrap().layers[0].values[..3], [1.0, 0.0, 0.2]);
}

#[test]
fn objects_are_o_else_g() {
    let faces =
        |names: [&str; 3]| format!("{SQUARE}{}", names.map(|n| format!("{n}f 1 2 3\n")).concat());
    let objects = |names| mesh(&faces(names)).objects;
    assert_eq!(objects(["g a\n", "g b c\n", "g a\n"]), labels(&["a", "b c"], &[0, 1, 0]));
    assert_eq!(objects(["o a\n", "g b\n", "o c\n"]), labels(&["a", "c"], &[0, 0, 1]));
    assert_eq!(objects(["", "o a\n", ""]), labels(&["", "a"], &[0, 1, 1]));
    assert_eq!(objects(["", "", ""]), None);
}

#[test]
fn materials_keep_their_names_without_a_library() {
    let text = format!("mtllib gone.mtl\n{SQUARE}usemtl\nf 1 2 3\nusemtl dark oak\nf 1 3 4\n");
    let scene = scene(&text);
    assert_eq!(scene.meshes[0].mesh.materials, labels(&["", "dark oak"], &[0, 1]));
    assert_eq!(scene.meshes[0].materials, [None, Some(0)]);
    assert_eq!(scene.materials[0].name, "dark oak");
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    for (text, message) in [
        ("v 1 2\n", "line 5: a vertex needs three coordinates"),
        ("v 1 2 nan\n", "line 5: \"nan\" is not a finite number"),
        ("v 1 2 3.1+e2\n", "line 5: \"3.1+e2\" is not a number"),
        ("f 1 2\n", "line 5: a face needs at least three corners, but this one has 2"),
        ("f\n", "line 5: a face needs at least three corners, but this one has 0"),
        ("f 1 2 0\n", "line 5: a face refers to vertex 0, but indices start at 1"),
        ("f 1 2 -5\n", "line 5: a face refers to vertex -5, but there are only 4 so far"),
        ("f 1 2 3\nf 1 2 5\n", "line 6: a face refers to vertex 5, but there are only 4"),
        ("f 1/1 2/1 3/1\n", "line 5: a face refers to texture coordinate 1, but there is none"),
        ("vn 0 0 1\nf 1//1 2//1 3//2\n", "line 6: a face refers to normal 2, but there is only 1"),
        ("f 1 2 99999999999999999999\n", "line 5: \"99999999999999999999\" is not an integer"),
        (
            "vt 0 0\nf 1 2 3/1/1/1\n",
            "line 6: \"/1\" is not a valid part of a corner; write 1, 1/2, 1//3 or 1/2/3",
        ),
        (
            "f 1,2,3\n",
            "line 5: \",2,3\" is not a valid part of a corner; write 1, 1/2, 1//3 or 1/2/3",
        ),
        ("<html>\n", "line 5: \"<html>\" is not an OBJ statement"),
        ("l 1 2\n", "line 5: the file ends without faces (4 vertices)"),
    ] {
        assert_eq!(error(&format!("{SQUARE}{text}")), message);
    }
    assert_eq!(error(""), "byte 0: the file is empty");
}

#[test]
fn a_vertex_with_many_different_corners_is_no_trouble() {
    let mut text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned();
    for i in 0..100_000 {
        text += &format!("vt {i} 0\nf 1/-1 2/-1 3/-1\n");
    }
    assert_eq!(mesh(&text).attributes.unwrap().wedge_count, 300_000);
}

#[test]
fn faces_without_normals_get_those_around_and_are_counted() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1 4 2\n";
    let scene = scene(text);
    let notes: Vec<String> = scene.notes.iter().map(|note| note.to_string()).collect();
    assert_eq!(notes, ["1 of 2 faces that lack normals, computed from the faces around"]);
    let attributes = scene.meshes[0].mesh.attributes.as_ref().unwrap();
    let normals = attributes.layer(LayerKind::Normal).unwrap();
    let at = |face: usize| attributes.corners[face].map(|wedge| normals.of(wedge).to_vec());
    assert_eq!(at(0), [[1.0, 0.0, 0.0]; 3].map(Vec::from), "those of the file stay");
    assert_eq!(at(1), [[0.0, 1.0, 0.0]; 3].map(Vec::from));
}
