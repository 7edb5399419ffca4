//! The project's root folder and its text files.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

/// The project, given by the root folder of its workspace.
pub struct Project {
    root: PathBuf,
}

/// A text file of the project.
#[derive(Clone, Debug)]
pub struct Text {
    /// Path of the file from the project's root, with slashes.
    pub path: String,
    /// Contents of the file.
    pub text: String,
}

/// Folders without hand-written files.
const GENERATED: [&str; 6] = ["target", "node_modules", "corpus", "artifacts", "out", "v"];

/// Returns a call of the cargo that runs this program, in the project's root.
pub fn cargo(project: &Project) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(project.root());
    cargo
}

impl Project {
    /// Returns the project that this program was compiled from.
    pub fn here() -> Self {
        Self { root: Path::new(env!("CARGO_MANIFEST_DIR")).join("../..") }
    }

    /// Returns the root folder of the project.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Reads a text file, given its path from the project's root.
    pub fn read(&self, path: &str) -> Result<Text> {
        let text =
            std::fs::read_to_string(self.root.join(path)).with_context(|| path.to_owned())?;
        Ok(Text { path: path.to_owned(), text })
    }

    /// Reads all files in `folder` and its subfolders whose names end in `suffix`, sorted by path;
    /// empty if the folder is missing.
    pub fn files(&self, folder: &str, suffix: &str) -> Result<Vec<Text>> {
        let mut paths = Vec::new();
        self.walk(folder, suffix, &mut paths)?;
        paths.sort();
        paths.iter().map(|path| self.read(path)).collect()
    }

    fn walk(&self, folder: &str, suffix: &str, paths: &mut Vec<String>) -> Result<()> {
        let Ok(entries) = std::fs::read_dir(self.root.join(folder)) else { return Ok(()) };
        for entry in entries {
            let entry = entry?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let path = if folder == "." { name.clone() } else { format!("{folder}/{name}") };
            if entry.path().is_dir() {
                if !name.starts_with('.') && !GENERATED.contains(&name.as_str()) {
                    self.walk(&path, suffix, paths)?;
                }
            } else if name.ends_with(suffix) {
                paths.push(path);
            }
        }
        Ok(())
    }
}
