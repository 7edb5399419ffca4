//! `page`: a model and its viewer as one HTML file.

use std::path::{Path, PathBuf};

use clap::Args;
use meshlod::io::write_file;
use meshlod::jobs::{self, BuildRequest};
use serde_json::json;

use crate::browser::VIEWER;
use crate::browser::page::{MOST_BYTES, with_model};
use crate::options::args::ReadArgs;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::hearing::Hearing;
use crate::text::numbers::count;

/// Write one HTML file that shows a model in any browser, without a server
///
/// It holds the viewer and the model with its textures, and refers to nothing else. An .mlod file is
/// taken as it is, all its levels; of anything else they are made as build makes them.
#[derive(Args)]
pub struct Page {
    /// Mesh, scene or .mlod file to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File to write
    #[arg(value_name = "OUT.html")]
    output: PathBuf,
    #[command(flatten)]
    reading: ReadArgs,
}

impl Page {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        check_output(&self.output)?;
        let (name, model) = self.model(session)?;
        if model.len() > MOST_BYTES {
            let reason = format_args!(
                "its levels have {} bytes, and a page may hold {}; show them by meshlod serve, or \
                 simplify the mesh before",
                count(model.len()),
                count(MOST_BYTES),
            );
            return Err(Failure::at(&self.input, reason));
        }
        session.progress.stage(&format!("writing {}", files::name(&self.output)));
        let page = with_model(&name, &model);
        write_file(&self.output, page.as_bytes())?;
        let file = files::name(&self.output);
        let text = format!(
            "{file}: {} bytes, of them {} of the model and {} of the viewer\n",
            count(page.len()),
            count(model.len()),
            count(VIEWER.len()),
        );
        let figures = json!({
            "file": file,
            "bytes": page.len(),
            "model_bytes": model.len(),
            "viewer_bytes": VIEWER.len(),
        });
        Ok(Answer::new(figures, text))
    }

    /// Returns all levels of the input, and the name that the page gives them.
    fn model(&self, session: &Session) -> Result<(String, Vec<u8>), Failure> {
        let file = files::open(&self.input, &self.reading, session)?;
        let name = format!("{}.mlod", files::stem(&self.input));
        if file.levels().is_some() {
            session.note(&self.input, &file.notes())?;
            // Of a file that is too large only its size is needed.
            return Ok((name, files::read_all(&self.input)?));
        }
        let scene = files::scene_of(file, session)?;
        let (shown, meshes) = (scene.instances().len(), scene.meshes.len());
        if shown > meshes {
            let line = format_args!(
                "its nodes show {} meshes {} times; the page shows each of them once",
                count(meshes),
                count(shown),
            );
            session.warn(Failure::at(&self.input, line));
        }
        let hearing = Hearing::new(session, &self.input, &self.output);
        let built = jobs::build(scene, &BuildRequest::default(), &hearing);
        let (bytes, report) = built.map_err(|error| hearing.failure(error))?;
        session.note(&self.output, &report.notes)?;
        Ok((name, bytes))
    }
}

/// Fails if a page cannot be written, before any work is done.
fn check_output(path: &Path) -> Result<(), Failure> {
    let suffix = path.extension().unwrap_or_default();
    if !["html", "htm"].iter().any(|known| suffix.eq_ignore_ascii_case(known)) {
        let name = files::name(path);
        return Err(Failure::usage(format_args!("{name}: a page must end in .html")));
    }
    files::check_place(path)
}
