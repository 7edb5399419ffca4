//! Contents of OBJ files and their libraries: they come through, or a note counts them.

mod in_folders;

use std::fs;

use meshlod_io::{Format, Image, Material, Note, ReadOptions, Scene};
use meshlod_io::{gltf, obj, ply, read_bytes};
use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh, VertexId, WedgeId};
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use in_folders::{folder, read_it, write_it};

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

fn text_of(folder: &TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join(name)).unwrap()
}

fn texts(notes: &[Note]) -> Vec<String> {
    notes.iter().map(Note::to_string).collect()
}

/// A square of two triangles, each with a wedge a corner, with these layers.
fn square(layers: Vec<Layer>) -> Mesh {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let corners = vec![[0, 1, 2].map(WedgeId), [3, 4, 5].map(WedgeId)];
    let faces = vec![[0, 1, 2].map(VertexId), [0, 2, 3].map(VertexId)];
    let attributes = Attributes { corners, wedge_count: 6, layers };
    Mesh { attributes: Some(attributes), ..Mesh::new(positions, faces) }
}

fn layer(kind: LayerKind, width: usize, values: Vec<f32>) -> Layer {
    Layer { kind, name: "layer".to_owned(), width, values }
}

/// Returns the colour of each corner of each face.
fn colors_at_corners(mesh: &Mesh) -> Vec<Vec<f32>> {
    let attributes = mesh.attributes.as_ref().unwrap();
    let colors = attributes.layer(LayerKind::Color(0)).unwrap();
    attributes.corners.as_flattened().iter().map(|&wedge| colors.of(wedge).to_vec()).collect()
}

#[test]
fn a_colour_for_each_face_splits_vertices_and_nothing_else_does() {
    let [red, blue] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let colors = [red, red, red, blue, blue, blue].as_flattened().to_vec();
    let uvs = (0..12).map(|i| i as f32 * 0.125).collect();
    let uvs = layer(LayerKind::Uv(0), 2, uvs);
    let here = tempdir().unwrap();
    let path = here.path().join("a.obj");

    let flat = square(vec![layer(LayerKind::Color(0), 3, colors), uvs.clone()]);
    let scene = Scene::from_mesh("", flat.clone());
    let limits = texts(&scene.limits_of(Format::Obj));
    assert_eq!(limits, ["2 vertices split at seams of their colours"]);
    write_it(&path, &scene);
    let again = read_it(&path);
    assert_eq!(again.meshes[0].mesh.positions.len(), 6);
    assert_eq!(colors_at_corners(&again.meshes[0].mesh), colors_at_corners(&flat));

    let even = square(vec![layer(LayerKind::Color(0), 3, red.repeat(6)), uvs]);
    let scene = Scene::from_mesh("", even);
    assert_eq!(texts(&scene.limits_of(Format::Obj)), [""; 0]);
    write_it(&path, &scene);
    assert_eq!(read_it(&path).meshes[0].mesh.positions.len(), 4, "texture seams tear nothing");
}

#[test]
fn the_opacity_of_vertices_is_counted_where_it_is_lost() {
    let colors = |opacity| [1.0, 0.0, 0.0, opacity].repeat(6);
    let scene = |opacity| {
        Scene::from_mesh("", square(vec![layer(LayerKind::Color(0), 4, colors(opacity))]))
    };
    for format in [Format::Obj, Format::Smf] {
        let limits = texts(&scene(0.5).limits_of(format));
        assert!(limits.contains(&"4 opacities of vertices".to_owned()), "{limits:?}");
        let limits = texts(&scene(1.0).limits_of(format));
        assert!(!limits.iter().any(|limit| limit.contains("opacit")), "{limits:?}");
    }
    let limits = texts(&scene(0.5).limits_of(Format::Off));
    assert!(!limits.iter().any(|limit| limit.contains("opacit")), "{limits:?}");
}

#[test]
fn a_file_written_alone_lacks_its_library_and_images() {
    let object = format!("mtllib a.mtl\n{SQUARE}usemtl red\nf 1 2 3\nusemtl bare\nf 1 3 4\n");
    let library = b"newmtl red\nmap_Kd t.png\nmap_Ks gone.png\nnewmtl bare\n";
    let here = folder(&[("a.obj", object.as_bytes()), ("a.mtl", library), ("t.png", PNG)]);
    let scene = read_it(&here.path().join("a.obj"));
    let limits = |format| texts(&scene.lone_file_limits(format));
    assert_eq!(limits(Format::Obj), ["1 material's look (red)", "1 texture (t.png)"]);
    assert_eq!(limits(Format::Ply), ["1 texture (t.png)"]);
    assert_eq!(limits(Format::Glb), [""; 0]);
}

