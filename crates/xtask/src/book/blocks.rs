//! Fenced blocks of a chapter, by what is to be done with them.

use std::ops::Range;

/// Block to act on. Lines are counted from 0, and ranges leave out the fences.
#[derive(Debug, PartialEq)]
pub enum ChapterBlock {
    /// ` ```console `: commands with what they print.
    Console(Vec<Step>),
    /// ` ```python `: the lines of a program, and of the ` ```text ` block below that shows what
    /// they print.
    Python { program: Range<usize>, printed: Option<Range<usize>> },
    /// Any block below a paragraph that ends in "`NAME`:": contents of a file.
    File { name: String, contents: Range<usize> },
}

/// Command of a console, and the lines that it prints.
#[derive(Debug, PartialEq)]
pub struct Step {
    /// Command without its prompt; lines that end in a backslash go on in the next.
    pub command: String,
    pub line: usize,
    pub printed: Range<usize>,
}

/// Start of a line with a command.
const PROMPT: &str = "$ ";
const FENCE: &str = "```";

/// Fenced block of any language.
struct Fenced<'t> {
    language: &'t str,
    contents: Range<usize>,
}

/// Lists the blocks of a chapter that are run or written; others are only to be read.
pub fn blocks(lines: &[&str]) -> Vec<ChapterBlock> {
    let fenced = fenced(lines);
    let mut blocks = Vec::new();
    for (i, Fenced { language, contents }) in fenced.iter().enumerate() {
        if let Some(name) = file_name(lines, contents.start - 1) {
            blocks.push(ChapterBlock::File { name: name.to_owned(), contents: contents.clone() });
        } else if *language == "console" {
            blocks.push(ChapterBlock::Console(steps(lines, contents)));
        } else if *language == "python" {
            let below = fenced.get(i + 1).filter(|below| {
                let between = &lines[contents.end + 1..below.contents.start - 1];
                below.language == "text" && between.iter().all(|line| line.is_empty())
            });
            let printed = below.map(|below| below.contents.clone());
            blocks.push(ChapterBlock::Python { program: contents.clone(), printed });
        }
    }
    blocks
}

/// Lists all fenced blocks; one that is never closed ends with the chapter.
fn fenced<'t>(lines: &[&'t str]) -> Vec<Fenced<'t>> {
    let mut blocks = Vec::new();
    let mut at = 0;
    while at < lines.len() {
        if let Some(language) = lines[at].strip_prefix(FENCE) {
            let rest = &lines[at + 1..];
            let length = rest.iter().position(|line| line.starts_with(FENCE));
            let end = at + 1 + length.unwrap_or(rest.len());
            blocks.push(Fenced { language, contents: at + 1..end });
            at = end;
        }
        at += 1;
    }
    blocks
}

/// Returns the name in "`NAME`:" at the end of the paragraph above a fence.
fn file_name<'t>(lines: &[&'t str], fence: usize) -> Option<&'t str> {
    let above = lines[..fence].iter().rev().find(|line| !line.is_empty())?;
    let name = above.strip_suffix("`:")?.rsplit_once('`')?.1;
    name.contains('.').then_some(name)
}

fn steps(lines: &[&str], contents: &Range<usize>) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    let mut at = contents.start;
    while at < contents.end {
        if let Some(first) = lines[at].strip_prefix(PROMPT) {
            let line = at;
            let mut command = first.to_owned();
            while command.ends_with('\\') && at + 1 < contents.end {
                at += 1;
                command = format!("{command}\n{}", lines[at]);
            }
            steps.push(Step { command, line, printed: at + 1..at + 1 });
        } else if let Some(step) = steps.last_mut() {
            step.printed.end = at + 1;
        }
        at += 1;
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blocks_of(text: &str) -> Vec<ChapterBlock> {
        blocks(&text.lines().collect::<Vec<_>>())
    }

    fn step(command: &str, line: usize, printed: Range<usize>) -> Step {
        Step { command: command.into(), line, printed }
    }

    #[test]
    fn a_console_has_commands_and_what_they_print() {
        let blocks = blocks_of("Do:\n```console\n$ a\n1\n2\n$ b \\\n  c\n$ d\n3\n```\nDone.");
        let steps = [step("a", 2, 3..5), step("b \\\n  c", 5, 7..7), step("d", 7, 8..9)];
        assert_eq!(blocks, [ChapterBlock::Console(steps.into())]);
    }

    #[test]
    fn a_named_block_is_a_file_whatever_its_language() {
        let blocks = blocks_of("Write this to `a.toml`:\n\n```toml\nverb = 1\n```");
        assert_eq!(blocks, [ChapterBlock::File { name: "a.toml".into(), contents: 3..4 }]);
        assert_eq!(blocks_of("By `--error`:\n```text\n1\n```"), []);
    }

    #[test]
    fn python_prints_what_the_text_right_below_shows() {
        let blocks = blocks_of("```python\np\n```\n\n```text\n1\n```\nx\n```text\n2\n```");
        assert_eq!(blocks, [ChapterBlock::Python { program: 1..2, printed: Some(5..6) }]);
        let apart = blocks_of("```python\np\n```\nx\n```text\n2\n```");
        assert_eq!(apart, [ChapterBlock::Python { program: 1..2, printed: None }]);
    }

    #[test]
    fn other_blocks_are_only_to_be_read() {
        assert_eq!(blocks_of("```rust\nfn f() {}\n```\n```text\n$ no\n```"), []);
    }
}
