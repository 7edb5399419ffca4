//! `view`: opens files in a window.

use std::path::PathBuf;

use clap::Args;

use crate::answer::Answer;
use crate::args::ReadArgs;
use crate::failure::Failure;
use crate::parse;
use crate::session::Session;

/// Open meshes in a window
///
/// Meshes of all formats, .mlod, .mlq and .mlz; more can be dropped on the window. Press ? for the
/// keys.
#[derive(Args)]
#[cfg_attr(not(feature = "view"), allow(dead_code))]
pub struct View {
    /// Files to open
    #[arg(value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Close the window S seconds after the first picture
    #[arg(long, value_name = "S", value_parser = parse::length, allow_negative_numbers = true)]
    pub seconds: Option<f64>,
    /// Write a picture once everything is loaded, and close the window unless --seconds is given
    #[arg(long, value_name = "OUT.png")]
    pub screenshot: Option<PathBuf>,
    #[command(flatten)]
    pub reading: ReadArgs,
}

impl View {
    #[cfg(feature = "view")]
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        crate::view::window::run(self, session)
    }

    #[cfg(not(feature = "view"))]
    pub fn run(self, _: &Session) -> Result<Answer, Failure> {
        Err(Failure::new(
            "this build has no viewer; get it with: cargo install --path crates/cli --features view",
        ))
    }
}