#[test]
fn in_place_a_missing_library_is_still_named_and_none_invents_its_materials() {
    let object =
        format!("mtllib m.mtl n.mtl\n{SQUARE}usemtl red\nf 1 2 3\nusemtl green\nf 1 3 4\n");
    let library: &[u8] = b"newmtl green\nKd 0 1 0\n";
    let here = folder(&[("two.obj", object.as_bytes()), ("n.mtl", library)]);
    let path = here.path().join("two.obj");
    let mut scene = read_it(&path);
    write_it(&path, &scene);
    assert!(text_of(&here, "two.obj").starts_with("mtllib m.mtl n.mtl\n"));
    assert_eq!(text_of(&here, "n.mtl").as_bytes(), library);
    assert!(!here.path().join("two.mtl").exists());

    // Another colour needs a library of its own, which says nothing of what the missing one may.
    scene.materials[1].base_color = [0.0, 0.5, 0.0, 1.0];
    write_it(&path, &scene);
    assert!(text_of(&here, "two.obj").starts_with("mtllib two.mtl\nmtllib m.mtl\n"));
    assert_eq!(text_of(&here, "two.mtl"), "newmtl green\nKd 0 0.5 0\n");
    assert_eq!(text_of(&here, "n.mtl").as_bytes(), library, "somebody else's");
    let again = read_it(&path);
    assert_eq!(texts(&again.notes), ["1 material library that was not found (m.mtl)"]);
}

#[test]
fn a_new_library_does_not_take_the_name_of_a_missing_one() {
    let object =
        format!("mtllib x.mtl n.mtl\n{SQUARE}usemtl red\nf 1 2 3\nusemtl green\nf 1 3 4\n");
    let here = folder(&[("x.obj", object.as_bytes()), ("n.mtl", b"newmtl green\nKd 0 1 0\n")]);
    let path = here.path().join("x.obj");
    let mut scene = read_it(&path);
    scene.materials[1].base_color = [0.0, 0.5, 0.0, 1.0];
    write_it(&path, &scene);
    assert!(text_of(&here, "x.obj").starts_with("mtllib x-2.mtl\nmtllib x.mtl\n"));
}

#[test]
fn images_of_one_name_go_to_one_folder() {
    let here = tempdir().unwrap();
    let scene = |bytes: &[u8]| {
        let uvs = layer(LayerKind::Uv(0), 2, vec![0.5; 12]);
        let mut scene = Scene::from_mesh("", square(vec![uvs]));
        scene.materials = vec![Material { base_color_image: Some(0), ..Material::default() }];
        scene.meshes[0].materials = vec![Some(0)];
        scene.images = vec![Image { name: "image0.png".into(), bytes: bytes.to_vec() }];
        scene
    };
    let [fox, duck] = [b"\x89PNG fox", b"\x89PNGduck"];
    for (name, bytes) in [("fox.obj", fox), ("duck.obj", duck), ("duck.ply", duck)] {
        write_it(&here.path().join(name), &scene(bytes));
    }
    assert_eq!(fs::read(here.path().join("image0.png")).unwrap(), fox);
    for (name, bytes) in [("fox.obj", fox), ("duck.obj", duck), ("duck.ply", duck)] {
        assert_eq!(read_it(&here.path().join(name)).images[0].bytes, bytes, "{name}");
    }
    // Once more, with a texture that was painted over since.
    let painted = b"\x89PNG new";
    write_it(&here.path().join("fox.obj"), &scene(painted));
    assert_eq!(read_it(&here.path().join("fox.obj")).images[0].bytes, painted);
    assert_eq!(read_it(&here.path().join("duck.obj")).images[0].bytes, duck);
    assert_eq!(fs::read(here.path().join("image0.png")).unwrap(), fox, "never overwritten");
}

#[test]
fn a_malformed_library_costs_a_note_and_stays_as_it_is() {
    let object = format!("mtllib a.mtl\n{SQUARE}usemtl a\nf 1 2 3\n");
    let library: &[u8] =
        b"newmtl a\nKd 0,8 0,8 0,8\nTr x\nKs 1 1 1\nd\nNs 96,0\nPr\nKs red\nKe 0 nan 0\nPm inf\n";
    let here = folder(&[("a.obj", object.as_bytes()), ("a.mtl", library)]);
    let scene = read_it(&here.path().join("a.obj"));
    let note = &scene.notes[0];
    assert_eq!((note.count, scene.notes.len()), (8, 1));
    assert_eq!(note.names[0], "a.mtl, line 2: \"0,8\" is not a number");
    let there = tempdir().unwrap();
    write_it(&there.path().join("a.obj"), &scene);
    assert_eq!(text_of(&there, "a.mtl").as_bytes(), library);

    let utf_16: &[u8] = b"\xff\xfen\0e\0";
    fs::write(here.path().join("a.mtl"), utf_16).unwrap();
    let scene = read_it(&here.path().join("a.obj"));
    let note = scene.notes[0].to_string();
    assert!(note.starts_with("1 material library that cannot be read (a.mtl: "), "{note}");
    write_it(&here.path().join("a.obj"), &scene);
    assert_eq!(fs::read(here.path().join("a.mtl")).unwrap(), utf_16);
}

