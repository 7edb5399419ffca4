//! `cargo xtask doc`: builds the documentation; all warnings are errors, except those about
//! reference keys.
//!
//! rustdoc takes `[GH97]` in a comment for a link to an item. That warning is ignored if the key is
//! in docs/REFERENCES.md.

use std::process::Stdio;

use anyhow::{Context, Result, bail};
use serde_json::Value;

use crate::check::keys_of;
use crate::project::{Project, cargo};

/// Builds the documentation of all crates in the workspace, with more options of cargo, and prints
/// the warnings.
pub fn run(project: &Project, options: &[String]) -> Result<()> {
    let references = project.read("docs/REFERENCES.md")?;
    let keys = keys_of(&references);
    let output = cargo(project)
        .args(["doc", "--release", "--no-deps", "--workspace", "--quiet", "--message-format=json"])
        .args(["--features", "meshlod-cli/view,meshlod-view/viewer"])
        .args(options)
        .env("RUSTDOCFLAGS", "-Wrustdoc::broken_intra_doc_links")
        .stderr(Stdio::inherit())
        .output()
        .context("cargo doc")?;
    let messages = String::from_utf8_lossy(&output.stdout);
    let findings: Vec<_> = messages.lines().filter_map(|line| finding(line, &keys)).collect();
    for finding in &findings {
        println!("{finding}");
    }
    if !findings.is_empty() || !output.status.success() {
        bail!("{} warnings in the documentation", findings.len());
    }
    Ok(())
}

/// Returns the warning in a line of cargo's JSON output; `None` for anything else and for reference
/// keys.
fn finding(line: &str, keys: &[&str]) -> Option<String> {
    let message: Value = serde_json::from_str(line).ok()?;
    let message = message.get("message")?;
    let text = message.get("message")?.as_str()?;
    let link = text.strip_prefix("unresolved link to `").and_then(|rest| rest.strip_suffix('`'));
    // Summaries such as "3 warnings emitted" have no span.
    let has_place = message.get("spans")?.as_array().is_some_and(|spans| !spans.is_empty());
    if !has_place || link.is_some_and(|link| keys.contains(&link)) {
        return None;
    }
    Some(message.get("rendered")?.as_str()?.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(text: &str, spans: &str) -> String {
        format!(r#"{{"message":{{"message":"{text}","spans":[{spans}],"rendered":"R"}}}}"#)
    }

    #[test]
    fn a_known_key_is_no_finding() {
        let warning = line("unresolved link to `GH97`", "1");
        assert_eq!(finding(&warning, &["GH97"]), None);
        assert_eq!(finding(&warning, &["CRS98"]).as_deref(), Some("R"));
    }

    #[test]
    fn other_warnings_are_findings_and_summaries_are_not() {
        assert!(finding(&line("missing documentation for a struct", "1"), &[]).is_some());
        assert_eq!(finding(&line("2 warnings emitted", ""), &[]), None);
        assert_eq!(finding(r#"{"reason":"build-finished","success":true}"#, &[]), None);
    }
}
