//! `view`: opens files or a school in a window, or films files without one.

use std::path::PathBuf;

use clap::Args;

use crate::flock::model::ModelArgs;
use crate::flock::school_args::SchoolArgs;
use crate::options::args::ReadArgs;
use crate::options::parse;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;

/// Open meshes or a school in a window
///
/// Meshes of all formats, .mlod, .mlq and .mlz; more can be dropped on the window. With --flock, a
/// school instead, whose levels of detail, camera and obstacles can be changed while it swims. Press ?
/// for the keys.
#[derive(Args)]
#[command(mut_group("ModelArgs", |group| group.requires("flock")))]
#[command(mut_group("SchoolArgs", |group| group.requires("flock")))]
#[cfg_attr(not(feature = "view"), allow(dead_code))]
pub struct View {
    /// Files to open
    #[arg(value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Close the window S seconds after the first picture
    #[arg(long, value_name = "S", value_parser = parse::length, allow_negative_numbers = true)]
    pub seconds: Option<f64>,
    /// Write a picture once everything is loaded
    ///
    /// Of a school, after 30 frames. Then the window closes unless --seconds is given.
    #[arg(long, value_name = "OUT.png")]
    pub screenshot: Option<PathBuf>,
    /// Draw the film that a script describes, without a window
    ///
    /// Writes OUT/frame_0000.png and so on, and the figures of the frames in OUT/frames.jsonl.
    #[arg(long, value_name = "FILE", requires = "out", conflicts_with_all = ["seconds", "screenshot"])]
    pub script: Option<PathBuf>,
    /// Folder for the film of a script; created if missing
    #[arg(long, value_name = "OUT", requires = "script")]
    pub out: Option<PathBuf>,
    /// Show a school of a model instead of files
    #[arg(long, conflicts_with_all = ["files", "script"])]
    pub flock: bool,
    #[command(flatten)]
    pub reading: ReadArgs,
    #[command(flatten, next_help_heading = "With --flock")]
    pub school: SchoolArgs,
    #[command(flatten)]
    pub model: ModelArgs,
}

impl View {
    #[cfg(feature = "view")]
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        if self.flock {
            return crate::view::school::run(self, session);
        }
        match (&self.script, &self.out) {
            (Some(script), Some(out)) => {
                crate::view::film::run(&self.files, &self.reading, script, out, session)
            }
            _ => crate::view::window::run(self, session),
        }
    }

    #[cfg(not(feature = "view"))]
    pub fn run(self, _: &Session) -> Result<Answer, Failure> {
        Err(Failure::new(crate::view::MISSING))
    }
}
