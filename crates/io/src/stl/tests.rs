use meshlod_fixtures::{shared_mesh, tetrahedron, two_objects};
use meshlod_mesh::{Mesh, VertexId};
use proptest::prelude::*;

use super::{read, read_scene, write, write_ascii, write_scene};
use crate::{Format, Precision, Scene};

const FACET: &str = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
                     endloop\nendfacet\n";

fn message(bytes: impl AsRef<[u8]>) -> String {
    let message = read(bytes.as_ref()).expect_err("this is no mesh").to_string();
    assert!(!message.contains('\n'), "one line: {message}");
    message
}

fn binary(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(mesh, &mut bytes).expect("memory takes everything");
    bytes
}

fn text(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_ascii(mesh, Precision::F64, &mut bytes).expect("memory takes everything");
    bytes
}

/// The corner positions of every face: what STL keeps.
fn corners(mesh: &Mesh) -> Vec<[[f64; 3]; 3]> {
    mesh.faces.iter().map(|face| face.map(|v| mesh.positions[v.index()])).collect()
}

#[test]
fn both_kinds_come_back_with_their_vertices_joined() {
    let mesh = tetrahedron();
    for bytes in [binary(&mesh), text(&mesh)] {
        let back = read(&bytes).unwrap();
        assert_eq!(corners(&back), corners(&mesh));
        assert_eq!(back.positions.len(), 4);
    }
}

#[test]
fn objects_become_solids_and_come_back() {
    let mesh = two_objects();
    let back = read(&text(&mesh)).unwrap();
    assert_eq!(back.objects, mesh.objects);
    assert_eq!(corners(&back), corners(&mesh));
}

#[test]
fn minus_zero_and_zero_are_one_place() {
    let minus =
        FACET.replace("vertex 0 0 0", "vertex -0 0 -0.0").replace("vertex 0 1 0", "vertex 0 2 0");
    let mesh = read(format!("solid\n{FACET}{minus}endsolid\n").as_bytes()).unwrap();
    assert_eq!(mesh.positions.len(), 4);
    assert!(mesh.positions.iter().flatten().all(|x| x.is_sign_positive()));
}

#[test]
fn facets_whose_corners_meet_stay() {
    let point = FACET.replace("vertex 1 0 0", "vertex 0 0 0");
    let mesh = read(format!("solid\n{point}endsolid\n").as_bytes()).unwrap();
    assert_eq!(mesh.faces, [[VertexId(0), VertexId(0), VertexId(1)]]);
}

#[test]
fn a_binary_file_may_begin_with_solid() {
    let mut bytes = binary(&tetrahedron());
    bytes[..80].fill(b' ');
    bytes[..10].copy_from_slice(b"solid made");
    assert_eq!(read(&bytes).unwrap().faces.len(), 4);
    // With bytes behind its facets only what stands in them tells.
    bytes.extend(b"more");
    assert_eq!(read(&bytes).unwrap().faces.len(), 4);
}

#[test]
fn an_open_count_is_that_of_the_facets_there() {
    let mesh = tetrahedron();
    for count in [0u32, u32::MAX] {
        let mut bytes = binary(&mesh);
        bytes[80..84].copy_from_slice(&count.to_le_bytes());
        let scene = read_scene(&bytes).unwrap();
        assert_eq!(scene.meshes[0].mesh.faces.len(), mesh.faces.len());
        let note = scene.notes[0].to_string();
        assert!(note.contains("taken from the length of the file"), "{note}");
        let none = message(&bytes[..84]);
        assert!(none.contains("facet"), "{none}");
    }
}

#[test]
fn empty_solids_are_noted_and_unnamed_ones_count() {
    let text = format!(
        "SOLID\n{FACET}endsolid\nsolid nothing\nendsolid nothing\nsolid b\n{FACET}ENDSOLID b"
    );
    let scene = read_scene(text.as_bytes()).unwrap();
    let objects = scene.meshes[0].mesh.objects.as_ref().unwrap();
    assert_eq!(
        (&objects.names[..], &objects.of_face[..]),
        (&[String::new(), "b".into()][..], &[0, 1][..])
    );
    let notes: Vec<String> = scene.notes.iter().map(ToString::to_string).collect();
    assert_eq!(notes, ["1 solid without facets (nothing)"]);
}

#[test]
fn solids_are_written_as_text_with_their_names() {
    let written = |scene: &Scene| {
        let mut out = Vec::new();
        write_scene(scene, Precision::Auto, &mut out).unwrap();
        out
    };
    let mut solids = String::new();
    for name in ["left part", "", "right"] {
        solids += format!("solid {name}").trim_end();
        solids += &format!("\n{FACET}");
        solids += format!("endsolid {name}").trim_end();
        solids += "\n";
    }
    let scene = read_scene(solids.as_bytes()).unwrap();
    assert!(scene.limits_of(Format::Stl).is_empty());
    assert_eq!(String::from_utf8(written(&scene)).unwrap(), solids);
    let one = read_scene(format!("solid it\n{FACET}endsolid it\n").as_bytes()).unwrap();
    assert_eq!((&*one.meshes[0].name, one.has_solids), ("it", false));
    assert!(read_scene(&written(&one)).unwrap().meshes[0].name.is_empty(), "in binary form");
}

