//! Levels by the contractions of a mesh, with the rest of its scene.

use std::iter::successors;
use std::sync::Arc;

use meshlod_io::Scene;
use meshlod_io::gltf::SourceDocument;
use meshlod_mesh::{AttributeBounds, Mesh, closed_faces};
use meshlod_multires::{
    Archive, BuildError, Certificate, ErrorKind, Forest, Recorder, Storage, StoredErrors,
};
use meshlod_simplify::{
    ExactVolumeError, Held, Observe, Options, Report, Simplifier, SimplifyError, Target,
};

use super::{BuildReport, BuildRequest, BuiltLevels, ErrorPoses, LevelModel, LevelOrder};
use crate::jobs::unused::{unused_parts, used_vertices};
use crate::jobs::{About, Contractions, JobError, Remark, Watch, end_if_cancelled};
use crate::model::{PackedScene, PlacedScene, PoseCounts, model_limits, place_scene};

/// Least of the errors within which contractions are made one after another, in parts of the diagonal:
/// twice the default rounding.
const FIRST_ERROR: f64 = 1e-4;

/// Factor between two of them. Bunny within .3, .1 and .03 %, and seconds of building: by 1.3 1,367,
/// 5,561, 26,076 faces, 3.6 s; by 2 1,741, 5,813, 28,237 faces, 2.7 s.
const NEXT_ERROR: f64 = 1.3;

/// Error from which contractions go by their cost alone.
const LAST_ERROR: f64 = 2e-2;

/// Facts about recorded contractions that a report has.
struct Recorded {
    held: Held,
    poses: ErrorPoses,
    /// Proof that no cut has a crack, once they are written.
    certificate: Certificate,
}

/// Builds the levels of a scene whose constraints have been applied to it.
pub(super) fn build(
    scene: Scene,
    request: &BuildRequest,
    watch: &dyn Watch,
) -> Result<(Vec<u8>, BuildReport), JobError> {
    let mut notes = model_limits(&scene);
    let attributes = refined(request.attributes, &scene);
    let options = Options { method: request.method, ..Options::default() };
    let placed = place_scene(scene, &request.constraints, options);
    let PlacedScene { mesh, options, mut rest, counts } = placed.map_err(JobError::input)?;
    if request.exact_volume {
        remark_if_open(&mesh, watch);
    }
    let lossless = request.lossless || request.exact_volume;
    let (forest, mut done) = record(&mesh, (&options, lossless), rest.as_mut(), request, watch)?;
    let scene = rest.is_some().then_some(counts);
    let storage = Storage {
        rounding: (!lossless).then(|| request.rounding_of(&mesh)),
        updates_per_chunk: request.in_chunk,
        errors: match request.errors {
            ErrorKind::Measured => StoredErrors::Measured,
            ErrorKind::Bound | ErrorKind::Estimate => StoredErrors::AsRecorded,
        },
        attributes,
    };
    let faces = forest.full_faces();
    notes.extend(unused_parts(&mesh, faces));
    let (input_vertices, input_faces) = (used_vertices(&mesh), mesh.faces.len());
    // From here on the contractions hold the mesh.
    drop(mesh);
    let (archive, certificate, surface_bytes) = pack(forest, &storage, rest, watch)?;
    done.certificate = certificate;
    let mut report = BuildReport {
        input_vertices,
        input_faces,
        bytes: 0,
        scene_bytes: 0,
        bytes_per_vertex: surface_bytes as f64 / input_vertices as f64,
        rounding: if lossless { 0.0 } else { archive.rounding() },
        levels: levels(&archive, &done, request),
        scene,
        faces,
        moved: archive.rounding(),
        diagonal: archive.diagonal(),
        error_poses: done.poses,
        notes,
    };
    let bytes = archive.into_source();
    (report.bytes, report.scene_bytes) = (bytes.len(), bytes.len() - surface_bytes);
    Ok((bytes, report))
}

/// Makes the bound of texture coordinates hold for textures that a material repeats by scaling the
/// coordinates.
fn refined(bounds: AttributeBounds, scene: &Scene) -> AttributeBounds {
    let scale = scene.source.as_ref().map_or(1.0, SourceDocument::largest_texture_scale);
    if scale > 1.0 { AttributeBounds { uv: bounds.uv / scale, ..bounds } } else { bounds }
}

/// Remarks that levels cannot get the volume of a mesh of which no part is closed.
fn remark_if_open(mesh: &Mesh, watch: &dyn Watch) {
    if !closed_faces(&mesh.faces, mesh.positions.len()).contains(&true) {
        watch.remark(&Remark::field("exact_volume", ExactVolumeError::OpenMesh));
    }
}

