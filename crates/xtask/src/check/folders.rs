//! Checks that folders of many files say in which order they are read.

use std::collections::BTreeMap;

use crate::check::source::Source;

/// Number of source files in a folder above which its module must give a reading order.
const MANY: usize = 12;

/// Lists folders of more than 12 source files whose module does not name at least half of them in
/// the comment at its top.
pub fn check(sources: &[Source]) -> Vec<String> {
    let mut folders: BTreeMap<&str, Vec<&Source>> = BTreeMap::new();
    for source in sources.iter().filter(|source| source.path.contains("/src/")) {
        let (folder, _) = source.path.rsplit_once('/').unwrap_or_default();
        folders.entry(folder).or_default().push(source);
    }
    let mut notes = Vec::new();
    for (folder, files) in folders.iter().filter(|(_, files)| files.len() > MANY) {
        let top = sources.iter().find(|source| is_module_of(&source.path, folder)).map(comment);
        let top = top.unwrap_or_default();
        let named = files.iter().filter(|file| top.contains(&format!("`{}`", name(&file.path))));
        if 2 * named.count() < files.len() {
            let count = files.len();
            notes.push(format!("{folder}: {count} files, and their module gives no reading order"));
        }
    }
    notes
}

/// Reports whether a file is the module of a folder: `mod.rs` in it, `NAME.rs` beside it, or a root.
fn is_module_of(path: &str, folder: &str) -> bool {
    let inside = path.strip_prefix(folder).and_then(|rest| rest.strip_prefix('/'));
    let is_root = folder.ends_with("/src") && matches!(inside, Some("lib.rs" | "main.rs"));
    inside == Some("mod.rs") || is_root || path.strip_suffix(".rs") == Some(folder)
}

/// Returns the comment at the top of a module.
fn comment(source: &Source) -> String {
    let lines = source.comments.iter().filter(|piece| piece.text.starts_with("//!"));
    lines.map(|piece| piece.text.as_str()).collect()
}

/// Returns the name of a file without its folder and suffix.
fn name(path: &str) -> &str {
    let file = path.rsplit('/').next().unwrap_or(path);
    file.strip_suffix(".rs").unwrap_or(file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::project::Text;

    fn notes(count: usize, module: &str, top: &str) -> usize {
        let file = |path: String, text: &str| Source::new(&Text { path, text: text.into() });
        let files = (1..count).map(|i| file(format!("crates/a/src/b/f{i}.rs"), ""));
        let files: Vec<_> = files.chain([file(format!("crates/a/src/{module}.rs"), top)]).collect();
        check(&files).len()
    }

    #[test]
    fn many_files_need_an_order() {
        let half = "//! | `f1`, `f2`, `f3` |\n//! | `f4`, `f5`, `f6`, `f7` |\n";
        assert_eq!(notes(12, "b/mod", ""), 0);
        assert_eq!(notes(13, "b/mod", ""), 1);
        assert_eq!(notes(13, "b/mod", half), 0);
        assert_eq!(notes(14, "b", half), 0);
        assert_eq!(notes(14, "b", "//! `f1`"), 1);
    }
}