#[test]
fn normals_point_out_and_are_zero_without_area() {
    let mut mesh = tetrahedron();
    mesh.faces.push([VertexId(0), VertexId(0), VertexId(1)]);
    let bytes = binary(&mesh);
    for (i, [a, b, c]) in mesh.faces.iter().map(|&face| mesh.triangle(face)).enumerate() {
        let float = |axis: usize| {
            let at = 84 + 50 * i + 4 * axis;
            f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
        };
        let normal = glam::Vec3::new(float(0), float(1), float(2));
        let expected = (b - a).cross(c - a).normalize_or_zero().as_vec3();
        assert!((normal - expected).length() < 1e-6, "{normal}");
        assert_eq!(normal.length() < 0.5, i == 4);
    }
}

#[test]
fn coordinates_beyond_floats_are_refused_in_binary_only() {
    let mut mesh = tetrahedron();
    mesh.positions[1][0] = 1e300;
    let mut out = Vec::new();
    let error = write(&mesh, &mut out).unwrap_err().to_string();
    assert!(out.is_empty() && error.starts_with("vertex 1 at"), "{error}");
    assert_eq!(corners(&read(&text(&mesh)).unwrap()), corners(&mesh));
}

#[test]
fn errors_name_the_line_or_the_byte() {
    let solid = |facet: String| message(format!("solid s\n{facet}endsolid s\n"));
    assert_eq!(
        solid(FACET.replace("1 0 0", "1 x 0")),
        "line 5: expected a coordinate, found \"x\""
    );
    assert_eq!(
        solid(FACET.replace("1 0 0", "1 NaN 0")),
        "line 5: the coordinate \"NaN\" is not finite"
    );
    assert_eq!(
        solid(FACET.replace("endloop\n", "")),
        "line 7: expected endloop, found \"endfacet\""
    );
    assert_eq!(
        message(format!("solid s\n{}", &FACET[..50])),
        "line 5: the file ends where a coordinate is expected"
    );
    assert_eq!(message("solid s\nendsolid s\njunk"), "line 3: expected solid, found \"junk\"");
    assert_eq!(message(""), "byte 0: the file is empty");
    assert!(message("<html>").starts_with("byte 6: not an STL file"));

    let mut bytes = binary(&tetrahedron());
    bytes.pop();
    assert_eq!(message(&bytes), "byte 283: the file ends inside facet 3 of 4");
    bytes.push(0);
    bytes[84 + 50 + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(
        message(&bytes).starts_with("byte 134: facet 1 of 4 has a coordinate that is not finite")
    );
    bytes[80..84].fill(0x7f);
    assert_eq!(message(&bytes), "byte 284: the file ends inside facet 4 of 2139062143");
}

#[test]
fn shared_meshes_have_the_counts_of_their_table() {
    let table = [
        ("bunny.stl", 34_834, 69_451),
        ("bat-cover.stl", 975, 1946),
        ("pig.stl", 8642, 16_848),
        ("teapot-ascii.stl", 1963, 2016),
        ("broken/empty-solid.stl", 3, 1),
    ];
    for (name, vertices, faces) in table {
        let Some(path) = shared_mesh(name) else { continue };
        let mesh = read(&std::fs::read(path).unwrap()).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!((mesh.positions.len(), mesh.faces.len()), (vertices, faces), "{name}");
        mesh.validate().unwrap();
    }
}

#[test]
fn broken_files_give_one_clear_line() {
    let table = [
        ("no-triangles-ascii.stl", "line 2: no faces: no solid has a facet"),
        ("no-triangles-binary.stl", "byte 80: no faces: the number of facets is 0"),
    ];
    for (name, expected) in table {
        let Some(path) = shared_mesh(&format!("broken/{name}")) else { continue };
        assert_eq!(message(std::fs::read(path).unwrap()), expected);
    }
}

prop_compose! {
    /// Coordinates that are the same as 32-bit floats.
    fn any_mesh()(
        positions in prop::collection::vec(prop::array::uniform3(-1e30f32..1e30), 1..20),
    )(
        faces in prop::collection::vec(prop::array::uniform3(0..positions.len() as u32), 1..30),
        positions in Just(positions),
    ) -> Mesh {
        let positions = positions.iter().map(|p| p.map(f64::from)).collect();
        Mesh::new(positions, faces.iter().map(|face| face.map(VertexId)).collect())
    }
}

proptest! {
    #[test]
    fn any_mesh_comes_back(mesh in any_mesh()) {
        prop_assert_eq!(corners(&read(&binary(&mesh)).unwrap()), corners(&mesh));
        prop_assert_eq!(corners(&read(&text(&mesh)).unwrap()), corners(&mesh));
    }

    #[test]
    fn changed_bytes_give_a_mesh_or_a_line(
        mesh in any_mesh(),
        is_text in any::<bool>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        kept in any::<prop::sample::Index>(),
    ) {
        let mut bytes = if is_text { text(&mesh) } else { binary(&mesh) };
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
}
