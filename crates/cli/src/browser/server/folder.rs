//! The folder that is served: files by the paths of requests, none outside, none that is hidden.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use percent_encoding::percent_decode_str;
use serde::Serialize;

/// Suffixes of the files that the viewer shows.
const SHOWN: [&str; 3] = ["mlod", "mlz", "mlq"];
/// Greatest number of files that are listed, of entries looked at, and of folders within each other.
const MOST_FILES: usize = 1000;
const MOST_ENTRIES: usize = 100_000;
const MOST_DEPTH: usize = 16;

/// The folder of a server.
#[derive(Debug)]
pub struct Folder {
    /// Its real path, without links.
    root: PathBuf,
}

/// A file that is open, as it was when it was opened.
pub struct OpenFile {
    pub file: File,
    pub length: u64,
    pub modified: SystemTime,
    /// Entity tag: another length or time is another file.
    pub tag: String,
    pub media_type: &'static str,
}

/// A file that the viewer can show.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct ListedFile {
    /// Path from the folder, with slashes.
    pub path: String,
    pub bytes: u64,
}

impl Folder {
    /// Takes a folder that is there.
    pub fn open(path: &Path) -> io::Result<Self> {
        let root = fs::canonicalize(path)?;
        match root.is_dir() {
            true => Ok(Self { root }),
            false => Err(io::ErrorKind::NotADirectory.into()),
        }
    }

    /// Opens a file by the path of a request; `None` for whatever is not to be served.
    pub fn file(&self, encoded: &str) -> Option<OpenFile> {
        let mut path = self.root.clone();
        for part in encoded.strip_prefix('/')?.split('/') {
            let name = percent_decode_str(part).decode_utf8().ok()?;
            if !is_plain(&name) {
                return None;
            }
            path.push(&*name);
        }
        // A link may lead out of the folder.
        let real = fs::canonicalize(&path).ok().filter(|real| real.starts_with(&self.root))?;
        // Opening a pipe would wait for somebody to write into it.
        let is_file = fs::metadata(&real).ok()?.is_file();
        let file = is_file.then(|| File::open(&real).ok())??;
        let facts = file.metadata().ok().filter(fs::Metadata::is_file)?;
        let modified = facts.modified().ok()?;
        let since = modified.duration_since(UNIX_EPOCH).unwrap_or_default();
        Some(OpenFile {
            file,
            length: facts.len(),
            modified,
            tag: format!("\"{:x}-{:x}\"", facts.len(), since.as_nanos()),
            media_type: media_type(&path),
        })
    }

    /// Lists the files that the viewer can show, in order.
    pub fn list(&self) -> Vec<ListedFile> {
        let mut files = Vec::new();
        let mut entries = MOST_ENTRIES;
        self.list_in(&self.root, "", MOST_DEPTH, &mut entries, &mut files);
        files.sort();
        files
    }

    fn list_in(
        &self,
        folder: &Path,
        prefix: &str,
        depth: usize,
        entries: &mut usize,
        files: &mut Vec<ListedFile>,
    ) {
        let Ok(found) = fs::read_dir(folder) else { return };
        for entry in found.flatten() {
            if *entries == 0 || files.len() >= MOST_FILES {
                return;
            }
            *entries -= 1;
            let Ok(name) = entry.file_name().into_string() else { continue };
            // Links are served where they stay inside, but not listed: folders may be in a ring.
            let Ok(facts) = entry.metadata() else { continue };
            if !is_plain(&name) {
                continue;
            }
            let path = format!("{prefix}{name}");
            let suffix = Path::new(&name).extension().unwrap_or_default();
            if facts.is_dir() && depth > 0 {
                self.list_in(&entry.path(), &format!("{path}/"), depth - 1, entries, files);
            } else if facts.is_file()
                && SHOWN.iter().any(|shown| suffix.eq_ignore_ascii_case(shown))
            {
                files.push(ListedFile { path, bytes: facts.len() });
            }
        }
    }
}

/// Returns true for a name that means one thing on every system, and is not hidden.
fn is_plain(name: &str) -> bool {
    let is_special =
        |c: char| matches!(c, '/' | '\\') || c.is_control() || cfg!(windows) && c == ':';
    !name.is_empty() && !name.starts_with('.') && !name.contains(is_special)
}

/// Returns the media type of a file by its suffix.
fn media_type(path: &Path) -> &'static str {
    let suffix = path.extension().unwrap_or_default().to_ascii_lowercase();
    match suffix.to_str().unwrap_or_default() {
        "html" | "htm" => "text/html; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "json" | "map" => "application/json",
        "txt" | "md" => "text/plain; charset=utf-8",
        "gltf" => "model/gltf+json",
        "glb" => "model/gltf-binary",
        "obj" => "model/obj",
        "stl" => "model/stl",
        "png" => "image/png",
        "jpg" | "jpeg" => "image/jpeg",
        "webp" => "image/webp",
        "svg" => "image/svg+xml",
        "wasm" => "application/wasm",
        _ => "application/octet-stream",
    }
}
