//! Files: what they hold, and the notes on what was left out or changed on the way.

use std::path::{Path, PathBuf};

use meshlod::io::{Note, Precision};
use meshlod::{
    AnyFile, AnyFileError, FileKind, IoError, Output, ReadOptions, Scene, WriteOptions, read,
};
use pyo3::prelude::*;

use crate::errors::{raised, raised_by_file};
use crate::scene::NativeScene;
use crate::work::{Watch, run};

/// Reads a mesh file or a compressed file, and returns its scene with notes on what was left out.
///
/// # Errors
/// A file that is missing, damaged or of another format.
#[pyfunction]
pub fn load(py: Python<'_>, path: PathBuf) -> PyResult<(NativeScene, Vec<String>)> {
    let scene = run(py, None, move |_| match FileKind::own_of_path(&path) {
        // Levels are opened by `Model`.
        Some(FileKind::Levels) => read(&path, &ReadOptions::default()).map_err(unreadable),
        _ => scene_of(&path).map_err(not_opened),
    })??;
    let notes = texts(&scene.notes);
    Ok((NativeScene::new(scene), notes))
}

/// Writes a scene, in the format of the suffix, and returns notes on what the format cannot hold.
///
/// # Errors
/// An unknown suffix, a scene that the format cannot hold, and errors of the file system.
#[pyfunction]
pub fn save(
    py: Python<'_>,
    scene: &NativeScene,
    path: PathBuf,
    precision: &str,
) -> PyResult<Vec<String>> {
    let precision = precision
        .parse::<Precision>()
        .map_err(|_| raised(format_args!("precision must be auto, f32 or f64, not {precision}")))?;
    let output = Output::new(path).map_err(raised_by_file)?;
    let options = WriteOptions { precision };
    let scene = scene.shared();
    let work = move |watch: &mut Watch| {
        let notes = output.limits(&scene, &options);
        // Files that belong together refer to each other by name: they are written where they stay.
        watch.commit();
        output.write(&scene, &options).map(|()| notes)
    };
    Ok(texts(&run(py, None, work)?.map_err(raised_by_file)?))
}

/// Makes an exception of an error of reading, which names the formats of this package too.
pub fn unreadable(error: IoError) -> PyErr {
    match &error {
        IoError::UnknownFormat { .. } => {
            raised(format_args!("{error} .mlz .mlq, and .mlod by meshlod.Model"))
        }
        _ => raised_by_file(error),
    }
}

fn scene_of(path: &Path) -> Result<Scene, AnyFileError> {
    AnyFile::open(path, &ReadOptions::default())?.into_scene()
}

/// Makes an exception of a file that cannot be opened, or whose scene cannot be read.
pub fn not_opened(error: AnyFileError) -> PyErr {
    match error {
        AnyFileError::Io(error) => unreadable(error),
        other => raised(other),
    }
}

/// Returns notes in words, those on nothing left out.
pub fn texts(notes: &[Note]) -> Vec<String> {
    let notes = notes.iter().filter(|note| note.count > 0);
    notes.map(|note| format!("{}: {note}", note.kind.word())).collect()
}
