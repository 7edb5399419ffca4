//! Figures of strips for programs.

use clap::ValueEnum;
use meshlod::jobs::KeptError;
use meshlod::mesh::Connectivity;
use meshlod::strip::StripStatistics;
use serde::Serialize;

use super::{Strip, StripSource, StrippedLevel};
use crate::options::fuse::FuseReport;
use crate::session::files;

/// Figures of the strips of all levels.
#[derive(Serialize)]
pub(super) struct StripFigures {
    file: String,
    input_faces: usize,
    fused: Option<FuseReport>,
    degenerate_faces: usize,
    duplicate_faces: usize,
    non_manifold_edges: usize,
    inconsistent_edges: usize,
    filter: Option<String>,
    quality: Option<String>,
    effort: Option<String>,
    levels: Vec<StrippedFigures>,
    simplify_seconds: f64,
    strip_seconds: Option<f64>,
    verified: Option<bool>,
    out: Option<String>,
    error: Option<KeptError>,
}

#[derive(Serialize)]
struct StrippedFigures {
    size: String,
    reached: bool,
    triangles: usize,
    vertices_sent: usize,
    indices_with_restart: usize,
    strips: usize,
    swaps: usize,
    acmr16: f64,
    acmr32: f64,
    seconds: f64,
    missing: Option<usize>,
    extra: Option<usize>,
}

impl Strip {
    pub(super) fn figures(
        &self,
        source: &StripSource,
        levels: &[StrippedLevel],
        error: Option<KeptError>,
    ) -> StripFigures {
        let mesh = &source.input.mesh;
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        let degenerate_faces = connectivity.degenerate_faces();
        let left_out = mesh.faces.len() - source.tree.faces().len();
        StripFigures {
            file: files::name(&self.input),
            input_faces: source.input.input_faces(),
            fused: source.input.fused,
            degenerate_faces,
            duplicate_faces: left_out - degenerate_faces,
            non_manifold_edges: connectivity.non_manifold_edges(),
            inconsistent_edges: connectivity.inconsistent_edges(),
            filter: self.filter.as_ref().and_then(name),
            quality: name(&self.quality),
            effort: name(&self.effort),
            levels: levels.iter().map(StrippedFigures::from).collect(),
            simplify_seconds: source.simplify_time.as_secs_f64(),
            strip_seconds: source.skip.as_ref().map(|_| source.strip_time.as_secs_f64()),
            verified: self.verify.then(|| !levels.iter().any(StrippedLevel::is_wrong)),
            out: self.out.as_deref().map(files::name),
            error,
        }
    }
}

impl From<&StrippedLevel> for StrippedFigures {
    fn from(level: &StrippedLevel) -> Self {
        let StripStatistics { vertices_sent, indices_with_restart, strips, swaps, .. } = level.sent;
        Self {
            size: level.size.to_string(),
            reached: level.reached,
            triangles: level.triangles,
            vertices_sent,
            indices_with_restart,
            strips,
            swaps,
            acmr16: level.sent.acmr16,
            acmr32: level.sent.acmr32,
            seconds: level.time.as_secs_f64(),
            missing: level.difference.map(|difference| difference.missing),
            extra: level.difference.map(|difference| difference.extra),
        }
    }
}

/// Returns the name of an argument's value on the command line.
pub(super) fn name(argument: &impl ValueEnum) -> Option<String> {
    argument.to_possible_value().map(|value| value.get_name().to_owned())
}
