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
use crate::numbers::count;
use crate::query_args::ErrorLimit;
use crate::session::Session;
use crate::table::aligned;

/// Strips of a cut, and what it took to get there from the one before.
struct FollowedCut {
    error: ErrorLimit,
    triangles: usize,
    /// Triangles that were added, removed or changed; all of the first cut.
    changed: usize,
    sent: StripStatistics,
    /// Entries of the index buffers, with restarts and unused places, and those written.
    entries: usize,
    written: usize,
    time: Duration,
    difference: Option<Difference>,
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
        let (model, _) = archive.read().map_err(|error| model_file::failure(&self.input, error))?;
        let mut cut = Cut::new(&model);
        let mut strips = None;
        let mut followed = Vec::new();
        for &error in &self.follow {
            session.progress.stage("following");
            let query = self.query.query_for(error, &file)?;
            let (query, _) = file
                .at_surface(&query, None)
                .map_err(|error| model_file::failure(&self.input, error))?;
            let start = Instant::now();
            cut.update(&query, &UpdateLimits::default()).map_err(Failure::usage)?;
            let changed = self.update(&model, &cut, &mut strips);
            let time = start.elapsed();
            if let Some((strips, indices)) = &strips {
                let difference = self.verify.then(|| strips.difference(&model, &cut));
                let followed_cut = FollowedCut::new(&cut, strips, indices);
                followed.push(FollowedCut { error, changed, time, difference, ..followed_cut });
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
            "cuts": followed.iter().map(FollowedCut::json).collect::<Vec<_>>(),
            "verified": self.verify.then_some(!wrong),
        });
        let outcome = Outcome::Found.when(wrong);
        Ok(Answer { outcome, ..Answer::new(json, self.follow_text(&followed)) })
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

impl FollowedCut {
    fn new(cut: &Cut<'_>, strips: &CutStrips, indices: &StripIndices) -> Self {
        let sets = 0..indices.sets();
        let changed = sets.clone().flat_map(|set| indices.changed(set));
        Self {
            error: ErrorLimit::Pixels(0.0),
            triangles: cut.face_count(),
            changed: 0,
            sent: StripStatistics::new(&strips.strips()),
            entries: sets.map(|set| indices.indices(set).len()).sum(),
            written: changed.map(ExactSizeIterator::len).sum(),
            time: Duration::ZERO,
            difference: None,
        }
    }

    fn is_wrong(&self) -> bool {
        self.difference.is_some_and(|difference| difference != Difference::default())
    }

    fn per_triangle(&self, number: usize) -> f64 {
        number as f64 / self.triangles.max(1) as f64
    }

    fn json(&self) -> Value {
        let Self { sent, difference, .. } = self;
        json!({
            "error": self.error.to_string(),
            "triangles": self.triangles,
            "changed": self.changed,
            "vertices_sent": sent.vertices_sent,
            "indices_with_restart": sent.indices_with_restart,
            "entries": self.entries,
            "entries_per_triangle": self.per_triangle(self.entries),
            "entries_written": self.written,
            "strips": sent.strips,
            "seconds": self.time.as_secs_f64(),
            "missing": difference.map(|difference| difference.missing),
            "extra": difference.map(|difference| difference.extra),
        })
    }

    fn row(&self) -> [String; 11] {
        [
            self.error.to_string(),
            count(self.triangles),
            count(self.changed),
            count(self.sent.vertices_sent),
            format!("{:.3}", self.per_triangle(self.sent.vertices_sent)),
            count(self.sent.indices_with_restart),
            count(self.entries),
            format!("{:.3}", self.per_triangle(self.entries)),
            count(self.written),
            count(self.sent.strips),
            format!("{:.1}", self.time.as_secs_f64() * 1e3),
        ]
    }
}
