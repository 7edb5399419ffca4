use meshlod_fixtures::{grid, tetrahedron};
use meshlod_mesh::{Attributes, Labels, Layer, LayerKind, Mesh, WedgeId};
use proptest::prelude::*;

use super::read_scene;
use super::write::write_scene;
use crate::{Format, Image, Material, Note, Precision, Scene};

/// A square of two triangles with what follows their vertices.
fn square(remarks: &str, properties: &str, faces: [&str; 2]) -> String {
    let [a, b] = faces;
    format!(
        "ply\nformat ascii 1.0\n{remarks}element vertex 4\nproperty float x\nproperty float y\n\
         property float z\nelement face 2\nproperty list uchar int vertex_indices\n{properties}\
         end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 {a}\n3 0 2 3 {b}\n"
    )
}

fn read(text: &str) -> Scene {
    read_scene(text.as_bytes(), &mut |name| Some(image(name))).unwrap()
}

/// An image, as far as its first bytes tell.
fn image(rest: &str) -> Vec<u8> {
    [b"\x89PNG", rest.as_bytes()].concat()
}

fn notes(scene: &Scene) -> Vec<String> {
    scene.notes.iter().map(Note::to_string).collect()
}

fn written(scene: &Scene) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_scene(scene, Precision::Auto, &mut bytes).unwrap();
    bytes
}

/// The header of a file, without its first two lines.
fn header(bytes: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(bytes);
    text.lines().skip(2).take_while(|&line| line != "end_header").map(str::to_owned).collect()
}

fn values(mesh: &Mesh, kind: LayerKind, face: usize, corner: usize) -> Vec<f32> {
    let attributes = mesh.attributes.as_ref().unwrap();
    attributes.layer(kind).unwrap().of(attributes.corners[face][corner]).to_vec()
}

const TEXCOORD: &str = "property list uchar float texcoord\n";

#[test]
fn lists_of_texture_coordinates_make_seams_of_wedges() {
    let scene = read(&square("", TEXCOORD, ["6 0 0 1 0 1 1", "6 .5 .5 1 1 0 1"]));
    let mesh = &scene.meshes[0].mesh;
    assert_eq!(mesh.positions.len(), 4);
    assert_eq!(mesh.attributes.as_ref().unwrap().wedge_count, 5);
    assert_eq!(values(mesh, LayerKind::Uv(0), 0, 0), [0.0, 0.0]);
    assert_eq!(values(mesh, LayerKind::Uv(0), 1, 0), [0.5, 0.5]);
    let bytes = written(&scene);
    assert!(header(&bytes).contains(&TEXCOORD.trim().to_owned()));
    let back = read_scene(&bytes, &mut |_| None).unwrap();
    assert_eq!(back.meshes[0].mesh, *mesh);
    assert!(back.limits_of(Format::Ply).is_empty());
}

#[test]
fn textures_are_materials_and_come_back() {
    let remarks = "comment TextureFile a b.png\ncomment by hand\ncomment TextureFile maps/c.jpg\n";
    let properties = [TEXCOORD, "property int texnumber\n"].concat();
    let text = square(remarks, &properties, ["6 0 0 1 0 1 1 1", "6 0 0 1 1 0 1 0"]);
    let scene = read(&text);
    let names: Vec<&str> = scene.materials.iter().map(|m| &*m.name).collect();
    assert_eq!(names, ["a b", "c"]);
    assert_eq!(scene.images[1], Image { name: "maps/c.jpg".into(), bytes: image("maps/c.jpg") });
    assert_eq!(scene.meshes[0].mesh.materials.as_ref().unwrap().of_face, [1, 0]);
    assert_eq!(notes(&scene), [""; 0]);
    let bytes = written(&scene);
    let head = header(&bytes);
    assert_eq!(
        head[..3],
        ["comment by hand", "comment TextureFile a b.png", "comment TextureFile maps/c.jpg"]
    );
    let back = read_scene(&bytes, &mut |_| Some(image(""))).unwrap();
    assert_eq!(back.meshes[0].mesh, scene.meshes[0].mesh);
    assert_eq!(written(&back), bytes);
}

#[test]
fn a_face_without_a_texture_has_no_material() {
    let text = square("comment TextureFile a.png\n", "property int texnumber\n", ["-1", "0"]);
    let scene = read(&text);
    assert_eq!(scene.meshes[0].materials, [Some(0), None]);
    assert_eq!(scene.meshes[0].mesh.materials.as_ref().unwrap().of_face, [1, 0]);
    let back = read_scene(&written(&scene), &mut |_| None).unwrap();
    assert_eq!(back.meshes[0].mesh, scene.meshes[0].mesh);
    let text = square("comment TextureFile a.png\n", "property int texnumber\n", ["7", "0"]);
    assert_eq!(notes(&read(&text)), ["1 face whose texture has no TextureFile"]);
}

