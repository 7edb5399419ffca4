//! Journal of a batch: one line for each file that it has made, beside the outputs.
//!
//! A line is written once its output is complete and in its place. It holds the recipe and the
//! states of input and output; an output counts as there while all of these are as they were. A line
//! that is cut off, as by a full disk, counts for nothing.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::json;

use crate::batch::file::FileState;
use crate::batch::plan::FileJob;
use crate::batch::report::{FileReport, Status};
use crate::session::failure::Failure;

/// Name of the journal in an output folder.
const NAME: &str = ".meshlod-batch.jsonl";

/// Journal of an output folder.
pub struct Journal {
    path: PathBuf,
    /// Recipe and report by which each output was made last.
    made: BTreeMap<String, (String, FileReport)>,
    /// The file, once a line is added.
    file: Option<File>,
}

/// A line of the journal.
#[derive(Deserialize)]
struct Line {
    recipe: String,
    report: FileReport,
}

impl Journal {
    /// Opens a journal for appending, without reading it.
    pub fn new(folder: &Path) -> Self {
        Self { path: folder.join(NAME), made: BTreeMap::new(), file: None }
    }

    /// Reads the journal of a folder, if there is one.
    ///
    /// # Errors
    /// Of the system.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let mut journal = Self::new(folder);
        let bytes = match fs::read(&journal.path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(journal),
            read => read.map_err(|error| Failure::at(&journal.path, error))?,
        };
        for line in bytes.split(|&byte| byte == b'\n') {
            if let Ok(Line { recipe, report }) = serde_json::from_slice(line) {
                journal.made.insert(report.output.clone(), (recipe, report));
            }
        }
        Ok(journal)
    }

    /// Returns the report of an output that is there and as this recipe would make it.
    pub fn made(&self, job: &FileJob, recipe: &str) -> Option<FileReport> {
        let planned = FileReport::planned(job);
        let (made_by, report) = self.made.get(&planned.output)?;
        let states = [FileState::of(&job.input)?, FileState::of(&job.output)?];
        let same = made_by == recipe && report.input == planned.input && report.is_of(states);
        same.then(|| FileReport { status: Status::Skipped, ..report.clone() })
    }

    /// Adds a line for a file that was made.
    ///
    /// # Errors
    /// Of the system.
    pub fn add(&mut self, report: &FileReport, recipe: &str) -> Result<(), Failure> {
        if report.status != Status::Done {
            return Ok(());
        }
        let line = json!({ "recipe": recipe, "report": report });
        let mut append = || -> io::Result<()> {
            let file = match &mut self.file {
                Some(file) => file,
                file => file.insert(open(&self.path)?),
            };
            // In one piece, so that lines of two processes do not mix.
            file.write_all(format!("{line}\n").as_bytes())
        };
        append().map_err(|error| Failure::at(&self.path, error))
    }
}

/// Opens a journal to add lines, after the end of a line that was cut off.
fn open(path: &Path) -> io::Result<File> {
    let mut file = OpenOptions::new().read(true).append(true).create(true).open(path)?;
    if !ends_with_line(&mut file)? {
        file.write_all(b"\n")?;
    }
    Ok(file)
}

/// Reports whether the last line of a file is whole, or there is none.
fn ends_with_line(file: &mut File) -> io::Result<bool> {
    if file.seek(SeekFrom::End(0))? == 0 {
        return Ok(true);
    }
    let mut last = [0];
    file.seek(SeekFrom::End(-1))?;
    file.read_exact(&mut last)?;
    Ok(last == *b"\n")
}
