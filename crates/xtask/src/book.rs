//! `cargo xtask book`: runs the commands and programs in the chapters of docs/book, in the order of its
//! summary, and compares what they print and draw with what the book shows.

mod blocks;
mod links;
mod output;
mod pictures;
mod session;

use std::path::PathBuf;

use anyhow::{Context, Result, bail};

use crate::project::{Project, Text};
use crate::results::Program;
use session::{Session, Tools};

pub use links::check;

/// Folder of the chapters and of their summary, from the project's root.
const CHAPTERS: &str = "docs/book/src";
/// Folder of the pictures: from that of the chapters, and from where a chapter runs.
const PICTURES: &str = "pictures";
/// File that lists the chapters.
const SUMMARY: &str = "SUMMARY.md";

/// Options of `cargo xtask book`.
#[derive(Default)]
struct Options {
    /// Rewrite what differs in place of reporting it.
    write: bool,
    /// Python that has the package; programs in Python are skipped without it.
    python: Option<PathBuf>,
    /// Build of `meshlod` to use in place of making one.
    program: Option<PathBuf>,
    /// Names of the chapters to run; all if there are no names.
    chapters: Vec<String>,
}

/// Runs the chapters and prints what is wrong in them; fails if anything is.
pub fn run(project: &Project, arguments: &[String]) -> Result<()> {
    let options = Options::parse(arguments)?;
    let program = match &options.program {
        Some(path) => Program::at(path.canonicalize().with_context(|| path.display().to_string())?),
        None => Program::build(project)?,
    };
    let tools = Tools { program: program.path(), python: options.python.as_deref() };
    let mut errors = Vec::new();
    let mut made = Vec::new();
    for name in chapters(project, &options.chapters)? {
        let chapter = project.read(&format!("{CHAPTERS}/{name}"))?;
        let session = Session::run(&chapter, &tools)?;
        session.notes.iter().for_each(|note| println!("note: {note}"));
        errors.extend(session.errors.iter().cloned());
        if options.write {
            let text = session.rewritten(&chapter.text);
            std::fs::write(project.root().join(&chapter.path), text)?;
        } else {
            errors.extend(session.differences.iter().map(ToString::to_string));
        }
        let place = project.root().join(CHAPTERS).join(PICTURES);
        errors.extend(pictures::settle(&session.pictures, &place, options.write)?);
        made.extend(session.pictures.into_iter().map(|picture| picture.name));
        println!("{name}: {} commands and programs", session.runs);
    }
    if options.chapters.is_empty() {
        errors.extend(pictures::orphans(&project.root().join(CHAPTERS).join(PICTURES), &made)?);
    }
    errors.iter().for_each(|error| println!("error: {error}"));
    if !errors.is_empty() {
        bail!("the book has {} errors; `cargo xtask book --write` shows new output", errors.len());
    }
    Ok(())
}

impl Options {
    fn parse(arguments: &[String]) -> Result<Self> {
        let mut options = Self::default();
        let mut arguments = arguments.iter();
        while let Some(argument) = arguments.next() {
            let mut path = || arguments.next().map(PathBuf::from).context("a path is missing");
            match argument.as_str() {
                "--write" => options.write = true,
                "--python" => options.python = Some(path()?),
                "--program" => options.program = Some(path()?),
                option if option.starts_with('-') => bail!("unknown option {option}"),
                chapter => options.chapters.push(chapter.to_owned()),
            }
        }
        Ok(options)
    }
}

/// Lists the file names of the chapters with such names, or of all, in the order of the summary.
fn chapters(project: &Project, names: &[String]) -> Result<Vec<String>> {
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
fn listed(summary: &Text) -> Vec<String> {
    let targets = summary.text.lines().filter_map(|line| line.split_once("](")?.1.split_once(')'));
    targets.map(|(target, _)| target.to_owned()).collect()
}
