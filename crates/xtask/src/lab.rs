//! Starts the laboratory, which measures; it needs all libraries, so it is a program of its own.

use anyhow::{Result, bail};

use crate::project::{Project, cargo};

/// Verbs that run in the laboratory.
pub const VERBS: [&str; 6] = ["results", "policies", "textured", "parts", "tiles", "compare"];

/// Builds the laboratory and runs it with a verb and its arguments.
pub fn run(project: &Project, arguments: &[String]) -> Result<()> {
    let status = cargo(project)
        .args(["run", "--release", "--quiet", "--package", "meshlod-bench", "--bin", "lab", "--"])
        .args(arguments)
        .status()?;
    if !status.success() {
        bail!("the laboratory ended with {status}");
    }
    Ok(())
}