#[test]
fn labels_and_types_come_back() {
    let text = square("", "property short label\n", ["-3", "12"]);
    let text = text.replace("property float z\n", "property float z\nproperty ushort intensity\n");
    let text = text.replace("0 0 0\n", "0 0 0 7\n").replace("1 0 0\n", "1 0 0 65535\n");
    let text = text.replace("1 1 0\n", "1 1 0 0\n").replace("0 1 0\n", "0 1 0 9\n");
    let scene = read(&text);
    let objects = scene.meshes[0].mesh.objects.clone().unwrap();
    assert_eq!(
        objects,
        Labels { names: vec!["label -3".into(), "label 12".into()], of_face: vec![0, 1] }
    );
    assert!(scene.limits_of(Format::Ply).is_empty());
    let bytes = written(&scene);
    let head = header(&bytes);
    assert!(head.contains(&"property short label".to_owned()), "{head:?}");
    assert!(head.contains(&"property ushort intensity".to_owned()), "{head:?}");
    let back = read_scene(&bytes, &mut |_| None).unwrap();
    assert_eq!(back.meshes[0].mesh, scene.meshes[0].mesh);
}

#[test]
fn few_face_colours_keep_their_borders() {
    let properties = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let scene = read(&square("", properties, ["255 0 0", "0 0 255"]));
    let mesh = &scene.meshes[0].mesh;
    assert_eq!(values(mesh, LayerKind::Color(0), 0, 2), [1.0, 0.0, 0.0]);
    assert_eq!(values(mesh, LayerKind::Color(0), 1, 1), [0.0, 0.0, 1.0]);
    let bytes = written(&scene);
    assert!(header(&bytes)[4..].contains(&"property uchar red".to_owned()));
    assert_eq!(read_scene(&bytes, &mut |_| None).unwrap().meshes[0].mesh, *mesh);
}

#[test]
fn many_face_colours_are_averaged_and_that_is_noted() {
    let mut text = String::from(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
         property float z\nelement face 300\nproperty list uchar int vertex_indices\n\
         property float red\nproperty float green\nproperty float blue\nend_header\n\
         0 0 0\n1 0 0\n0 1 0\n",
    );
    (0..300).for_each(|i| text += &format!("3 0 1 2 {} 0.5 0\n", f64::from(i) / 299.0));
    let scene = read(&text);
    assert_eq!(notes(&scene), ["300 colours of faces averaged at vertices"]);
    let color = values(&scene.meshes[0].mesh, LayerKind::Color(0), 7, 1);
    assert!((color[0] - 0.5).abs() < 1e-6 && color[1] == 0.5, "{color:?}");
}

#[test]
fn what_is_skipped_is_noted() {
    let text = square("vendor 1\n", "property list int int ring\n", ["1 5", "0"]);
    let text = text
        .replace("element face", "element edge 0\nelement camera 1\nproperty int id\nelement face");
    let text = text.replace("0 1 0\n3", "0 1 0\n5\n3");
    assert_eq!(
        notes(&read(&text)),
        [
            "1 unknown line of the header (vendor)",
            "1 row of an unknown element (camera)",
            "1 list of vertices or faces (ring)"
        ]
    );
    let text = square("", TEXCOORD, ["4 0 0 1 0", "6 nan 0 1 1 0 1"]);
    let scene = read(&text);
    assert_eq!(
        notes(&scene),
        [
            "1 list of texture coordinates that does not match its face",
            "1 value of a face that is not finite read as 0"
        ]
    );
    assert_eq!(values(&scene.meshes[0].mesh, LayerKind::Uv(0), 1, 0), [0.0, 0.0]);
}

#[test]
fn a_polygon_keeps_the_coordinates_of_its_corners() {
    let text = square("", TEXCOORD, ["6 0 0 1 0 1 1", "6 0 0 1 1 0 1"]);
    let text = text.replace("face 2", "face 1").replace("3 0 1 2 6 0 0 1 0 1 1\n", "");
    let text = text.replace("3 0 2 3 6 0 0 1 1 0 1", "4 0 1 2 3 8 0 0 .1 0 .1 .1 0 .1");
    let mesh = &read(&text).meshes[0].mesh;
    for face in 0..2 {
        for corner in 0..3 {
            let [x, y, _] = mesh.positions[mesh.faces[face][corner].index()];
            let expected = [x, y].map(|x| (0.1 * x) as f32);
            assert_eq!(values(mesh, LayerKind::Uv(0), face, corner), expected);
        }
    }
}

