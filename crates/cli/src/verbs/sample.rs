//! `sample`: writes a procedural mesh.

mod streamed;

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
use streamed::Streamed;

/// Write a procedural mesh of any size
///
/// From 4,000,000 faces on, terrain and gyroid are written in passing if OUT is a PLY file, up to
/// 2,000,000,000 faces; others are made in memory and have at most 500,000,000. That gyroid has more
/// periods, not smaller faces, and fills a cube.
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
    /// Seed of what is random in boxes, voxels, tunnels and parts, and of --turned
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    seed: u64,
    /// Colour the terrain by its height
    #[arg(long)]
    colors: bool,
    /// Turn the mesh in a random direction, so that its flats are on no axis
    #[arg(long)]
    turned: bool,
    #[command(flatten)]
    writing: WriteArgs,
}

impl Sample {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        files::check_output(&self.output, session)?;
        if self.colors && self.name != "terrain" {
            return Err(Failure::usage("--colors: only the terrain has colours"));
        }
        session.progress.stage("generating");
        let [vertices, faces] = match self.streamed() {
            Some(sample) => {
                let precision = self.writing.options().precision;
                sample.write(&self.output, precision, session)?.map(|n| n as usize)
            }
            None => self.write(session)?,
        };
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

impl Sample {
    /// Returns the sample if it is so large that it is written in passing.
    fn streamed(&self) -> Option<Streamed> {
        let faces = self.faces.filter(|_| !self.turned)?;
        Streamed::new(&self.name, faces, &self.output, self.colors)
    }

    /// Makes the mesh in memory and writes it; returns the numbers of vertices and faces.
    fn write(&self, session: &Session) -> Result<[usize; 2], Failure> {
        if self.faces.is_some_and(|faces| faces > samples::MAX_FACES) {
            let most = count(samples::MAX_FACES);
            let reason =
                format!("--faces must be at most {most}, but for terrain and gyroid as PLY");
            return Err(Failure::usage(reason));
        }
        let mesh = match self.faces {
            Some(faces) if self.colors => Some(samples::colored_terrain(faces)),
            None if self.colors => Some(samples::colored_terrain(samples::TERRAIN_FACES)),
            faces => samples::by_seed(&self.name, faces, self.seed),
        };
        let mesh =
            mesh.ok_or_else(|| Failure::usage(format_args!("no sample is called {}", self.name)))?;
        let mesh = if self.turned { samples::turned(&mesh, self.seed) } else { mesh };
        let sizes = [mesh.positions.len(), mesh.faces.len()];
        let scene = Scene::from_mesh(&self.name, mesh);
        scene_files::write(&self.output, &scene, &self.writing, session)?;
        Ok(sizes)
    }
}

fn faces(text: &str) -> Result<usize, String> {
    match parse::positive(text)? {
        faces if faces <= samples::MAX_STREAMED_FACES => Ok(faces),
        _ => Err(format!("it must be at most {}", count(samples::MAX_STREAMED_FACES))),
    }
}
