//! Any file that we read: what it is, and the scene in it.

use std::fs::File;
use std::path::{Path, PathBuf};

use meshlod_codec::{Malformed, TransportFile};
use meshlod_io::{Format, IoError, Note, ReadOptions, Resolve, Scene, Weld, read, read_bytes};
use meshlod_multires::{FileError, ModelFile, Query};
use thiserror::Error;

use crate::files::compressed::decode;
use crate::files::{FileBytes, FileKind};
use crate::model::{ModelScene, ModelSceneError};

/// A file of any kind that we read, opened: the suffix decides whether it is one of ours.
///
/// ```
/// use meshlod::{AnyFile, Output, ReadOptions, Scene, WriteOptions, samples};
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("fish.ply");
///
/// let fish = Scene::from_mesh("fish", samples::fish(4_000));
/// Output::new(&path)?.write(&fish, &WriteOptions::default())?;
/// let scene = AnyFile::open(&path, &ReadOptions::default())?.into_scene()?;
/// assert_eq!(scene.meshes[0].mesh.faces.len(), fish.meshes[0].mesh.faces.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct AnyFile {
    path: PathBuf,
    content: Content,
}

#[derive(Debug)]
enum Content {
    Scene(Box<Scene>),
    Levels(Box<ModelFile<FileBytes>>),
    Compressed(Vec<u8>),
}

/// Reason why a file cannot be opened, or its scene not be read: one line that names the file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AnyFileError {
    /// The system, an unknown suffix, or a mesh file that is malformed.
    #[error(transparent)]
    Io(#[from] IoError),
    /// A multiresolution file that is malformed.
    #[error("{}: {source}{}", path.display(), advice(source))]
    Levels {
        /// The file.
        path: PathBuf,
        /// Reason.
        source: FileError,
    },
    /// A compressed file that is malformed.
    #[error("{}: {source}", path.display())]
    Compressed {
        /// The file.
        path: PathBuf,
        /// Reason, with the byte.
        source: Malformed,
    },
    /// A scene in a file of ours that is malformed.
    #[error("{}: {source}", path.display())]
    Scene {
        /// The file.
        path: PathBuf,
        /// Reason.
        source: ModelSceneError,
    },
    /// [`Weld::Within`] for a file of ours.
    #[error(
        "{}: weld: vertices of this file were joined when it was made; weld the mesh that it was \
         made from",
        .0.display()
    )]
    Weld(PathBuf),
}

impl AnyFileError {
    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        match self {
            Self::Io(error) => error.path(),
            Self::Levels { path, .. }
            | Self::Compressed { path, .. }
            | Self::Scene { path, .. }
            | Self::Weld(path) => path,
        }
    }
}

/// Says what to do about a file that is no multiresolution file.
fn advice(error: &FileError) -> &'static str {
    match error {
        FileError::Magic => "; meshlod build makes such a file of a mesh",
        _ => "",
    }
}

impl AnyFile {
    /// Opens a file. A mesh is read whole, with the files that it refers to; of a multiresolution
    /// file only the header.
    ///
    /// # Errors
    /// One line that names the file and the place in it.
    pub fn open(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Self, AnyFileError> {
        let path = path.as_ref();
        let system = |error| IoError::system(path, error);
        let content = match FileKind::of_path(path)? {
            FileKind::Mesh(_) => Content::Scene(Box::new(read(path, options)?)),
            own => {
                may_weld(path, options)?;
                match own {
                    FileKind::Levels => {
                        levels(path, FileBytes::Disk(File::open(path).map_err(system)?))?
                    }
                    _ => Content::Compressed(std::fs::read(path).map_err(system)?),
                }
            }
        };
        Ok(Self { path: path.to_owned(), content })
    }

    /// Opens a file that is in memory; `path` names it in errors, and `resolve` loads the files that
    /// a mesh refers to.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn from_bytes(
        path: impl AsRef<Path>,
        kind: FileKind,
        bytes: Vec<u8>,
        resolve: Resolve<'_>,
        options: &ReadOptions,
    ) -> Result<Self, AnyFileError> {
        let path = path.as_ref();
        let content = match kind {
            FileKind::Mesh(format) => {
                Content::Scene(Box::new(scene_of(path, format, &bytes, resolve, options)?))
            }
            FileKind::Levels => {
                may_weld(path, options)?;
                levels(path, FileBytes::Memory(bytes))?
            }
            FileKind::Resident | FileKind::Sent => {
                may_weld(path, options)?;
                Content::Compressed(bytes)
            }
        };
        Ok(Self { path: path.to_owned(), content })
    }

