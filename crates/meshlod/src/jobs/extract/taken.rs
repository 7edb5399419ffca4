//! The level that a query asks for, with what is known about its error.

use meshlod_multires::{ErrorKind, Extract, FileError, Level, ModelFile, Query, Source};

use super::{
    AskedError, ExtractReport, ExtractRequest, KeptError, KnownError, PosedError, QueryTarget,
    failed, failed_for_scene,
};
use crate::jobs::{JobError, Watch, begin};
use crate::model::scene::ModelScene;
use crate::model::verified::{VerifiedExtract, extract_verified, measure_extract};

/// Level of a file, with what the report says of it and of what was read.
pub(super) struct Taken {
    pub(super) level: Level,
    pub(super) report: ExtractReport,
    /// Largest displacement of a vertex of the finest level when the file was built, in model units.
    pub(super) rounding: f64,
}

/// Takes the level that is asked for out of a file, without the faces that are to be cropped.
pub(super) fn take<S: Source>(
    (file, model): (&ModelFile<S>, &ModelScene),
    request: &ExtractRequest,
    watch: &dyn Watch,
) -> Result<Taken, JobError> {
    let asked = request.query.query(file)?;
    let most = request.query.most_faces();
    let found = model.query_of_levels(file, &asked, most);
    let (query, nearest) = found.map_err(failed_for_scene)?;
    let (taken, known) = answer(file, &query, request, watch)?;
    let Extract { level, chunks, updates, bytes } = taken;
    let poses = in_poses((file, model), &level, request, watch)?;
    let [chunks_there, all] = file.pieces();
    let is_error = matches!(request.query.target, QueryTarget::Error(_));
    let error = KeptError {
        asked: if is_error { AskedError::of(&asked.tolerance) } else { AskedError::Faces },
        known,
        in_focus: request.query.has_focus() && is_error,
        is_whole: chunks_there == all,
        moved: 0.0,
        diagonal: file.diagonal(),
        poses,
    };
    let (rounding, lossless, error_kind) = match file {
        ModelFile::Contractions(archive) => {
            let rounding = if archive.is_lossless() { 0.0 } else { archive.rounding() };
            (rounding, archive.is_lossless(), archive.error_kind())
        }
        ModelFile::HeightField(field, _) => (field.fit().rounded, false, ErrorKind::Bound),
    };
    let level_faces = level.faces.len();
    let (level, meets_focus) = cut_out(level, &query, nearest, request)?;
    let report = ExtractReport {
        vertices: 0,
        faces: 0,
        reached: false,
        error_kind,
        error,
        lossless,
        chunks: all,
        chunks_there,
        chunks_read: chunks,
        updates_read: updates,
        bytes_read: bytes,
        volume_residual: None,
        volume_moved: None,
        shown_faces: 0,
        level_faces,
        meets_focus,
        precision: None,
        rounded: None,
        merged_meshes: 0,
    };
    Ok(Taken { level, report, rounding })
}

/// Extracts the mesh that a query asks for, and finds out about its error.
fn answer<S: Source>(
    file: &ModelFile<S>,
    query: &Query<'_>,
    request: &ExtractRequest,
    watch: &dyn Watch,
) -> Result<(Extract, KnownError), JobError> {
    begin(watch, "extracting")?;
    match request.query.most_faces() {
        None if !request.verify => Ok((file.extract(query).map_err(failed)?, KnownError::Stored)),
        None => {
            let found = extract_verified(file, query);
            let VerifiedExtract { extract, verification } = found.map_err(failed)?;
            Ok((extract, KnownError::Verified(verification)))
        }
        Some(faces) => {
            let taken = file.extract_at_most(faces, query).map_err(failed)?;
            if !request.verify {
                return Ok((taken, KnownError::Stored));
            }
            begin(watch, "measuring the error")?;
            let error = measure_extract(file, &taken.level.mesh()).map_err(failed)?;
            Ok((taken, KnownError::Measured(error)))
        }
    }
}

/// Returns the error of a cut in the poses in which errors were measured, by what the file says.
fn in_poses<S: Source>(
    (file, model): (&ModelFile<S>, &ModelScene),
    level: &Level,
    request: &ExtractRequest,
    watch: &dyn Watch,
) -> Result<Option<PosedError>, JobError> {
    let (ModelFile::Contractions(archive), Some(poses)) = (file, model.poses()) else {
        return Ok(None);
    };
    let [there, all] = file.pieces();
    if !request.verify || request.query.is_local() || there < all {
        return Ok(Some(PosedError { poses, error: None }));
    }
    begin(watch, "reading errors in poses")?;
    let rounding = if archive.is_lossless() { 0.0 } else { archive.rounding() };
    let error = archive.error_of(level).map_err(failed)? + rounding;
    Ok(Some(PosedError { poses, error: Some(error) }))
}

/// Leaves out the faces that are outside the focus, if that is asked for. Also returns false if
/// there is a focus that no face intersects.
fn cut_out(
    level: Level,
    query: &Query<'_>,
    nearest: Option<[f64; 3]>,
    request: &ExtractRequest,
) -> Result<(Level, bool), JobError> {
    let wrong = |error| failed(FileError::Query(error));
    if let Some(point) = nearest {
        let level = if request.crop { level.nearest(point).map_err(wrong)? } else { level };
        return Ok((level, true));
    }
    if !request.query.has_focus() {
        return Ok((level, true));
    }
    let within = level.where_asked(query).map_err(wrong)?;
    let meets_focus = !within.faces.is_empty();
    Ok((if request.crop { within } else { level }, meets_focus))
}
