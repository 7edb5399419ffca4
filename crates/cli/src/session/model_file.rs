//! Multiresolution files: opening them and describing their contents.

use std::path::Path;

use meshlod::model::PoseCounts;
use meshlod::multires::{Archive, Certificate, ErrorKind, FileError, Fit, ModelFile, Source};
use meshlod::{AnyFile, FileBytes, FileKind, ReadOptions};

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
        let levels = match FileKind::of_path(path).map(FileKind::format) {
            Ok(Some(format)) => format!("; levels in .{format} are written by meshlod lods"),
            _ => String::new(),
        };
        return Err(Failure::usage(format_args!(
            "{}: a multiresolution file must end in .{SUFFIX}{levels}",
            files::name(path)
        )));
    }
    files::check_place(path)
}

/// Opens a multiresolution file, with a note of how far it goes if it is truncated.
pub fn open(path: &Path, session: &Session) -> Result<AnyFile, Failure> {
    if files::is_pipe(path) {
        return Err(Failure::usage(
            "-: a multiresolution file is read in parts and cannot be a pipe; name a file",
        ));
    }
    check_input(path)?;
    session.progress.stage(&format!("reading {}", files::name(path)));
    let file = AnyFile::open(path, &ReadOptions::default())?;
    session.note(path, &file.notes())?;
    Ok(file)
}

/// Fails if a file is of another kind by its suffix, with how a multiresolution file is made of it.
pub fn check_input(path: &Path) -> Result<(), Failure> {
    if is_model(path) || FileKind::of_path(path).is_err() {
        return Ok(());
    }
    let (name, model) = (files::name(path), files::name(&path.with_extension(SUFFIX)));
    let reason = format_args!("is no .{SUFFIX} file; make one first: meshlod build {name} {model}");
    Err(Failure::at(path, reason))
}

/// Returns the levels in a file, or says how such a file is made.
pub fn levels(file: &AnyFile) -> Result<&ModelFile<FileBytes>, Failure> {
    file.levels().ok_or_else(|| {
        let reason =
            format_args!("{}; meshlod build makes such a file of a mesh", FileError::Magic);
        Failure::at(file.path(), reason)
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

/// Returns the failure of a query: of its own values, or of the file.
pub fn failure(path: &Path, error: FileError) -> Failure {
    match error {
        FileError::Query(error) => Failure::usage(error),
        error => Failure::at(path, error),
    }
}

/// Returns the word for the errors stored in a file.
pub fn kind_name(kind: ErrorKind) -> &'static str {
    match kind {
        ErrorKind::Estimate => "estimate",
        ErrorKind::Measured => "measured",
        ErrorKind::Bound => "bound",
    }
}

/// Returns the largest displacement of a vertex by rounding in the file, in model units.
pub fn rounding<S: Source>(archive: &Archive<S>) -> f64 {
    if archive.is_lossless() { 0.0 } else { archive.rounding() }
}

/// Describes in words the displacement of vertices by rounding, in model units.
pub fn rounding_text(moved: f64, diagonal: f64, lossless: bool) -> String {
    let part = percent(100.0 * moved / diagonal);
    let moved = format!("moved by up to {} ({part})", value(moved));
    match lossless {
        true => format!("lossless; vertices of coarser levels {moved}"),
        false => format!("vertices {moved}"),
    }
}

/// Returns the kind of a model's errors in words, and the poses in which they were measured.
pub fn errors_text(kind: ErrorKind, poses: Option<PoseCounts>) -> String {
    match (kind, poses) {
        (ErrorKind::Measured, Some(poses)) => {
            format!("errors measured over {}", poses_text(poses))
        }
        (ErrorKind::Measured, None) => "measured errors".to_owned(),
        (ErrorKind::Bound, _) => "error bounds".to_owned(),
        (ErrorKind::Estimate, _) => "error estimates".to_owned(),
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
