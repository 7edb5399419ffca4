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

    pub(super) fn compared(&mut self, Difference { missing, extra }: Difference) {
        (self.missing, self.extra) = (Some(missing), Some(extra));
    }

    /// Returns true if the strips were compared with the level, and draw something else.
    pub fn is_wrong(&self) -> bool {
        [self.missing, self.extra].into_iter().flatten().any(|faces| faces > 0)
    }
}

/// Counts what is odd about the faces of a mesh: degenerate and duplicate faces, non-manifold and
/// inconsistent edges.
pub(super) fn odd_faces(mesh: &Mesh, tree: &MergeTree) -> [usize; 4] {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let degenerate = connectivity.degenerate_faces();
    let left_out = mesh.faces.len() - tree.faces().len();
    let [non_manifold, inconsistent] =
        [connectivity.non_manifold_edges(), connectivity.inconsistent_edges()];
    [degenerate, left_out - degenerate, non_manifold, inconsistent]
}