/// Contracts a mesh to nothing, and gives every contraction its error.
fn record(
    mesh: &Mesh,
    (options, lossless): (&Options, bool),
    rest: Option<&mut PackedScene>,
    request: &BuildRequest,
    watch: &dyn Watch,
) -> Result<(Forest, Recorded), JobError> {
    let failed = |error: BuildError| JobError::input(error);
    let options = Forest::options(mesh, options);
    let simplifier = Simplifier::new(mesh, &options).map_err(|error| failed(error.into()))?;
    watch.stage("contracting");
    let recorder = if lossless { Recorder::lossless } else { Recorder::new };
    let mut both = (recorder(&simplifier), Contractions::new(watch, Some(mesh.faces.len())));
    let report = contract(simplifier, request.order, &mut both, watch);
    let held = report.map_err(|error| failed(error.into()))?.held;
    let mut forest = both.0.into_forest().map_err(failed)?;
    watch.stage("measuring errors");
    end_if_cancelled(watch);
    let poses = pose(&mut forest, mesh, rest, request, watch);
    match request.errors {
        ErrorKind::Bound => forest.measure_bounds(),
        ErrorKind::Estimate | ErrorKind::Measured => forest.smooth_errors(),
    }
    Ok((forest, Recorded { held, poses, certificate: Certificate::default() }))
}

/// Contracts a mesh to nothing, in this order.
///
/// A run within an error leaves what would break it for a later run. So no contraction that needs a
/// greater error is below one that needs less, as happens by cost, and a cut need not undo both.
fn contract(
    mut simplifier: Simplifier<'_>,
    order: LevelOrder,
    observer: &mut dyn Observe,
    watch: &dyn Watch,
) -> Result<Report, SimplifyError> {
    if order == LevelOrder::Error {
        let diagonal = simplifier.input().bounds().diagonal();
        let parts = successors(Some(FIRST_ERROR), |part| Some(part * NEXT_ERROR));
        for part in parts.take_while(|part| *part < LAST_ERROR) {
            simplifier.run(Target::Error(part * diagonal), observer)?;
            end_if_cancelled(watch);
        }
    }
    Ok(simplifier.run_out(observer))
}

/// Has errors measured in the poses of the scene's animations, where they are measured and the
/// scene has such poses. Returns the poses for which errors will hold.
fn pose(
    forest: &mut Forest,
    mesh: &Mesh,
    rest: Option<&mut PackedScene>,
    request: &BuildRequest,
    watch: &dyn Watch,
) -> ErrorPoses {
    let Some(rest) = rest else { return ErrorPoses::Unknown };
    let Some(poses) = rest.poses(mesh) else { return ErrorPoses::Unknown };
    for note in &poses.notes {
        watch.remark(&Remark::new(About::Input, format_args!("poses: {note}")));
    }
    match poses.counts {
        PoseCounts { measured: 0, .. } if poses.notes.is_empty() => ErrorPoses::Unbent,
        PoseCounts { measured: 0, .. } => ErrorPoses::Unknown,
        _ if request.errors != ErrorKind::Measured => ErrorPoses::Unknown,
        counts => {
            rest.note_poses(counts);
            forest.pose_by(Arc::new(poses));
            ErrorPoses::Measured(counts)
        }
    }
}

/// Writes recorded contractions and the rest of their scene; also returns the proof that no cut has
/// a crack, and the number of bytes without that rest.
fn pack(
    forest: Forest,
    storage: &Storage,
    rest: Option<PackedScene>,
    watch: &dyn Watch,
) -> Result<(Archive<Vec<u8>>, Certificate, usize), JobError> {
    watch.stage("proving and packing");
    end_if_cancelled(watch);
    let (archive, certificate) = Archive::encode(forest, storage).map_err(JobError::input)?;
    let surface_bytes = archive.bytes().len();
    let Some(rest) = rest else { return Ok((archive, certificate, surface_bytes)) };
    watch.stage("packing images");
    end_if_cancelled(watch);
    let resources = rest.resources(&archive.chunk_lengths());
    let archive = archive.with_resources(&resources).map_err(JobError::output)?;
    Ok((archive, certificate, surface_bytes))
}

fn levels(archive: &Archive<Vec<u8>>, recorded: &Recorded, request: &BuildRequest) -> BuiltLevels {
    BuiltLevels::Contractions {
        held: recorded.held,
        error_kind: archive.error_kind(),
        poses: recorded.poses.measured(),
        model: LevelModel::Contractions,
        method: request.method,
        order: request.order,
        lossless: archive.is_lossless(),
        updates: archive.update_count(),
        base_faces: archive.base_faces(),
        certificate: recorded.certificate,
    }
}

impl ErrorPoses {
    /// Returns the poses in which errors were measured.
    pub fn measured(self) -> Option<PoseCounts> {
        match self {
            Self::Measured(counts) => Some(counts),
            Self::Unknown | Self::Unbent => None,
        }
    }
}
