//! Files of a batch: found by patterns, each with a place for its output.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

use glob::Pattern;
use meshlod::FileKind;

use crate::options::parse::Suffix;
use crate::session::failure::Failure;
use crate::session::{files, patterns};

/// One file of a batch.
#[derive(Clone, Debug, PartialEq)]
pub struct FileJob {
    pub input: PathBuf,
    pub output: PathBuf,
}

/// All files of a batch.
pub struct Plan {
    /// Files in the order of the patterns, and of their paths.
    pub jobs: Vec<FileJob>,
    /// Number of files that patterns match but that are of no format that is read.
    pub others: usize,
}

impl Plan {
    /// Finds the files of `patterns`; outputs are below `folder`, with another suffix if one is
    /// given.
    ///
    /// # Errors
    /// Patterns that match nothing, and outputs that would overwrite each other or an input.
    pub fn new(
        patterns: &[PathBuf],
        folder: &Path,
        suffix: Option<&Suffix>,
    ) -> Result<Self, Failure> {
        check_folder(folder)?;
        let mut plan = Self { jobs: Vec::new(), others: 0 };
        let mut seen = BTreeSet::new();
        for pattern in patterns {
            let found = Found::of(pattern, folder)?;
            plan.others += found.others;
            for input in found.files {
                let output = place(&input, &found.base, folder, suffix)?;
                if seen.insert((input.clone(), output.clone())) {
                    plan.jobs.push(FileJob { input, output });
                }
            }
        }
        plan.refuse_collisions()?;
        Ok(plan)
    }

    fn refuse_collisions(&self) -> Result<(), Failure> {
        let real = |path: &Path| fs::canonicalize(path).ok();
        let inputs: BTreeMap<PathBuf, &Path> =
            self.jobs.iter().filter_map(|job| Some((real(&job.input)?, &*job.input))).collect();
        let mut outputs: BTreeMap<&Path, &Path> = BTreeMap::new();
        for FileJob { input, output } in &self.jobs {
            if let Some(other) = outputs.insert(output, input) {
                let [input, other] = [input, other].map(files::name);
                let reason = format_args!("would be the output of both {other} and {input}");
                return Err(Failure::at(output, reason));
            }
            if let Some(other) = real(output).and_then(|output| inputs.get(&output)) {
                let reason = format_args!("would overwrite the input {}", files::name(other));
                return Err(Failure::at(output, reason));
            }
        }
        Ok(())
    }
}

/// Fails if the output folder is a mesh, which was meant as an input or as the output of one file.
fn check_folder(folder: &Path) -> Result<(), Failure> {
    if FileKind::of_path(folder).is_err() || folder.is_dir() {
        return files::check_folder(folder);
    }
    let reason = "the last path of a batch is the folder to write to, not a mesh; one file is written by \
                  meshlod simplify";
    Err(Failure::usage(format_args!("{}: {reason}", files::name(folder))).about(folder))
}

/// Files that one pattern matches.
struct Found {
    /// Folder that the pattern fixes.
    base: PathBuf,
    files: Vec<PathBuf>,
    others: usize,
}

impl Found {
    fn of(pattern: &Path, out: &Path) -> Result<Self, Failure> {
        if pattern.is_file() {
            let base = pattern.parent().unwrap_or(Path::new("")).to_owned();
            return Ok(Self { base, files: vec![pattern.to_owned()], others: 0 });
        }
        if !pattern.exists() && !patterns::is_pattern(pattern) {
            return Err(Failure::at(pattern, "there is no such file or folder"));
        }
        let text = pattern.to_str().ok_or_else(|| Failure::at(pattern, "is not Unicode"))?;
        let (base, text) = match pattern.is_dir() {
            true => (
                pattern.to_owned(),
                format!("{}/**/*", Pattern::escape(text.trim_end_matches('/'))),
            ),
            false => (fixed_part(pattern), text.to_owned()),
        };
        // Paths that are found do not begin with a dot of the pattern.
        let base = base.strip_prefix(".").map(Path::to_owned).unwrap_or(base);
        let mut found = Self { base, files: Vec::new(), others: 0 };
        let made_before = made_before(&found.base, out);
        for path in patterns::matches(pattern, &text)? {
            if !path.is_file() || made_before.as_deref().is_some_and(|out| is_below(&path, out)) {
                continue;
            }
            match FileKind::of_path(&path).is_ok() {
                true => found.files.push(path),
                false => found.others += 1,
            }
        }
        match found.files.is_empty() {
            true => Err(Failure::at(pattern, "no file of a format that is read")),
            false => Ok(found),
        }
    }
}

/// Returns the folders before the first name of a pattern that stands for several.
fn fixed_part(pattern: &Path) -> PathBuf {
    let is_fixed =
        |part: &Component<'_>| !part.as_os_str().to_string_lossy().contains(['*', '?', '[']);
    let fixed: PathBuf = pattern.components().take_while(is_fixed).collect();
    match fixed == pattern {
        true => fixed.parent().unwrap_or(Path::new("")).to_owned(),
        false => fixed,
    }
}

/// Returns the output folder if it is below the folder that is searched, so that what an earlier
/// batch has made is not taken for an input.
fn made_before(base: &Path, out: &Path) -> Option<PathBuf> {
    let base = fs::canonicalize(if base.as_os_str().is_empty() { Path::new(".") } else { base });
    let (base, out) = (base.ok()?, fs::canonicalize(out).ok()?);
    (out != base && out.starts_with(base)).then_some(out)
}

fn is_below(path: &Path, folder: &Path) -> bool {
    fs::canonicalize(path).is_ok_and(|path| path.starts_with(folder))
}

/// Chooses the place of an output: below `folder` as the input is below `base`.
fn place(
    input: &Path,
    base: &Path,
    folder: &Path,
    suffix: Option<&Suffix>,
) -> Result<PathBuf, Failure> {
    let below = input.strip_prefix(base).unwrap_or(input);
    if !below.components().all(|part| matches!(part, Component::Normal(_))) {
        return Err(Failure::at(input, "its pattern leads out of the folder where it begins"));
    }
    let output = folder.join(below);
    Ok(match suffix {
        Some(suffix) => output.with_extension(&suffix.text),
        None => output,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_begin_with_a_fixed_part() {
        let cases = [
            ("in/**/*.glb", "in"),
            ("*.ply", ""),
            ("a/b/c?.ply", "a/b"),
            ("/a/[bc]/d.ply", "/a"),
            ("a/missing.ply", "a"),
            ("../x/*.ply", "../x"),
        ];
        for (pattern, fixed) in cases {
            assert_eq!(fixed_part(Path::new(pattern)), Path::new(fixed), "{pattern}");
        }
    }

    #[test]
    fn outputs_stay_below_their_folder() {
        let glb = Suffix { text: "glb".into(), mesh: None };
        let at = |input: &str, base: &str| {
            place(Path::new(input), Path::new(base), Path::new("out"), Some(&glb))
        };
        assert_eq!(at("in/a/b.c.ply", "in").unwrap(), Path::new("out/a/b.c.glb"));
        assert!(at("in/a/../../b.ply", "in").is_err());
        assert!(at("/b.ply", "in").is_err());
    }
}
