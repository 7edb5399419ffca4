//! Writing a glTF document with its buffer and images.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde::Deserialize;

use super::images::stage_image;
use super::names::stem;
use super::staged::{StagedFiles, is_mentioned, is_part_name, obsolete_parts, part_name};
use crate::error::{IoError, Unsupported};
use crate::gltf::document::uri;
use crate::gltf::document::uri::Uri;
use crate::gltf::write::output::GltfFiles;
use crate::gltf::write::settings::CompressionReport;

/// Writes the files made by `encode`, which takes a function that names the buffer by its bytes.
pub(super) fn write_gltf(
    path: &Path,
    encode: impl FnOnce(&dyn Fn(&[u8]) -> String) -> Result<(GltfFiles, CompressionReport), Unsupported>,
) -> Result<CompressionReport, IoError> {
    let stem = stem(path);
    let old = buffers_of(path);
    let is_there = |name: &str, bytes: &[u8]| {
        let file = path.with_file_name(name);
        // A buffer of another size is not read.
        fs::metadata(&file).is_ok_and(|found| found.len() == bytes.len() as u64)
            && fs::read(&file).is_ok_and(|found| found == bytes)
    };
    let name = |bytes: &[u8]| {
        let is_taken = |name: &str| {
            path.with_file_name(name).exists()
                && !is_there(name, bytes)
                && (old.contains(name) || is_mentioned(path, name))
        };
        part_name(&stem, "bin", is_taken)
    };
    let (files, report) = encode(&name).map_err(|error| IoError::unsupported(path, error))?;
    let mut staged = StagedFiles::default();
    for image in &files.images {
        stage_image(path, image, &mut staged)?;
    }
    let mut replaced = old.clone();
    if let Some((name, bytes)) = &files.buffer {
        replaced.remove(name);
        if !is_there(name, bytes) {
            staged.add(&path.with_file_name(name), |out| out.write_all(bytes))?;
        }
    }
    let is_own = |name: &str| is_part_name(name, &stem, "bin");
    let obsolete = obsolete_parts(path, &replaced, is_own);
    staged.finish(path, |out| out.write_all(&files.document), &obsolete)?;
    Ok(report)
}

/// Returns the file names of the buffers of a document in the same folder; empty if there is no
/// readable document.
fn buffers_of(path: &Path) -> BTreeSet<String> {
    #[derive(Default, Deserialize)]
    #[serde(default)]
    struct OldDocument {
        buffers: Vec<OldBuffer>,
    }
    #[derive(Default, Deserialize)]
    #[serde(default)]
    struct OldBuffer {
        uri: Option<String>,
    }
    let is_file = fs::metadata(path).is_ok_and(|found| found.is_file());
    let bytes = if is_file { fs::read(path).unwrap_or_default() } else { Vec::new() };
    let document: OldDocument = serde_json::from_slice(&bytes).unwrap_or_default();
    let uris = document.buffers.into_iter().filter_map(|buffer| buffer.uri);
    let name = |uri: String| match uri::parse(&uri) {
        Ok(Uri::File(name)) => Some(name.trim_start_matches("./").to_owned()),
        _ => None,
    };
    uris.filter_map(name).collect()
}
