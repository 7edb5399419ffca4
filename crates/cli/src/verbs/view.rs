//! `view`: shows models in a window, or films them without one.

use std::path::PathBuf;

use clap::Args;

use crate::answer::Answer;
use crate::args::ReadArgs;
use crate::failure::Failure;
use crate::session::Session;

/// View models on the GPU, live
///
/// Opens any mesh, levels of detail (.mlod) and compressed meshes (.mlq, .mlz). With --script it draws
/// the pictures of a film instead, without a window.
#[derive(Args)]
pub struct View {
    /// Files to view
    #[arg(value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Draw the film that a script describes, as OUT/frame_0000.png and so on, and write the figures of
    /// its frames to OUT/frames.jsonl
    #[arg(long, value_name = "FILE", requires = "out")]
    pub script: Option<PathBuf>,
    /// Folder for the pictures of a script; created if missing
    #[arg(long, value_name = "DIR", requires = "script")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub reading: ReadArgs,
}

impl View {
    #[cfg(not(feature = "view"))]
    pub fn run(self, _: &Session) -> Result<Answer, Failure> {
        Err(Failure::new(crate::view::MISSING))
    }

    #[cfg(feature = "view")]
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        match (&self.script, &self.out) {
            (Some(script), Some(out)) => {
                crate::view::film::run(&self.files, &self.reading, script, out, session)
            }
            _ => Err(Failure::new("no window yet")),
        }
    }
}
