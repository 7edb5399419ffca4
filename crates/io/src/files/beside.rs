//! Companion files of a mesh file, looked up by name in its folder.

use std::collections::{BTreeMap, HashMap};
use std::ffi::OsString;
use std::fs;
use std::path::{Component, Path, PathBuf};

use crate::files::names::bare_name;
use crate::format::Format;
use crate::notes::Note;

/// Size limit of an image or material library, in bytes.
const MOST_OF_ONE: u64 = 1 << 30;

/// Limit on the total size of the images and material libraries of a scene, in bytes.
const MOST_OF_ALL: u64 = 1 << 32;

/// Suffixes of images: unlike buffers, they have a size limit.
const IMAGES: [&str; 6] = ["png", "jpg", "jpeg", "webp", "ktx2", "dds"];

/// Reader of the companion files of a mesh file.
pub(super) struct Beside {
    folder: PathBuf,
    /// True if the mesh file refers only to images and libraries.
    has_no_buffers: bool,
    /// Remaining bytes of the total limit.
    left: u64,
    /// Entries of each folder by lower-case name.
    listed: HashMap<PathBuf, HashMap<String, OsString>>,
    /// Absolute names, each with the name of the companion file read instead.
    replaced: BTreeMap<String, String>,
}

impl Beside {
    pub fn of(path: &Path, format: Format) -> Self {
        Self {
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            has_no_buffers: !format.is_gltf(),
            left: MOST_OF_ALL,
            listed: HashMap::new(),
            replaced: BTreeMap::new(),
        }
    }

    /// Reads a file by its name relative to the folder; returns `None` if it does not exist or
    /// exceeds a size limit.
    pub fn read(&mut self, name: &str) -> Option<Vec<u8>> {
        let file = self.find(name)?;
        if self.has_no_buffers || is_image_name(&file) {
            let size = fs::metadata(&file).ok()?.len();
            if size > MOST_OF_ONE.min(self.left) {
                return None;
            }
            self.left -= size;
        }
        let bytes = fs::read(&file).ok()?;
        if bare_name(name).is_some() && self.find_relative(name).is_none() {
            let found = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
            self.replaced.insert(name.to_owned(), found);
        }
        Some(bytes)
    }

    /// Notes the companion files read in place of absolute names.
    pub fn note(self) -> Note {
        let (one, many) = (
            "file with an absolute path, taken from beside the model",
            "files with absolute paths, taken from beside the model",
        );
        let names = self.replaced.iter().map(|(name, found)| format!("{found} for {name}"));
        let note = Note::changed(self.replaced.len(), one, many).named(names);
        note.remedied("write the names of files without their folders")
    }

    /// Finds a file by its name relative to the folder, ignoring case if there is no exact match.
    ///
    /// Only the last part of an absolute name counts, since its folders may not exist on this
    /// machine. Buffers with absolute names are not found.
    pub fn find(&mut self, name: &str) -> Option<PathBuf> {
        self.find_relative(name).or_else(|| {
            let bare = bare_name(name)?;
            let may_be = self.has_no_buffers || is_image_name(Path::new(bare));
            may_be.then(|| self.find_relative(bare))?
        })
    }

    fn find_relative(&mut self, name: &str) -> Option<PathBuf> {
        // Exporters on Windows write backslashes.
        let names = [name.to_owned(), name.replace('\\', "/")];
        let names = names.into_iter().filter(|name| is_relative(Path::new(name)));
        let names: Vec<String> = names.collect();
        // Only regular files: reading a device might never end.
        let exact = names.iter().map(|name| self.folder.join(name)).find(|path| path.is_file());
        exact.or_else(|| names.iter().find_map(|name| self.find_any_case(Path::new(name))))
    }

    fn find_any_case(&mut self, name: &Path) -> Option<PathBuf> {
        let mut path = self.folder.clone();
        for part in name.components() {
            let Component::Normal(part) = part else {
                path.push(part);
                continue;
            };
            if path.join(part).exists() {
                path.push(part);
                continue;
            }
            let listed = self.listed.entry(path.clone()).or_insert_with(|| list(&path));
            path.push(listed.get(&part.to_string_lossy().to_lowercase())?);
        }
        path.is_file().then_some(path)
    }
}

