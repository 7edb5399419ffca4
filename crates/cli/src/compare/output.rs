//! Where the levels go, in a format that holds all that the input has.

use std::path::{Path, PathBuf};

use meshlod::io::Precision;
use meshlod::{Format, IoError, Method, Scene, WriteOptions, write};

use crate::amounts::Size;
use crate::files;
use crate::session::Session;

/// A folder, and the format of the levels in it.
pub struct Output {
    pub folder: PathBuf,
    suffix: &'static str,
}

impl Output {
    /// In the input's own format where only that keeps its textures and nodes, else PLY, which
    /// keeps every bit of the positions.
    pub fn new(folder: &Path, input: &Path, scene: &Scene, session: &Session) -> Self {
        let format = match files::is_pipe(input) {
            true => session.format,
            false => Format::of_path(input).ok(),
        };
        let attributes = scene.meshes.iter().any(|mesh| mesh.mesh.attributes.is_some());
        let suffix = match format {
            // Of .gltf the buffer would lie beside: a file more for every level.
            Some(Format::Glb | Format::Gltf) => "glb",
            Some(Format::Obj) if attributes || !scene.materials.is_empty() => "obj",
            _ => "ply",
        };
        Self { folder: folder.to_owned(), suffix }
    }

    /// The name of a level's file.
    pub fn file(&self, method: Method, size: Size) -> String {
        format!("{}-{}.{}", method.name(), size.in_file_names(), self.suffix)
    }

    /// Writes a level with 64 bits a coordinate where the format has them, so that it measures the
    /// same again.
    pub fn write(&self, file: &str, scene: &Scene) -> Result<(), IoError> {
        write(&self.folder.join(file), scene, &WriteOptions { precision: Precision::F64 })
    }
}
