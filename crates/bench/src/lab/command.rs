//! Builds and runs the command-line program `meshlod`.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use serde_json::Value;
use wait4::{ResourceUsage, Wait4};

use crate::lab::folders::root;

/// Path of the release build of `meshlod`.
pub struct Program(PathBuf);

impl Program {
    /// Takes a build of `meshlod` by its path.
    pub fn at(path: impl Into<PathBuf>) -> Self {
        Self(path.into())
    }

    /// Builds `meshlod` in release mode.
    pub fn build() -> Result<Self> {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let status = Command::new(cargo)
            .args(["build", "--release", "--package", "meshlod-cli"])
            .current_dir(root())
            .status()?;
        if !status.success() {
            bail!("building meshlod failed");
        }
        let target = std::env::current_exe()?;
        let folder = target.parent().context("the path of a program has a folder")?;
        Ok(Self(folder.join("meshlod")))
    }

    /// Runs `meshlod` and returns its time and memory; fails if the program fails.
    pub fn run(&self, arguments: &[&str], files: [&Path; 2]) -> Result<ResourceUsage> {
        let mut child = Command::new(&self.0)
            .arg(arguments[0])
            .args(files)
            .args(&arguments[1..])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .with_context(|| self.0.display().to_string())?;
        let used = child.wait4()?;
        if !used.status.success() {
            bail!("meshlod {} failed", arguments.join(" "));
        }
        Ok(used.rusage)
    }

    /// Runs `meshlod` with `--json` and returns its answer; fails with its message if the program
    /// fails.
    pub fn answer(&self, arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Result<Value> {
        let output = Command::new(&self.0).args(arguments).arg("--json").output();
        let output = output.with_context(|| self.0.display().to_string())?;
        if !output.status.success() {
            bail!("{}", String::from_utf8_lossy(&output.stderr).trim());
        }
        Ok(serde_json::from_slice(&output.stdout)?)
    }
}
