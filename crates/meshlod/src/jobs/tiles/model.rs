//! The model that tiles are made of: one file, or several and those in folders as one.

use std::hash::Hasher;
use std::path::{Path, PathBuf};

use meshlod_io::{IoError, Material, Note, Scene};
use meshlod_tiles::plan::Look;
use meshlod_tiles::source::{JoinedSource, LEAST_STREAMED, SceneSource, Source, open_stream};
use rustc_hash::FxHasher;
use thiserror::Error;

use crate::files::FileKind;
use crate::jobs::refuse_points;
use crate::jobs::tiles::TileInput;

/// Largest number of materials.
const MOST_MATERIALS: usize = u16::MAX as usize;

/// Reason why a file cannot be made into tiles: one line that names it.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TileFileError {
    /// The system, or a file that is malformed.
    #[error(transparent)]
    Io(#[from] IoError),
    /// A file or folder that holds nothing that tiles can be made of.
    #[error("{}: {reason}", path.display())]
    Unfit {
        /// The file or folder.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
}

impl TileFileError {
    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        match self {
            Self::Io(error) => error.path(),
            Self::Unfit { path, .. } => path,
        }
    }

    fn unfit(path: &Path, reason: impl ToString) -> Self {
        Self::Unfit { path: path.to_owned(), reason: reason.to_string() }
    }
}

/// Program that has a model opened: it reads files as a whole, and hears what tiles lack of them.
pub trait TileFiles {
    /// Reason why a file cannot be used.
    type Error: From<TileFileError>;

    /// Returns true for a file that must not be read in passing, such as a pipe.
    fn is_read_whole(&self, path: &Path) -> bool;

    /// Returns a text that is different where files are read in another way.
    fn reading(&self) -> String;

    /// Reads a file as a whole.
    ///
    /// # Errors
    /// Whatever the program fails at.
    fn read(&self, path: &Path) -> Result<Scene, Self::Error>;

    /// Hears what tiles lack of the scene in a file.
    ///
    /// # Errors
    /// The program may refuse such a file.
    fn note(&self, path: &Path, notes: &[Note]) -> Result<(), Self::Error>;

    /// Hears a warning, about a file or about all of them.
    fn warn(&self, path: Option<&Path>, text: &str);
}

/// Model that tiles are made of, opened.
pub struct TileModel {
    source: Box<dyn Source>,
    look: Look,
    key: String,
}

/// File of a model.
struct ModelPart {
    path: PathBuf,
    source: Box<dyn Source>,
    look: Look,
}

impl TileModel {
    /// Opens files and the files in folders, as one model. Large ones are read in passing where that
    /// is possible, the others as a whole. `out` is the folder or archive that the tiles or the plan
    /// will be in, on the disk of which OBJ files that are read in passing take about their size.
    ///
    /// # Errors
    /// Files that cannot be read, that have no faces, or more materials than tiles can number.
    pub fn open<F: TileFiles>(inputs: &[PathBuf], out: &Path, files: &F) -> Result<Self, F::Error> {
        let paths = inputs.iter().map(|input| files_in(input)).collect::<Result<Vec<_>, _>>()?;
        let paths = paths.concat();
        // What is read as a whole is in memory at the same time.
        let least = LEAST_STREAMED / paths.len().max(1) as u64;
        let scratch = folder_there(out);
        let open = |path: &PathBuf| ModelPart::open(path, least, &scratch, files);
        let parts = paths.iter().map(open).collect::<Result<Vec<_>, _>>()?;
        let version = concat!("meshlod ", env!("CARGO_PKG_VERSION"));
        let keys = paths.iter().map(|path| key(path)).chain(parts.iter().map(ModelPart::key));
        let keys = [version.to_owned(), files.reading()].into_iter().chain(keys);
        let key = keys.collect::<Vec<_>>().join("\n");
        Self::join(parts, key, files)
    }

    fn join<F: TileFiles>(
        mut parts: Vec<ModelPart>,
        key: String,
        files: &F,
    ) -> Result<Self, F::Error> {
        if parts.len() == 1 {
            let ModelPart { source, look, .. } = parts.remove(0);
            return Ok(Self { source, look, key });
        }
        let mut look = Look::default();
        let is_plain = parts.iter().all(|part| part.look.labels.is_empty());
        let mut sources = Vec::with_capacity(parts.len());
        for ModelPart { path, source, look: own } in parts {
            let first = match is_plain {
                true => 0,
                false => add(&mut look, own, &path)?,
            };
            sources.push((source, first));
        }
        let (source, dropped) = JoinedSource::new(sources);
        if !dropped.is_empty() {
            let dropped = dropped.join(", ");
            files.warn(None, &format!("not all files have these layers, left out: {dropped}"));
        }
        Ok(Self { source: Box::new(source), look, key })
    }

    /// Returns what the job works on.
    pub fn input(&self) -> TileInput<'_> {
        TileInput { source: &*self.source, look: &self.look, key: &self.key }
    }
}

impl ModelPart {
    /// Returns a text that is different for other materials and images.
    fn key(&self) -> String {
        let mut sum = FxHasher::default();
        self.look.images.iter().for_each(|image| sum.write(&image.bytes));
        sum.write(format!("{:?}", self.look.materials).as_bytes());
        format!("{:016x}", sum.finish())
    }

