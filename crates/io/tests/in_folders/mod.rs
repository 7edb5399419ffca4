//! Files in folders of their own, read and written with the default options.

use std::fs;
use std::path::Path;

use meshlod_io::{ReadOptions, Scene, WriteOptions, read, write};
use tempfile::{TempDir, tempdir};

pub fn read_it(path: &Path) -> Scene {
    read(path, &ReadOptions::default()).unwrap()
}

pub fn write_it(path: &Path, scene: &Scene) {
    write(path, scene, &WriteOptions::default()).unwrap();
}

/// Returns a folder with these files.
pub fn folder(files: &[(&str, &[u8])]) -> TempDir {
    let folder = tempdir().unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    folder
}
