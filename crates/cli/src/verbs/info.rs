//! `info`: prints what a file contains.

mod contents;
mod facts;

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;
use serde_json::Value;

use crate::options::args::ReadArgs;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::own_files;
use crate::session::several;
use crate::text::numbers::faces;
use crate::text::table::aligned;
use crate::verbs::info::contents::Contents;
use crate::verbs::info::facts::Facts;

/// Print what a file contains
///
/// Counts, bounds, area, volume, closed or open; textures, skins, animations, instances, extensions
/// and bytes.
#[derive(Args)]
pub struct Info {
    /// Meshes to read, or -
    #[arg(id = "input", value_name = "IN", required = true)]
    inputs: Vec<PathBuf>,
    #[command(flatten)]
    reading: ReadArgs,
}

impl Info {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        several::answer(&self.inputs, session, |path| self.one(path, session))
    }

    fn one(&self, path: &Path, session: &Session) -> Result<Answer, Failure> {
        let file = files::open(path, &self.reading, session)?;
        let stored = own_files::stored(&file).transpose()?;
        let scene = files::scene_of(file, session)?;
        session.progress.stage("inspecting");
        let meshes = scene.meshes.len();
        let file = (!files::is_pipe(path)).then(|| std::fs::metadata(path));
        let file_bytes = file.and_then(Result::ok).map(|file| file.len());
        let contents = Contents::of(&scene, file_bytes, stored.is_some());
        let facts = Facts::of(&scene);
        let faces_once = facts.faces_once;
        let mut text = format!("{}\n{}{}", files::name(path), facts.text(), contents.text());
        if let Some(stored) = &stored {
            text += &match faces_once == facts.faces() {
                true => "stored as\n".to_owned(),
                false => format!("stored as {}, each mesh once\n", faces(faces_once)),
            };
            let rows = stored.rows.iter().map(|[name, of]| [format!("  {name}"), of.clone()]);
            text += &aligned(&rows.collect::<Vec<_>>());
        }
        let figures = InfoFigures {
            facts,
            file: files::name(path),
            meshes,
            contents,
            stored: stored.map(|stored| StoredFigures { form: stored.json, faces: faces_once }),
        };
        Ok(Answer::new(figures, text))
    }
}

/// All that is printed for programs.
#[derive(Serialize)]
struct InfoFigures {
    #[serde(flatten)]
    facts: Facts,
    file: String,
    meshes: usize,
    #[serde(flatten)]
    contents: Contents,
    #[serde(skip_serializing_if = "Option::is_none")]
    stored: Option<StoredFigures>,
}

/// How a file of our own stores its mesh, with the faces of its meshes, each once.
#[derive(Serialize)]
struct StoredFigures {
    #[serde(flatten)]
    form: Value,
    faces: usize,
}
