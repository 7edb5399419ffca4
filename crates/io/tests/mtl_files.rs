//! OBJ files with their libraries and images, in folders as people have them.

mod in_folders;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use meshlod_fixtures::own_file;
use meshlod_io::gltf::{Skeleton, SkeletonImage, write_glb};
use meshlod_io::{Format, Note, NoteKind, Scene};
use tempfile::tempdir;

use in_folders::{folder, read_it, write_it};

/// Returns all files of a folder by their names in it.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for path in fs::read_dir(next).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().to_owned();
                all.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    all
}

fn lines(library: &Path) -> Vec<String> {
    let mut lines: Vec<String> =
        fs::read_to_string(library).unwrap().lines().map(str::to_owned).collect();
    lines.sort();
    lines
}

fn notes(scene: &Scene) -> Vec<String> {
    scene.notes.iter().map(Note::to_string).collect()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

#[test]
fn every_statement_and_map_comes_to_another_folder() {
    let there = tempdir().unwrap();
    let scene = read_it(&own_file("full.obj"));
    assert_eq!(notes(&scene), [""; 0]);
    write_it(&there.path().join("full.obj"), &scene);
    assert_eq!(lines(&there.path().join("full.mtl")), lines(&own_file("full.mtl")));
    let mut new = contents(there.path());
    let mut old = contents(&own_file(""));
    for files in [&mut new, &mut old] {
        // The mesh is written anew, and others belong to other fixtures.
        let is_own = |name: &Path| name.starts_with("maps") || name.ends_with("wood grain.png");
        files.retain(|name, _| is_own(name) || name.ends_with("full.mtl"));
        assert_eq!(files.len(), 6);
    }
    assert_eq!(new, old);
    let again = read_it(&there.path().join("full.obj"));
    assert_eq!((again.materials, again.images), (scene.materials, scene.images));
}

#[test]
fn in_place_nothing_changes_but_the_mesh() {
    let files = contents(&own_file(""));
    let files: Vec<(&str, &[u8])> =
        files.iter().map(|(name, bytes)| (name.to_str().unwrap(), &bytes[..])).collect();
    let here = folder(&files);
    // A comment before the first material is not part of the scene, and stays.
    let library = here.path().join("full.mtl");
    let text = format!("# by hand\n{}", fs::read_to_string(&library).unwrap());
    fs::write(&library, text).unwrap();
    let path = here.path().join("full.obj");
    let mut before = contents(here.path());
    let mut scene = read_it(&path);
    scene.meshes[0].mesh.positions[0] = [-1.0, 0.0, 0.0];
    write_it(&path, &scene);
    let mut after = contents(here.path());
    let name = Path::new("full.obj");
    assert_ne!(before.remove(name), after.remove(name));
    assert_eq!(after, before);
    assert_eq!(read_it(&path).materials, scene.materials);
}

#[test]
fn several_libraries_stay_where_they_are_or_become_one() {
    let object = format!(
        "mtllib a b.mtl\nmtllib c.mtl d.mtl\n{SQUARE}usemtl one\nf 1 2 3\nusemtl two\nf 1 3 4\n"
    );
    let files: [(&str, &[u8]); 4] = [
        ("x.obj", object.as_bytes()),
        ("a b.mtl", b"newmtl one\nNs 1\n"),
        ("c.mtl", b"newmtl two\nNs 2\n"),
        ("d.mtl", b"newmtl three\nNs 3\n"),
    ];
    let here = folder(&files);
    let path = here.path().join("x.obj");
    let scene = read_it(&path);
    let names: Vec<&str> = scene.materials.iter().map(|material| &*material.name).collect();
    assert_eq!(names, ["one", "two", "three"]);
    write_it(&path, &scene);
    assert_eq!(contents(here.path()).len(), 4);
    assert_eq!(read_it(&path).materials, scene.materials);
    write_it(&here.path().join("y.obj"), &scene);
    let library = fs::read_to_string(here.path().join("y.mtl")).unwrap();
    assert_eq!(library, "newmtl one\nNs 1\nnewmtl two\nNs 2\nnewmtl three\nNs 3\n");
}

#[test]
fn images_are_found_by_any_spelling_and_not_copied_beside_themselves() {
    let object = format!("mtllib A.MTL\n{SQUARE}usemtl m\nf 1 2 3\n");
    let library = b"newmtl m\nmap_Kd Maps\\Wood Grain.png\nmap_Ks .\\maps\\wood grain.PNG\n";
    let here =
        folder(&[("a.obj", object.as_bytes()), ("a.mtl", library), ("maps/wood grain.png", PNG)]);
    let path = here.path().join("a.obj");
    let scene = read_it(&path);
    assert!(scene.images.iter().all(|image| image.bytes == PNG));
    write_it(&path, &scene);
    assert_eq!(contents(here.path()).len(), 3);
    let there = tempdir().unwrap();
    write_it(&there.path().join("b.obj"), &scene);
    assert_eq!(lines(&there.path().join("b.mtl")), lines(&here.path().join("a.mtl")));
    let again = read_it(&there.path().join("b.obj"));
    assert!(notes(&again).is_empty() && again.images[0].bytes == PNG);
}

#[test]
fn absolute_paths_lead_to_files_beside_and_stay_in_place() {
    let object = format!("mtllib C:\\my models\\a.mtl\n{SQUARE}usemtl m\nf 1 2 3\n");
    let library = b"newmtl m\nmap_Kd -bm 2 C:\\my maps\\wood.png\nmap_Ks /gone/stone.png\n";
    let here = folder(&[("a.obj", object.as_bytes()), ("a.mtl", library), ("Wood.png", PNG)]);
    let path = here.path().join("a.obj");
    let scene = read_it(&path);
    assert_eq!(scene.images[0].bytes, PNG);
    let taken = "2 files with absolute paths, taken from beside the model (Wood.png for \
                 C:\\my maps\\wood.png, a.mtl for C:\\my models\\a.mtl)";
    let missing = "1 image that was not found or cannot be used (/gone/stone.png)";
    assert_eq!(notes(&scene), [missing, taken]);
    let before = contents(here.path());
    write_it(&path, &scene);
    let mut after = contents(here.path());
    let text = after.remove(Path::new("a.obj")).unwrap();
    assert!(text.starts_with(b"mtllib C:\\my models\\a.mtl\n"));
    assert!(after.iter().all(|(name, bytes)| before[name] == *bytes) && after.len() == 2);
    let there = tempdir().unwrap();
    write_it(&there.path().join("b.obj"), &scene);
    let written = contents(there.path());
    assert_eq!(written[Path::new("wood.png")], PNG);
    let library = String::from_utf8_lossy(&written[Path::new("b.mtl")]).into_owned();
    assert!(library.contains("map_Kd -bm 2 wood.png\nmap_Ks /gone/stone.png\n"), "{library}");
    assert_eq!(written.len(), 3);
}

#[test]
fn images_of_one_name_in_two_places_become_two() {
    let object = format!("mtllib a.mtl\n{SQUARE}usemtl m\nf 1 2 3\n");
    let second: &[u8] = b"\x89PNG2";
    let here = folder(&[
        ("in/a.obj", object.as_bytes()),
        ("in/a.mtl", b"newmtl m\nmap_Kd ../x/w.png\nmap_Ks ../y/w.png\nbump ../x/w.png\n"),
        ("x/w.png", PNG),
        ("y/w.png", second),
    ]);
    let scene = read_it(&here.path().join("in/a.obj"));
    let there = tempdir().unwrap();
    write_it(&there.path().join("a.obj"), &scene);
    let library = fs::read_to_string(there.path().join("a.mtl")).unwrap();
    assert_eq!(library, "newmtl m\nmap_Kd w.png\nmap_Ks w-2.png\nbump w.png\n");
    assert_eq!(fs::read(there.path().join("w-2.png")).unwrap(), second);
}

#[test]
fn embedded_images_of_one_name_become_two() {
    let mut scene = read_it(&own_file("full.obj"));
    for name in ["maps/Normal.PNG", "wood grain.png"] {
        scene.images.iter_mut().find(|image| image.name == name).unwrap().name =
            "maps/a.png".into();
    }
    let there = tempdir().unwrap();
    write_it(&there.path().join("a.obj"), &scene);
    let again = read_it(&there.path().join("a.obj"));
    let bytes = |scene: &Scene, image: Option<usize>| scene.images[image.unwrap()].bytes.clone();
    for (new, old) in again.materials.iter().zip(&scene.materials).take(1) {
        let [a, b] = [new, old].map(|material| material.base_color_image);
        assert_eq!(bytes(&again, a), bytes(&scene, b));
        let [a, b] = [new, old].map(|material| material.shading.normal_image);
        assert_eq!(bytes(&again, a), bytes(&scene, b));
    }
    assert!(there.path().join("maps/a-2.png").exists());
}

#[test]
fn what_is_missing_is_named_and_stays_named() {
    let object = format!("mtllib gone.mtl\n{SQUARE}usemtl m\nf 1 2 3\n");
    let here = folder(&[("a.obj", object.as_bytes())]);
    let path = here.path().join("a.obj");
    let scene = read_it(&path);
    assert_eq!(notes(&scene), ["1 material library that was not found (gone.mtl)"]);
    write_it(&path, &scene);
    assert_eq!(contents(here.path()).len(), 1, "no library of nothing");
    assert!(fs::read_to_string(&path).unwrap().starts_with("mtllib gone.mtl\n"));
    let object = format!("mtllib a.mtl\n{SQUARE}usemtl m\nf 1 2 3\n");
    let library: &[u8] = b"newmtl m\nmap_Ns gone.png\nnorm text.png\n";
    let here = folder(&[
        ("a.obj", object.as_bytes()),
        ("a.mtl", library),
        ("text.png", b"This is a secret."),
    ]);
    let scene = read_it(&here.path().join("a.obj"));
    let note = "2 images that were not found or cannot be used (gone.png, text.png)";
    assert_eq!(notes(&scene), [note]);
    let there = tempdir().unwrap();
    write_it(&there.path().join("a.obj"), &scene);
    let written = contents(there.path());
    assert_eq!(written[Path::new("a.mtl")], library);
    assert_eq!(written.len(), 2, "the text is no image, and is not copied");
}

#[test]
fn what_is_no_face_is_counted() {
    let text = format!(
        "{SQUARE}v 2 2 2 0.5\nv 3 3 3 1 0 0 0.5\nvt 0 0 0.5\nvt 0 1 0\no a\ng b c\ns round\ns 1\nf 1 2 3\n\
         s off\nf 1 2\nf 3\nl 1 2\nl 1 3\np 1\ncstype bezier\ncurv 0 1 1 2\nmg 1\n"
    );
    let here = folder(&[("a.obj", text.as_bytes())]);
    let expected = [
        "2 lines",
        "1 statement of points",
        "2 statements of free-form curves or surfaces",
        "1 other statement (mg)",
        "2 faces of fewer than three corners",
        "1 smoothing group that is no number (round)",
        "1 name of a group (b c)",
        "1 third texture coordinate",
        "1 weight of a vertex",
        "1 opacity of a vertex",
    ];
    assert_eq!(notes(&read_it(&here.path().join("a.obj"))), expected);
}

#[test]
fn gltf_gets_what_it_has_a_place_for_and_gives_it_back() {
    let scene = read_it(&own_file("full.obj"));
    let back = meshlod_io::gltf::read(
        &write_glb(&scene, &[]).unwrap(),
        &mut |_| None,
        meshlod_io::Weld::Exact,
    )
    .unwrap();
    for (new, old) in back.materials.iter().zip(&scene.materials) {
        let image = |scene: &Scene, image: Option<usize>| {
            image.map(|image| scene.images[image].bytes.clone())
        };
        let [a, b] = [&new.shading, &old.shading];
        assert_eq!(
            (new.base_color, a.metallic, a.roughness),
            (old.base_color, b.metallic, b.roughness)
        );
        assert_eq!((a.emission, a.normal_scale), (b.emission, b.normal_scale));
        for (a, b) in [
            (a.metallic_image, b.metallic_image),
            (a.roughness_image, b.roughness_image),
            (a.normal_image, b.normal_image),
            (a.emission_image, b.emission_image),
            (new.base_color_image, old.base_color_image),
        ] {
            assert_eq!(image(&back, a), image(&scene, b), "{}", old.name);
        }
    }
    let metal = &back.materials[1].shading;
    assert_eq!((metal.metallic, metal.roughness, metal.emission), (1.0, 0.4, [2.0, 1.0, 0.5]));
    assert_eq!(back.materials[0].shading.roughness, 0.5, "(2 / 32)^(1/4), of Ns 30");
    let left_out: fn(&Note) -> bool = |note| note.kind == NoteKind::LeftOut;
    assert!(!back.limits_of(Format::Obj).iter().any(left_out));
    let names: Vec<&str> = back.nodes.iter().map(|node| &*node.name).collect();
    assert_eq!(names, ["", "ends", "walls"]);
    let there = tempdir().unwrap();
    write_it(&there.path().join("a.obj"), &back);
    let again = read_it(&there.path().join("a.obj"));
    for (new, old) in again.materials.iter().zip(&back.materials) {
        let [a, b] = [&new.shading, &old.shading];
        assert_eq!(
            (new.base_color, a.metallic, a.roughness),
            (old.base_color, b.metallic, b.roughness)
        );
        assert_eq!((a.emission, a.normal_scale), (b.emission, b.normal_scale));
        assert_eq!(a.normal_image.is_some(), b.normal_image.is_some());
    }
    let losses = scene.limits_of(Format::Glb);
    assert_eq!(losses.len(), 2, "{losses:?}");
    assert!(
        losses[0].names.contains(&"Ka".to_owned()) && losses[1].names.contains(&"Ns".to_owned())
    );
}

#[test]
fn skeletons_keep_every_statement() {
    let scene = read_it(&own_file("full.obj"));
    let skeleton = Skeleton::of(&scene, vec![true]).unwrap();
    let image = |bytes: &Vec<u8>| SkeletonImage { bytes: bytes.clone(), is_preview: false };
    let images: Vec<_> = scene.images.iter().map(|of| image(&of.bytes)).collect();
    let back = skeleton.clone().into_scene(images, true).unwrap();
    assert_eq!((back.materials, back.images), (scene.materials, scene.images));
    let text = String::from_utf8(skeleton.document).unwrap();
    let wrong = text.replace("\"map\":{\"image\":0", "\"map\":{\"image\":99");
    assert_ne!(wrong, text);
    let skeleton =
        Skeleton { document: wrong.into_bytes(), emptied: vec![true], ..Skeleton::default() };
    let error = skeleton.into_scene(vec![SkeletonImage::default(); 5], true).unwrap_err();
    assert!(error.to_string().contains("image 99"), "{error}");
}
