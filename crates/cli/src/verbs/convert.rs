//! `convert`: writes a mesh in another format.

use std::path::{Path, PathBuf};

use clap::Args;
use meshlod::jobs::ConvertReport;
use serde::Serialize;

use crate::options::args::{ReadArgs, WriteArgs};
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::scene_files;
use crate::text::numbers::{count, faces};

/// Write a mesh in another format, or the same one; what the format cannot hold is named
#[derive(Args)]
pub struct Convert {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File to write, or -
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    reading: ReadArgs,
    #[command(flatten)]
    writing: WriteArgs,
}

/// Figures of a converted file for programs.
#[derive(Serialize)]
struct ConvertFigures {
    file: String,
    #[serde(flatten)]
    report: ConvertReport,
}

impl Convert {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        files::check_output(&self.output, session)?;
        let scene = files::read(&self.input, &self.reading, session)?;
        let report = scene_files::write_counted(&self.output, &scene, &self.writing, session)?;
        let text = text(&self.output, &report);
        let figures = ConvertFigures { file: files::name(&self.output), report };
        Ok(Answer { file_on_stdout: files::is_pipe(&self.output), ..Answer::new(figures, text) })
    }
}

fn text(output: &Path, report: &ConvertReport) -> String {
    let ConvertReport { meshes, vertices, faces: of_meshes, shown_faces, .. } = *report;
    let shown = match shown_faces == of_meshes {
        true => String::new(),
        false => format!(", shown as {}", count(shown_faces)),
    };
    format!(
        "{}: {meshes} mesh{}, {} vertices, {}{shown}\n",
        files::name(output),
        if meshes == 1 { "" } else { "es" },
        count(vertices),
        faces(of_meshes),
    )
}
