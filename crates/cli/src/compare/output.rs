//! Files of simplified meshes, in a format that keeps everything the input has.

use std::path::{Path, PathBuf};

use meshlod::io::Precision;
use meshlod::{Format, IoError, Method, Scene, WriteOptions, write};

use crate::options::parse::LevelSize;
use crate::session::Session;
use crate::session::files;

/// Output folder, and the format of the meshes written to it.
pub struct Output {
    pub folder: PathBuf,
    suffix: &'static str,
}

impl Output {
    /// Chooses the file format: the input's own if no other keeps its textures and nodes, otherwise
    /// PLY, which keeps positions exactly.
    pub fn new(folder: &Path, input: &Path, scene: &Scene, session: &Session) -> Self {
        let format = match files::is_pipe(input) {
            true => session.format(),
            false => Format::of_path(input).ok(),
        };
        let attributes = scene.meshes.iter().any(|mesh| mesh.mesh.attributes.is_some());
        let suffix = match format {
            // A .gltf would need a separate buffer file for every level.
            Some(Format::Glb | Format::Gltf) => "glb",
            Some(Format::Obj) if attributes || !scene.materials.is_empty() => "obj",
            _ => "ply",
        };
        Self { folder: folder.to_owned(), suffix }
    }

    /// Returns the file name of a simplified mesh.
    pub fn file(&self, method: Method, size: LevelSize) -> String {
        format!("{}-{}.{}", method.name(), size.in_file_names(), self.suffix)
    }

    /// Writes a simplified mesh with 64-bit coordinates where the format allows, so that it can be
    /// measured again with equal results.
    pub fn write(&self, file: &str, scene: &Scene) -> Result<(), IoError> {
        write(self.folder.join(file), scene, &WriteOptions { precision: Precision::F64 })
    }
}
