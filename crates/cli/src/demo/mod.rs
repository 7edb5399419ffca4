//! `demo`: simplifies samples and writes the levels and one page with pictures.
//!
//! [`samples`] lists the meshes, and [`sample_report`] simplifies and measures them; [`pipeline`]
//! takes the first through all steps from a broken mesh to a compressed one. [`page`] and
//! [`summary`] show the same figures on a page and on the terminal.

mod next_steps;
mod page;
mod pipeline;
mod sample_report;
mod samples;
mod section;
mod summary;
mod title_picture;

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use meshlod::Method;
use meshlod::io::write_file;

use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use pipeline::{Pipeline, RunLine};
use sample_report::SampleReport;

/// Take sample meshes through all steps, and write a page with pictures
#[derive(Args)]
pub struct Demo {
    /// Folder to write to; created if missing
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Results of a demo run.
struct DemoResult {
    reports: Vec<SampleReport>,
    pipeline: Pipeline,
    /// First sample at several levels, side by side.
    title_picture: title_picture::TitlePicture,
    page: PathBuf,
    page_bytes: usize,
    seconds: f64,
}

impl DemoResult {
    fn folder(&self) -> &Path {
        self.page.parent().unwrap_or(Path::new(""))
    }
}

impl Demo {
    /// Makes the page; `run_line` runs the commands on it.
    pub fn run(self, run_line: RunLine, session: &Session) -> Result<Answer, Failure> {
        let start = Instant::now();
        files::make_folder(&self.folder)?;
        let make = |sample| SampleReport::make(sample, &self.folder, session);
        let reports: Vec<SampleReport> = samples::ALL.iter().map(make).collect::<Result<_, _>>()?;
        let pipeline = Pipeline::make(&reports[0], &self.folder, run_line, session)?;
        session.progress.stage("drawing the picture and writing the page");
        let title_picture = title_picture::TitlePicture::make(&reports[0], &self.folder)?;
        let page = self.folder.join("index.html");
        let html = page::page(&reports, &pipeline, &title_picture).into_string();
        write_file(&page, html.as_bytes())?;
        let seconds = start.elapsed().as_secs_f64();
        let result =
            DemoResult { reports, pipeline, title_picture, page, page_bytes: html.len(), seconds };
        Ok(Answer::new(summary::json(&result), summary::text(&result)))
    }
}

/// Returns the method whose levels are drawn, the default of `simplify`.
fn main_method() -> Method {
    Method::default()
}

/// Methods compared: edges by quadrics, edges by volume, faces. More would make the page slow.
const METHODS: [Method; 3] = [Method::Qem, Method::LindstromTurk, Method::LeeJang];
