//! Chapters of the book, as its summary lists them.

use anyhow::{Result, bail};

use crate::project::{Project, Text};

/// Folder of the chapters and of the summary, from the project's root.
pub const CHAPTERS: &str = "docs/book/src";
/// File that lists the chapters.
pub const SUMMARY: &str = "SUMMARY.md";

/// Lists the file names of the chapters with such names, or of all, in the order of the summary.
pub fn chapters(project: &Project, names: &[String]) -> Result<Vec<String>> {
    let summary = project.read(&format!("{CHAPTERS}/{SUMMARY}"))?;
    let all = listed(&summary);
    let stem = |file: &str| file.trim_end_matches(".md").to_owned();
    if let Some(unknown) = names.iter().find(|name| !all.iter().any(|file| stem(file) == **name)) {
        bail!("{CHAPTERS}/{SUMMARY} has no chapter {unknown}");
    }
    let is_wanted = |file: &String| names.is_empty() || names.contains(&stem(file));
    Ok(all.into_iter().filter(is_wanted).collect())
}

/// Lists the files that the summary links to.
pub fn listed(summary: &Text) -> Vec<String> {
    let targets = summary.text.lines().filter_map(|line| line.split_once("](")?.1.split_once(')'));
    targets.map(|(target, _)| target.to_owned()).collect()
}
