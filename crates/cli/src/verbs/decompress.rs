//! `decompress`: decodes a compressed file to a mesh.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use meshlod::{Mesh, decompress_scene};
use serde_json::{Value, json};

use crate::answer::Answer;
use crate::args::WriteArgs;
use crate::failure::Failure;
use crate::files;
use crate::numbers::{faces, value};
use crate::session::Session;

/// Decode a compressed file (.mlq or .mlz) to a mesh
#[derive(Args)]
pub struct Decompress {
    /// File to read, .mlq or .mlz, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File to write, or -
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    writing: WriteArgs,
}

impl Decompress {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        files::check_output(&self.output, session)?;
        files::check_apart(&self.output, &[&self.input])?;
        session.progress.stage(&format!("reading {}", files::name(&self.input)));
        let bytes = files::read_all(&self.input)?;
        let start = Instant::now();
        let name = self.input.file_stem().map_or("mesh".into(), |stem| stem.to_string_lossy());
        let scene = decompress_scene(&bytes, name);
        let scene = scene.map_err(|error| Failure::at(&self.input, error))?;
        let time = start.elapsed();
        let mesh = &scene.meshes[0].mesh;
        let (json, text) = (self.json(mesh, time), self.text(mesh, time));
        files::write(&self.output, &scene, &self.writing, session)?;
        Ok(Answer { file_on_stdout: files::is_pipe(&self.output), ..Answer::new(json, text) })
    }

    fn json(&self, mesh: &Mesh, time: Duration) -> Value {
        json!({
            "file": files::name(&self.output),
            "vertices": mesh.positions.len(),
            "faces": mesh.faces.len(),
            "decode_seconds": time.as_secs_f64(),
        })
    }

    fn text(&self, mesh: &Mesh, time: Duration) -> String {
        let seconds = value(time.as_secs_f64());
        let name = files::name(&self.output);
        format!("{name}: {}\ndecode_seconds: {seconds}\n", faces(mesh.faces.len()))
    }
}
