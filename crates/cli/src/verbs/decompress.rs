//! `decompress`: decodes a compressed file to a scene.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use meshlod::jobs::ConvertReport;
use meshlod::{AnyFile, FileKind, ReadOptions};
use serde_json::json;

use crate::options::args::WriteArgs;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::scene_files;
use crate::text::numbers::{count, faces, value};

/// Decode a compressed file (.mlq or .mlz)
///
/// To glTF as the scene that it was made from, to other formats as its surface.
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
        self.check_input()?;
        session.progress.stage(&format!("reading {}", files::name(&self.input)));
        let bytes = files::read_all(&self.input)?;
        let start = Instant::now();
        // The content decides which of the two kinds it is.
        let kind = FileKind::Resident;
        let options = ReadOptions::default();
        let file = AnyFile::from_bytes(&self.input, kind, bytes, &mut |_| None, &options)?;
        let scene = file.into_scene()?;
        let seconds = start.elapsed().as_secs_f64();
        let report = scene_files::write_counted(&self.output, &scene, &self.writing, session)?;
        let ConvertReport { vertices, faces: of_meshes, shown_faces, .. } = report;
        let json = json!({
            "file": files::name(&self.output),
            "vertices": vertices,
            "faces": of_meshes,
            "shown_faces": shown_faces,
            "decode_seconds": seconds,
        });
        let shown = match shown_faces == of_meshes {
            true => String::new(),
            false => format!(", shown as {}", count(shown_faces)),
        };
        let name = files::name(&self.output);
        let decoded = format!("decode_seconds: {}", value(seconds));
        let text = format!("{name}: {}{shown}\n{decoded}\n", faces(of_meshes));
        Ok(Answer { file_on_stdout: files::is_pipe(&self.output), ..Answer::new(json, text) })
    }

    /// Fails if the input is of another kind by its suffix, with the verb that reads it.
    fn check_input(&self) -> Result<(), Failure> {
        let (verb, options) = match FileKind::of_path(&self.input) {
            Ok(FileKind::Mesh(_)) => ("convert", ""),
            Ok(FileKind::Levels) => ("extract", " --error 0"),
            _ => return Ok(()),
        };
        let [input, output] = [&self.input, &self.output].map(|path| files::name(path));
        let reason =
            format_args!("is no .mlq or .mlz file; use meshlod {verb} {input} {output}{options}");
        Err(Failure::at(&self.input, reason))
    }
}
