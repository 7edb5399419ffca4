//! `replay`: any level of a run that was kept.

use std::fs;
use std::path::PathBuf;

use clap::Args;
use meshlod::simplify::Progressive;
use meshlod::{Scene, Target};
use serde_json::json;

use crate::amounts;
use crate::answer::Answer;
use crate::args::Writing;
use crate::failure::Failure;
use crate::files;
use crate::numbers::{count, faces};
use crate::session::Session;

#[derive(Args)]
pub struct Replay {
    /// File that simplify --sequence has written
    #[arg(value_name = "FILE")]
    input: PathBuf,
    /// File to write, or -
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    goal: Goal,
    #[command(flatten)]
    writing: Writing,
}

/// Which level.
#[derive(Args)]
#[group(required = true, multiple = false)]
struct Goal {
    /// The finest of at most this many faces
    #[arg(long, value_name = "N", value_parser = amounts::whole, allow_negative_numbers = true)]
    faces: Option<usize>,
    /// The finest of at most this part of all faces: 10% or 0.1
    #[arg(long, value_name = "PART", value_parser = amounts::ratio, allow_hyphen_values = true)]
    ratio: Option<f64>,
}

impl Replay {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        files::check_output(&self.output, session)?;
        session.progress.stage(&format!("reading {}", files::name(&self.input)));
        let at = |reason: &dyn std::fmt::Display| Failure::at(&self.input, reason);
        let bytes = fs::read(&self.input).map_err(|error| at(&error))?;
        let mut sequence = Progressive::from_bytes(&bytes).map_err(|error| at(&error))?;
        let (base, full) = (sequence.live_faces(), sequence.full_faces());
        let target = self.goal.ratio.map_or(Target::Faces(0), Target::Ratio);
        let wanted = self.goal.faces.unwrap_or_else(|| target.faces_of(full));
        sequence.go_to(wanted);
        let (found, splits) = (sequence.live_faces(), sequence.len());
        let reached = found <= wanted;
        if !reached {
            session.warn(at(&format_args!("its coarsest level has {}", faces(base))));
        }
        let name = self.input.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let scene = Scene::from_mesh(name.unwrap_or_default(), sequence.level());
        files::write(&self.output, &scene, &self.writing, session)?;
        let json = json!({
            "full_faces": full,
            "base_faces": base,
            "splits": splits,
            "output_faces": found,
            "reached": reached,
            "file": files::name(&self.output),
        });
        let out = files::name(&self.output);
        let text = format!("{out}: {} of {} to {}\n", faces(found), count(base), count(full));
        Ok(Answer { file_on_stdout: files::is_pipe(&self.output), ..Answer::new(json, text) })
    }
}
