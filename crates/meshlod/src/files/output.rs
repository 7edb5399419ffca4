//! Where a result goes, and in which format.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use meshlod_io::gltf::{Level, LodLayout, NeedleLevels, StripMesh};
use meshlod_io::{
    Format, IoError, Note, Scene, WriteOptions, WrittenFile, check_place, write, write_file,
    write_lods, write_needle, write_strips, write_to,
};
use meshlod_mesh::Mesh;

use crate::files::FileKind;
use crate::jobs::ConvertRequest;

/// A file to be written: its path, and what its suffix says that it is; or standard output.
///
/// Missing folders are made when it is written. Scenes are written one at a time in a process, since
/// an image takes a name that is free.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    /// `None` for standard output.
    path: Option<PathBuf>,
    kind: FileKind,
}

impl Output {
    /// Creates an output, and checks that a file can be there, before any work is done.
    ///
    /// # Errors
    /// An unknown suffix, one of files that are only read, a path that is a folder, and a folder that
    /// is a file.
    pub fn new(path: impl Into<PathBuf>) -> Result<Self, IoError> {
        let path = path.into();
        check_place(&path)?;
        let own = FileKind::own_of_path(&path);
        let kind = own.map_or_else(|| Format::of_output(&path).map(FileKind::Mesh), Ok)?;
        Ok(Self { kind, path: Some(path) })
    }

    /// Creates standard output, to which a scene goes in this format.
    pub fn stdout(format: Format) -> Self {
        Self { path: None, kind: FileKind::Mesh(format) }
    }

    /// Returns the path; `-` for standard output.
    pub fn path(&self) -> &Path {
        self.path.as_deref().unwrap_or(Path::new("-"))
    }

    /// Returns true if the file comes without others beside it.
    pub fn is_alone(&self) -> bool {
        self.path.is_none()
    }

    /// Returns the kind of file that is written.
    pub fn kind(&self) -> FileKind {
        self.kind
    }

    /// Returns notes on what the file will lack of a scene, with a format that keeps everything as
    /// the remedy, where there is one.
    pub fn limits(&self, scene: &Scene, options: &WriteOptions) -> Vec<Note> {
        self.request(options).map(|request| limits(scene, &request)).unwrap_or_default()
    }

    /// Returns notes like [`limits`](Self::limits) on all files of a scene and its levels, each
    /// given as the meshes that it has instead of those of the scene.
    pub fn limits_of_levels<'l>(
        &self,
        scene: &mut Scene,
        levels: impl IntoIterator<Item = &'l mut Vec<Mesh>>,
        options: &WriteOptions,
    ) -> Vec<Note> {
        let Some(request) = self.request(options) else { return Vec::new() };
        let mut lost = scene.limits_of(request.format);
        for level in levels {
            scene.swap_meshes(level);
            Note::merge(&mut lost, scene.limits_of(request.format));
            scene.swap_meshes(level);
        }
        all_limits(scene, lost, &request)
    }

    /// Returns the request to convert a scene to what this is, unless it is of a kind of our own.
    fn request(&self, options: &WriteOptions) -> Option<ConvertRequest> {
        let FileKind::Mesh(format) = self.kind else { return None };
        Some(ConvertRequest { format, precision: options.precision, alone: self.is_alone() })
    }

    /// Writes a scene, with the files that belong to it.
    ///
    /// # Errors
    /// Those of [`meshlod_io::write`]; a kind of our own, which a job packs: see
    /// [`write_bytes`](Self::write_bytes).
    pub fn write(&self, scene: &Scene, options: &WriteOptions) -> Result<(), IoError> {
        match (&self.path, self.kind) {
            (None, FileKind::Mesh(format)) => {
                let mut out = BufWriter::new(io::stdout().lock());
                let written = write_to(&mut out, scene, format, options);
                let written = written.and_then(|()| out.flush());
                written.map_err(|error| IoError::system(self.path(), error))
            }
            _ => {
                let _naming = naming();
                write(self.path(), scene, options)
            }
        }
    }

    /// Writes a scene and its coarser levels as glTF.
    ///
    /// # Errors
    /// Those of [`meshlod_io::write_lods`].
    pub fn write_levels(
        &self,
        scene: &Scene,
        levels: &[Level],
        layout: LodLayout,
    ) -> Result<(), IoError> {
        let _naming = naming();
        write_lods(self.path(), scene, levels, layout)
    }

    /// Writes a scene and its coarser levels as `NEEDLE_progressive`; returns the files, that of this
    /// output first.
    ///
    /// # Errors
    /// Those of [`meshlod_io::write_needle`].
    pub fn write_needle(
        &self,
        scene: &Scene,
        levels: NeedleLevels<'_>,
    ) -> Result<Vec<WrittenFile>, IoError> {
        let _naming = naming();
        write_needle(self.path(), scene, levels)
    }

    /// Writes a scene as glTF, with strips for faces.
    ///
    /// # Errors
    /// Those of [`meshlod_io::write_strips`].
    pub fn write_strips(&self, scene: &Scene, strips: &[StripMesh]) -> Result<(), IoError> {
        let _naming = naming();
        write_strips(self.path(), scene, strips)
    }

    /// Writes a file that a job has packed.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write_bytes(&self, bytes: &[u8]) -> Result<(), IoError> {
        write_file(self.path(), bytes)
    }
}

