//! Runs one chapter in a fresh folder, as a reader would who copies every block.

use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result};

use super::blocks::{Block, Step, blocks};
use super::output;
use super::pictures::{self, Picture};
use super::{PICTURES, Text};

/// Programs that chapters call.
pub struct Tools<'t> {
    /// The command `meshlod`.
    pub program: &'t Path,
    /// Python that has the package `meshlod`.
    pub python: Option<&'t Path>,
}

/// Findings of the run of a chapter.
#[derive(Default)]
pub struct Session {
    pub errors: Vec<String>,
    pub differences: Vec<Difference>,
    pub notes: Vec<String>,
    pub pictures: Vec<Picture>,
    /// Number of commands, and of blocks in Python.
    pub runs: usize,
}

/// Lines of the book that are not what was printed.
pub struct Difference {
    place: String,
    lines: Range<usize>,
    first: [String; 2],
    printed: Vec<String>,
}

/// Line that separates what the blocks of a program in Python print.
const SEPARATOR: &str = "-- end of a block --";

impl Session {
    /// Runs all blocks: files and consoles in turn, and then Python as one program, if there is a
    /// Python.
    pub fn run(chapter: &Text, tools: &Tools<'_>) -> Result<Self> {
        let folder = tempfile::tempdir()?;
        std::fs::create_dir(folder.path().join(PICTURES))?;
        let lines: Vec<&str> = chapter.text.lines().collect();
        let mut session = Self::default();
        let mut python = Vec::new();
        for block in blocks(&lines) {
            match block {
                Block::File { name, contents } => {
                    let text: String = lines[contents].iter().flat_map(|l| [*l, "\n"]).collect();
                    std::fs::write(folder.path().join(name), text)?;
                }
                Block::Console(steps) => {
                    for step in steps {
                        session.step(chapter, &lines, step, tools, folder.path())?;
                    }
                }
                Block::Python { program, printed } => python.push((program, printed)),
            }
        }
        match tools.python {
            Some(python_path) => {
                session.python(chapter, &lines, &python, python_path, folder.path())?;
            }
            None if python.is_empty() => {}
            None => session.notes.push(format!(
                "{}: {} blocks of Python skipped; `--python PATH` runs them",
                chapter.path,
                python.len()
            )),
        }
        session.pictures = pictures::made(&folder.path().join(PICTURES))?;
        Ok(session)
    }

    /// Returns the chapter with what was printed in place of what differs.
    pub fn rewritten(&self, text: &str) -> String {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let mut differences: Vec<_> = self.differences.iter().collect();
        differences.sort_by_key(|difference| difference.lines.start);
        for difference in differences.into_iter().rev() {
            lines.splice(difference.lines.clone(), difference.printed.iter().cloned());
        }
        lines.iter().flat_map(|line| [line, "\n"]).collect()
    }

    fn step(
        &mut self,
        chapter: &Text,
        lines: &[&str],
        step: Step,
        tools: &Tools<'_>,
        folder: &Path,
    ) -> Result<()> {
        let programs = tools.program.parent().context("a program is in a folder")?;
        let path = std::env::var_os("PATH").unwrap_or_default();
        let paths = std::iter::once(programs.to_owned()).chain(std::env::split_paths(&path));
        let output = Command::new("sh")
            .args(["-c", &format!("exec 2>&1\n{}", step.command)])
            .env("PATH", std::env::join_paths(paths)?)
            .env("LC_ALL", "C")
            .current_dir(folder)
            .stdin(Stdio::null())
            .output()
            .context("sh")?;
        let printed = String::from_utf8_lossy(&output.stdout);
        if !output.status.success() {
            let place = format!("{}:{}", chapter.path, step.line + 1);
            let reason = printed.lines().last().unwrap_or("no output");
            self.errors.push(format!("{place}: the command failed: {reason}"));
        }
        self.compare(chapter, lines, step.printed, &printed);
        Ok(())
    }

    /// Runs the blocks of a chapter as one program, so that a name of one is known in the next.
    fn python(
        &mut self,
        chapter: &Text,
        lines: &[&str],
        blocks: &[(Range<usize>, Option<Range<usize>>)],
        python: &Path,
        folder: &Path,
    ) -> Result<()> {
        let mut program = String::new();
        for (block, _) in blocks {
            program.extend(lines[block.clone()].iter().flat_map(|line| [*line, "\n"]));
            program.push_str(&format!("print({SEPARATOR:?}, flush=True)\n"));
        }
        let file = folder.join("chapter.py");
        std::fs::write(&file, program)?;
        let output = Command::new("sh")
            .args(["-c", "exec \"$0\" -u \"$1\" 2>&1"])
            .args([python, &file])
            .current_dir(folder)
            .stdin(Stdio::null())
            .output()
            .context("sh")?;
        let printed = String::from_utf8_lossy(&output.stdout);
        if !output.status.success() {
            let reason = printed.lines().last().unwrap_or("no output");
            self.errors.push(format!("{}: Python failed: {reason}", chapter.path));
        }
        let ends = format!("{SEPARATOR}\n");
        for ((block, shown), printed) in blocks.iter().zip(printed.split(&ends)) {
            let below = block.end + 1..block.end + 1;
            let before = self.differences.len();
            self.compare(chapter, lines, shown.clone().unwrap_or(below), printed);
            for difference in self.differences[before..].iter_mut().filter(|_| shown.is_none()) {
                difference.printed.insert(0, "```text".into());
                difference.printed.push("```".into());
            }
        }
        Ok(())
    }

    fn compare(&mut self, chapter: &Text, lines: &[&str], shown: Range<usize>, printed: &str) {
        self.runs += 1;
        let printed: Vec<&str> = printed.lines().map(str::trim_end).collect();
        let expected = &lines[shown.clone()];
        if output::matches(expected, &printed) {
            return;
        }
        self.differences.push(Difference {
            place: format!("{}:{}", chapter.path, shown.start + 1),
            first: output::first_difference(expected, &printed).map(str::to_owned),
            printed: output::rewritten(expected, &printed),
            lines: shown,
        });
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place, first: [shown, printed], .. } = self;
        write!(f, "{place}: the book shows `{shown}`, but printed is `{printed}`")
    }
}
