//! The model that tiles are made of: one file, or several as one.

use std::path::{Path, PathBuf};

use meshlod::io::Material;
use meshlod::jobs::TileInput;
use meshlod::tiles::plan::Look;
use meshlod::tiles::source::{JoinedSource, LEAST_STREAMED, SceneSource, Source, open_stream};
use meshlod::{FileKind, Scene};

use crate::options::args::ReadArgs;
use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::numbers::count;

/// Largest number of materials.
const MOST_MATERIALS: usize = u16::MAX as usize;

/// Model that tiles are made of.
pub struct Model {
    source: Box<dyn Source>,
    look: Look,
    key: String,
}

/// File of a model.
struct ModelPart {
    source: Box<dyn Source>,
    look: Look,
}

impl Model {
    /// Opens files and the files in folders, as one model.
    pub fn open(
        inputs: &[PathBuf],
        reading: &ReadArgs,
        session: &Session,
    ) -> Result<Self, Failure> {
        let paths: Vec<PathBuf> =
            inputs.iter().map(|input| files_in(input)).collect::<Result<Vec<_>, _>>()?.concat();
        // What is read as a whole is in memory at the same time.
        let least = LEAST_STREAMED / paths.len().max(1) as u64;
        let open = |path: &PathBuf| ModelPart::open(path, least, reading, session);
        let parts = paths.iter().map(open).collect::<Result<Vec<_>, _>>()?;
        let key = paths.iter().map(|path| key(path)).collect::<Vec<_>>().join("\n");
        Self::join(parts, key, session)
    }

    fn join(mut parts: Vec<ModelPart>, key: String, session: &Session) -> Result<Self, Failure> {
        if parts.len() == 1 {
            let ModelPart { source, look } = parts.remove(0);
            return Ok(Self { source, look, key });
        }
        let mut look = Look::default();
        let is_plain = parts.iter().all(|part| part.look.labels.is_empty());
        let mut sources = Vec::with_capacity(parts.len());
        for ModelPart { source, look: own } in parts {
            let first = match is_plain {
                true => 0,
                false => add(&mut look, own)?,
            };
            sources.push((source, first));
        }
        let (source, dropped) = JoinedSource::new(sources);
        if !dropped.is_empty() {
            let dropped = dropped.join(", ");
            session.warn(format_args!("not all files have these layers, left out: {dropped}"));
        }
        Ok(Self { source: Box::new(source), look, key })
    }

    pub fn input(&self) -> TileInput<'_> {
        TileInput { source: &*self.source, look: &self.look, key: &self.key }
    }
}

impl ModelPart {
    /// Opens a file, in passing from a number of bytes on where that is possible.
    fn open(
        path: &Path,
        least: u64,
        reading: &ReadArgs,
        session: &Session,
    ) -> Result<Self, Failure> {
        let can_stream = !files::is_pipe(path) && reading.weld().is_none();
        if can_stream && let Some(streamed) = open_stream(path, least)? {
            if !streamed.left_out.is_empty() {
                let names = streamed.left_out.join(", ");
                let reason = format!("properties of faces left out: {names}");
                session.warn(Failure::at(path, reason));
            }
            return Ok(Self { source: streamed.source, look: Look::default() });
        }
        let scene = files::read_surface(path, reading, session)?;
        session.note(path, &scene.tile_limits())?;
        let look = look(&scene);
        if look.labels.len() > MOST_MATERIALS {
            return Err(Failure::at(path, too_many_materials()));
        }
        Ok(Self { source: Box::new(SceneSource::new(scene)), look })
    }
}

/// Adds the materials and images of a file; returns the label of the first one.
fn add(all: &mut Look, mut own: Look) -> Result<u16, Failure> {
    if own.labels.is_empty() {
        own.labels.push(String::new());
        own.materials.push(Material::default());
    }
    let (first, images) = (all.labels.len(), all.images.len());
    if first + own.labels.len() > MOST_MATERIALS {
        return Err(Failure::new(too_many_materials()));
    }
    own.materials.iter_mut().for_each(|material| material.shift_images(images));
    all.labels.append(&mut own.labels);
    all.materials.append(&mut own.materials);
    all.images.append(&mut own.images);
    Ok(first as u16)
}

fn too_many_materials() -> String {
    format!("more than {} materials; tiles number them by 16 bits", count(MOST_MATERIALS))
}

/// Returns the files of a folder that are read, by name; of a file or pipe, itself.
fn files_in(input: &Path) -> Result<Vec<PathBuf>, Failure> {
    if !input.is_dir() {
        return Ok(vec![input.to_owned()]);
    }
    let failure = |error| Failure::at(input, error);
    let entries = std::fs::read_dir(input).map_err(failure)?;
    let paths = entries.map(|entry| entry.map(|entry| entry.path()));
    let mut paths = paths.collect::<Result<Vec<_>, _>>().map_err(failure)?;
    paths.retain(|path| path.is_file() && FileKind::of_path(path).is_ok());
    paths.sort();
    match paths.is_empty() {
        true => Err(Failure::at(input, "no file of a format that is read")),
        false => Ok(paths),
    }
}

/// Returns the materials of a scene by the labels that its faces have when it is one mesh.
fn look(scene: &Scene) -> Look {
    if scene.materials.is_empty() {
        return Look::default();
    }
    let mut materials = scene.materials.clone();
    // Faces without a material have the last label.
    materials.push(Material::default());
    let labels = materials.iter().map(|material| material.name.clone()).collect();
    Look { labels, materials, images: scene.images.clone(), ..Look::default() }
}

/// Returns a text that is different for another file, and mostly for another content.
fn key(path: &Path) -> String {
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
