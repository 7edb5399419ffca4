//! Runs one chapter in a fresh folder, as a reader would who copies every block.

use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result};

use super::blocks::{ChapterBlock, Step, blocks};
use super::output::{first_difference, matches, rewritten};
use super::pictures::{FOLDER, Picture, made};
use crate::project::Text;

/// Programs that chapters call.
pub struct Programs<'p> {
    /// The command `meshlod`.
    pub meshlod: &'p Path,
    /// Python that has the package `meshlod`.
    pub python: Option<&'p Path>,
}

/// Results of the run of a chapter.
#[derive(Default)]
pub struct Findings {
    /// Commands that failed.
    pub errors: Vec<String>,
    pub differences: Vec<Difference>,
    /// Blocks that were skipped.
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

/// Run of a chapter in its folder.
struct Session<'c> {
    chapter: &'c Text,
    lines: Vec<&'c str>,
    programs: &'c Programs<'c>,
    folder: &'c Path,
    findings: Findings,
}

/// Block of Python: the lines of the program, and of what the chapter shows it to print.
type PythonBlock = (Range<usize>, Option<Range<usize>>);

/// Line that separates what the blocks of a program in Python print.
const SEPARATOR: &str = "-- end of a block --";

/// Runs all blocks: files and consoles in turn, and then Python as one program, if there is a
/// Python.
pub fn run(chapter: &Text, programs: &Programs<'_>) -> Result<Findings> {
    let folder = tempfile::tempdir()?;
    std::fs::create_dir(folder.path().join(FOLDER))?;
    let mut session = Session {
        chapter,
        lines: chapter.text.lines().collect(),
        programs,
        folder: folder.path(),
        findings: Findings::default(),
    };
    let mut python = Vec::new();
    for block in blocks(&session.lines) {
        match block {
            ChapterBlock::File { name, contents } => {
                std::fs::write(folder.path().join(name), session.text(contents))?;
            }
            ChapterBlock::Console(steps) => {
                steps.into_iter().try_for_each(|step| session.step(step))?;
            }
            ChapterBlock::Python { program, printed } => python.push((program, printed)),
        }
    }
    session.python(&python)?;
    session.findings.pictures = made(&folder.path().join(FOLDER))?;
    Ok(session.findings)
}

impl Session<'_> {
    fn step(&mut self, step: Step) -> Result<()> {
        let programs = self.programs.meshlod.parent().context("a program is in a folder")?;
        let path = std::env::var_os("PATH").unwrap_or_default();
        let paths = std::iter::once(programs.to_owned()).chain(std::env::split_paths(&path));
        let mut shell = Command::new("bash");
        shell.args(["-o", "pipefail", "-c", &format!("exec 2>&1\n{}", step.command)]);
        shell.env("PATH", std::env::join_paths(paths)?).env("LC_ALL", "C");
        let printed = self.output_of(shell, step.line)?;
        self.compare(step.printed, &printed);
        Ok(())
    }

    /// Runs the blocks as one program, so that a name of one is known in the next.
    fn python(&mut self, blocks: &[PythonBlock]) -> Result<()> {
        let Some((first, _)) = blocks.first() else { return Ok(()) };
        let Some(python) = self.programs.python else {
            let (path, skipped) = (&self.chapter.path, blocks.len());
            let note = format!("{path}: {skipped} blocks of Python skipped: no `--python PATH`");
            self.findings.notes.push(note);
            return Ok(());
        };
        let separate = format!("print({SEPARATOR:?}, flush=True)\n");
        let program = blocks.iter().map(|(block, _)| self.text(block.clone()) + &separate);
        let program: String = program.collect();
        let file = self.folder.join("chapter.py");
        std::fs::write(&file, program)?;
        let mut shell = Command::new("bash");
        shell.args(["-c", "exec \"$0\" -u \"$1\" 2>&1"]).args([python, &file]);
        let printed = self.output_of(shell, first.start)?;
        let separator = format!("{SEPARATOR}\n");
        for ((block, shown), printed) in blocks.iter().zip(printed.split(&separator)) {
            let below = block.end + 1..block.end + 1;
            let before = self.findings.differences.len();
            self.compare(shown.clone().unwrap_or(below), printed);
            let differences = &mut self.findings.differences[before..];
            for difference in differences.iter_mut().filter(|_| shown.is_none()) {
                difference.printed.insert(0, "```text".into());
                difference.printed.push("```".into());
            }
        }
        Ok(())
    }

    /// Runs a command of the block or line at `line` in the folder and returns what it prints.
    fn output_of(&mut self, mut command: Command, line: usize) -> Result<String> {
        let output =
            command.current_dir(self.folder).stdin(Stdio::null()).output().context("bash")?;
        let printed = String::from_utf8_lossy(&output.stdout).into_owned();
        if !output.status.success() {
            let place = self.place(line);
            let reason = printed.lines().last().unwrap_or("no output");
            self.findings.errors.push(format!("{place}: the command failed: {reason}"));
        }
        Ok(printed)
    }

    /// Notes the difference between what was printed and the lines that show it.
    fn compare(&mut self, lines: Range<usize>, printed: &str) {
        self.findings.runs += 1;
        let printed: Vec<&str> = printed.lines().map(str::trim_end).collect();
        let shown = &self.lines[lines.clone()];
        if matches(shown, &printed) {
            return;
        }
        let difference = Difference {
            place: self.place(lines.start),
            first: first_difference(shown, &printed).map(str::to_owned),
            printed: rewritten(shown, &printed),
            lines,
        };
        self.findings.differences.push(difference);
    }

    fn text(&self, lines: Range<usize>) -> String {
        self.lines[lines].iter().flat_map(|line| [*line, "\n"]).collect()
    }

    fn place(&self, line: usize) -> String {
        format!("{}:{}", self.chapter.path, line + 1)
    }
}

