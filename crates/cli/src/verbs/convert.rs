//! `convert`: writes a mesh in another format.

use std::path::PathBuf;

use clap::Args;
use meshlod::{Mesh, Scene};
use serde_json::{Value, json};

use crate::options::args::{ReadArgs, WriteArgs};
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::scene_files;
use crate::text::model_scene::shown_faces;
use crate::text::numbers::{count, faces};

/// Write a mesh in another format, or the same one; what the format cannot hold is named
#[derive(Args)]
pub struct Convert {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File to write, or -
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    reading: ReadArgs,
    #[command(flatten)]
    writing: WriteArgs,
}

impl Convert {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        files::check_output(&self.output, session)?;
        let scene = files::read(&self.input, &self.reading, session)?;
        scene_files::write(&self.output, &scene, &self.writing, session)?;
        let format = files::check_output(&self.output, session)?;
        let keeps_unused = scene.keeps_unused_vertices(format);
        let vertices = vertices(&scene, keeps_unused);
        let (json, text) = (self.json(&scene, vertices), self.text(&scene, vertices));
        Ok(Answer { file_on_stdout: files::is_pipe(&self.output), ..Answer::new(json, text) })
    }

    fn json(&self, scene: &Scene, vertices: usize) -> Value {
        json!({
            "file": files::name(&self.output),
            "meshes": scene.meshes.len(),
            "vertices": vertices,
            "faces": of_meshes(scene),
            "shown_faces": shown_faces(scene),
        })
    }

    fn text(&self, scene: &Scene, vertices: usize) -> String {
        let meshes = scene.meshes.len();
        let shown = match shown_faces(scene) {
            shown if shown == of_meshes(scene) => String::new(),
            shown => format!(", shown as {}", count(shown)),
        };
        format!(
            "{}: {meshes} mesh{}, {} vertices, {}{shown}\n",
            files::name(&self.output),
            if meshes == 1 { "" } else { "es" },
            count(vertices),
            faces(of_meshes(scene)),
        )
    }
}

/// Counts the vertices that are written of all meshes, each counted once and before seams split any.
fn vertices(scene: &Scene, keeps_unused: bool) -> usize {
    let is_written = |&&is_used: &&bool| is_used || keeps_unused;
    let written = |mesh: &Mesh| mesh.used_vertices().iter().filter(is_written).count();
    scene.meshes.iter().map(|mesh| written(&mesh.mesh)).sum()
}

/// Returns the number of faces of all meshes, each counted once.
fn of_meshes(scene: &Scene) -> usize {
    scene.meshes.iter().map(|mesh| mesh.mesh.faces.len()).sum()
}
