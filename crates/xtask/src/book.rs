//! `cargo xtask book`: runs the commands and programs in the chapters of docs/book and compares
//! what they print and draw with what the book shows.

mod blocks;
mod links;
mod output;
mod pictures;
pub mod program;
mod session;
mod summary;

use std::path::PathBuf;

use anyhow::{Context, Result, bail};

use crate::project::Project;
use session::Programs;
use summary::{CHAPTERS, chapters};

pub use links::check;

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
        Some(path) => path.clone(),
        None => program::build(project)?,
    };
    let programs = Programs { meshlod: &program, python: options.python.as_deref() };
    let pictures = project.root().join(CHAPTERS).join(pictures::FOLDER);
    let mut errors = Vec::new();
    let mut made = Vec::new();
    for name in chapters(project, &options.chapters)? {
        let chapter = project.read(&format!("{CHAPTERS}/{name}"))?;
        let findings = session::run(&chapter, &programs)?;
        findings.notes.iter().for_each(|note| println!("note: {note}"));
        errors.extend(findings.errors.iter().cloned());
        // What a command prints that fails is not for the book.
        if options.write && findings.errors.is_empty() {
            let text = findings.rewritten(&chapter.text);
            std::fs::write(project.root().join(&chapter.path), text)?;
        } else {
            errors.extend(findings.differences.iter().map(ToString::to_string));
        }
        errors.extend(pictures::settle(&findings.pictures, &pictures, options.write)?);
        made.extend(findings.pictures.into_iter().map(|picture| picture.name));
        println!("{name}: {} commands and programs", findings.runs);
    }
    if options.chapters.is_empty() {
        errors.extend(pictures::orphans(&pictures, &made)?);
    }
    errors.iter().for_each(|error| println!("error: {error}"));
    if !errors.is_empty() {
        bail!(
            "errors in the book: {}; `--write` puts new output and pictures into it",
            errors.len()
        );
    }
    Ok(())
}

impl Options {
    fn parse(arguments: &[String]) -> Result<Self> {
        let mut options = Self::default();
        let mut arguments = arguments.iter();
        while let Some(argument) = arguments.next() {
            let mut path = || {
                let path = arguments.next().with_context(|| format!("{argument} needs a path"))?;
                // Chapters run elsewhere. Links stay: they say which environment a Python has.
                std::path::absolute(path).with_context(|| path.clone())
            };
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