impl Findings {
    /// Returns the chapter with what was printed in place of what differs.
    pub fn rewritten(&self, chapter: &str) -> String {
        let mut lines: Vec<String> = chapter.lines().map(str::to_owned).collect();
        let mut differences: Vec<_> = self.differences.iter().collect();
        differences.sort_by_key(|difference| difference.lines.start);
        for difference in differences.into_iter().rev() {
            lines.splice(difference.lines.clone(), difference.printed.iter().cloned());
        }
        lines.iter().flat_map(|line| [line, "\n"]).collect()
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place, first: [shown, printed], .. } = self;
        write!(f, "{place}: the book shows `{shown}`, but printed is `{printed}`")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn findings(text: &str) -> Findings {
        let chapter = Text { path: "a.md".into(), text: text.into() };
        run(&chapter, &Programs { meshlod: Path::new("bin/meshlod"), python: None }).unwrap()
    }

    #[test]
    fn files_and_commands_of_a_chapter_follow_each_other_in_one_folder() {
        let found = findings(
            "`a.txt`:\n```text\nhello\n```\n```console\n$ cp a.txt pictures/b\n$ cat pictures/b\n\
             hello\n```\n",
        );
        assert!(found.errors.is_empty() && found.differences.is_empty());
        assert_eq!((found.runs, &*found.pictures[0].bytes), (2, &b"hello\n"[..]));
    }

    #[test]
    fn what_differs_is_named_and_rewritten() {
        let text = "```console\n$ echo a; echo b >&2\na\nc\n$ echo d\n```\nend\n";
        let found = findings(text);
        let named: Vec<_> = found.differences.iter().map(ToString::to_string).collect();
        assert_eq!(
            named,
            [
                "a.md:3: the book shows `c`, but printed is `b`",
                "a.md:6: the book shows ``, but printed is `d`",
            ]
        );
        let rewritten = "```console\n$ echo a; echo b >&2\na\nb\n$ echo d\nd\n```\nend\n";
        assert_eq!(found.rewritten(text), rewritten);
    }

    #[test]
    fn a_command_that_fails_is_an_error_and_python_without_a_python_a_note() {
        let found =
            findings("```console\n$ echo no; exit 3\nno\n$ false | cat\n```\n```python\nx\n```\n");
        let failed = ["a.md:2: the command failed: no", "a.md:4: the command failed: no output"];
        assert_eq!(found.errors, failed);
        assert_eq!(found.notes.len(), 1);
    }
}
