//! `strip --follow`: strips and index buffers that follow a cut from one error to the next.

use meshlod::jobs::{FollowReport, FollowRequest, FollowedCut, follow_strips};
use meshlod::multires::ModelFile;
use meshlod::strip::StripEffort;
use serde::Serialize;

use super::Strip;
use crate::options::query_args::ErrorLimit;
use crate::session::Session;
use crate::session::answer::{Answer, Outcome};
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::hearing::Hearing;
use crate::session::model_file;
use crate::text::model_scene;
use crate::text::numbers::count;
use crate::text::table::aligned;

/// Figures of the strips of all cuts for programs.
#[derive(Serialize)]
struct FollowFigures {
    file: String,
    effort: StripEffort,
    each_mesh_once: bool,
    cuts: Vec<CutFigures>,
    verified: Option<bool>,
}

/// Strips of a cut, and the error that was asked for.
#[derive(Serialize)]
struct CutFigures {
    error: String,
    #[serde(flatten)]
    cut: FollowedCut,
}

impl Strip {
    /// Follows cuts of a multiresolution file, and repairs the strips where each differs from the
    /// last.
    pub(super) fn run_follow(&self, session: &Session) -> Result<Answer, Failure> {
        let opened = model_file::open(&self.input, session)?;
        let file = model_file::levels(&opened)?;
        let ModelFile::Contractions(archive) = file else {
            return Err(Failure::usage(
                "--follow: strips do not follow the right triangles of a height field; use --error",
            ));
        };
        let scene = model_scene::read(&self.input, file, session)?;
        let (model, _) = archive.read().map_err(|error| model_file::failure(&self.input, error))?;
        let hearing = Hearing::new(session, &self.input, &self.input);
        let query = |&error: &ErrorLimit| {
            let query = self.query.request_for(error).query(file);
            let query = query.map_err(|error| hearing.failure(error))?;
            let of_levels = model_scene::query(&self.input, (file, &scene), &query, None)?;
            Ok(of_levels.0)
        };
        let queries = self.follow.iter().map(query).collect::<Result<Vec<_>, Failure>>()?;
        let (quality, effort) = (self.strip_quality(), self.effort.into());
        let request = FollowRequest { quality, effort, verify: self.verify };
        let done = follow_strips(&model, &queries, &request, &hearing);
        let FollowReport { effort, cuts, verified } = done.map_err(|e| hearing.failure(e))?;
        if verified == Some(false) {
            session.warn(Failure::at(
                &self.input,
                "the strips do not draw the faces of the cut, which is a defect of this program",
            ));
        }
        let cuts = self.follow.iter().zip(cuts);
        let cuts = cuts.map(|(error, cut)| CutFigures { error: error.to_string(), cut }).collect();
        let (file, each_mesh_once) = (files::name(&self.input), !scene.is_flat());
        let figures = FollowFigures { file, effort, each_mesh_once, cuts, verified };
        let text = text(&figures);
        let outcome = Outcome::Found.when(verified == Some(false));
        Ok(Answer { outcome, ..Answer::new(figures, text) })
    }
}

fn text(figures: &FollowFigures) -> String {
    let headings = [
        "error",
        "triangles",
        "changed",
        "vertices",
        "per triangle",
        "indices",
        "entries",
        "per triangle",
        "written",
        "strips",
        "ms",
    ];
    let mut rows = vec![headings.map(String::from)];
    rows.extend(figures.cuts.iter().map(CutFigures::row));
    let mut text = aligned(&rows);
    text += "error: as the file has it; changed: triangles that the last cut did not have, or has no more;\n";
    text += "entries: index buffers with restarts and free places; written: those that changed\n";
    for CutFigures { error, cut } in figures.cuts.iter().filter(|of| of.cut.is_wrong()) {
        let [missing, extra] = [cut.missing, cut.extra].map(Option::unwrap_or_default);
        text += &format!("{error}: {missing} missing and {extra} extra triangles\n");
    }
    if figures.verified == Some(true) {
        text += "verified: the strips draw exactly the faces of each cut\n";
    }
    if figures.each_mesh_once {
        text += "counts are of each mesh once, however many nodes show it\n";
    }
    text
}

impl CutFigures {
    fn row(&self) -> [String; 11] {
        let Self { error, cut } = self;
        [
            error.clone(),
            count(cut.triangles),
            count(cut.changed),
            count(cut.vertices_sent),
            format!("{:.3}", cut.vertices_sent as f64 / cut.triangles.max(1) as f64),
            count(cut.indices_with_restart),
            count(cut.entries),
            format!("{:.3}", cut.entries_per_triangle),
            count(cut.entries_written),
            count(cut.strips),
            format!("{:.1}", cut.seconds * 1e3),
        ]
    }
}