    /// Opens a file, in passing from a number of bytes on where that is possible.
    fn open<F: TileFiles>(
        path: &Path,
        least: u64,
        scratch: &Path,
        files: &F,
    ) -> Result<Self, F::Error> {
        let at = path.to_owned();
        let streamed = match files.is_read_whole(path) {
            true => None,
            false => open_stream(path, least, scratch).map_err(TileFileError::from)?,
        };
        if let Some(streamed) = streamed {
            if !streamed.left_out.is_empty() {
                let names = streamed.left_out.join(", ");
                files.warn(Some(path), &format!("properties of faces left out: {names}"));
            }
            let look = match &streamed.scene {
                Some(scene) => {
                    files.note(path, &scene.notes)?;
                    look(scene)
                }
                None => Look::default(),
            };
            check_materials(&look, path)?;
            return Ok(Self { path: at, source: streamed.source, look });
        }
        let scene = files.read(path)?;
        check_faces(&scene).map_err(|reason| TileFileError::unfit(path, reason))?;
        files.note(path, &scene.tile_limits())?;
        let look = look(&scene);
        check_materials(&look, path)?;
        Ok(Self { path: at, source: Box::new(SceneSource::new(scene)), look })
    }
}

/// Refuses a scene that shows no face.
fn check_faces(scene: &Scene) -> Result<(), String> {
    refuse_points(scene).map_err(|error| error.to_string())?;
    let has_faces = |mesh: usize| !scene.meshes[mesh].mesh.faces.is_empty();
    match scene.instances().iter().any(|shown| has_faces(shown.mesh)) {
        true => Ok(()),
        false => Err("the mesh has no faces".into()),
    }
}

/// Adds the materials and images of a file; returns the label of the first one.
fn add(all: &mut Look, mut own: Look, path: &Path) -> Result<u16, TileFileError> {
    if own.labels.is_empty() {
        own.labels.push(String::new());
        own.materials.push(Material::default());
    }
    let (first, images) = (all.labels.len(), all.images.len());
    if first + own.labels.len() > MOST_MATERIALS {
        return Err(too_many_materials(path));
    }
    own.materials.iter_mut().for_each(|material| material.shift_images(images));
    all.labels.append(&mut own.labels);
    all.materials.append(&mut own.materials);
    all.images.append(&mut own.images);
    Ok(first as u16)
}

fn check_materials(look: &Look, path: &Path) -> Result<(), TileFileError> {
    match look.labels.len() > MOST_MATERIALS {
        true => Err(too_many_materials(path)),
        false => Ok(()),
    }
}

fn too_many_materials(path: &Path) -> TileFileError {
    let reason = format!("more than {MOST_MATERIALS} materials; tiles number them by 16 bits");
    TileFileError::unfit(path, reason)
}

/// Returns the folder nearest to a path that is to be made, which is there already.
fn folder_there(path: &Path) -> PathBuf {
    let there = path.ancestors().find(|folder| folder.is_dir());
    there.map_or_else(|| PathBuf::from("."), Path::to_owned)
}

/// Returns the files of a folder that are read, by name; of a file or pipe, itself.
fn files_in(input: &Path) -> Result<Vec<PathBuf>, TileFileError> {
    if !input.is_dir() {
        return Ok(vec![input.to_owned()]);
    }
    let failure = |error| IoError::system(input, error);
    let entries = std::fs::read_dir(input).map_err(failure)?;
    let paths = entries.map(|entry| entry.map(|entry| entry.path()));
    let mut paths = paths.collect::<Result<Vec<_>, _>>().map_err(failure)?;
    paths.retain(|path| path.is_file() && FileKind::of_path(path).is_ok());
    paths.sort();
    match paths.is_empty() {
        true => Err(TileFileError::unfit(input, "no file of a format that is read")),
        false => Ok(paths),
    }
}

/// Returns the materials of a scene by the labels that its faces have when it is one mesh.
pub(super) fn look(scene: &Scene) -> Look {
    if scene.materials.is_empty() {
        return Look::default();
    }
    let mut materials = scene.materials.clone();
    // Faces without a material have the last label.
    materials.push(Material::default());
    let labels = materials.iter().map(|material| material.name.clone()).collect();
    Look { labels, materials, images: scene.images.clone(), ..Look::default() }
}

/// Returns a text that is different for another file, and mostly for another content. What comes
/// through a pipe has a new one each time.
fn key(path: &Path) -> String {
    if path == Path::new("-") {
        return format!("{:?}", std::time::SystemTime::now());
    }
    let facts = std::fs::metadata(path).ok();
    let changed = facts.as_ref().and_then(|facts| facts.modified().ok());
    let seconds = changed.and_then(|at| at.duration_since(std::time::UNIX_EPOCH).ok());
    format!(
        "{} {} {}",
        std::path::absolute(path).unwrap_or_else(|_| path.to_owned()).display(),
        facts.map_or(0, |facts| facts.len()),
        seconds.map_or(0, |since| since.as_nanos()),
    )
}