    /// Returns the path of the file, or what was given in its place.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns what the file is: of compressed files the content decides, not the suffix.
    pub fn kind(&self) -> FileKind {
        match &self.content {
            Content::Scene(_) => {
                FileKind::of_path(&self.path).unwrap_or(FileKind::Mesh(Format::Ply))
            }
            Content::Levels(_) => FileKind::Levels,
            Content::Compressed(bytes) if bytes.starts_with(&TransportFile::MAGIC) => {
                FileKind::Sent
            }
            Content::Compressed(_) => FileKind::Resident,
        }
    }

    /// Returns all levels, if the file has them.
    pub fn levels(&self) -> Option<&ModelFile<FileBytes>> {
        match &self.content {
            Content::Levels(file) => Some(file),
            _ => None,
        }
    }

    /// Returns the bytes of a compressed file.
    pub fn compressed(&self) -> Option<&[u8]> {
        match &self.content {
            Content::Compressed(bytes) => Some(bytes),
            _ => None,
        }
    }

    /// Returns notes on what the file lacks: what a mesh format could not hold, or what a truncated
    /// file of ours has lost.
    pub fn notes(&self) -> Vec<Note> {
        match &self.content {
            Content::Scene(scene) => scene.notes.clone(),
            Content::Levels(file) => vec![truncation(file)],
            Content::Compressed(_) => Vec::new(),
        }
    }

    /// Returns the scene in the file, with its notes; of all levels, the finest that it holds.
    ///
    /// # Errors
    /// A file of ours that is malformed.
    pub fn into_scene(self) -> Result<Scene, AnyFileError> {
        let notes = self.notes();
        let Self { path, content } = self;
        let (mesh, model) = match content {
            Content::Scene(scene) => return Ok(*scene),
            Content::Compressed(bytes) => match decode(&bytes) {
                Ok(decoded) => decoded,
                Err(source) => return Err(AnyFileError::Compressed { path, source }),
            },
            Content::Levels(file) => match file.extract(&Query::finest()) {
                Ok(taken) => (taken.level.mesh(), model_of(&path, &file)?),
                Err(source) => return Err(AnyFileError::Levels { path, source }),
            },
        };
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let lost = model.missing.notes();
        let scene = model.into_scene(name, mesh);
        let mut scene = scene.map_err(|source| AnyFileError::Scene { path, source })?;
        scene.notes.extend([notes, lost].concat().into_iter().filter(|note| note.count > 0));
        Ok(scene)
    }
}

/// Reads the scene of a multiresolution file, which a height field does not have.
fn model_of(path: &Path, file: &ModelFile<FileBytes>) -> Result<ModelScene, AnyFileError> {
    let ModelFile::Contractions(archive) = file else { return Ok(ModelScene::default()) };
    let model = ModelScene::read(archive);
    model.map_err(|source| AnyFileError::Scene { path: path.to_owned(), source })
}

/// Returns the note of how far a truncated multiresolution file goes, of count 0 if it is whole.
fn truncation(file: &ModelFile<FileBytes>) -> Note {
    let [there, all] = file.pieces();
    let one = file.piece_name();
    let many = format!("{one}s");
    let goes = format!(": the file is truncated, and {there} of its {all} {many} are present");
    let note = Note::left_out(all - there, one, &many).detailed(&goes);
    note.remedied("fetch the rest for the finest levels")
}

/// Opens a multiresolution file.
fn levels(path: &Path, bytes: FileBytes) -> Result<Content, AnyFileError> {
    let opened = ModelFile::open(bytes);
    let opened = opened.map_err(|source| AnyFileError::Levels { path: path.to_owned(), source })?;
    Ok(Content::Levels(Box::new(opened)))
}

/// Refuses to weld a file of ours.
fn may_weld(path: &Path, options: &ReadOptions) -> Result<(), AnyFileError> {
    match options.weld {
        Weld::Within(_) => Err(AnyFileError::Weld(path.to_owned())),
        Weld::Exact | Weld::Off => Ok(()),
    }
}

/// Parses a mesh in memory.
fn scene_of(
    path: &Path,
    format: Format,
    bytes: &[u8],
    resolve: Resolve<'_>,
    options: &ReadOptions,
) -> Result<Scene, AnyFileError> {
    let parsed = read_bytes(bytes, format, resolve, options);
    Ok(parsed.map_err(|source| IoError::Parse { path: path.to_owned(), source })?)
}
