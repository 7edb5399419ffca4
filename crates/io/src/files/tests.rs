use meshlod_fixtures::{cube, seam_strip, shared_broken, shared_mesh};
use tempfile::tempdir;

use super::*;
use crate::{Image, Material, Precision, Weld};

fn read_default(path: &Path) -> Result<Scene, IoError> {
    read(path, &ReadOptions::default())
}

#[test]
fn every_format_gives_back_the_geometry_it_was_given() {
    let folder = tempdir().unwrap();
    for (suffix, _) in Format::ALL {
        let path = folder.path().join(format!("cube.{suffix}"));
        write(&path, &Scene::from_mesh("cube", cube()), &WriteOptions::default()).unwrap();
        let scene = read_default(&path).unwrap();
        assert_eq!(scene.meshes[0].name, "cube", "{suffix}");
        let (mesh, cube) = (scene.into_mesh(), cube());
        let corners = |mesh: &meshlod_mesh::Mesh| -> Vec<_> {
            mesh.faces.iter().map(|&face| mesh.triangle(face)).collect()
        };
        assert_eq!(corners(&mesh), corners(&cube), "{suffix}");
        assert_eq!(mesh.positions.len(), cube.positions.len(), "{suffix} is welded");
    }
}

#[test]
fn stl_is_torn_only_where_that_is_asked_for() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("cube.stl");
    write(&path, &Scene::from_mesh("", cube()), &WriteOptions::default()).unwrap();
    let vertices = |weld| read(&path, &ReadOptions { weld }).unwrap().into_mesh().positions.len();
    assert_eq!(vertices(Weld::Exact), 8);
    assert_eq!(vertices(Weld::Off), 36);
    assert_eq!(vertices(Weld::Within(10.0)), 1);
}

#[test]
fn an_image_that_differs_is_not_overwritten() {
    let folder = tempdir().unwrap();
    let mut scene = Scene::from_mesh("strip", seam_strip());
    let image = |bytes: &[u8]| Image { name: "maps/a.png".into(), bytes: bytes.to_vec() };
    scene.materials = vec![Material { base_color_image: Some(0), ..Material::default() }];
    scene.images = vec![image(b"one")];
    let path = folder.path().join("strip.obj");
    let write = |scene: &Scene| write(&path, scene, &WriteOptions::default());
    write(&scene).unwrap();
    write(&scene).unwrap();
    scene.images = vec![image(b"two")];
    for _ in 0..2 {
        write(&scene).unwrap();
        assert_eq!(fs::read(folder.path().join("maps/a.png")).unwrap(), b"one");
        assert_eq!(fs::read(folder.path().join("maps/a-2.png")).unwrap(), b"two");
        assert_eq!(fs::read_dir(folder.path().join("maps")).unwrap().count(), 2);
    }
    scene.images[0].name = "..".into();
    assert!(write(&scene).unwrap_err().to_string().contains("outside the folder"));
}

#[test]
fn a_texture_outside_of_the_folder_stays_there_or_comes_beside() {
    let folder = tempdir().unwrap();
    for name in ["in", "tex", "far/out"] {
        fs::create_dir_all(folder.path().join(name)).unwrap();
    }
    fs::write(folder.path().join("tex/a.png"), b"one").unwrap();
    let mut scene = Scene::from_mesh("strip", seam_strip());
    scene.materials = vec![Material { base_color_image: Some(0), ..Material::default() }];
    scene.images = vec![Image { name: "../tex/a.png".into(), bytes: b"one".to_vec() }];
    for (place, name, copied) in [("in", "../tex/a.png", false), ("far/out", "a.png", true)] {
        let path = folder.path().join(place).join("strip.obj");
        write(&path, &scene, &WriteOptions::default()).unwrap();
        let library = fs::read_to_string(path.with_extension("mtl")).unwrap();
        assert!(library.contains(&format!("map_Kd {name}\n")), "{library}");
        assert_eq!(path.with_file_name("a.png").exists(), copied, "{place}");
        let picture = fs::read(path.parent().unwrap().join(name)).unwrap();
        assert_eq!(picture, b"one");
    }
}

#[test]
fn only_images_come_in_from_the_files_that_a_document_names() {
    let folder = tempdir().unwrap();
    let inner = folder.path().join("inner");
    fs::create_dir(&inner).unwrap();
    let outer = folder.path().join("a.png");
    fs::write(&outer, b"\x89PNG1234").unwrap();
    fs::write(folder.path().join("secret.png"), "SECRET").unwrap();
    let absolute = outer.to_str().unwrap();
    let uris = ["../a.png", "../secret.png", absolute];
    let json = serde_json::json!({
        "asset": { "version": "2.0" },
        "images": uris.map(|uri| serde_json::json!({ "uri": uri })),
    });
    let path = inner.join("a.gltf");
    fs::write(&path, json.to_string()).unwrap();
    let scene = read_default(&path).unwrap();
    let bytes: Vec<&[u8]> = scene.images.iter().map(|image| &image.bytes[..]).collect();
    assert_eq!(bytes, [&b"\x89PNG1234"[..], b"", b""]);
    let glb = inner.join("a.glb");
    write(&glb, &scene, &WriteOptions::default()).unwrap();
    let written = String::from_utf8_lossy(&fs::read(&glb).unwrap()).into_owned();
    assert!(!written.contains("SECRET"), "{written}");
    assert!(uris[1..].iter().all(|uri| written.contains(uri)), "{written}");
}

#[test]
fn a_scene_that_cannot_be_written_leaves_no_file() {
    let folder = tempdir().unwrap();
    let mut mesh = cube();
    mesh.positions[0][0] = 1e300;
    let scene = Scene::from_mesh("", mesh);
    for name in ["a.glb", "a.gltf", "a.stl", "a.ply", "a.off", "a.obj", "a.smf"] {
        let path = folder.path().join(name);
        let options = WriteOptions { precision: Precision::F32 };
        let error = write(&path, &scene, &options).unwrap_err().to_string();
        let place = ["v0", "vertex 0"].iter().any(|place| error.contains(place));
        assert!(error.contains(name) && place, "{error}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "{name}");
    }
}

#[test]
fn what_is_not_there_is_named() {
    let error = read_default(Path::new("no/such.ply")).unwrap_err().to_string();
    assert!(error.starts_with("no/such.ply: "), "{error}");
    let error = write_lods(Path::new("a.ply"), &Scene::default(), &[], LodLayout::Linked)
        .unwrap_err()
        .to_string();
    assert!(error.contains(".glb"), "{error}");
}

#[test]
fn every_broken_file_is_read_or_refused_in_one_line() {
    for path in shared_broken() {
        match read_default(&path) {
            Ok(scene) => {
                for mesh in &scene.meshes {
                    mesh.mesh.validate().unwrap();
                }
                scene.flatten().validate().unwrap();
            }
            Err(error) => {
                let error = error.to_string();
                let name = path.file_name().unwrap().to_string_lossy().into_owned();
                assert!(error.contains(&name) && !error.contains('\n'), "{error}");
            }
        }
    }
}

#[test]
fn a_textured_obj_becomes_a_glb_with_its_materials() {
    let Some(path) = shared_mesh("pirate.obj") else { return };
    let folder = tempdir().unwrap();
    let scene = read_default(&path).unwrap();
    let glb = folder.path().join("pirate.glb");
    write(&glb, &scene, &WriteOptions::default()).unwrap();
    let again = read_default(&glb).unwrap();
    assert_eq!(again.materials.len(), scene.materials.len());
    assert_eq!(again.flatten().faces.len(), scene.flatten().faces.len());
}
