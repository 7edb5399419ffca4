//! The work of jobs that open files: reading, uploading, refining normals.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::JoinHandle;

use meshlod::ReadOptions;
use meshlod::picture::Normals;
use meshlod::scene::OwnedPaint;

use super::jobs::{Outcome, Watch};
use super::work::{News, NormalsState};
use crate::stage::{LoadError, Loaded, LoadedContent, Stage, Subject, SubjectId};
use crate::{Canvas, Renderer, ViewError};

/// File whose reading began before the GPU was open.
pub(crate) struct EarlyLoad {
    pub path: PathBuf,
    reading: JoinHandle<Result<Loaded, LoadError>>,
}

/// Faces above which a file is first shown with smooth normals: 100,000 take 0.15 s with creases on
/// one core.
const ROUGH_FACES: usize = 100_000;

impl EarlyLoad {
    pub fn start(path: &Path, reading: &ReadOptions) -> Self {
        let (from, reading) = (path.to_owned(), *reading);
        let read = std::thread::spawn(move || Loaded::read(&from, &reading));
        Self { path: path.to_owned(), reading: read }
    }

    /// Waits for the file and uploads it.
    pub fn upload(self, renderer: &Renderer, watch: &Watch) -> Outcome<News> {
        let read = self.reading.join();
        let internal = || format!("{}: an internal error", self.path.display());
        let loaded = read.map_err(|_| internal())?.map_err(|error| error.to_string())?;
        upload(loaded, renderer, watch)
    }
}

/// Reads a file and uploads it.
pub(crate) fn open(
    path: &Path,
    reading: &ReadOptions,
    renderer: &Renderer,
    watch: &Watch,
) -> Outcome<News> {
    let loaded = Loaded::read(path, reading).map_err(|error| error.to_string())?;
    upload(loaded, renderer, watch)
}

fn upload(loaded: Loaded, renderer: &Renderer, watch: &Watch) -> Outcome<News> {
    if watch.is_cancelled() {
        return Ok(None);
    }
    let is_mesh = matches!(loaded.content, LoadedContent::Mesh | LoadedContent::Transport);
    let has_creases = is_mesh && matches!(loaded.normals, Normals::Creased { .. });
    let is_rough = has_creases && loaded.mesh.faces.len() > ROUGH_FACES;
    let (state, first) = match is_rough {
        true => (NormalsState::Rough, Loaded { normals: Normals::Smooth, ..loaded.clone() }),
        false => (NormalsState::Final, loaded.clone()),
    };
    let subject = Subject::new(renderer, &first);
    let subject = subject.map_err(|error| format!("{}: {error}", loaded.name()))?;
    Ok(Some(News::Opened(Arc::new(loaded), subject, state)))
}

/// Makes a subject again, with the normals of its file.
pub(crate) fn refine(
    id: SubjectId,
    loaded: &Loaded,
    renderer: &Renderer,
    watch: &Watch,
) -> Outcome<News> {
    if watch.is_cancelled() {
        return Ok(None);
    }
    let subject = Subject::new(renderer, loaded).map_err(|error| error.to_string())?;
    Ok(Some(News::Colored(id, subject)))
}

/// Draws a few pixels of a small mesh, so that all shaders of the first picture are compiled.
pub(crate) fn warm_up(renderer: &Renderer) -> Result<(), ViewError> {
    let mesh = meshlod::samples::sphere(20);
    let loaded = Loaded::from_mesh("warm-up", mesh, Arc::new(OwnedPaint::CLAY));
    let mut stage = Stage::default();
    let id = stage.add(Subject::new(renderer, &loaded)?);
    stage.show(&[id]);
    stage.rig.frame(&loaded.bounds, 1.0);
    let canvas = Canvas::with_format(renderer.gpu(), [8, 8], renderer.format())?;
    canvas.draw(|pass| stage.draw(renderer, pass, [8, 8]));
    Ok(())
}
