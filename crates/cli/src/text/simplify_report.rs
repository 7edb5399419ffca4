//! Reports of a simplification, as JSON and text.

use std::time::Duration;

use meshlod::simplify::{Contractions, Held, Refusal, Refusals};
use meshlod::{Report, Topology};
use serde::Serialize;

use crate::text::numbers::{count, faces, value};

/// Numbers of edges and faces contracted, with the share of edges.
#[derive(Serialize)]
pub struct ContractionFigures {
    #[serde(flatten)]
    contractions: Contractions,
    edge_share: Option<f64>,
}

impl From<Contractions> for ContractionFigures {
    fn from(contractions: Contractions) -> Self {
        Self { contractions, edge_share: contractions.edge_share() }
    }
}

/// Time that a run took, and what its input had that is left out or kept in place.
#[derive(Serialize)]
pub struct InputFigures {
    simplify_seconds: f64,
    degenerate_faces: usize,
    duplicate_faces: usize,
    non_manifold_vertices: usize,
}

impl InputFigures {
    pub fn of(report: &Report, time: Duration) -> Self {
        let Report { degenerate_faces, duplicate_faces, non_manifold_vertices, .. } = *report;
        let simplify_seconds = time.as_secs_f64();
        Self { simplify_seconds, degenerate_faces, duplicate_faces, non_manifold_vertices }
    }
}

/// Vertices that a run held, components that vanished, and contractions that were refused.
#[derive(Serialize)]
pub struct RunFigures {
    held: Held,
    vanished: usize,
    vanished_volume: f64,
    refusals: Refusals,
}

impl From<&Report> for RunFigures {
    fn from(report: &Report) -> Self {
        let Report { held, vanished, refusals, volume, .. } = *report;
        Self { held, vanished, vanished_volume: volume.vanished, refusals }
    }
}

/// Formats a line that explains why the target of a simplification was missed, and what would help.
pub fn why_not_reached(report: &Report, topology: Topology) -> String {
    let mut line = format!(
        "target not reached: no further contraction is possible at {} (refused: {})",
        faces(report.output_faces),
        report.refusals,
    );
    for advice in advice(report, topology) {
        line += "; ";
        line += &advice;
    }
    line
}

/// Returns what would let a simplification go on, by what has held it up.
fn advice(report: &Report, topology: Topology) -> Vec<String> {
    let refused = |refusal: Refusal| report.refusals.count(refusal) > 0;
    let by_topology = [Refusal::NonManifold, Refusal::Link, Refusal::LastFaces];
    let held = report.held.locked + report.held.tied;
    let mut advice = Vec::new();
    if topology == Topology::Keep
        && (report.non_manifold_vertices > 0 || by_topology.into_iter().any(refused))
    {
        advice.push("--topology free would let components vanish and places come apart".into());
    }
    if held > 0 && (refused(Refusal::Locked) || refused(Refusal::Tied)) {
        let vertices = if held == 1 { "vertex is" } else { "vertices are" };
        let held = count(held);
        advice.push(format!("{held} {vertices} locked or tied: fewer locks would help"));
    }
    if refused(Refusal::Boundary) {
        advice.push("--weld EPS would close borders that lie near each other".into());
    }
    if refused(Refusal::Seam) {
        advice.push("fewer texture charts and materials would help".into());
    }
    if refused(Refusal::Disproportion) {
        advice.push("what is left would destroy the shape: keep more faces".into());
    }
    if advice.is_empty() {
        advice.push(format!("ask for {} or more", faces(report.output_faces)));
    }
    advice
}

/// Formats lines about faces left out and vertices kept in place; empty if there are neither.
pub fn mesh_notes(report: &Report) -> String {
    let mut text = String::new();
    let mut line = |number: usize, nouns: [&str; 2], what: &str| {
        let noun = nouns[usize::from(number != 1)];
        if number > 0 {
            text.push_str(&format!("{} {noun} {what}\n", count(number)));
        }
    };
    line(
        report.degenerate_faces,
        ["degenerate face", "degenerate faces"],
        "left out, as repair does",
    );
    line(report.duplicate_faces, ["duplicate face", "duplicate faces"], "left out, as repair does");
    let vertices = ["vertex", "vertices"];
    let non_manifold = ["non-manifold vertex", "non-manifold vertices"];
    line(report.non_manifold_vertices, non_manifold, "kept in place; repair would divide them");
    line(report.held.locked, vertices, "locked");
    line(report.held.protected, vertices, "protected");
    line(report.held.tied, vertices, "tied to others");
    let volume = report.volume.vanished;
    let removed = match volume > 0.0 {
        true => format!("removed, with a volume of {}", value(volume)),
        false => "removed".into(),
    };
    line(report.vanished, ["component", "components"], &removed);
    text
}

/// Formats the line with the simplification time.
pub fn seconds_line(time: Duration) -> String {
    format!("simplify_seconds: {}\n", value(time.as_secs_f64()))
}
