//! `strip --follow`: strips and index buffers that follow a cut from one error to the next.

use std::time::{Duration, Instant};

use meshlod::multires::{Cut, Implicit, ModelFile, UpdateLimits};
use meshlod::strip::{CutStrips, Difference, StripIndices, StripStatistics};
use serde_json::{Value, json};

use super::Strip;
use crate::answer::{Answer, Outcome};
use crate::failure::Failure;
use crate::files;
use crate::model_file;
use crate::model_scene;
use crate::numbers::count;
use crate::query_args::ErrorLimit;
use crate::session::Session;
use crate::table::aligned;

/// Strips of a cut, and what it took to get there from the one before.
struct FollowedCut {
    error: ErrorLimit,
    /// Triangles that were added, removed or changed; all of the first cut.
    changed: usize,
    figures: CutFigures,
    time: Duration,
    difference: Option<Difference>,
}

/// Sizes of a cut and of its strips.
struct CutFigures {
    triangles: usize,
    sent: StripStatistics,
    /// Entries of the index buffers, with restarts and unused places, and those written.
    entries: usize,
    written: usize,
}

impl Strip {
    /// Follows cuts of a multiresolution file, and repairs the strips where each differs from the
    /// last.
    pub(super) fn run_follow(&self, session: &Session) -> Result<Answer, Failure> {
        let file = model_file::open(&self.input, session)?;
        let ModelFile::Contractions(archive) = &file else {
            return Err(Failure::usage(
                "--follow: strips do not follow the right triangles of a height field; use --error",
            ));
        };
        let scene = model_scene::read(&self.input, &file, session)?;
        let (model, _) = archive.read().map_err(|error| model_file::failure(&self.input, error))?;
        let mut cut = Cut::new(&model);
        let mut strips = None;
        let mut followed = Vec::new();
        for &error in &self.follow {
            session.progress.stage("following");
            let query = self.query.query_for(error, &file)?;
            let (query, _) = model_scene::query(&self.input, (&file, &scene), &query, None)?;
            let start = Instant::now();
            cut.update(&query, &UpdateLimits::default()).map_err(Failure::usage)?;
            let changed = self.update(&model, &cut, &mut strips);
            let time = start.elapsed();
            if let Some((strips, indices)) = &strips {
                let difference = self.verify.then(|| strips.difference(&model, &cut));
                let figures = CutFigures::of(&cut, strips, indices);
                followed.push(FollowedCut { error, changed, figures, time, difference });
            }
        }
        let wrong = followed.iter().any(FollowedCut::is_wrong);
        if wrong {
            session.warn(Failure::at(
                &self.input,
                "the strips do not draw the faces of the cut, which is a defect of this program",
            ));
        }
        let json = json!({
            "file": files::name(&self.input),
            "effort": self.effort_name(),
            "each_mesh_once": !scene.is_flat(),
            "cuts": followed.iter().map(FollowedCut::json).collect::<Vec<_>>(),
            "verified": self.verify.then_some(!wrong),
        });
        let mut text = self.follow_text(&followed);
        if !scene.is_flat() {
            text += "counts are of each mesh once, however many nodes show it\n";
        }
        let outcome = Outcome::Found.when(wrong);
        Ok(Answer { outcome, ..Answer::new(json, text) })
    }

    /// Brings strips and index buffers up to date, and returns how many triangles have changed.
    fn update(
        &self,
        model: &Implicit,
        cut: &Cut<'_>,
        state: &mut Option<(CutStrips, StripIndices)>,
    ) -> usize {
        let Some((strips, indices)) = state else {
            let mut strips = CutStrips::new(model, cut, &self.options(), self.effort.into());
            let indices = strips.indices(model);
            *state = Some((strips, indices));
            return cut.face_count();
        };
        let changed = strips.update(cut);
        strips.update_indices(model, indices);
        changed
    }

    fn follow_text(&self, followed: &[FollowedCut]) -> String {
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
        rows.extend(followed.iter().map(FollowedCut::row));
        let mut text = aligned(&rows);
        text += "error: as the file has it; changed: triangles that the last cut did not have, or has no more;\n";
        text +=
            "entries: index buffers with restarts and free places; written: those that changed\n";
        for FollowedCut { error, difference, .. } in followed.iter().filter(|cut| cut.is_wrong()) {
            let (missing, extra) = difference.map_or((0, 0), |d| (d.missing, d.extra));
            text += &format!("{error}: {missing} missing and {extra} extra triangles\n");
        }
        if self.verify && !followed.iter().any(FollowedCut::is_wrong) {
            text += "verified: the strips draw exactly the faces of each cut\n";
        }
        text
    }
}

impl CutFigures {
    fn of(cut: &Cut<'_>, strips: &CutStrips, indices: &StripIndices) -> Self {
        let sets = 0..indices.sets();
        let changed = sets.clone().flat_map(|set| indices.changed(set));
        Self {
            triangles: cut.face_count(),
            sent: StripStatistics::new(&strips.strips()),
            entries: sets.map(|set| indices.indices(set).len()).sum(),
            written: changed.map(ExactSizeIterator::len).sum(),
        }
    }

    fn per_triangle(&self, number: usize) -> f64 {
        number as f64 / self.triangles.max(1) as f64
    }
}

impl FollowedCut {
    fn is_wrong(&self) -> bool {
        self.difference.is_some_and(|difference| difference != Difference::default())
    }

    fn json(&self) -> Value {
        let Self { figures, difference, .. } = self;
        let CutFigures { triangles, sent, entries, written } = figures;
        json!({
            "error": self.error.to_string(),
            "triangles": triangles,
            "changed": self.changed,
            "vertices_sent": sent.vertices_sent,
            "indices_with_restart": sent.indices_with_restart,
            "entries": entries,
            "entries_per_triangle": figures.per_triangle(*entries),
            "entries_written": written,
            "strips": sent.strips,
            "seconds": self.time.as_secs_f64(),
            "missing": difference.map(|difference| difference.missing),
            "extra": difference.map(|difference| difference.extra),
        })
    }

    fn row(&self) -> [String; 11] {
        let CutFigures { triangles, sent, entries, written } = &self.figures;
        [
            self.error.to_string(),
            count(*triangles),
            count(self.changed),
            count(sent.vertices_sent),
            format!("{:.3}", self.figures.per_triangle(sent.vertices_sent)),
            count(sent.indices_with_restart),
            count(*entries),
            format!("{:.3}", self.figures.per_triangle(*entries)),
            count(*written),
            count(sent.strips),
            format!("{:.1}", self.time.as_secs_f64() * 1e3),
        ]
    }
}
