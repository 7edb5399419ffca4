//! The work of jobs: reading, simplifying, comparing, checking, colouring, saving.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Instant;

use meshlod::check::CheckOptions;
use meshlod::jobs::{JobError, SimplifyRequest, simplify as simplify_scene};
use meshlod::measure::{PreparedSurface, vertex_errors};
use meshlod::picture::{Normals, Picture};
use meshlod::{CheckReport, Method, OwnedPaint, ReadOptions, Report, Scene, Target, check_report};

use super::document::{DocumentId, LevelDistance};
use super::jobs::{Outcome, Watch};
use crate::stage::{
    Coloring, LoadError, Loaded, LoadedContent, MeshSubject, Stage, Subject, SubjectId,
};
use crate::{Canvas, Renderer, ViewError};

/// Result of a job.
pub(crate) enum News {
    /// A file, and its subject; with normals that are still to be refined, or not.
    Opened(Arc<Loaded>, Subject, NormalsState),
    Simplified(DocumentId, Box<MadeLevel>),
    Compared(DocumentId, Box<Comparison>),
    Checked(DocumentId, Box<(CheckReport, Vec<Option<[f64; 3]>>)>),
    Colored(SubjectId, Subject),
    Saved(PathBuf),
}

/// Whether a subject has the normals that its file asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NormalsState {
    Final,
    /// Smooth ones, which are made several times as fast as those with creases.
    Rough,
}

/// Level that was made, on the GPU.
pub(crate) struct MadeLevel {
    pub loaded: Arc<Loaded>,
    pub subject: Subject,
    pub report: Report,
    pub seconds: f64,
}

/// Surfaces in the colours of their distance from the other; only meshes have them.
pub(crate) struct Comparison {
    pub subjects: Vec<(SubjectId, Subject)>,
    /// Level that was compared.
    pub level: SubjectId,
    pub distance: LevelDistance,
}

/// File that is being read since before there was a GPU.
pub(crate) struct EarlyLoad {
    pub path: PathBuf,
    reading: JoinHandle<Result<Loaded, LoadError>>,
}

/// Largest number of findings of a kind that are listed.
const FINDINGS_LISTED: usize = 500;
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

/// Makes a subject again, with the normals that its file asks for.
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

/// Simplifies a document by a method to a target.
pub(crate) fn simplify(
    document: DocumentId,
    loaded: &Loaded,
    method: Method,
    target: Target,
    renderer: &Renderer,
    watch: &Watch,
) -> Outcome<News> {
    let start = Instant::now();
    let scene = Scene::from_mesh("level", (*loaded.mesh).clone());
    let request = SimplifyRequest { target: target.into(), method, ..SimplifyRequest::default() };
    let (mut scene, report) = match simplify_scene(scene, &request, watch) {
        Err(JobError::Cancelled) => return Ok(None),
        done => done.map_err(|error| error.to_string())?,
    };
    let level = scene.meshes.pop().map(|level| level.mesh).unwrap_or_default();
    let seconds = start.elapsed().as_secs_f64();
    let level = Loaded {
        single_sided: Arc::clone(&loaded.single_sided),
        ..Loaded::from_mesh("level", level, Arc::clone(&loaded.paint))
    };
    if level.mesh.faces.is_empty() {
        return Err("no face is left at this level".into());
    }
    let subject = Subject::new(renderer, &level).map_err(|error| error.to_string())?;
    let made = MadeLevel { loaded: Arc::new(level), subject, report: report.run, seconds };
    Ok(Some(News::Simplified(document, Box::new(made))))
}

/// Measures the distance of two surfaces, and uploads both in its colours.
pub(crate) fn compare(
    document: DocumentId,
    surfaces: [(SubjectId, Arc<Loaded>, Option<MeshSubject>); 2],
    renderer: &Renderer,
    watch: &Watch,
) -> Outcome<News> {
    let [a, b] = [&surfaces[0].1.mesh, &surfaces[1].1.mesh];
    let ready = |mesh| PreparedSurface::new(mesh).map_err(|error| error.to_string());
    let to_b = vertex_errors(a, &ready(b)?);
    watch.set(0.4);
    if watch.is_cancelled() {
        return Ok(None);
    }
    let to_a = vertex_errors(b, &ready(a)?);
    watch.set(0.8);
    if watch.is_cancelled() {
        return Ok(None);
    }
    let all = || to_b.iter().chain(&to_a).copied().filter(|distance| distance.is_finite());
    let greatest = all().fold(0.0, f64::max);
    let rms = (all().map(|x| x * x).sum::<f64>() / all().count().max(1) as f64).sqrt();
    let level = surfaces[1].0;
    let mut subjects = Vec::new();
    for ((id, loaded, mesh), distances) in surfaces.into_iter().zip([to_b, to_a]) {
        let distances: Vec<f32> = distances.into_iter().map(|distance| distance as f32).collect();
        let Some(mut mesh) = mesh else { continue };
        mesh.set_heat(renderer, &loaded.mesh, loaded.normals, &distances, greatest as f32)
            .map_err(|error| error.to_string())?;
        subjects.push((id, mesh.into()));
    }
    let distance = LevelDistance { greatest, rms };
    Ok(Some(News::Compared(document, Box::new(Comparison { subjects, level, distance }))))
}

/// Checks a document.
pub(crate) fn check(document: DocumentId, loaded: &Loaded, watch: &Watch) -> Outcome<News> {
    let report = check_report(&loaded.mesh, &CheckOptions::default(), FINDINGS_LISTED);
    if watch.is_cancelled() {
        return Ok(None);
    }
    let places = report.findings.iter().map(|finding| finding.place(&loaded.mesh)).collect();
    Ok(Some(News::Checked(document, Box::new((report, places)))))
}

/// Uploads the colours of faces that a colouring needs.
pub(crate) fn color(
    id: SubjectId,
    mut mesh: MeshSubject,
    loaded: &Loaded,
    coloring: Coloring,
    renderer: &Renderer,
) -> Outcome<News> {
    let colored = mesh.color_faces(renderer, &loaded.mesh, coloring);
    colored.map_err(|error| error.to_string())?;
    Ok(Some(News::Colored(id, mesh.into())))
}

/// Writes a picture to a file.
pub(crate) fn save(picture: &Picture, path: PathBuf) -> Outcome<News> {
    meshlod::io::write_file(&path, &picture.png()).map_err(|error| error.to_string())?;
    Ok(Some(News::Saved(path)))
}
