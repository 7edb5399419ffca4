//! The whole way of one mesh, step by step: checked, repaired, simplified, at all levels in one file,
//! as strips, and compressed.
//!
//! The [`steps`] are command lines. They run as they are shown, in the folder of the page, so that
//! readers can repeat them; each gives a [figure](steps::Figure) and a [picture](pictures).

mod broken;
mod pictures;
pub mod section;
mod steps;

use std::ffi::OsString;
use std::path::Path;

use serde_json::{Value, json};

use crate::demo::sample_report::SampleReport;
use crate::page::inline_picture::InlinePicture;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use pictures::StepPainter;
use steps::{Figure, STEPS, Step};

/// All steps that have been run, with their pictures and figures.
pub struct Pipeline {
    done: Vec<StepDone>,
}

/// Runs a command of this program, given its arguments, the first of which is its name.
pub type RunLine = fn(Vec<OsString>, &Session) -> Result<Answer, Failure>;

/// A step that has been run.
struct StepDone {
    step: &'static Step,
    figure: Figure,
    picture: InlinePicture,
}

impl Pipeline {
    /// Runs all steps on the file of a sample in the folder of the page.
    pub fn make(
        report: &SampleReport,
        folder: &Path,
        run_line: RunLine,
        session: &Session,
    ) -> Result<Self, Failure> {
        broken::write_file(&report.subject.mesh, folder)?;
        let painter = StepPainter::new(&report.subject, folder, session);
        let run = |step: &'static Step| {
            let commands = step.commands.iter().map(|words| {
                let line = line(words, folder);
                // The mesh is broken on purpose: that `check` finds errors is no failure.
                Ok::<_, Failure>(run_line(line, session)?.json)
            });
            let answers: Vec<Value> = commands.collect::<Result<_, _>>()?;
            session.progress.stage(&format!("drawing: {}", step.name));
            let figure = (step.figure)(&answers);
            Ok(StepDone { step, picture: painter.picture(step, &figure)?, figure })
        };
        Ok(Self { done: STEPS.iter().map(run).collect::<Result<_, Failure>>()? })
    }

    /// Returns the commands, figures and files of all steps as JSON.
    pub fn json(&self, folder: &Path) -> Value {
        let step = |done: &StepDone| {
            let files = done.step.files.iter().map(|file| files::name(&folder.join(file)));
            json!({
                "step": done.step.name,
                "commands": done.step.commands.iter().map(|words| shown(words)).collect::<Vec<_>>(),
                "figure": done.figure.exact,
                "figure_text": done.figure.text(),
                "files": files.collect::<Vec<_>>(),
            })
        };
        self.done.iter().map(step).collect()
    }

    /// Iterates over the files that the steps have written, with the names of the steps.
    pub fn files(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        self.done.iter().flat_map(|done| done.step.files.iter().map(|&file| (file, done.step.name)))
    }

    /// Formats a line about each step.
    pub fn text(&self) -> String {
        let line = |done: &StepDone| format!("  {}: {}\n", done.step.name, done.figure.text());
        self.done.iter().map(line).collect()
    }
}

/// Returns the arguments of a command, with its files in a folder.
fn line(words: &[&str], folder: &Path) -> Vec<OsString> {
    // So that the name of a folder is not taken for an option.
    let folder = Path::new(".").join(folder);
    let placed = words.iter().map(|word| match steps::is_file(word) {
        true => folder.join(word).into_os_string(),
        false => OsString::from(word),
    });
    std::iter::once(OsString::from("meshlod")).chain(placed).collect()
}

/// Formats a command as readers type it in the folder of the page.
fn shown(words: &[&str]) -> String {
    let word = |word: &&str| match word.contains(' ') {
        true => format!("\"{word}\""),
        false => (*word).to_owned(),
    };
    format!("meshlod {}", words.iter().map(word).collect::<Vec<_>>().join(" "))
}