#[test]
fn the_knot_of_another_program_keeps_its_surface_and_texture() {
    let path = meshlod_fixtures::file("knot.ply");
    let scene = crate::read(&path, &Default::default()).unwrap();
    let mesh = &scene.meshes[0].mesh;
    assert_eq!((mesh.positions.len(), mesh.faces.len()), (480, 960));
    assert_eq!(mesh.attributes.as_ref().unwrap().wedge_count, 49 * 11);
    assert_eq!(scene.materials[0].name, "knot");
    assert!(scene.images[0].bytes.starts_with(b"\x89PNG"));
    assert!(scene.notes.is_empty() && scene.limits_of(Format::Ply).is_empty());
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.ply");
    crate::write(&out, &scene, &Default::default()).unwrap();
    let back = crate::read(&out, &Default::default()).unwrap();
    assert_eq!(back.images, scene.images);
    assert_eq!(back.meshes[0].mesh.faces, mesh.faces);
    assert_eq!(back.meshes[0].mesh.attributes, mesh.attributes);
}

/// A mesh with texture coordinates and textures drawn from small sets, so that seams fall anywhere.
fn textured() -> impl Strategy<Value = Scene> {
    let draws = proptest::collection::vec((0u8..3, 0u8..3, 0u32..3, -2i64..3), 54);
    (prop_oneof![Just(tetrahedron()), Just(grid(3))], draws).prop_map(|(mut mesh, draws)| {
        let faces = mesh.faces.len();
        let wedge = |corner: usize| WedgeId::new(corner);
        let corners = (0..faces).map(|f| [0, 1, 2].map(|c| wedge(3 * f + c))).collect();
        let uv = |&(u, v, _, _): &(u8, u8, u32, i64)| [u, v].map(|x| f32::from(x) / 3.0);
        let values = draws.iter().cycle().take(3 * faces).flat_map(uv).collect();
        let layer = Layer { kind: LayerKind::Uv(0), name: "uv".into(), width: 2, values };
        mesh.attributes = Some(Attributes { corners, wedge_count: 3 * faces, layers: vec![layer] });
        let face = || draws.iter().cycle().take(faces);
        let names = ["a", "b", "c"].map(str::to_owned).to_vec();
        mesh.materials = Some(Labels { names, of_face: face().map(|draw| draw.2).collect() });
        let names = (-2..3).map(|label| format!("label {label}")).collect();
        let of_face = face().map(|draw| (draw.3 + 2) as u32).collect();
        mesh.objects = Some(Labels { names, of_face });
        let mut scene = Scene::from_mesh("", mesh);
        scene.images =
            ["a.png", "b.png"].map(|name| Image { name: name.into(), bytes: vec![1] }).to_vec();
        scene.materials[0].base_color_image = Some(0);
        scene.materials[2] = Material { base_color_image: Some(1), ..scene.materials[2].clone() };
        scene
    })
}

proptest! {
    #[test]
    fn textures_labels_and_seams_come_back(scene in textured()) {
        let bytes = written(&scene);
        let back = read_scene(&bytes, &mut |_| Some(image(""))).unwrap();
        let (then, now) = (&scene.meshes[0], &back.meshes[0]);
        prop_assert_eq!(&then.mesh.positions, &now.mesh.positions);
        prop_assert_eq!(&then.mesh.faces, &now.mesh.faces);
        let image = |scene: &Scene, face: usize| {
            let mesh = &scene.meshes[0];
            let label = mesh.mesh.materials.as_ref().map_or(0, |labels| labels.of(face));
            let image = scene.materials[mesh.materials[label as usize]?].base_color_image?;
            Some(scene.images[image].name.clone())
        };
        let object = |mesh: &Mesh, face: usize| {
            let objects = mesh.objects.as_ref().unwrap();
            objects.names[objects.of(face) as usize].clone()
        };
        for face in 0..then.mesh.faces.len() {
            prop_assert_eq!(image(&scene, face), image(&back, face));
            prop_assert_eq!(object(&then.mesh, face), object(&now.mesh, face));
            for corner in 0..3 {
                let uv = |mesh| values(mesh, LayerKind::Uv(0), face, corner);
                prop_assert_eq!(uv(&then.mesh), uv(&now.mesh));
            }
        }
        prop_assert_eq!(written(&back), bytes);
    }
}
