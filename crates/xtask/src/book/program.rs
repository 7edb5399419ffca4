//! Builds the command-line program `meshlod`.

use std::path::PathBuf;
use std::process::Stdio;

use anyhow::{Context, Result, bail};
use serde_json::Value;

use crate::project::{Project, cargo};

/// Builds `meshlod` in release mode and returns its path.
pub fn build(project: &Project) -> Result<PathBuf> {
    let output = cargo(project)
        .args(["build", "--release", "--package", "meshlod-cli", "--message-format=json"])
        .stderr(Stdio::inherit())
        .output()
        .context("cargo build")?;
    if !output.status.success() {
        bail!("building meshlod failed");
    }
    let messages = String::from_utf8_lossy(&output.stdout);
    messages.lines().find_map(executable).context("cargo names no program that it has built")
}

/// Returns the path of the program that a line of cargo's JSON output names.
fn executable(line: &str) -> Option<PathBuf> {
    let message: Value = serde_json::from_str(line).ok()?;
    Some(message.get("executable")?.as_str()?.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_programs_have_a_path() {
        let library = r#"{"reason":"compiler-artifact","executable":null}"#;
        let program = r#"{"reason":"compiler-artifact","executable":"/t/release/meshlod"}"#;
        let end = r#"{"reason":"build-finished","success":true}"#;
        assert_eq!(
            [library, program, end].map(executable),
            [None, Some("/t/release/meshlod".into()), None]
        );
    }
}
