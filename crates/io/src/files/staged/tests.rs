use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;

use meshlod_fixtures::{cube, tetrahedron};
use meshlod_mesh::{Labels, LayerKind};
use tempfile::tempdir;

use super::*;
use crate::vertex_attributes::{named_layer, per_vertex};
use crate::{Image, Material, ReadOptions, Scene, WriteOptions, read, write};

type Hook = Box<dyn FnMut() -> bool>;

thread_local! {
    /// Called before every step; false makes the step fail.
    static HOOK: RefCell<Option<Hook>> = const { RefCell::new(None) };
    /// Bytes until the disk is full.
    static ROOM: Cell<usize> = const { Cell::new(usize::MAX) };
}

pub(super) fn step(_: &str, path: &Path) -> Result<(), IoError> {
    let goes = HOOK.with_borrow_mut(|hook| hook.as_mut().is_none_or(|hook| hook()));
    let failed = || IoError::system(path, io::Error::other("injected"));
    if goes { Ok(()) } else { Err(failed()) }
}

pub(super) fn bounded<'a>(out: &'a mut dyn Write) -> Box<dyn Write + 'a> {
    Box::new(Bounded(out))
}

/// Writer to a disk with little room.
struct Bounded<'a>(&'a mut dyn Write);

impl Write for Bounded<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let room = ROOM.get();
        if room < bytes.len() {
            let _ = self.0.write(&bytes[..room])?;
            return Err(io::ErrorKind::StorageFull.into());
        }
        ROOM.set(room - bytes.len());
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// Contents of all files of a folder, by their names; folders have none.
type Contents = BTreeMap<PathBuf, Option<Vec<u8>>>;

fn contents(folder: &Path) -> Contents {
    let mut all = Contents::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => {
                all.insert(path.clone(), None);
                all.extend(contents(&path));
            }
            false => {
                all.insert(path.clone(), fs::read(&path).ok());
            }
        }
    }
    all
}

fn restore(folder: &Path, all: &Contents) {
    fs::remove_dir_all(folder).unwrap();
    fs::create_dir(folder).unwrap();
    for (path, bytes) in all {
        match bytes {
            Some(bytes) => fs::write(path, bytes).unwrap(),
            None => fs::create_dir(path).unwrap(),
        }
    }
}

/// Returns two scenes, of which everything differs that is written to files.
fn versions() -> [Scene; 2] {
    let image = |name: &str, end: u8| Image {
        name: format!("maps/{name}.png"),
        bytes: [&b"\x89PNG\r\n\x1a\n"[..], &[end]].concat(),
    };
    let scene = |mesh, color: f32, image: Image| Scene {
        materials: vec![Material {
            name: "paint".into(),
            base_color: [color, 0.5, 0.5, 1.0],
            base_color_image: Some(0),
            ..Material::default()
        }],
        images: vec![image],
        ..Scene::from_mesh("it", mesh)
    };
    let mut versions =
        [scene(tetrahedron(), 0.25, image("old", 1)), scene(cube(), 1.0, image("new", 2))];
    versions.iter_mut().for_each(|scene| scene.meshes[0].materials = vec![Some(0)]);
    versions.iter_mut().for_each(|scene| {
        let faces = scene.meshes[0].mesh.faces.len();
        let names = vec!["paint".to_owned()];
        let mesh = &mut scene.meshes[0].mesh;
        mesh.materials = Some(Labels { names, of_face: vec![0; faces] });
        let count = mesh.positions.len();
        let uvs = named_layer(LayerKind::Uv(0), 2, vec![0.5; 2 * count]);
        mesh.attributes = per_vertex(count, &mesh.faces, vec![uvs]);
    });
    versions
}

/// Returns the parts that tell one version of a scene from the other.
fn parts(scene: &Scene) -> (usize, [f32; 4], Vec<Image>) {
    (scene.flatten().faces.len(), scene.materials[0].base_color, scene.images.clone())
}

fn read_it(path: &Path) -> Scene {
    read(path, &ReadOptions::default()).unwrap()
}

fn write_it(path: &Path, scene: &Scene) -> Result<(), IoError> {
    write(path, scene, &WriteOptions::default())
}

/// Writes a scene, and returns what a kill before each step would have left.
fn states_of_write(path: &Path, scene: &Scene) -> Vec<Contents> {
    let folder = path.parent().unwrap().to_owned();
    let states = std::rc::Rc::new(RefCell::new(Vec::new()));
    let seen = std::rc::Rc::clone(&states);
    let hook: Hook = Box::new(move || {
        seen.borrow_mut().push(contents(&folder));
        true
    });
    HOOK.set(Some(hook));
    write_it(path, scene).unwrap();
    HOOK.set(None);
    states.take()
}

