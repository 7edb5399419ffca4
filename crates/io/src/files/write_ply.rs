//! Writing a PLY file with its images.

use std::collections::BTreeSet;
use std::io;
use std::path::Path;

use super::images::{stage_image, use_own_names};
use super::replace::replace;
use super::staged::StagedFiles;
use crate::error::IoError;
use crate::ply::{self, StreamShape, StreamWriter};
use crate::precision::Precision;
use crate::scene::Scene;

/// Writes a PLY file and, beside it, the images its materials use.
pub(super) fn write_ply(path: &Path, scene: &Scene, precision: Precision) -> Result<(), IoError> {
    let used = scene.materials.iter().filter_map(|material| material.base_color_image);
    let used: BTreeSet<usize> = used.collect();
    let mut images = scene.images.clone();
    use_own_names(path, &mut images);
    let mut staged = StagedFiles::default();
    for &image in used.range(..images.len()) {
        if !images[image].bytes.is_empty() {
            stage_image(path, &images[image], &mut staged)?;
        }
    }
    staged.finish(path, |out| ply::write_named(scene, &images, precision, out), &[])
}

/// Writes a PLY file vertex by vertex and face by face, as `fill` hands them on. The old file stays
/// as it is until the new one is complete.
///
/// # Errors
/// Errors of the system and of `fill`, and other numbers of vertices and faces than the shape says.
pub fn write_ply_stream(
    path: &Path,
    shape: StreamShape,
    fill: impl FnOnce(&mut StreamWriter<'_>) -> io::Result<()>,
) -> Result<(), IoError> {
    let written = replace(path, |out| {
        let mut writer = StreamWriter::new(out, shape)?;
        fill(&mut writer)?;
        writer.finish()
    });
    written.map_err(|error| IoError::system(path, error))
}
