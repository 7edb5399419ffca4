//! `strip --follow`: strips and index buffers that follow a cut from one error to the next.

use std::time::{Duration, Instant};

use meshlod::multires::{Cut, Implicit, ModelFile, UpdateLimits};
use meshlod::strip::{CutStrips, Difference, StripIndices, StripStatistics};
use serde::Serialize;

use super::{Strip, report};
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

/// Strips of a cut, and what it took to get there from the one before, under the keys of JSON.
#[derive(Serialize)]
struct FollowedCut {
    error: String,
    triangles: usize,
    /// Triangles that were added, removed or changed; all of the first cut.
    changed: usize,
    vertices_sent: usize,
    indices_with_restart: usize,
    /// Entries of the index buffers, with restarts and unused places.
    entries: usize,
    entries_per_triangle: f64,
    entries_written: usize,
    strips: usize,
    seconds: f64,
    /// Triangles by which the strips differ from the cut, if they were compared.
    missing: Option<usize>,
    extra: Option<usize>,
}

/// Figures of the strips of all cuts for programs.
#[derive(Serialize)]
struct FollowFigures<'c> {
    file: String,
    effort: Option<String>,
    each_mesh_once: bool,
    cuts: &'c [FollowedCut],
    verified: Option<bool>,
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
        let mut cut = Cut::new(&model);
        let mut strips = None;
        let mut followed = Vec::new();
        for &error in &self.follow {
            session.progress.stage("following");
            let asked = self.query.request_for(error).query(file);
            let asked = asked.map_err(|error| hearing.failure(error))?;
            let (query, _) = model_scene::query(&self.input, (file, &scene), &asked, None)?;
            let start = Instant::now();
            cut.update(&query, &UpdateLimits::default()).map_err(Failure::usage)?;
            let changed = self.update(&model, &cut, &mut strips);
            let time = start.elapsed();
            if let Some((strips, indices)) = &strips {
                let difference = self.verify.then(|| strips.difference(&model, &cut));
                let all = (strips, indices);
                followed.push(FollowedCut::of((error, changed), &cut, all, difference, time));
            }
        }
        let wrong = followed.iter().any(FollowedCut::is_wrong);
        if wrong {
            session.warn(Failure::at(
                &self.input,
                "the strips do not draw the faces of the cut, which is a defect of this program",
            ));
        }
        let figures = FollowFigures {
            file: files::name(&self.input),
            effort: report::name(&self.effort),
            each_mesh_once: !scene.is_flat(),
            cuts: &followed,
            verified: self.verify.then_some(!wrong),
        };
        let mut text = self.follow_text(&followed);
        if !scene.is_flat() {
            text += "counts are of each mesh once, however many nodes show it\n";
        }
        let outcome = Outcome::Found.when(wrong);
        Ok(Answer { outcome, ..Answer::new(figures, text) })
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
        for cut in followed.iter().filter(|cut| cut.is_wrong()) {
            let [missing, extra] = [cut.missing, cut.extra].map(Option::unwrap_or_default);
            text += &format!("{}: {missing} missing and {extra} extra triangles\n", cut.error);
        }
        if self.verify && !followed.iter().any(FollowedCut::is_wrong) {
            text += "verified: the strips draw exactly the faces of each cut\n";
        }
        text
    }
}

impl FollowedCut {
    fn of(
        (error, changed): (ErrorLimit, usize),
        cut: &Cut<'_>,
        (strips, indices): (&CutStrips, &StripIndices),
        difference: Option<Difference>,
        time: Duration,
    ) -> Self {
        let sets = 0..indices.sets();
        let written = sets.clone().flat_map(|set| indices.changed(set));
        let entries = sets.map(|set| indices.indices(set).len()).sum();
        let triangles = cut.face_count();
        let sent = StripStatistics::new(&strips.strips());
        Self {
            error: error.to_string(),
            triangles,
            changed,
            vertices_sent: sent.vertices_sent,
            indices_with_restart: sent.indices_with_restart,
            entries,
            entries_per_triangle: entries as f64 / triangles.max(1) as f64,
            entries_written: written.map(ExactSizeIterator::len).sum(),
            strips: sent.strips,
            seconds: time.as_secs_f64(),
            missing: difference.map(|difference| difference.missing),
            extra: difference.map(|difference| difference.extra),
        }
    }

    fn is_wrong(&self) -> bool {
        [self.missing, self.extra].into_iter().flatten().any(|number| number > 0)
    }

    fn row(&self) -> [String; 11] {
        [
            self.error.clone(),
            count(self.triangles),
            count(self.changed),
            count(self.vertices_sent),
            format!("{:.3}", self.vertices_sent as f64 / self.triangles.max(1) as f64),
            count(self.indices_with_restart),
            count(self.entries),
            format!("{:.3}", self.entries_per_triangle),
            count(self.entries_written),
            count(self.strips),
            format!("{:.1}", self.seconds * 1e3),
        ]
    }
}
