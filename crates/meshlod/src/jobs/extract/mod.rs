//! `extract`: the scene of one level of detail out of a multiresolution file.

mod kept_error;
mod query;
mod taken;
#[cfg(test)]
mod tests;
mod written;

use meshlod_io::{Precision, Scene};
use meshlod_multires::{ErrorKind, FileError, ModelFile, Source};

use crate::jobs::{About, JobError, Remark, Watch, WrittenAs};
use crate::model::scene::{ModelScene, SceneQueryError};
use crate::scene::place::shown_faces;
use taken::{Taken, take};
use written::written;

pub use kept_error::{AskedError, KeptError, KnownError, PosedError};
pub use query::{ErrorLimit, FocusRequest, QueryRequest, QueryTarget};

/// Request to [`extract`] a level.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct ExtractRequest {
    /// How coarse the mesh may be, and where.
    pub query: QueryRequest,
    /// True to refine the mesh until it is proven to satisfy the query, or to measure its error if a
    /// number of faces is asked for; false to go by the errors stored in the file, which is faster
    /// and reads less.
    pub verify: bool,
    /// True to leave out faces entirely outside the focus. Of a point only the nearest faces are
    /// left.
    pub crop: bool,
    /// True to move vertices until closed parts have exactly the volume of the finest level in the
    /// file. Does not go with `crop`.
    pub exact_volume: bool,
    /// Format and precision in which the scene will be written, so that the error holds for what is
    /// read back; `None` for a scene that stays in memory. A format without nodes gets one mesh, if
    /// the scene shows each of its meshes once and where the levels have it.
    pub written_as: Option<WrittenAs>,
    /// Name of the mesh, if the file has none.
    pub name: String,
}

/// Mesh that [`extract`] has found, in figures.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ExtractReport {
    /// Number of vertices of the level.
    pub vertices: usize,
    /// Number of its faces.
    pub faces: usize,
    /// True if it is as close or as coarse as asked.
    pub reached: bool,
    /// Kind of the errors stored in the file.
    pub error_kind: ErrorKind,
    /// Its error: asked for, and known.
    pub error: KeptError,
    /// True if the finest level equals the mesh that the file was built from.
    pub lossless: bool,
    /// Number of [chunks or parts](ModelFile::pieces) of the whole file.
    pub chunks: usize,
    /// Number of these that are there. If it is less, the finest levels are missing, and errors
    /// refer to what is there.
    pub chunks_there: usize,
    /// Number of these that were read.
    pub chunks_read: usize,
    /// Number of updates in them.
    pub updates_read: usize,
    /// Number of bytes read from the file.
    pub bytes_read: u64,
    /// Difference in volume that is left, relative to it, if the volume was restored.
    pub volume_residual: Option<f64>,
    /// Largest distance by which a vertex was moved for that, in model units.
    pub volume_moved: Option<f64>,
    /// Number of faces that the scene shows, over all instances.
    pub shown_faces: usize,
    /// Number of faces of the level, with those that were cropped.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub level_faces: usize,
    /// False if the query has a focus that no face intersects, so that all are as coarse as the file
    /// has them.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub meets_focus: bool,
    /// Precision in which to write the scene; `None` if it stays in memory.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub precision: Option<Precision>,
    /// Largest change of a coordinate by writing, in model units, if that is more than the rounding
    /// of the file or than the error leaves.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub rounded: Option<f64>,
    /// Number of meshes that become one since the format has no nodes; 0 if none do.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub merged_meshes: usize,
}

impl Default for ExtractRequest {
    fn default() -> Self {
        Self {
            query: QueryRequest::default(),
            verify: true,
            crop: false,
            exact_volume: false,
            written_as: None,
            name: String::new(),
        }
    }
}

/// Extracts the scene of one level of detail from a multiresolution file, reading only the parts
/// needed. Notes of the scene say which of its parts a truncated file lacks.
///
/// Unless a number of faces is asked for, **every point of the mesh in the focus is as close to the
/// original as the query asks, and every point of the original to the mesh**, also after rounding to
/// the precision in which it is written, or the report says what holds instead. Where a mesh is
/// shown several times, its levels are as fine as the most demanding of its instances needs.
///
/// A mesh without faces, where a focus is cropped that no face intersects, is returned as it is.
///
/// Cost: about O(n log n), n = faces of the finest mesh around the focus.
/// # Errors
/// A damaged file, and a query that is invalid or does not go with the file.
///
/// ```
/// use meshlod::jobs::{
///     BuildRequest, ErrorLimit, ExtractRequest, FocusRequest, QueryRequest, QueryTarget, build,
///     extract,
/// };
/// use meshlod::multires::{Focus, ModelFile};
/// use meshlod::{Bound, Scene, samples};
///
/// let knot = Scene::from_mesh("knot", samples::knot(4_000));
/// let file = ModelFile::open(build(knot, &BuildRequest::default(), &())?.0)?;
///
/// // Fine in a ball, coarse elsewhere.
/// let ball = Focus::Sphere { center: [0.9, 0.0, 0.0], radius: 0.2 };
/// let near = QueryRequest {
///     target: QueryTarget::Error(ErrorLimit::Length(Bound::Length(0.001))),
///     focus: FocusRequest::Region(ball),
///     ..QueryRequest::default()
/// };
/// let request = ExtractRequest { query: near, ..ExtractRequest::default() };
/// let (_, near) = extract(&file, &request, &())?;
/// let (_, all) = extract(&file, &ExtractRequest::default(), &())?;
/// assert!(2 * near.faces < all.faces);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn extract<S: Source>(
    file: &ModelFile<S>,
    request: &ExtractRequest,
    watch: &dyn Watch,
) -> Result<(Scene, ExtractReport), JobError> {
    if request.crop && request.exact_volume {
        let reason = "a cropped cut encloses no volume: extract the whole one";
        return Err(JobError::request("exact_volume", reason));
    }
    let model = scene_of(file, watch)?;
    let Taken { level, mut report, rounding } = take((file, &model), request, watch)?;
    let mesh = level.mesh();
    (report.vertices, report.faces) = (mesh.positions.len(), mesh.faces.len());
    let lost = model.missing.notes();
    let mut scene = match mesh.faces.is_empty() {
        true => Scene::from_mesh(request.name.clone(), mesh),
        false => written((file, model), mesh, rounding, (request, &mut report), watch)?,
    };
    scene.notes = lost.into_iter().filter(|note| note.count > 0).collect();
    let is_coarse = request.query.most_faces().is_none_or(|most| report.level_faces <= most);
    report.reached = is_coarse && report.error.is_kept() != Some(false);
    report.shown_faces = shown_faces(&scene);
    Ok((scene, report))
}

/// Reads the scene of a multiresolution file, which a height field does not have.
fn scene_of<S: Source>(file: &ModelFile<S>, watch: &dyn Watch) -> Result<ModelScene, JobError> {
    let ModelFile::Contractions(archive) = file else { return Ok(ModelScene::default()) };
    if archive.has_old_resources() {
        let reason =
            "its materials are in the form of an earlier version and left out; build it again";
        watch.remark(&Remark::new(About::Input, reason));
    }
    ModelScene::read(archive).map_err(JobError::input)
}

/// Says whether a query is wrong, or the file that it was put to.
fn failed(error: impl Into<FileError>) -> JobError {
    match error.into() {
        FileError::Query(error) => JobError::request("", error),
        error => JobError::input(error),
    }
}

fn failed_for_scene(error: SceneQueryError) -> JobError {
    match error {
        SceneQueryError::File(error) => failed(error),
        SceneQueryError::Scene(error) => JobError::input(error),
    }
}