#[test]
fn a_kill_at_any_step_leaves_one_version_or_the_other() {
    for name in ["it.gltf", "it.obj"] {
        let folder = tempdir().unwrap();
        let path = folder.path().join(name);
        let [old, new] = versions();
        write_it(&path, &old).unwrap();
        // glTF embeds what is new; OBJ has images beside it.
        let [is_old, is_new] = [&old, &new].map(|scene| {
            let other = tempdir().unwrap();
            let path = other.path().join(name);
            write_it(&path, scene).unwrap();
            parts(&read_it(&path))
        });
        assert!(is_old.0 != is_new.0 && is_old.1 != is_new.1 && is_old.2 != is_new.2);
        let states = states_of_write(&path, &new);
        assert!(states.len() >= 5, "{name}: a write and a rename of two files, and a removal");
        let found = parts(&read_it(&path));
        assert_eq!(found, is_new, "{name}");
        let mut seen = [0, 0];
        for state in &states {
            restore(folder.path(), state);
            let found = parts(&read_it(&path));
            assert!(found == is_old || found == is_new, "{name}: {:?}", state.keys());
            seen[usize::from(found == is_new)] += 1;
        }
        assert!(seen.iter().all(|&count| count > 0), "{name}: {seen:?}");
    }
}

#[test]
fn a_step_that_fails_leaves_what_was_there() {
    for name in ["it.gltf", "it.obj"] {
        for had_old in [false, true] {
            let folder = tempdir().unwrap();
            let path = folder.path().join(name);
            let [old, new] = versions();
            if had_old {
                write_it(&path, &old).unwrap();
            }
            let before = contents(folder.path());
            let mut failures = 0;
            loop {
                let mut left = failures;
                HOOK.set(Some(Box::new(move || {
                    left -= 1;
                    left >= 0
                })));
                let written = write_it(&path, &new);
                HOOK.set(None);
                let is_done = read(&path, &ReadOptions::default())
                    .is_ok_and(|scene| scene.flatten().faces.len() == cube().faces.len());
                if written.is_ok() || is_done {
                    break;
                }
                assert_eq!(contents(folder.path()), before, "{name}: step {failures}");
                failures += 1;
            }
            assert!(failures >= 4, "{name}: {failures}");
        }
    }
}

#[test]
fn a_full_disk_leaves_what_was_there() {
    for name in ["it.gltf", "it.obj"] {
        for had_old in [false, true] {
            let folder = tempdir().unwrap();
            let path = folder.path().join(name);
            let [old, new] = versions();
            if had_old {
                write_it(&path, &old).unwrap();
            }
            let before = contents(folder.path());
            let mut room = 0;
            loop {
                ROOM.set(room);
                let written = write_it(&path, &new);
                ROOM.set(usize::MAX);
                if written.is_ok() {
                    break;
                }
                assert_eq!(contents(folder.path()), before, "{name}: {room} bytes");
                room += 7;
            }
            let is_new =
                |(path, bytes): &(PathBuf, Option<Vec<u8>>)| before.get(path) != Some(bytes);
            let new = contents(folder.path()).into_iter().filter(is_new);
            let written: usize = new.filter_map(|(_, bytes)| Some(bytes?.len())).sum();
            assert!(written > 100 && room >= written, "{name}: {written} bytes were cut anywhere");
        }
    }
}

#[test]
fn writes_in_place_litter_nothing() {
    for (name, part) in [("it.gltf", "it.bin"), ("it.obj", "it.mtl")] {
        let folder = tempdir().unwrap();
        let path = folder.path().join(name);
        let [old, new] = versions();
        write_it(&path, &old).unwrap();
        assert!(folder.path().join(part).exists(), "the ordinary name");
        let count = || {
            let files = fs::read_dir(folder.path()).unwrap().flatten();
            files.filter(|entry| entry.path().is_file()).count()
        };
        assert_eq!(count(), 2);
        for scene in [&new, &new, &old, &new, &old] {
            write_it(&path, scene).unwrap();
            assert_eq!(count(), 2, "{:?}", contents(folder.path()).keys());
            assert_eq!(read_it(&path).materials[0].base_color, scene.materials[0].base_color);
        }
        write_it(&path, &old).unwrap();
        assert!(folder.path().join(part).exists(), "the ordinary name again");
        let before = contents(folder.path());
        write_it(&path, &old).unwrap();
        assert!(contents(folder.path()) == before, "the same again changes nothing");
    }
}

#[test]
fn a_part_that_another_document_uses_stays() {
    for (name, other, suffix) in [("it.gltf", "other.gltf", "bin"), ("it.obj", "other.obj", "mtl")]
    {
        let folder = tempdir().unwrap();
        let [path, other] = [name, other].map(|name| folder.path().join(name));
        let [old, new] = versions();
        write_it(&path, &old).unwrap();
        fs::copy(&path, &other).unwrap();
        let was = parts(&read_it(&other));
        for scene in [&new, &old, &new] {
            write_it(&path, scene).unwrap();
            assert_eq!(parts(&read_it(&other)), was, "{name}");
            assert_eq!(read_it(&path).materials[0].base_color, scene.materials[0].base_color);
        }
        assert!(folder.path().join(format!("it.{suffix}")).exists());
    }
}

#[test]
fn names_of_parts_are_known_again() {
    assert_eq!(part_name("a", "bin", |_| false), "a.bin");
    assert_eq!(part_name("a", "bin", |name| name.len() < 7), "a-2.bin");
    for (name, is) in [
        ("a.bin", true),
        ("a-2.bin", true),
        ("a-1.bin", false),
        ("a-x.bin", false),
        ("ab.bin", false),
        ("a.mtl", false),
        ("a-2bin", false),
    ] {
        assert_eq!(is_part_name(name, "a", "bin"), is, "{name}");
    }
}
