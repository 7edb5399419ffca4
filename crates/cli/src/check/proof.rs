//! Proof that a multiresolution file has no cracks.

use std::path::Path;

use meshlod::FileBytes;
use meshlod::model::measured_poses;
use meshlod::multires::{Archive, FileError, HeightField, ModelFile, Rtin};
use serde_json::json;

use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::model_file;
use crate::text::model_scene;
use crate::text::numbers::{count, faces, plural};

/// Proves that no mesh extracted from a multiresolution file has a crack, or fails with the reason.
pub fn prove(path: &Path, session: &Session) -> Result<Answer, Failure> {
    let opened = model_file::open(path, session)?;
    let file = model_file::levels(&opened)?;
    match file {
        ModelFile::Contractions(archive) => prove_contractions(path, file, archive, session),
        ModelFile::HeightField(field, _) => prove_field(path, file, field, session),
    }
}

fn prove_contractions(
    path: &Path,
    file: &ModelFile<FileBytes>,
    archive: &Archive<FileBytes>,
    session: &Session,
) -> Result<Answer, Failure> {
    session.progress.stage("proving");
    let proved = archive.read_chunks(archive.chunk_count());
    let (model, certificate) = proved.map_err(|error| match error {
        FileError::NotCertified(error) => Failure::found(path, error),
        error => Failure::at(path, error),
    })?;
    let [there, chunks] = [archive.complete_chunks(), archive.chunk_count()];
    let kind = archive.error_kind();
    let poses = measured_poses(archive).map_err(|error| Failure::at(path, error))?;
    let scene = model_scene::read(path, file, session)?;
    // Also what the scene does not need, such as a small image beside the whole one, is to be sound.
    let mut parts = 0..archive.resource_count();
    let read = parts.try_for_each(|at| archive.resource(at).map(drop));
    read.map_err(|error| Failure::at(path, error))?;
    let json = json!({
        "file": files::name(path),
        "model": "contractions",
        "error_kind": kind,
        "poses": poses,
        "rounding": model_file::rounding(archive),
        "lossless": archive.is_lossless(),
        "chunks": chunks,
        "chunks_there": there,
        "updates": model.update_count(),
        "base_faces": model.base_faces(),
        "faces": model.full_faces(),
        "certificate": certificate,
        "scene_missing": scene.missing,
    });
    let text = format!(
        "{}: {} to {}, {there} of {chunks} chunk{}, {}; {}\n{}{}\n",
        files::name(path),
        count(model.base_faces()),
        faces(model.full_faces()),
        plural(chunks),
        model_file::errors_text(kind, poses),
        model_file::rounding_text(archive.rounding(), archive.diagonal(), archive.is_lossless()),
        model_file::certificate_text(&certificate),
        unproved_text(file),
    );
    Ok(Answer::new(json, text))
}

fn prove_field(
    path: &Path,
    file: &ModelFile<FileBytes>,
    field: &HeightField,
    session: &Session,
) -> Result<Answer, Failure> {
    session.progress.stage("proving");
    let model = Rtin::new(field);
    let sound = model.certify().map_err(|error| Failure::found(path, error))?;
    let [columns, rows] = field.size();
    let [there, parts] = file.pieces();
    let json = json!({
        "file": files::name(path),
        "model": "right-triangles",
        "error_kind": "bound",
        "grid": [columns, rows],
        "fit": field.fit(),
        "parts": parts,
        "parts_there": there,
        "faces": model.full_faces(),
        "certificate": { "sound": sound },
    });
    let text = format!(
        "{}: right triangles of {columns} x {rows} heights, up to {}; {}\nproved: no cut of {} updates \
         has a crack{}\n",
        files::name(path),
        faces(model.full_faces()),
        model_file::fit_text(&field.fit()),
        count(sound),
        unproved_text(file),
    );
    Ok(Answer::new(json, text))
}

/// Describes the unproved part of a truncated file; empty if the file is whole.
fn unproved_text(file: &ModelFile<FileBytes>) -> String {
    let [there, all] = file.pieces();
    let piece = file.piece_name();
    match all - there {
        0 => String::new(),
        missing => format!(
            ", of those in the {} {piece}{} that are present; nothing is proved of the {} that {} missing",
            count(there),
            plural(there),
            count(missing),
            if missing == 1 { "is" } else { "are" },
        ),
    }
}
