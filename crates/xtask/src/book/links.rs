//! Checks that the summary has every chapter, and that what chapters name exists.

use std::path::Path;

use anyhow::Result;

use super::summary::{CHAPTERS, SUMMARY, listed};
use crate::project::{Project, Text};

/// Start of the line that shows a file; mdbook puts the file in its place.
const INCLUDE: &str = "{{#include ";

/// Lists chapters that the summary lacks, and links, pages and included files that are missing.
pub fn check(project: &Project) -> Result<Vec<String>> {
    let pages = project.files(CHAPTERS, ".md")?;
    let exists = |path: &str| project.root().join(path).exists();
    Ok(check_pages(&pages, exists))
}

/// As [`check`], for these pages of a project that has the files for which `exists` holds.
fn check_pages(pages: &[Text], exists: impl Fn(&str) -> bool) -> Vec<String> {
    let is_summary = |page: &&Text| page.path.ends_with(SUMMARY);
    let listed = pages.iter().find(is_summary).map(listed).unwrap_or_default();
    let mut errors = Vec::new();
    for page in pages {
        let name = page.path.strip_prefix(&format!("{CHAPTERS}/")).unwrap_or(&page.path);
        if !is_summary(&page) && listed.iter().filter(|file| *file == name).count() != 1 {
            errors.push(format!("{}: {SUMMARY} must list it once", page.path));
        }
        for (i, line) in page.text.lines().enumerate() {
            let missing = named_files(&page.path, line).into_iter().filter(|path| !exists(path));
            errors.extend(missing.map(|path| format!("{}:{}: no {path}", page.path, i + 1)));
        }
    }
    errors
}

/// Lists files that a line of a page links to, includes, or names as `docs/…`, from the project's
/// root.
fn named_files(page: &str, line: &str) -> Vec<String> {
    let folder = Path::new(page).parent().unwrap_or(Path::new(""));
    let beside = |target: &str| resolved(&folder.join(target));
    let links = line.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
    let links = links.map(|(target, _)| target.split('#').next().unwrap_or_default());
    let links = links.filter(|target| !target.is_empty() && !target.contains("://"));
    let included = line.strip_prefix(INCLUDE).and_then(|rest| rest.strip_suffix("}}"));
    let named = line.split('`').skip(1).step_by(2).filter(|code| code.starts_with("docs/"));
    links.chain(included).map(beside).chain(named.map(str::to_owned)).collect()
}

/// Takes `..` out of a path, which a system might resolve by links.
fn resolved(path: &Path) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.iter().filter_map(|part| part.to_str()) {
        match part {
            "." => {}
            ".." => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(chapter: &str, files: &[&str]) -> Vec<String> {
        let page = |name: &str, text: &str| Text {
            path: format!("{CHAPTERS}/{name}"),
            text: text.to_owned(),
        };
        let pages = [page(SUMMARY, "- [A](a.md)"), page("a.md", chapter)];
        let there = ["docs/book/src/a.md"];
        check_pages(&pages, |path| there.contains(&path) || files.contains(&path))
    }

    #[test]
    fn links_includes_and_pages_must_exist() {
        let files = ["docs/book/src/p.png", "crates/x.rs", "docs/notes/y.md"];
        let text = "![P](p.png) [A](a.md#b) [w](https://x) [here](#b)\n\
                    {{#include ../../../crates/x.rs}}\nSee `docs/notes/y.md`.";
        assert_eq!(errors(text, &files), [""; 0]);
        assert_eq!(
            errors(text, &[]),
            [
                "docs/book/src/a.md:1: no docs/book/src/p.png",
                "docs/book/src/a.md:2: no crates/x.rs",
                "docs/book/src/a.md:3: no docs/notes/y.md",
            ]
        );
    }

    #[test]
    fn every_chapter_is_in_the_summary_once() {
        let path = format!("{CHAPTERS}/b.md");
        let pages = [Text { path, text: String::new() }];
        assert_eq!(check_pages(&pages, |_| true).len(), 1);
    }
}
