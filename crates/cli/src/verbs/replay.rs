//! `replay`: restores a level of a recorded run.

use std::path::PathBuf;

use clap::Args;
use meshlod::simplify::Progressive;
use meshlod::{Scene, Target};
use serde_json::json;

use crate::options::args::{ReadArgs, WriteArgs};
use crate::options::parse;
use crate::sequence;
use crate::session::Session;
use crate::session::answer::{Answer, Outcome};
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::scene_files;
use crate::text::numbers::{count, faces};

/// Restore any level recorded by simplify --sequence
#[derive(Args)]
pub struct Replay {
    /// File written by simplify --sequence, or -
    #[arg(value_name = "FILE")]
    input: PathBuf,
    /// File to write, or -
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// The input of that simplify, to be read with the same options: OUT gets its nodes, materials
    /// and textures [default: OUT has geometry and attributes only]
    #[arg(long, value_name = "IN")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    level: LevelArgs,
    #[command(flatten)]
    reading: ReadArgs,
    #[command(flatten)]
    writing: WriteArgs,
}

/// Level to restore.
#[derive(Args)]
#[command(next_help_heading = "Level, one of")]
#[group(required = true, multiple = false)]
struct LevelArgs {
    /// The finest level of at most N faces
    #[arg(short, long, value_name = "N", value_parser = parse::whole,
        allow_negative_numbers = true)]
    faces: Option<usize>,
    /// The finest level of at most this ratio of all faces: 10% or 0.1
    #[arg(short, long, value_name = "RATIO", value_parser = parse::ratio,
        allow_hyphen_values = true)]
    ratio: Option<f64>,
}

impl LevelArgs {
    /// Returns the face limit of the level, if the finest has `full` faces.
    fn most_faces(&self, full: usize) -> usize {
        match (self.faces, self.ratio) {
            (Some(faces), _) => faces,
            (None, ratio) => Target::Ratio(ratio.unwrap_or(1.0)).faces_of(full),
        }
    }
}

impl Replay {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        files::check_output(&self.output, session)?;
        self.check_paths()?;
        let mut sequence = self.read(session)?;
        let (base, full) = (sequence.live_faces(), sequence.full_faces());
        let wanted = self.level.most_faces(full);
        sequence.go_to(wanted);
        let (found, splits) = (sequence.live_faces(), sequence.len());
        let reached = found <= wanted;
        if !reached {
            let reason = format_args!(
                "its coarsest level has {}, and that is what was written",
                faces(base)
            );
            session.miss(&Failure::at(&self.input, reason));
        }
        let scene = self.scene_of(&sequence, session)?;
        scene_files::write(&self.output, &scene, &self.writing, session)?;
        let json = json!({
            "full_faces": full,
            "base_faces": base,
            "splits": splits,
            "output_faces": found,
            "reached": reached,
            "file": files::name(&self.output),
        });
        let out = files::name(&self.output);
        let text = format!(
            "{out}: {}; the sequence has levels of {} to {}\n",
            faces(found),
            count(base),
            count(full)
        );
        Ok(Answer {
            file_on_stdout: files::is_pipe(&self.output),
            outcome: Outcome::Missed.when(session.strict && !reached),
            ..Answer::new(json, text)
        })
    }

    fn check_paths(&self) -> Result<(), Failure> {
        if files::is_pipe(&self.input) && self.scene.as_deref().is_some_and(files::is_pipe) {
            return Err(Failure::usage("-: only one of the two files can be standard input"));
        }
        files::check_apart(&self.output, &[&self.input])
    }

    fn read(&self, session: &Session) -> Result<Progressive, Failure> {
        session.progress.stage(&format!("reading {}", files::name(&self.input)));
        let bytes = files::read_all(&self.input)?;
        Progressive::from_bytes(&bytes).map_err(|error| Failure::at(&self.input, error))
    }

    /// Builds the scene of the current level: that of `--scene`, or a new one.
    fn scene_of(&self, sequence: &Progressive, session: &Session) -> Result<Scene, Failure> {
        if let Some(path) = &self.scene {
            let mut scene = files::read(path, &self.reading, session)?;
            sequence::put_into(&mut scene, sequence, path)?;
            return Ok(scene);
        }
        Ok(Scene::from_mesh(files::stem(&self.input), sequence.level()))
    }
}