#[test]
fn quoted_libraries_and_options_behind_names_are_understood() {
    let object = format!("mtllib \"a b.mtl\"\n{SQUARE}usemtl m\nf 1 2 3\n");
    let library: &[u8] = b"newmtl m\nmap_Kd \"t.png\"\nnorm t.png -bm 0.5\n";
    let here = folder(&[("a.obj", object.as_bytes()), ("a b.mtl", library), ("t.png", PNG)]);
    let path = here.path().join("a.obj");
    let scene = read_it(&path);
    assert_eq!(texts(&scene.notes), [""; 0]);
    assert_eq!(scene.images.len(), 1);
    let shading = &scene.materials[0].shading;
    assert_eq!((shading.normal_image, shading.normal_scale), (Some(0), 0.5));
    write_it(&path, &scene);
    assert!(text_of(&here, "a.obj").starts_with("mtllib \"a b.mtl\"\n"));
    let there = tempdir().unwrap();
    write_it(&there.path().join("a.obj"), &scene);
    assert_eq!(text_of(&there, "a.mtl").as_bytes(), library);
}

#[test]
fn remedies_of_missing_images_fit_their_names() {
    let object = format!("mtllib a.mtl\n{SQUARE}usemtl m\nf 1 2 3\n");
    for (name, expected) in [
        ("t.<UDIM>.png", "tiles of UDIM"),
        ("https://example.com/t.png", "images are not downloaded"),
        ("t.png -bm 0.3", "t.png"),
    ] {
        let library = format!("newmtl m\nmap_Kd {name}\n");
        let here = folder(&[("a.obj", object.as_bytes()), ("a.mtl", library.as_bytes())]);
        let scene = read_it(&here.path().join("a.obj"));
        let remedy = scene.notes[0].remedy.clone().unwrap();
        assert!(remedy.contains(expected) && !remedy.contains("-bm"), "{name}: {remedy}");
    }
}

fn obj(text: &str) -> Scene {
    read_bytes(text.as_bytes(), Format::Obj, &mut |_| None, &ReadOptions::default()).unwrap()
}

#[test]
fn attributes_that_are_not_finite_are_counted() {
    let scene = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt nan 0\nvt 1 0\nvt 0 1\nvn nan 0 1e99\n\
                     f 1/1/1 2/2/1 3/3/1\n");
    let note = "3 values of attributes that are not finite read as 0";
    assert!(texts(&scene.notes).contains(&note.to_owned()), "{:?}", scene.notes);
    assert_eq!(texts(&obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").notes), [""; 0]);
}

#[test]
fn polypaint_becomes_colours() {
    let faces = "f 1 2 3\nf 1 3 4\n";
    let scene =
        obj(&format!("# by hand\n#MRGB ffff0000ff00ff00\n#MRGB ff0000ffffffffff\n{SQUARE}{faces}"));
    assert_eq!(texts(&scene.notes), [""; 0]);
    let colors = colors_at_corners(&scene.meshes[0].mesh);
    let [red, green, blue] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(colors[..4], [red, green, blue, red]);

    // Too many, some masked; and where vertices have colours, these count.
    let paint = "#MRGB 00ff0000ffff0000ffff0000ffff0000ffff0000\n";
    let scene = obj(&format!("{SQUARE}{faces}{paint}"));
    assert_eq!(texts(&scene.notes), ["1 mask of a vertex", "1 colour of polypaint"]);
    let scene = obj("v 0 0 0 0 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n#MRGB ffff0000\n");
    assert_eq!(texts(&scene.notes), ["1 colour of polypaint"]);
    assert_eq!(colors_at_corners(&scene.meshes[0].mesh)[0], green);
}

/// A document of one square for each material, each with two sets of texture coordinates: 0.25 in
/// the first, 0.75 in the second.
fn document(materials: &Value, mut more: Value) -> Scene {
    let corners = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mut buffer: Vec<u8> = corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    for uv in [0.25f32, 0.75] {
        buffer.extend(uv.to_le_bytes().repeat(6));
    }
    let primitive = |material| {
        json!({ "attributes": { "POSITION": 0, "TEXCOORD_0": 1, "TEXCOORD_1": 2 },
                "material": material })
    };
    let count = materials.as_array().map_or(0, Vec::len);
    let primitives: Vec<Value> = (0..count).map(primitive).collect();
    let uri: String = buffer.iter().map(|byte| format!("%{byte:02x}")).collect();
    let own = json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": primitives }],
        "materials": materials,
        "buffers": [{ "byteLength": 84, "uri": format!("data:,{uri}") }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 24 },
            { "buffer": 0, "byteOffset": 60, "byteLength": 24 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
              "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2" },
            { "bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC2" },
        ],
    });
    let all = more.as_object_mut().unwrap();
    all.extend(own.as_object().unwrap().clone());
    let text = more.to_string();
    gltf::read(text.as_bytes(), &mut |_| Some(PNG.to_vec()), meshlod_io::Weld::Exact).unwrap()
}

