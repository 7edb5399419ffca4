//! Strips and index buffers that follow a cut from one query to the next.

use std::time::{Duration, Instant};

use meshlod_multires::{Cut, Implicit, Query, SlotMesh, UpdateLimits};
use meshlod_strip::{
    CutStrips, Difference, StripEffort, StripIndices, StripQuality, StripStatistics,
};

use super::request::options;
use crate::jobs::{JobError, Watch, begin};

/// Request of [`follow_strips`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct FollowRequest {
    /// Quality of the strips of the first cut.
    pub quality: StripQuality,
    /// Effort of repairs where a cut differs from the last.
    pub effort: StripEffort,
    /// True to compare what the strips draw with each cut.
    pub verify: bool,
}

impl Default for FollowRequest {
    fn default() -> Self {
        Self { quality: StripQuality::Fast, effort: StripEffort::Thorough, verify: false }
    }
}

/// Report of [`follow_strips`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FollowReport {
    /// Effort of repairs.
    pub effort: StripEffort,
    /// Strips of each cut.
    pub cuts: Vec<FollowedCut>,
    /// True if the strips draw exactly the faces of all cuts; `None` if they were not compared.
    pub verified: Option<bool>,
}

/// Strips of a cut, and what it took to get there from the one before.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FollowedCut {
    /// Number of triangles of the cut.
    pub triangles: usize,
    /// Number of triangles that were added, removed or changed; all of the first cut.
    pub changed: usize,
    /// Number of vertices sent if each strip is drawn by a call of its own.
    pub vertices_sent: usize,
    /// Number of indices sent with restarts between strips.
    pub indices_with_restart: usize,
    /// Entries of the index buffers, with restarts and unused places.
    pub entries: usize,
    /// Entries of the index buffers for each triangle.
    pub entries_per_triangle: f64,
    /// Entries of the index buffers that changed.
    pub entries_written: usize,
    /// Number of strips.
    pub strips: usize,
    /// Time that the cut and its strips took, in seconds.
    pub seconds: f64,
    /// Number of triangles of the cut that are not drawn; `None` if they were not compared.
    pub missing: Option<usize>,
    /// Number of triangles drawn that the cut does not have; `None` if they were not compared.
    pub extra: Option<usize>,
}

/// Follows cuts of a model by queries in turn, and repairs the strips and index buffers where each
/// cut differs from the last.
///
/// Queries are about the levels, as
/// [`ModelScene::query_of_levels`](crate::model::ModelScene::query_of_levels) makes them.
///
/// # Errors
/// A query that is invalid.
pub fn follow_strips(
    model: &Implicit,
    queries: &[Query<'_>],
    request: &FollowRequest,
    watch: &dyn Watch,
) -> Result<FollowReport, JobError> {
    let mut cut = Cut::new(model);
    let mut strips = None;
    let mut cuts = Vec::new();
    for query in queries {
        begin(watch, "following")?;
        let start = Instant::now();
        let limits = UpdateLimits::default();
        cut.update(query, &limits).map_err(|error| JobError::request("", error))?;
        let changed = update((model, &cut), request, &mut strips);
        let time = start.elapsed();
        if let Some((strips, indices)) = &strips {
            let difference = request.verify.then(|| strips.difference(model, &cut));
            cuts.push(FollowedCut::of(changed, &cut, (strips, indices), difference, time));
        }
    }
    let is_right = !cuts.iter().any(FollowedCut::is_wrong);
    Ok(FollowReport { effort: request.effort, cuts, verified: request.verify.then_some(is_right) })
}

/// Brings strips and index buffers up to date, and returns how many triangles have changed.
fn update(
    (model, cut): (&Implicit, &Cut<'_>),
    request: &FollowRequest,
    state: &mut Option<(CutStrips, StripIndices)>,
) -> usize {
    let Some((strips, indices)) = state else {
        let mut strips = CutStrips::new(model, cut, &options(request.quality), request.effort);
        let indices = strips.indices(model);
        *state = Some((strips, indices));
        return cut.face_count();
    };
    let changed = strips.update(cut);
    strips.update_indices(model, indices);
    changed
}

impl FollowedCut {
    fn of(
        changed: usize,
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

    /// Returns true if the strips were compared with the cut, and draw something else.
    pub fn is_wrong(&self) -> bool {
        [self.missing, self.extra].into_iter().flatten().any(|number| number > 0)
    }
}
