//! The work of jobs on open files: simplifying, comparing, checking, colouring, saving.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use meshlod::jobs::{self, CheckReport, CheckRequest, JobError, SimplifyRequest};
use meshlod::measure::{PreparedSurface, vertex_errors};
use meshlod::picture::Picture;
use meshlod::{Method, Report, Scene, Target};

use super::document::{DocumentId, LevelDistance};
use super::jobs::{Outcome, Watch};
use crate::Renderer;
use crate::stage::{Coloring, Loaded, MeshSubject, Subject, SubjectId};

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

/// Whether a subject has the normals of its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NormalsState {
    Final,
    /// Smooth normals, which take a fraction of the time of those with creases.
    Rough,
}

/// New level, on the GPU.
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

/// Largest number of listed findings of one kind.
const FINDINGS_LISTED: usize = 500;

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
    let (mut scene, report) = match jobs::simplify(scene, &request, watch) {
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
    let request = CheckRequest { limit: FINDINGS_LISTED, ..CheckRequest::default() };
    let Ok(report) = jobs::check(&loaded.mesh, &request, watch) else { return Ok(None) };
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