fn textured(set: u8) -> Value {
    let texture = json!({ "index": 0, "texCoord": set });
    json!({ "name": format!("uses {set}"), "pbrMetallicRoughness":
            { "metallicFactor": 0, "baseColorTexture": texture } })
}

fn textures() -> Value {
    json!({ "textures": [{ "source": 0 }], "images": [{ "uri": "t.png" }] })
}

fn written(scene: &Scene) -> String {
    let mut out = Vec::new();
    obj::write(scene, Default::default(), &mut out, &[]).unwrap();
    String::from_utf8(out).unwrap()
}

#[test]
fn a_texture_comes_with_the_coordinates_that_it_uses() {
    let scene = document(&json!([textured(1)]), textures());
    let text = written(&scene);
    assert!(text.contains("vt 0.75 0.25\n") && !text.contains("vt 0.25 0.75"), "{text}");
    let note = "1 vertex attribute (texture coordinates)".to_owned();
    assert_eq!(texts(&scene.limits_of(Format::Obj)), [note]);

    let both = document(&json!([textured(0), textured(1)]), textures());
    let text = written(&both);
    assert!(text.contains("vt 0.25 0.75\nvt 0.75 0.25\n"), "{text}");
    let first = text.find("usemtl uses 0\nf 1/1 2/1 3/1\n");
    assert!(first.is_some() && text.contains("usemtl uses 1\nf 1/2 2/2 3/2\n"), "{text}");
    assert_eq!(texts(&both.limits_of(Format::Obj)), [""; 0]);

    for (scene, expected) in [(&scene, 0), (&both, 1)] {
        let mut out = Vec::new();
        ply::write_scene(scene, Default::default(), &mut out).unwrap();
        let own = Format::Ply;
        let again = read_bytes(&out, own, &mut |_| Some(PNG.to_vec()), &ReadOptions::default());
        let mesh = again.unwrap().into_mesh();
        let first = mesh.attributes.unwrap().layer(LayerKind::Uv(0)).unwrap().values[0];
        assert_eq!(first, if expected == 0 { 0.75 } else { 0.25 });
        let limits = texts(&scene.limits_of(own));
        let lost = "1 material with texture coordinates of its own (uses 1)".to_owned();
        assert_eq!(limits.contains(&lost), expected == 1, "{limits:?}");
    }
}

#[test]
fn every_colour_of_a_document_is_said() {
    let grey = json!({ "name": "grey", "pbrMetallicRoughness":
                       { "baseColorFactor": [0.8, 0.8, 0.8, 1.0], "metallicFactor": 0 } });
    let scene = document(&json!([grey]), json!({}));
    let here = tempdir().unwrap();
    write_it(&here.path().join("a.obj"), &scene);
    assert_eq!(text_of(&here, "a.mtl"), "newmtl grey\nKd 0.8 0.8 0.8\n");
}

#[test]
fn images_that_only_extensions_name_are_named() {
    let more = json!({
        "textures": [{ "extensions": { "KHR_texture_basisu": { "source": 0 } } }],
        "images": [{ "uri": "b.ktx2" }],
        "extensionsUsed": ["KHR_texture_basisu"],
    });
    let scene = document(&json!([textured(0)]), more);
    for format in [Format::Obj, Format::Ply, Format::Stl] {
        let limits = texts(&scene.limits_of(format));
        let expected = "1 texture that only an extension of glTF names (b.ktx2)".to_owned();
        assert!(limits.contains(&expected), "{limits:?}");
    }
}

#[test]
fn images_of_a_document_on_the_web_are_named_by_their_addresses() {
    let address = "https://example.com/t.png";
    let more = json!({ "textures": [{ "source": 0 }], "images": [{ "uri": address }] });
    let scene = document(&json!([textured(0)]), more);
    assert_eq!((&*scene.images[0].name, scene.images[0].bytes.len()), (address, 0));
}
