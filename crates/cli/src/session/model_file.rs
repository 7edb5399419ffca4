//! Multiresolution files: opening them and describing their contents.

use std::fs::File;
use std::path::Path;

use meshlod::PoseCounts;
use meshlod::io::Note;
use meshlod::multires::{Archive, Certificate, ErrorKind, FileError, Fit, ModelFile, Source};

use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::numbers::{count, percent, plural, value};

/// File name suffix of multiresolution files.
pub const SUFFIX: &str = "mlod";

pub fn is_model(path: &Path) -> bool {
    path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case(SUFFIX))
}

/// Fails if a multiresolution file cannot be written, before any work is done.
pub fn check_output(path: &Path) -> Result<(), Failure> {
    if !is_model(path) {
        return Err(Failure::usage(format_args!(
            "{}: a multiresolution file must end in .{SUFFIX}",
            files::name(path)
        )));
    }
    files::check_place(path)
}

/// Opens a multiresolution file, with a note of how far it goes if it is truncated.
pub fn open(path: &Path, session: &Session) -> Result<ModelFile<File>, Failure> {
    let model = open_again(path, session)?;
    let [there, all] = model.pieces();
    if there < all {
        let one = model.piece_name();
        let many = format!("{one}s");
        let goes = format!(": the file is truncated, and {there} of its {all} {many} are present");
        let note = Note::left_out(all - there, one, &many).detailed(&goes);
        session.note(path, &[note.remedied("fetch the rest for the finest levels")])?;
    }
    Ok(model)
}

/// Opens a multiresolution file, without a note, since it has been opened before.
pub fn open_again(path: &Path, session: &Session) -> Result<ModelFile<File>, Failure> {
    if files::is_pipe(path) {
        return Err(Failure::usage(
            "-: a multiresolution file is read in parts and cannot be a pipe; name a file",
        ));
    }
    session.progress.stage(&format!("reading {}", files::name(path)));
    let file = File::open(path).map_err(|error| Failure::at(path, error))?;
    ModelFile::open(file).map_err(|error| match error {
        FileError::Magic => {
            Failure::at(path, format_args!("{error}; meshlod build makes such a file of a mesh"))
        }
        error => Failure::at(path, error),
    })
}

pub fn certificate_text(certificate: &Certificate) -> String {
    let Certificate { sound, odd } = *certificate;
    let mut text =
        format!("proved: no cut of {} update{} has a crack", count(sound), plural(sound));
    if odd > 0 {
        text += &format!("; {} next to non-manifold parts of the input", count(odd));
    }
    text
}

/// Describes the distance of a height field's finest level from the mesh.
pub fn fit_text(fit: &Fit) -> String {
    format!(
        "the finest level is off the mesh by up to {} where a cell is split along its other diagonal, \
         and by up to {} where vertices are off the grid; error bounds refer to the finest level",
        value(fit.turned),
        value(fit.moved),
    )
}

/// Returns true unless the file is truncated.
pub fn is_whole(file: &ModelFile<File>) -> bool {
    let [there, all] = file.pieces();
    there == all
}

/// Returns the failure of a query: of its own values, or of the file.
pub fn failure(path: &Path, error: FileError) -> Failure {
    match error {
        FileError::Query(error) => Failure::usage(error),
        error => Failure::at(path, error),
    }
}

/// Returns the word for the errors stored in a file: estimates or bounds.
pub fn error_kind<S: Source>(archive: &Archive<S>) -> &'static str {
    match archive.error_kind() {
        ErrorKind::Estimate => "estimate",
        ErrorKind::Measured => "measured",
        ErrorKind::Bound => "bound",
    }
}

/// Returns the largest displacement of a vertex by rounding in the file, in model units.
pub fn rounding<S: Source>(archive: &Archive<S>) -> f64 {
    if archive.is_lossless() { 0.0 } else { archive.rounding() }
}

/// Describes in words the displacement of vertices by rounding.
pub fn rounding_text<S: Source>(archive: &Archive<S>) -> String {
    let part = percent(100.0 * archive.rounding() / archive.diagonal());
    let moved = format!("moved by up to {} ({part})", value(archive.rounding()));
    match archive.is_lossless() {
        true => format!("lossless; vertices of coarser levels {moved}"),
        false => format!("vertices {moved}"),
    }
}

/// Returns the kind of a model's errors in words, and the poses in which they were measured.
pub fn errors_text(kind: &str, poses: Option<PoseCounts>) -> String {
    match (kind, poses) {
        ("measured", Some(poses)) => format!("errors measured over {}", poses_text(poses)),
        ("measured", None) => "measured errors".to_owned(),
        ("bound", _) => "error bounds".to_owned(),
        _ => "error estimates".to_owned(),
    }
}

/// Names the poses in which errors were measured.
pub fn poses_text(PoseCounts { measured, animations }: PoseCounts) -> String {
    let [poses, animations] = [measured, animations].map(|number| number as usize);
    if animations == 0 {
        return format!("{} pose{} of the nodes", count(poses), plural(poses));
    }
    format!(
        "{} pose{} of {} animation{}",
        count(poses),
        plural(poses),
        count(animations),
        plural(animations),
    )
}
