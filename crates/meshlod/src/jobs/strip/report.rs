//! The report on strips.

use std::time::Duration;

use meshlod_mesh::{Connectivity, Mesh};
use meshlod_strip::{Difference, MergeTree, StripEffort, StripStatistics};

use super::StripFilter;
use crate::scene::FuseReport;

/// Report of [`strip`](super::strip).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StripReport {
    /// Number of faces before fusing.
    pub input_faces: usize,
    /// True if each mesh was stripped once, however many nodes show it. All counts are of what is
    /// shown, but for missing and extra triangles.
    pub each_mesh_once: bool,
    /// Changes made by fusing, if it was asked for.
    pub fused: Option<FuseReport>,
    /// Number of degenerate faces, which are left out.
    pub degenerate_faces: usize,
    /// Number of faces that repeat another one, which are left out.
    pub duplicate_faces: usize,
    /// Number of edges with more than two faces.
    pub non_manifold_edges: usize,
    /// Number of edges whose two faces have opposite orientations.
    pub inconsistent_edges: usize,
    /// Filter that shortened the strips of the whole mesh.
    pub filter: Option<StripFilter>,
    /// Quality of the strips: `fast` or `best`.
    pub quality: &'static str,
    /// Effort of repairs.
    pub effort: StripEffort,
    /// Strips of each level, in the order of the request.
    pub levels: Vec<StrippedLevelReport>,
    /// Time that simplification took, in seconds; 0 if there was none.
    pub simplify_seconds: f64,
    /// Time that the strips of the whole mesh took, in seconds; `None` if each level has its own.
    pub strip_seconds: Option<f64>,
    /// True if the strips draw exactly the faces of all levels; `None` if they were not compared.
    pub verified: Option<bool>,
}

/// Strips of a level.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StrippedLevelReport {
    /// Size that was asked for.
    pub size: String,
    /// True if the level has no more faces than that.
    pub reached: bool,
    /// Number of faces of the level.
    pub triangles: usize,
    /// Number of vertices sent if each strip is drawn by a call of its own.
    pub vertices_sent: usize,
    /// Number of indices sent with restarts between strips.
    pub indices_with_restart: usize,
    /// Number of strips.
    pub strips: usize,
    /// Number of degenerate triangles inside strips.
    pub swaps: usize,
    /// Vertices fetched per triangle with a cache of 16.
    pub acmr16: f64,
    /// Vertices fetched per triangle with a cache of 32.
    pub acmr32: f64,
    /// Time that the strips took, in seconds.
    pub seconds: f64,
    /// Number of faces of the level that the strips do not draw; `None` if they were not compared.
    pub missing: Option<usize>,
    /// Number of triangles drawn that the level does not have; `None` if they were not compared.
    pub extra: Option<usize>,
}

impl StrippedLevelReport {
    pub(super) fn new(
        (size, faces): (String, usize),
        triangles: usize,
        sent: &StripStatistics,
        time: Duration,
    ) -> Self {
        Self {
            size,
            reached: triangles <= faces,
            triangles,
            vertices_sent: sent.vertices_sent,
            indices_with_restart: sent.indices_with_restart,
            strips: sent.strips,
            swaps: sent.swaps,
            acmr16: sent.acmr16,
            acmr32: sent.acmr32,
            seconds: time.as_secs_f64(),
            missing: None,
            extra: None,
        }
    }

    /// Replaces the counts by those of all instances, for a level of at most so many faces.
    pub(super) fn show(&mut self, faces: usize, triangles: usize, sent: &StripStatistics) {
        let (size, time) = (std::mem::take(&mut self.size), Duration::from_secs_f64(self.seconds));
        let (missing, extra) = (self.missing, self.extra);
        *self = Self { missing, extra, ..Self::new((size, faces), triangles, sent, time) };
    }

    pub(super) fn compared(&mut self, Difference { missing, extra }: Difference) {
        (self.missing, self.extra) = (Some(missing), Some(extra));
    }

    /// Returns true if the strips were compared with the level, and draw something else.
    pub fn is_wrong(&self) -> bool {
        [self.missing, self.extra].into_iter().flatten().any(|faces| faces > 0)
    }
}

/// Counts of what is odd about the faces of a mesh.
#[derive(Clone, Copy, Default)]
pub(super) struct Odd {
    pub degenerate: usize,
    pub duplicate: usize,
    pub non_manifold_edges: usize,
    pub inconsistent_edges: usize,
}

impl Odd {
    /// Counts what is odd about a mesh of which so many faces have no strips.
    pub fn of(connectivity: &Connectivity, left_out: usize) -> Self {
        let degenerate = connectivity.degenerate_faces();
        Self {
            degenerate,
            duplicate: left_out - degenerate,
            non_manifold_edges: connectivity.non_manifold_edges(),
            inconsistent_edges: connectivity.inconsistent_edges(),
        }
    }

    /// Counts what is odd about a mesh, all of whose faces with strips are in a tree.
    pub fn of_mesh(mesh: &Mesh, tree: &MergeTree) -> Self {
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        Self::of(&connectivity, mesh.faces.len() - tree.faces().len())
    }

    /// Adds a mesh that is shown a number of times.
    pub fn add(&mut self, own: &Self, times: usize) {
        self.degenerate += times * own.degenerate;
        self.duplicate += times * own.duplicate;
        self.non_manifold_edges += times * own.non_manifold_edges;
        self.inconsistent_edges += times * own.inconsistent_edges;
    }
}
