//! `cargo xtask instructions`: counts the instructions of the commands in a table of the notes, and
//! compares them with the table.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::book::program;
use crate::project::Project;

/// The note that has the table, and the commands that make what it reads.
const NOTE: &str = "docs/notes/instructions.md";

/// Start of a line with a command that makes a sample.
const SAMPLE: &str = "    meshlod ";

/// Fraction of its figure by which a command may differ.
const TOLERANCE: f64 = 0.01;

/// Row of the table: the arguments of `meshlod`, millions of instructions, and why they have grown.
#[derive(Debug, PartialEq)]
struct Row<'t> {
    arguments: &'t str,
    millions: f64,
    why: &'t str,
}

/// Counts anew what every row takes, and prints it. With `--write` it goes into the note; otherwise
/// a row that differs is an error.
pub fn run(project: &Project, arguments: &[String]) -> Result<()> {
    let mut write = false;
    let mut program = None;
    let mut arguments = arguments.iter();
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--write" => write = true,
            "--program" => program = Some(arguments.next().context("--program needs a path")?),
            other => bail!("unknown option {other}"),
        }
    }
    let program = match program {
        Some(path) => std::path::absolute(path)?,
        None => program::build(project)?,
    };
    let mut text = project.read(NOTE)?.text;
    let folder = tempfile::tempdir()?;
    for line in text.lines().filter_map(|line| line.strip_prefix(SAMPLE)) {
        let status = meshlod(Command::new(&program), line, folder.path()).status()?;
        ensure!(status.success(), "meshlod {line}: {status}");
    }
    let mut differing = 0;
    for line in text.clone().lines() {
        let Some(row) = Row::of(line) else { continue };
        let counted = count(&program, row.arguments, folder.path())?;
        let change = counted / row.millions - 1.0;
        println!("{counted:10.1} {:+6.1} % {}", 100.0 * change, row.arguments);
        if write {
            text = text.replace(line, &Row { millions: counted, ..row }.line());
        } else if change.is_nan() || change.abs() > TOLERANCE {
            differing += 1;
        }
    }
    if write {
        std::fs::write(project.root().join(NOTE), text)?;
    }
    ensure!(
        differing == 0,
        "commands off their figures in {NOTE}: {differing}; `--write` puts new ones in"
    );
    Ok(())
}

impl<'t> Row<'t> {
    fn of(line: &'t str) -> Option<Self> {
        let (command, rest) = line.strip_prefix("| `meshlod ")?.split_once("` |")?;
        let (millions, why) = rest.split_once('|')?;
        let why = why.trim().trim_end_matches('|').trim();
        Some(Self { arguments: command, millions: millions.trim().parse().ok()?, why })
    }

    fn line(&self) -> String {
        let Self { arguments, millions, why } = self;
        let why = if why.is_empty() { String::new() } else { format!("{why} ") };
        format!("| `meshlod {arguments}` | {millions:.1} | {why}|")
    }
}

/// Returns the millions of instructions that one thread takes for a command.
fn count(program: &PathBuf, arguments: &str, folder: &Path) -> Result<f64> {
    let mut counter = Command::new("valgrind");
    counter.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]).arg(program);
    let output = meshlod(counter, arguments, folder).output().context("valgrind")?;
    let printed = String::from_utf8_lossy(&output.stderr);
    let last = printed.lines().last().unwrap_or_default();
    ensure!(output.status.success(), "meshlod {arguments}: {}; {last}", output.status);
    collected(&printed).context("callgrind counted nothing")
}

fn meshlod(mut command: Command, arguments: &str, folder: &Path) -> Command {
    command.args(arguments.split_whitespace()).args(["-q", "-j", "1"]).current_dir(folder);
    command
}

/// Returns the millions of instructions in what callgrind prints.
fn collected(printed: &str) -> Option<f64> {
    let (_, after) = printed.split_once("Collected : ")?;
    Some(after.lines().next()?.trim().parse::<f64>().ok()? / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_read_and_written() {
        let line = "| `meshlod simplify a.ply o.ply` | 12.5 | reads twice |";
        let row = Row::of(line).unwrap();
        let why = "reads twice";
        assert_eq!(row, Row { arguments: "simplify a.ply o.ply", millions: 12.5, why });
        assert_eq!(row.line(), line);
        let plain = "| `meshlod strip a.ply` | 3.0 | |";
        assert_eq!(Row::of(plain).unwrap().line(), plain);
        assert_eq!(Row::of("| command | millions | why |"), None);
    }

    #[test]
    fn callgrinds_sum_is_found() {
        let printed = "==1== Events    : Ir\n==1== Collected : 721862633\n==1==\n";
        assert_eq!(collected(printed), Some(721.862633));
        assert_eq!(collected("==1== "), None);
    }
}
