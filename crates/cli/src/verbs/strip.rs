//! `strip`: converts levels of a mesh to triangle strips and counts what they send.

mod follow;
mod model;
mod options;
mod output;
mod report;

use std::path::PathBuf;

use clap::Args;
use meshlod::Scene;
use meshlod::jobs::{self, StripFilter, StripRequest};
use meshlod::strip::StripQuality;

use crate::options::args::ReadArgs;
use crate::options::constraints::ConstraintArgs;
use crate::options::doubt;
use crate::options::locks::InputScene;
use crate::options::model_query::QueryArgs;
use crate::options::parse::{self, LevelSize};
use crate::options::query_args::{self, ErrorLimit};
use crate::session::Session;
use crate::session::answer::{Answer, Outcome};
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::hearing::Hearing;
use crate::text::kept_error;
use crate::text::numbers;
use options::{EffortArg, FilterArg, QualityArg};

/// Convert a mesh and its levels to triangle strips
///
/// Or a cut of a multiresolution file; counts the vertices that the strips send.
#[derive(Args)]
pub struct Strip {
    /// Mesh to read, or -; or an .mlod file to take a cut from
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// Follow the cuts of an .mlod file at these errors: 1%,0.1%
    ///
    /// In turn, repairing strips and index buffers where one differs from the last, and listing
    /// each.
    #[arg(long, value_name = "BOUNDS", value_delimiter = ',', value_parser = query_args::error_limit,
        allow_hyphen_values = true, conflicts_with_all = ["error", "faces", "levels", "filter", "out",
        "strict"])]
    follow: Vec<ErrorLimit>,
    /// Level sizes: 10% or 0.1 of the faces, or a number of faces
    #[arg(long, visible_alias = "level", value_name = "SIZES", value_delimiter = ',',
        default_value = "100%", value_parser = parse::size, allow_hyphen_values = true)]
    levels: Vec<LevelSize>,
    /// Carry the strips of the whole mesh down by this filter
    ///
    /// They are shortened at each level. By default each level gets strips of its own.
    #[arg(long, value_name = "FILTER")]
    filter: Option<FilterArg>,
    /// Quality of the strips of the mesh or of a level
    #[arg(long, value_name = "QUALITY", default_value = "fast")]
    quality: QualityArg,
    /// Effort of --quality best and --filter repair
    #[arg(long, value_name = "EFFORT", default_value = "thorough")]
    effort: EffortArg,
    /// File to write: .glb, .gltf or .json
    ///
    /// glTF gets the scene with strips for faces, finest level first, linked by MSFT_lod; .json
    /// gets lists of vertices.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Verify what the strips draw; exit with 3 if it differs
    ///
    /// Compares the triangles, and without --follow their attributes and materials, with those of
    /// the level, which is simplified a second time for that, or of the cut.
    #[arg(long)]
    verify: bool,
    #[command(flatten)]
    query: QueryArgs,
    #[command(flatten)]
    constraints: ConstraintArgs,
    #[command(flatten)]
    reading: ReadArgs,
}

impl Strip {
    pub fn run(mut self, session: &Session) -> Result<Answer, Failure> {
        let reason = "strips keep the topology, since all levels share the vertices of the mesh";
        self.constraints.topology.keep(reason)?;
        if let Some(out) = &self.out {
            output::check(out, &self.input)?;
        }
        let mut error = None;
        let scene = if self.reads_model()? {
            if !self.follow.is_empty() {
                return self.run_follow(session);
            }
            let cut = self.read_cut(session)?;
            error = Some(cut.error);
            cut.scene
        } else {
            files::read_surface(&self.input, &self.reading, session)?
        };
        let hearing = Hearing::new(session, &self.input, &self.input);
        session.doubt(&self.input, doubt::of_sizes(&self.levels, &scene));
        let request = self.request(&scene)?;
        let done = jobs::strip(scene, &request, &hearing);
        let (stripped, report) = done.map_err(|error| hearing.failure(error))?;
        for level in report.levels.iter().filter(|level| !level.reached) {
            let reason = format_args!(
                "{}: no further contraction is possible at {}: strips keep the topology, so ask for more, \
                 or simplify first",
                level.size,
                numbers::faces(level.triangles)
            );
            session.miss(&Failure::at(&self.input, reason));
        }
        if let Some(out) = &self.out {
            output::write(out, &stripped, &report, session)?;
        }
        if report.verified == Some(false) {
            session.warn(Failure::at(
                &self.input,
                "the strips do not draw the faces of the level, which is a defect of this program",
            ));
        }
        let outcome = Outcome::Found.when(report.verified == Some(false));
        let mut text = report::text(&report);
        text += &error.as_ref().map(kept_error::to_text).unwrap_or_default();
        Ok(Answer { outcome, ..Answer::new(self.figures(report, error), text) })
    }

    fn request(&self, scene: &Scene) -> Result<StripRequest, Failure> {
        let input = InputScene { scene, path: &self.input, reading: &self.reading };
        Ok(StripRequest {
            levels: self.levels.iter().map(|size| size.target()).collect(),
            filter: self.filter.map(StripFilter::from),
            quality: self.strip_quality(),
            effort: self.effort.into(),
            verify: self.verify,
            constraints: self.constraints.constraints(&input)?,
        })
    }

    fn strip_quality(&self) -> StripQuality {
        match (self.quality, self.effort) {
            (QualityArg::Fast, _) => StripQuality::Fast,
            (QualityArg::Best, EffortArg::Quick) => StripQuality::QUICK,
            (QualityArg::Best, EffortArg::Thorough) => StripQuality::THOROUGH,
        }
    }
}