/// Returns notes on what a file of a format will lack of a scene.
pub(crate) fn limits(scene: &Scene, request: &ConvertRequest) -> Vec<Note> {
    all_limits(scene, scene.limits_of(request.format), request)
}

/// Adds remedies to what a format lacks, and notes on what this file lacks besides.
fn all_limits(scene: &Scene, lost: Vec<Note>, request: &ConvertRequest) -> Vec<Note> {
    let ConvertRequest { format, precision, alone } = *request;
    let mut notes = remedied(scene, lost);
    if alone {
        notes.extend(scene.lone_file_limits(format));
    }
    notes.extend(scene.precision_limits(format, precision));
    notes
}

/// Adds to what a format lacks of a scene the name of another that holds all of it, if there is one
/// and nothing else is to do.
fn remedied(scene: &Scene, limits: Vec<Note>) -> Vec<Note> {
    let holds = |(format, _): &(Format, &str)| scene.limits_of(*format).is_empty();
    let mut formats = [(Format::Glb, ".glb"), (Format::Obj, ".obj")].into_iter();
    let Some((_, suffix)) = formats.find(|format| !limits.is_empty() && holds(format)) else {
        return limits;
    };
    let keeps = format!("{suffix} keeps everything");
    let remedy = |note: Note| match note.remedy {
        Some(_) => note,
        None => note.remedied(keeps.clone()),
    };
    limits.into_iter().map(remedy).collect()
}

/// Has one thread at a time write scenes: an image gets a name that is free, and takes it only once
/// it is complete.
fn naming() -> MutexGuard<'static, ()> {
    static NAMING: Mutex<()> = Mutex::new(());
    NAMING.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use meshlod_samples as samples;

    use super::*;

    #[test]
    fn the_folder_of_an_output_is_made() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b/torus.ply");
        let torus = Scene::from_mesh("torus", samples::torus(100));
        Output::new(&path).unwrap().write(&torus, &WriteOptions::default()).unwrap();
        assert!(path.exists());
    }

    #[test]
    fn an_output_that_cannot_be_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        let refused = |path: PathBuf| Output::new(path).unwrap_err().to_string();
        assert!(refused(folder.path().into()).contains("is a folder"));
        assert!(refused(file.join("a.ply")).contains("its folder is a file"));
        assert!(refused(file.join("b/a.ply")).contains("its folder is a file"));
        assert!(refused(folder.path().join("a.txt")).contains("unknown suffix"));
    }
}
