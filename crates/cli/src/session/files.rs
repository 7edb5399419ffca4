//! Reading and writing meshes and pictures, by path or through a pipe.

use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use meshlod::io::{IoError, write_file};
use meshlod::jobs::refuse_points;
use meshlod::{AnyFile, AnyFileError, FileKind, Format, Output, Scene};

use crate::options::args::ReadArgs;
use crate::options::doubt;
use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::{absent, foreign};

/// Returns true if a path is `-`, which stands for standard input or output.
pub fn is_pipe(path: &Path) -> bool {
    path == Path::new("-")
}

/// Formats a path for messages.
pub fn name(path: &Path) -> String {
    if is_pipe(path) { "-".into() } else { path.display().to_string() }
}

/// Returns the file name without its suffix, by which a mesh that has no name is called.
pub fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Reads a scene from a file or standard input; of our own formats, the finest level.
pub fn read(path: &Path, reading: &ReadArgs, session: &Session) -> Result<Scene, Failure> {
    let scene = scene_of(open(path, reading, session)?, session)?;
    if let Some(length) = reading.weld() {
        session.doubt(path, doubt::of_distance("--weld", length, &scene));
    }
    Ok(scene)
}

/// Returns the scene in a file, with its notes; of all levels, the finest one.
pub fn scene_of(file: AnyFile, session: &Session) -> Result<Scene, Failure> {
    let path = file.path().to_owned();
    let of_file = file.levels().map(|_| file.notes()).unwrap_or_default();
    session.note(&path, &of_file)?;
    let scene = file.into_scene()?;
    let others = scene.notes.iter().filter(|note| !of_file.contains(note)).cloned();
    session.note(&path, &others.collect::<Vec<_>>())?;
    Ok(scene)
}

/// Returns the format of a mesh to read by its suffix, that of standard input by `--format`.
pub fn format_of(path: &Path, session: &Session) -> Option<Format> {
    if is_pipe(path) { session.format() } else { Format::of_path(path).ok() }
}

/// Opens a file of any kind, or standard input.
pub fn open(path: &Path, reading: &ReadArgs, session: &Session) -> Result<AnyFile, Failure> {
    session.progress.stage(&format!("reading {}", name(path)));
    let options = reading.options();
    if !is_pipe(path) {
        return Ok(AnyFile::open(path, &options)?);
    }
    // Files referenced by a piped mesh are not available.
    let (kind, bytes) = (FileKind::Mesh(pipe_format(session)?), read_all(path)?);
    Ok(AnyFile::from_bytes(path, kind, bytes, &mut |_| None, &options)?)
}

/// Reads a scene like [`read`], for verbs that need faces.
pub fn read_surface(path: &Path, reading: &ReadArgs, session: &Session) -> Result<Scene, Failure> {
    let scene = read(path, reading, session)?;
    refuse_points(&scene).map_err(|error| Failure::at(path, error))?;
    let has_faces = |mesh: usize| !scene.meshes[mesh].mesh.faces.is_empty();
    match scene.instances().iter().any(|shown| has_faces(shown.mesh)) {
        true => Ok(scene),
        false => Err(Failure::at(path, "the mesh has no faces")),
    }
}

/// Reads all bytes of a file or standard input.
pub fn read_all(path: &Path) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let read = match is_pipe(path) {
        true => io::stdin().lock().read_to_end(&mut bytes).map(|_| bytes),
        false => fs::read(path),
    };
    read.map_err(|error| Failure::at(path, error))
}

/// Fails if an output file cannot be written, before any work is done; otherwise returns its
/// format.
pub fn check_output(path: &Path, session: &Session) -> Result<Format, Failure> {
    if !is_pipe(path) {
        let format = Format::of_output(path).map_err(|error| unknown_output(path, &error))?;
        return check_place(path).map(|()| format);
    }
    check_stdout(session)?;
    session.check_format()?;
    match pipe_format(session)? {
        Format::Gltf => {
            Err(Failure::usage("-: .gltf needs a separate buffer file; use --format glb"))
        }
        format => Ok(format),
    }
}

/// Returns the output at a path, which [`check_output`] allows; `-` is standard output.
pub fn output(path: &Path, session: &Session) -> Result<Output, Failure> {
    Ok(match is_pipe(path) {
        true => Output::stdout(check_output(path, session)?),
        false => Output::new(path)?,
    })
}

/// Reports whether a path is that of a folder, which may be missing: it ends like one then.
pub fn is_folder(path: &Path) -> bool {
    path.is_dir() || path.to_string_lossy().ends_with(std::path::is_separator)
}

/// Makes the failure of a mesh whose suffix is unknown.
fn unknown_input(path: &Path, error: &IoError) -> Failure {
    match path.is_dir() {
        true => Failure::at(path, "is a folder; name a file to read"),
        false => match foreign::way_from(path) {
            Some(way) => Failure::at(path, way),
            None => Failure::new(format_args!("{error} .mlod .mlq .mlz")).about(path),
        },
    }
}

