//! `sample`: writes a procedural mesh.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use meshlod::Scene;
use meshlod::samples;
use serde_json::json;

use crate::options::args::WriteArgs;
use crate::options::parse;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::scene_files;
use crate::text::numbers::{self, count};

/// Write a procedural mesh of any size
#[derive(Args)]
pub struct Sample {
    /// Name of the sample
    #[arg(value_name = "NAME", value_parser = PossibleValuesParser::new(samples::NAMES))]
    name: String,
    /// File to write, or -
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Approximate number of faces [default: enough to show the sample well]
    #[arg(short, long, value_name = "N", value_parser = faces, allow_negative_numbers = true)]
    faces: Option<usize>,
    /// Seed of the random parts of boxes and voxels, and of --turned
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    seed: u64,
    /// Turn the mesh in a random direction, so that its flats are on no axis
    #[arg(long)]
    turned: bool,
    #[command(flatten)]
    writing: WriteArgs,
}

impl Sample {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        files::check_output(&self.output, session)?;
        session.progress.stage("generating");
        let mesh = samples::by_seed(&self.name, self.faces, self.seed)
            .ok_or_else(|| Failure::usage(format_args!("no sample is called {}", self.name)))?;
        let mesh = if self.turned { samples::turned(&mesh, self.seed) } else { mesh };
        let (vertices, faces) = (mesh.positions.len(), mesh.faces.len());
        let scene = Scene::from_mesh(&self.name, mesh);
        scene_files::write(&self.output, &scene, &self.writing, session)?;
        let json = json!({
            "name": self.name,
            "file": files::name(&self.output),
            "vertices": vertices,
            "faces": faces,
        });
        let out = files::name(&self.output);
        let text = format!("{out}: {} vertices, {}\n", count(vertices), numbers::faces(faces));
        Ok(Answer { file_on_stdout: files::is_pipe(&self.output), ..Answer::new(json, text) })
    }
}

fn faces(text: &str) -> Result<usize, String> {
    match parse::positive(text)? {
        faces if faces <= samples::MAX_FACES => Ok(faces),
        _ => Err(format!("it must be at most {}", count(samples::MAX_FACES))),
    }
}
