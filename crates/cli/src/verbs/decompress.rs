//! `decompress`: decodes a compressed file to a scene.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use meshlod::decompress_model;
use serde_json::{Value, json};

use crate::options::args::WriteArgs;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::scene_files;
use crate::text::model_scene;
use crate::text::numbers::{count, faces, value};

/// Decode a compressed file (.mlq or .mlz): to glTF as the scene it was made of, else as its surface
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
        let format = files::check_output(&self.output, session)?;
        files::check_apart(&self.output, &[&self.input])?;
        session.progress.stage(&format!("reading {}", files::name(&self.input)));
        let bytes = files::read_all(&self.input)?;
        let start = Instant::now();
        let decoded = decompress_model(&bytes);
        let (mesh, model) = decoded.map_err(|error| Failure::at(&self.input, error))?;
        let counts = [mesh.positions.len(), mesh.faces.len()];
        let flat = model.flat_scene(files::stem(&self.input), mesh);
        model_scene::note_merged(&self.output, &model, format, session)?;
        let scene = model_scene::restored(&self.input, model, flat, format)?;
        let time = start.elapsed();
        let shown = model_scene::shown_faces(&scene);
        let (json, text) = (self.json(counts, shown, time), self.text(counts, shown, time));
        scene_files::write(&self.output, &scene, &self.writing, session)?;
        Ok(Answer { file_on_stdout: files::is_pipe(&self.output), ..Answer::new(json, text) })
    }

    fn json(&self, [vertices, faces]: [usize; 2], shown: usize, time: Duration) -> Value {
        json!({
            "file": files::name(&self.output),
            "vertices": vertices,
            "faces": faces,
            "shown_faces": shown,
            "decode_seconds": time.as_secs_f64(),
        })
    }

    fn text(&self, [_, of_meshes]: [usize; 2], shown: usize, time: Duration) -> String {
        let seconds = value(time.as_secs_f64());
        let name = files::name(&self.output);
        let shown = match shown == of_meshes {
            true => String::new(),
            false => format!(", shown as {}", count(shown)),
        };
        format!("{name}: {}{shown}\ndecode_seconds: {seconds}\n", faces(of_meshes))
    }
}
