//! Writing a scene as `NEEDLE_progressive`: a document and the folder of its finer levels.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use super::images::stage_image;
use super::names::stem;
use super::staged::StagedFiles;
use super::write_gltf::write_gltf;
use crate::error::{IoError, Unsupported};
use crate::format::Format;
use crate::gltf::NeedleLevels;
use crate::gltf::write::levels::{Levels, Needle};
use crate::gltf::write::needle::part::{FOLDER, is_part_name};
use crate::gltf::write::output::Output;
use crate::scene::Scene;

/// Name and size of a file that was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenFile {
    /// Name of the file, relative to the folder of the document, with `/`.
    pub name: String,
    /// Size of the file in bytes.
    pub bytes: usize,
}

/// Writes a scene as glTF or GLB with its coarsest level and smallest images, and all others as GLB
/// files in the folder `stem_levels` beside it, from which clients of `NEEDLE_progressive` load what
/// they need.
///
/// Returns the files, the document first. Each file in the folder is named after its bytes; those of
/// an older version are removed at the end.
///
/// # Errors
/// Errors of [`write()`](super::write()); also any other suffix, and levels whose number of meshes
/// differs from the scene's.
pub fn write_needle(
    path: impl AsRef<Path>,
    scene: &Scene,
    levels: NeedleLevels<'_>,
) -> Result<Vec<WrittenFile>, IoError> {
    let path = path.as_ref();
    let stem = stem(path);
    let needle = Needle { levels, stem: &stem };
    let all = Levels { levels: levels.levels, needle: Some(&needle), ..Levels::default() };
    let written = match Format::of_output(path)? {
        Format::Glb => write_as_glb(path, scene, all)?,
        Format::Gltf => write_as_gltf(path, scene, all)?,
        _ => {
            let reason = "only .glb and .gltf have NEEDLE_progressive; use one of those";
            return Err(IoError::unsupported(path, Unsupported::new("levels", reason)));
        }
    };
    remove_old(path, &stem, &written);
    Ok(written)
}

fn write_as_glb(
    path: &Path,
    scene: &Scene,
    levels: Levels<'_>,
) -> Result<Vec<WrittenFile>, IoError> {
    let unsupported = |error| IoError::unsupported(path, error);
    let mut output = Output::of(scene, levels, None).map_err(unsupported)?;
    let parts = std::mem::take(&mut output.parts);
    let bytes = output.into_glb(scene).map_err(unsupported)?;
    let mut written = vec![WrittenFile { name: file_name(path), bytes: bytes.len() }];
    let mut staged = StagedFiles::default();
    for part in &parts {
        stage_image(path, part, &mut staged)?;
        written.push(WrittenFile { name: part.name.clone(), bytes: part.bytes.len() });
    }
    staged.finish(path, |out| out.write_all(&bytes), &[])?;
    Ok(written)
}

fn write_as_gltf(
    path: &Path,
    scene: &Scene,
    levels: Levels<'_>,
) -> Result<Vec<WrittenFile>, IoError> {
    let mut written = Vec::new();
    write_gltf(path, |name| {
        let mut output = Output::of(scene, levels, None)?;
        let (report, parts) = (output.report.clone(), std::mem::take(&mut output.parts));
        let mut files = output.into_files(scene, name)?;
        files.images.extend(parts);
        let file = |name: &str, bytes: &[u8]| WrittenFile { name: name.into(), bytes: bytes.len() };
        written.push(file(&file_name(path), &files.document));
        written.extend(files.buffer.iter().map(|(name, bytes)| file(name, bytes)));
        written.extend(files.images.iter().map(|image| file(&image.name, &image.bytes)));
        Ok((files, report))
    })?;
    Ok(written)
}

/// Removes the files of an older version from the folder of levels, unless another document of the
/// same stem may use them. What cannot be removed does no harm.
fn remove_old(path: &Path, stem: &str, written: &[WrittenFile]) {
    let others = ["glb", "gltf"].map(|suffix| path.with_extension(suffix));
    if others.iter().any(|other| other != path && other.exists()) {
        return;
    }
    let folder = path.with_file_name(format!("{stem}{FOLDER}"));
    let own: BTreeSet<&str> =
        written.iter().filter_map(|file| file.name.rsplit('/').next()).collect();
    for file in fs::read_dir(&folder).into_iter().flatten().flatten() {
        let name = file.file_name().to_string_lossy().into_owned();
        if is_part_name(&name) && !own.contains(&name[..]) {
            let _ = fs::remove_file(file.path());
        }
    }
    // Only if it is empty by now.
    let _ = fs::remove_dir(&folder);
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests;
