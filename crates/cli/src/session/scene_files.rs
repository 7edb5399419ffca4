//! Writing scenes to files. No verb writes a scene that was read by itself, so that what a format
//! cannot hold is always noted, and before anything is written.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use meshlod::io::gltf::{Level, LodLayout, StripMesh};
use meshlod::io::{Note, write_file, write_lods, write_strips, write_to};
use meshlod::jobs::{self, ConvertReport, ConvertRequest};
use meshlod::{Format, Mesh, Scene};

use crate::options::args::WriteArgs;
use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files::{check_output, is_pipe, name};

/// Writes a scene to a file or standard output.
pub fn write(
    path: &Path,
    scene: &Scene,
    writing: &WriteArgs,
    session: &Session,
) -> Result<(), Failure> {
    write_counted(path, scene, writing, session).map(|_| ())
}

/// Writes a scene to a file or standard output, and returns what was written.
pub fn write_counted(
    path: &Path,
    scene: &Scene,
    writing: &WriteArgs,
    session: &Session,
) -> Result<ConvertReport, Failure> {
    let request = ConvertRequest {
        format: check_output(path, session)?,
        precision: writing.options().precision,
        alone: is_pipe(path),
    };
    let report = jobs::convert(scene, &request);
    session.note(path, &report.notes)?;
    write_noted(path, scene, writing, session)?;
    Ok(report)
}

/// Adds to what a format lacks of a scene the name of another that holds all of it, if there is one
/// and nothing else is to do.
fn remedied(scene: &Scene, limits: Vec<Note>) -> Vec<Note> {
    let holds = |(format, _): &(Format, &str)| scene.limits_of(*format).is_empty();
    let mut formats = [(Format::Glb, ".glb"), (Format::Obj, ".obj")].into_iter();
    match formats.find(|format| !limits.is_empty() && holds(format)) {
        None => limits,
        Some((_, suffix)) => {
            let keeps = format!("{suffix} keeps everything");
            let remedy = |note: Note| match note.remedy {
                Some(_) => note,
                None => note.remedied(keeps.clone()),
            };
            limits.into_iter().map(remedy).collect()
        }
    }
}

/// Writes a scene to the first file and each of its levels to one of the others. What all of them
/// lack is noted once, on the first.
pub fn write_chain(
    first: &Path,
    scene: &mut Scene,
    mut levels: Vec<(PathBuf, Vec<Mesh>)>,
    writing: &WriteArgs,
    session: &Session,
) -> Result<(), Failure> {
    let format = check_output(first, session)?;
    let mut notes = scene.limits_of(format);
    for (_, level) in &mut levels {
        swap(scene, level);
        Note::merge(&mut notes, scene.limits_of(format));
        swap(scene, level);
    }
    let mut notes = remedied(scene, notes);
    notes.extend(scene.precision_limits(format, writing.options().precision));
    session.note(first, &notes)?;
    write_noted(first, scene, writing, session)?;
    for (path, level) in &mut levels {
        swap(scene, level);
        write_noted(path, scene, writing, session)?;
    }
    Ok(())
}

/// Writes a scene and its coarser levels to one glTF file.
pub fn write_levels(
    path: &Path,
    scene: &Scene,
    levels: &[Level],
    layout: LodLayout,
    session: &Session,
) -> Result<(), Failure> {
    let format = check_output(path, session)?;
    session.note(path, &scene.limits_of(format))?;
    session.progress.stage(&format!("writing {}", name(path)));
    let _naming = naming();
    Ok(write_lods(path, scene, levels, layout)?)
}

/// Has one thread at a time write scenes: an image gets a name that is free, and takes it only once
/// it is complete.
fn naming() -> MutexGuard<'static, ()> {
    static NAMING: Mutex<()> = Mutex::new(());
    NAMING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes a scene to a glTF file, with these strips for faces.
pub fn write_stripped(
    path: &Path,
    scene: &Scene,
    strips: &[StripMesh],
    session: &Session,
) -> Result<(), Failure> {
    let format = check_output(path, session)?;
    session.note(path, &[scene.limits_of(format), scene.whole_mesh_limits()].concat())?;
    Ok(write_strips(path, scene, strips)?)
}

/// Writes a file that is already encoded, given what it lacks of its scene.
pub fn write_encoded(
    path: &Path,
    notes: &[Note],
    bytes: &[u8],
    session: &Session,
) -> Result<(), Failure> {
    session.note(path, notes)?;
    session.progress.stage(&format!("writing {}", name(path)));
    Ok(write_file(path, bytes)?)
}

/// Exchanges the meshes of a scene for those of a level.
fn swap(scene: &mut Scene, level: &mut [Mesh]) {
    let meshes = scene.meshes.iter_mut().map(|mesh| &mut mesh.mesh);
    meshes.zip(level).for_each(|(mesh, level)| std::mem::swap(mesh, level));
}

fn write_noted(
    path: &Path,
    scene: &Scene,
    writing: &WriteArgs,
    session: &Session,
) -> Result<(), Failure> {
    session.progress.stage(&format!("writing {}", name(path)));
    if !is_pipe(path) {
        let _naming = naming();
        return Ok(meshlod::write(path, scene, &writing.options())?);
    }
    let format = check_output(path, session)?;
    let mut out = BufWriter::new(io::stdout().lock());
    let written = write_to(&mut out, scene, format, &writing.options());
    written.and_then(|()| out.flush()).map_err(|error| Failure::at(path, error))
}