fn is_image_name(path: &Path) -> bool {
    let suffix = path.extension().unwrap_or_default().to_ascii_lowercase();
    IMAGES.iter().any(|&image| suffix == image)
}

/// Lists a folder by lower-case name; of names that differ only in case, the first in order wins.
fn list(folder: &Path) -> HashMap<String, OsString> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<OsString> = entries.map(|entry| entry.file_name()).collect();
    names.sort();
    let mut listed = HashMap::new();
    for name in names {
        listed.entry(name.to_string_lossy().to_lowercase()).or_insert(name);
    }
    listed
}

fn is_relative(path: &Path) -> bool {
    !path.components().any(|part| matches!(part, Component::RootDir | Component::Prefix(_)))
}

#[cfg(test)]
mod tests {
    use tempfile::tempdir;

    use super::*;

    #[test]
    fn files_are_found_in_other_spellings() {
        let folder = tempdir().unwrap();
        fs::create_dir_all(folder.path().join("Maps/Old")).unwrap();
        fs::write(folder.path().join("Maps/Old/Wood grain.PNG"), "a").unwrap();
        fs::write(folder.path().join("b.png"), "lower").unwrap();
        fs::write(folder.path().join("B.png"), "upper").unwrap();
        let mut beside = Beside::of(&folder.path().join("a.obj"), Format::Obj);
        for name in [
            "Maps/Old/Wood grain.PNG",
            "maps\\old\\wood grain.png",
            "./maps/OLD/../Old/WOOD GRAIN.png",
        ] {
            assert_eq!(beside.read(name).unwrap(), b"a", "{name}");
        }
        assert_eq!(beside.read("b.png").unwrap(), b"lower");
        assert_eq!(beside.read("b.PNG").unwrap(), b"upper", "the first in order");
        for name in ["gone.png", "maps", "", "/etc/hostname"] {
            assert_eq!(beside.read(name), None, "{name}");
        }
    }

    #[test]
    fn absolute_names_lead_to_files_beside() {
        let folder = tempdir().unwrap();
        fs::write(folder.path().join("Wood grain.png"), "a").unwrap();
        fs::write(folder.path().join("a.bin"), "b").unwrap();
        let mut beside = Beside::of(&folder.path().join("a.gltf"), Format::Gltf);
        let names =
            ["C:\\my maps\\wood grain.png", "/home/x/Wood grain.png", "\\\\s\\Wood grain.png"];
        for name in names {
            assert_eq!(beside.read(name).unwrap(), b"a", "{name}");
        }
        for name in ["C:\\a.bin", "/x/a.bin", "C:\\gone.png", "/", "C:\\.."] {
            assert_eq!(beside.read(name), None, "{name}");
        }
        assert_eq!(beside.read("a.bin").unwrap(), b"b");
        let note = beside.note();
        assert_eq!(note.count, 3);
        assert_eq!(note.names[1], "Wood grain.png for C:\\my maps\\wood grain.png");
    }

    #[test]
    fn several_names_in_a_row_are_not_one() {
        for name in ["/a.mtl /b.mtl", "C:/a.mtl D:\\b.mtl", "a.mtl /b.mtl", "maps/a.mtl", "C:a.mtl"]
        {
            assert_eq!(bare_name(name), None, "{name}");
        }
        assert_eq!(bare_name("c:/my maps/a.mtl"), Some("a.mtl"));
    }

    #[test]
    fn what_is_too_large_is_not_read() {
        let folder = tempdir().unwrap();
        let path = folder.path().join("big.png");
        // Sparse: it takes no room.
        fs::File::create(&path).unwrap().set_len(MOST_OF_ONE + 1).unwrap();
        for format in [Format::Obj, Format::Gltf, Format::Ply] {
            assert_eq!(Beside::of(&path, format).read("big.png"), None);
        }
        fs::rename(&path, folder.path().join("big.tga")).unwrap();
        assert_eq!(Beside::of(&path, Format::Ply).read("big.tga"), None, "whatever its suffix");
        let mut beside = Beside::of(&path, Format::Obj);
        beside.left = 3;
        fs::write(folder.path().join("a.png"), "ab").unwrap();
        assert!(beside.read("a.png").is_some() && beside.read("a.png").is_none());
    }
}