impl From<AnyFileError> for Failure {
    fn from(error: AnyFileError) -> Self {
        let path = error.path().to_owned();
        match error {
            AnyFileError::Io(error @ IoError::UnknownFormat { .. }) => unknown_input(&path, &error),
            AnyFileError::Io(error) => absent::failure(error),
            error @ AnyFileError::Weld(_) => {
                Self::new(error.to_string().replace(": weld:", ": --weld:")).about(&path)
            }
            error => Self::new(error).about(&path),
        }
    }
}

/// Makes the failure of an output whose suffix is not that of a mesh: says which verb writes it.
fn unknown_output(path: &Path, error: &IoError) -> Failure {
    let verb = match FileKind::own_of_path(path) {
        _ if is_folder(path) => {
            let file = path.join("out.glb");
            let reason = format_args!("is a folder; name a file to write, such as {}", name(&file));
            return Failure::at(path, reason);
        }
        Some(FileKind::Levels) => "build",
        Some(_) => "compress",
        None => {
            let reason = match (foreign::way_to(path), path.extension()) {
                (Some(way), _) => format!("{}: {way}", name(path)),
                (None, None) => format!("{error}; did you mean {}?", with_suffix(path)),
                (None, Some(_)) => error.to_string(),
            };
            return Failure::usage(reason).about(path);
        }
    };
    Failure::usage(format_args!("{}: only `meshlod {verb}` writes such files", name(path)))
        .about(path)
}

/// Returns a name with a suffix for a path without one, which may be a suffix itself.
fn with_suffix(path: &Path) -> String {
    let name = name(path);
    match Format::of_suffix(name.trim_start_matches('.')) {
        Some(suffix) => format!("out.{suffix}"),
        None => format!("{name}.glb"),
    }
}

/// Fails if a picture cannot be written to a path, before any work is done.
pub fn check_picture(path: &Path, session: &Session) -> Result<(), Failure> {
    if is_pipe(path) {
        return check_stdout(session);
    }
    match path.extension() {
        Some(suffix) if suffix.eq_ignore_ascii_case("png") => check_place(path),
        _ => Err(Failure::usage(format_args!("{}: a picture file must end in .png", name(path)))),
    }
}

/// Fails if no file can be at an output path; its folders may be missing.
pub fn check_place(path: &Path) -> Result<(), Failure> {
    meshlod::io::check_place(path).map_err(|error| match error {
        IoError::System { source, .. } => Failure::at(path, source),
        error => error.into(),
    })
}

/// Fails if an output path is that of another file of the same run, which would be overwritten.
pub fn check_apart(path: &Path, others: &[&Path]) -> Result<(), Failure> {
    let same = |other: &&&Path| !is_pipe(other) && place_of(other) == place_of(path);
    match others.iter().find(same).filter(|_| !is_pipe(path)) {
        Some(_) => Err(Failure::usage(format_args!(
            "{}: is given for two files of the same run",
            name(path)
        ))),
        None => Ok(()),
    }
}

/// Returns the canonical path of a file that may not exist yet.
fn place_of(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = fs::canonicalize(folder.unwrap_or(Path::new(".")));
        let file = path.file_name().unwrap_or_default();
        folder.map_or_else(|_| path.to_owned(), |folder| folder.join(file))
    })
}

/// File that is made to try whether a folder is writable. Its name is always the same, so that the next
/// run removes what one that was killed has left.
const TRIED: &str = ".meshlod-tried";

/// Creates a folder if it is missing, and fails if it is not writable.
pub fn make_folder(folder: &Path) -> Result<(), Failure> {
    check_folder(folder)?;
    let tried = folder.join(TRIED);
    // Another run may try at the same time.
    let unless = |kind: io::ErrorKind| {
        move |error: io::Error| if error.kind() == kind { Ok(()) } else { Err(error) }
    };
    fs::create_dir_all(folder)
        .and_then(|()| {
            fs::File::create_new(&tried).map(drop).or_else(unless(io::ErrorKind::AlreadyExists))
        })
        .and_then(|()| fs::remove_file(&tried).or_else(unless(io::ErrorKind::NotFound)))
        .map_err(|error| Failure::at(folder, error))
}

/// Fails if the path of an output folder is that of a file.
pub fn check_folder(folder: &Path) -> Result<(), Failure> {
    match folder.exists() && !folder.is_dir() {
        true => Err(Failure::at(folder, "is a file; name a folder to write to")),
        false => Ok(()),
    }
}

/// Writes a PNG to a file or standard output.
pub fn write_picture(path: &Path, png: &[u8]) -> Result<(), Failure> {
    if !is_pipe(path) {
        return Ok(write_file(path, png)?);
    }
    let mut out = io::stdout().lock();
    out.write_all(png).and_then(|()| out.flush()).map_err(|error| Failure::at(path, error))
}

fn check_stdout(session: &Session) -> Result<(), Failure> {
    match session.json {
        true => Err(Failure::usage("-: standard output is taken by --json; name a file")),
        false => Ok(()),
    }
}

/// Returns the format of standard input and output.
fn pipe_format(session: &Session) -> Result<Format, Failure> {
    session
        .format()
        .ok_or_else(|| Failure::usage("-: give --format with the suffix of a mesh, such as ply"))
}
