//! `extract`: takes one mesh out of a multiresolution file.

mod report;

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use meshlod::Format;
use meshlod::io::merged_instances;
use meshlod::jobs::{self, ExtractReport, ExtractRequest};

use crate::options::args::WriteArgs;
use crate::options::model_query::QueryArgs;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::hearing::Hearing;
use crate::session::model_file;
use crate::session::scene_files;
use crate::text::kept_error;
use crate::text::numbers::value;

/// Extract one level from a multiresolution file (.mlod)
///
/// Fine where it is needed, coarse elsewhere. glTF gets the whole scene, with nodes, materials,
/// skins and animations, other formats its surface.
#[derive(Args)]
pub struct Extract {
    /// Multiresolution file to read
    #[arg(value_name = "IN.mlod")]
    input: PathBuf,
    /// File to write, or -
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Leave out faces that do not intersect the focus; of a point leave the nearest ones
    #[arg(long, requires = "focus")]
    only: bool,
    /// Restore the volume of closed parts
    ///
    /// Vertices move along their normals, mostly by their last digits, until closed parts have the
    /// volume of the finest cut in the file, in the precision that is written: that of the mesh, if
    /// the file was built with --exact-volume or --lossless. Reads the whole file. Vertices move on
    /// top of --error, and so do those that were locked, which the file does not know.
    #[arg(long, conflicts_with = "only")]
    exact_volume: bool,
    /// Trust the errors in the file: faster
    ///
    /// Reads only what the result needs, but places can be farther off than --error, and the error
    /// of --faces is not measured.
    #[arg(long)]
    unverified: bool,
    #[command(flatten)]
    query: QueryArgs,
    #[command(flatten)]
    writing: WriteArgs,
}

impl Extract {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        let format = files::check_output(&self.output, session)?;
        files::check_apart(&self.output, &[&self.input])?;
        model_file::check_input(&self.input)?;
        self.query.check_target()?;
        let start = Instant::now();
        let file = model_file::open(&self.input, session)?;
        self.query.warn_of_error(&file, session);
        let hearing = Hearing::new(session, &self.input, &self.output);
        let done = jobs::extract(model_file::levels(&file)?, &self.request(format), &hearing);
        let (scene, report) = done.map_err(|error| hearing.failure(error))?;
        let time = start.elapsed();
        session.note(&self.input, &scene.notes)?;
        if report.faces == 0 {
            return Err(Failure::at(&self.input, "no face intersects the focus"));
        }
        self.say_what_is_missed(&report, session);
        let merged = merged_instances(report.merged_meshes);
        session.note(&self.output, &[merged.remedied(".glb keeps them apart")])?;
        let writing =
            report.precision.map_or(self.writing, |chosen| self.writing.in_precision(chosen));
        scene_files::write(&self.output, &scene, &writing, session)?;
        let figures = report::figures(&self.output, &report, time);
        Ok(Answer {
            file_on_stdout: files::is_pipe(&self.output),
            ..Answer::new(figures, report::to_text(&self.output, &report, time))
        })
    }

    fn request(&self, format: Format) -> ExtractRequest {
        ExtractRequest {
            query: self.query.request(),
            verify: !self.unverified,
            crop: self.only,
            exact_volume: self.exact_volume,
            written_as: Some(self.writing.in_format(format)),
            name: files::stem(&self.input),
        }
    }

    /// Warns of what the mesh lacks of what was asked for.
    fn say_what_is_missed(&self, report: &ExtractReport, session: &Session) {
        if !report.meets_focus && !self.only {
            session.warn(Failure::at(
                &self.input,
                "no face intersects the focus, so all are as coarse as the file has them; info shows the bounds",
            ));
        }
        self.query.warn_of_faces(&self.input, report.level_faces, "extracted", session);
        let missed = kept_error::warning(&report.error);
        let is_below = report.error.below_rounding().is_some();
        if let Some(moves) = report.rounded {
            let moved = format_args!("rounding to f32 moved coordinates by up to {}", value(moves));
            let moved = Failure::at(&self.output, moved);
            if missed.is_some() && !is_below {
                return session.miss(&moved);
            }
            session.warn(moved);
        }
        if let Some(warning) = missed {
            session.miss(&Failure::at(&self.input, warning));
        }
    }
}
