//! Writing scenes to files. No verb writes a scene that was read by itself, so that what a format
//! cannot hold is always noted, and before anything is written.

use std::path::{Path, PathBuf};

use meshlod::io::gltf::{Level, LodLayout, NeedleLevels, StripMesh};
use meshlod::io::{Note, WrittenFile};
use meshlod::jobs::{self, ConvertReport, ConvertRequest};
use meshlod::{Mesh, Output, Scene};

use crate::options::args::WriteArgs;
use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files::{check_output, is_pipe, name, output};

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
    write_noted(&output(path, session)?, scene, writing, session)?;
    Ok(report)
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
    let file = output(first, session)?;
    let meshes = levels.iter_mut().map(|(_, meshes)| meshes);
    session.note(first, &file.limits_of_levels(scene, meshes, &writing.options()))?;
    write_noted(&file, scene, writing, session)?;
    for (path, level) in &mut levels {
        scene.swap_meshes(level);
        write_noted(&output(path, session)?, scene, writing, session)?;
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
    Ok(output(path, session)?.write_levels(scene, levels, layout)?)
}

/// Writes a scene and its coarser levels to a glTF file and files that its client loads by need;
/// returns all of them.
pub fn write_needle(
    path: &Path,
    scene: &Scene,
    levels: NeedleLevels<'_>,
    session: &Session,
) -> Result<Vec<WrittenFile>, Failure> {
    let format = check_output(path, session)?;
    session.note(path, &scene.limits_of(format))?;
    session.progress.stage(&format!("writing {}", name(path)));
    Ok(output(path, session)?.write_needle(scene, levels)?)
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
    Ok(output(path, session)?.write_strips(scene, strips)?)
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
    Ok(Output::new(path)?.write_bytes(bytes)?)
}

fn write_noted(
    file: &Output,
    scene: &Scene,
    writing: &WriteArgs,
    session: &Session,
) -> Result<(), Failure> {
    session.progress.stage(&format!("writing {}", name(file.path())));
    Ok(file.write(scene, &writing.options())?)
}
