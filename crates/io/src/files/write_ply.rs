//! Writing a PLY file with its images.

use std::collections::BTreeSet;
use std::path::Path;

use super::images::{stage_image, use_own_names};
use super::staged::StagedFiles;
use crate::error::IoError;
use crate::ply;
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
