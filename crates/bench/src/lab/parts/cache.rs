//! Figures of other programs, kept between runs under `target`.

use std::hash::{DefaultHasher, Hasher};
use std::path::PathBuf;

use anyhow::{Context, Result};
use serde_json::{Map, Value};

use crate::lab::folders::root;

/// Figures that depend on one input alone, in a file named after its content.
pub struct Cache {
    path: PathBuf,
    values: Map<String, Value>,
}

impl Cache {
    /// Opens the figures for an input, given by all bytes that they depend on; empty if there are
    /// no figures yet. A change of how distances are measured is not seen: delete the folder then.
    pub fn open<'b>(input: impl IntoIterator<Item = &'b [u8]>) -> Result<Self> {
        let mut hasher = DefaultHasher::new();
        for bytes in input {
            hasher.write_usize(bytes.len());
            hasher.write(bytes);
        }
        let folder = folder("figures")?;
        let path = folder.join(format!("{:016x}.json", hasher.finish()));
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        Ok(Self { path, values: serde_json::from_str(&text).unwrap_or_default() })
    }

    /// Returns a figure by its name; `None` if it has yet to be made.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.values.get(name)
    }

    /// Keeps a figure for this run and later ones.
    pub fn set(&mut self, name: String, value: Value) -> Result<()> {
        self.values.insert(name, value);
        let text = serde_json::to_string_pretty(&self.values)?;
        std::fs::write(&self.path, text).with_context(|| self.path.display().to_string())
    }
}

/// Returns a folder for generated files of this section, `target/parts/NAME`, which it makes.
pub fn folder(name: &str) -> Result<PathBuf> {
    let folder = root().join("target/parts").join(name);
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    Ok(folder)
}
