//! Writing an OBJ file with its material library and images.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::path::Path;

use super::beside::Beside;
use super::images::{stage_image, use_own_names};
use super::names::stem;
use super::staged::{StagedFiles, is_mentioned, is_part_name, obsolete_parts, part_name};
use crate::error::IoError;
use crate::format::Format;
use crate::obj;
use crate::obj::mtl;
use crate::precision::Precision;
use crate::scene::Scene;
use crate::text::cursor::text_of;

/// Writes a scene; the material library of the old file stays if it is equivalent.
pub(super) fn write_obj(path: &Path, scene: &Scene, precision: Precision) -> Result<(), IoError> {
    let mut staged = StagedFiles::default();
    let mut images = scene.images.clone();
    use_own_names(path, &mut images);
    for image in images.iter().filter(|image| !image.bytes.is_empty()) {
        stage_image(path, image, &mut staged)?;
    }
    let (materials, source) = (scene.materials.clone(), scene.source.clone());
    let named = Scene { materials, images, source, ..Scene::default() };
    let old = OldLibraries::of(path);
    let libraries = match named.materials.is_empty() {
        true => Vec::new(),
        false if old.say(&named) => old.lines.clone(),
        false => stage_library(path, &named, &old, &mut staged)?,
    };
    let used = names_in(&libraries);
    // A scene without materials says nothing of those of the file before.
    let replaced = names_in(&old.lines).into_iter().filter(|_| !libraries.is_empty());
    let replaced: BTreeSet<String> = replaced.filter(|name| !used.contains(name)).collect();
    let is_own = |name: &str| is_part_name(name, &stem(path), "mtl");
    let obsolete = obsolete_parts(path, &replaced, is_own);
    staged.finish(path, |out| obj::write(scene, precision, out, &libraries), &obsolete)
}

/// Material libraries of the file to be replaced.
struct OldLibraries {
    /// File names on each `mtllib` line.
    lines: Vec<String>,
    known: mtl::Library,
}

impl OldLibraries {
    fn of(path: &Path) -> Self {
        let lines = libraries_of(path);
        let mut beside = Beside::of(path, Format::Obj);
        let mut known = mtl::Library::default();
        lines.iter().for_each(|names| known.add(names, &mut |name| beside.read(name)));
        Self { lines, known }
    }

    /// Reports whether the libraries define the materials of a scene.
    fn say(&self, scene: &Scene) -> bool {
        // Without their libraries, the materials are but names.
        !self.lines.is_empty()
            && (mtl::same_library(&self.known, scene) || mtl::defined(scene).is_empty())
    }
}

/// Lists all file names that `mtllib` lines may refer to.
fn names_in(lines: &[String]) -> BTreeSet<String> {
    let parts = lines.iter().flat_map(|line| mtl::library_names(line)).map(str::to_owned);
    parts.chain(lines.iter().cloned()).collect()
}

/// Stages the library of a scene, unless it exists already. Returns its name, followed by libraries
/// that were not found, if they may define materials of which the scene only has names.
fn stage_library(
    path: &Path,
    scene: &Scene,
    old: &OldLibraries,
    staged: &mut StagedFiles,
) -> Result<Vec<String>, IoError> {
    let own = mtl::own_definitions(&old.known, scene);
    let is_partial = own.len() < scene.materials.len();
    let unread: Vec<&str> = old.known.unread().filter(|_| is_partial).collect();
    let mut bytes = Vec::new();
    mtl::write_definitions(&own, &mut bytes).map_err(|error| IoError::system(path, error))?;
    let found = |name: &str| fs::read(path.with_file_name(name)).ok();
    let used = names_in(&old.lines);
    let is_taken = |name: &str| {
        // A library that says more can take the place of one in use.
        unread.contains(&name)
            || found(name).is_some_and(|found| !mtl::is_superset(&bytes, &found))
                && (used.contains(name) || is_mentioned(path, name))
    };
    let name = part_name(&stem(path), "mtl", is_taken);
    if found(&name).as_deref() != Some(&bytes) {
        staged.add(&path.with_file_name(&name), |out| out.write_all(&bytes))?;
    }
    Ok(std::iter::once(name).chain(unread.into_iter().map(str::to_owned)).collect())
}

/// Returns the distinct names on the `mtllib` lines of a file; empty if the file does not exist.
fn libraries_of(path: &Path) -> Vec<String> {
    let mut libraries = Vec::new();
    if !fs::metadata(path).is_ok_and(|found| found.is_file()) {
        return libraries;
    }
    let Ok(file) = File::open(path) else { return libraries };
    // A file without line ends is no OBJ file, and not read as one line.
    let mut file = BufReader::with_capacity(1 << 16, file);
    let mut line = Vec::new();
    while let Ok(piece) = file.fill_buf()
        && !piece.is_empty()
    {
        let end = piece.iter().position(|&byte| byte == b'\n' || byte == b'\r');
        let used = end.map_or(piece.len(), |end| end + 1);
        if line.len() < LONGEST_LINE {
            line.extend_from_slice(&piece[..end.unwrap_or(piece.len())]);
        }
        file.consume(used);
        if end.is_some() {
            add_library(&line, &mut libraries);
            line.clear();
        }
    }
    add_library(&line, &mut libraries);
    libraries
}

/// Length in bytes from which lines are ignored.
const LONGEST_LINE: usize = 1 << 16;

fn add_library(line: &[u8], libraries: &mut Vec<String>) {
    let Some(rest) = line.trim_ascii_start().strip_prefix(b"mtllib") else { return };
    let name = text_of(rest.trim_ascii());
    if rest.first().is_some_and(u8::is_ascii_whitespace) && !libraries.contains(&name) {
        libraries.push(name);
    }
}
