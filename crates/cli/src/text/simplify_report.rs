//! Reports of a simplification, as text.

use std::time::Duration;

use meshlod::jobs::{LostVolume, SimplifyReport};
use meshlod::scene::FlatFaces;
use meshlod::simplify::{HandleCounts, Refusal};
use meshlod::{Report, Topology};

use crate::text::numbers::{count, faces, percent, value};
use crate::text::stuck::Stuck;

/// Relative change of volume up to which the text does not mention it.
const UNSEEN: f64 = 1e-4;

/// Formats a line that explains why the target of a simplification was missed, and what would help.
pub fn why_not_reached(report: &Report, topology: Topology, stuck: Stuck) -> String {
    let mut line = format!(
        "target not reached: no further contraction is possible at {} (refused: {})",
        faces(report.output_faces),
        report.refusals,
    );
    for advice in advice(report, topology, stuck) {
        line += "; ";
        line += &advice;
    }
    line
}

/// Returns what would let a simplification go on, by what has held it up.
fn advice(report: &Report, topology: Topology, stuck: Stuck) -> Vec<String> {
    let refused = |refusal: Refusal| report.refusals.count(refusal) > 0;
    let by_topology = [Refusal::NonManifold, Refusal::Link, Refusal::LastFaces];
    let held = report.held.locked + report.held.tied;
    let mut advice = Vec::new();
    if topology == Topology::Keep
        && (report.non_manifold_vertices > 0 || by_topology.into_iter().any(refused))
    {
        advice.push("--topology free would let components vanish and places come apart".into());
    }
    if stuck.holes > 0 && refused(Refusal::Link) {
        let holes = if stuck.holes == 1 { "hole stays" } else { "holes stay" };
        advice.push(format!("{} {holes}: repair --holes N closes holes", count(stuck.holes)));
    }
    if stuck.by_meshes() && (refused(Refusal::Link) || refused(Refusal::LastFaces)) {
        let meshes = count(stuck.meshes);
        advice
            .push(format!("each of {meshes} meshes keeps a face: convert to .ply makes them one"));
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
    let HandleCounts { before, closed } = report.handles.unwrap_or_default();
    line(closed, ["handle", "handles"], &format!("closed, of {}", count(before)));
    if report.near_limit && report.reached {
        text +=
            "near_limit: most of the model is as coarse as it can be, and the rest has moved far ";
        text += "for it; ask for more faces\n";
    }
    text
}

/// Formats the line with the volume that a run has lost, and what would restore it.
pub fn lost_volume(lost: &LostVolume) -> String {
    let part = |relative: f64| percent(100.0 * relative);
    let sign = if lost.part > 0.0 { "-" } else { "+" };
    let of_level = format!("{sign}{}", part(lost.part.abs()));
    let vanished = format!("{} in parts that vanished", part(lost.vanished));
    let all = match (lost.part.abs() < UNSEEN, lost.vanished < UNSEEN) {
        (true, false) => format!("-{vanished}"),
        (false, false) => format!("{of_level}, and another {vanished}"),
        _ => of_level,
    };
    let advice = match lost.is_restorable {
        true => "--exact-volume restores it",
        false => "more than --exact-volume can restore",
    };
    format!("volume: {all}; {advice}\n")
}

/// Formats the line with the faces of flats that went, and those that the shape needs; empty if
/// nothing is flat, unless nothing may move.
pub fn flats(report: &SimplifyReport, flats: FlatFaces) -> String {
    let is_exact = report.error.is_some_and(|error| error.asked == 0.0);
    let needed = faces(flats.needed);
    match (flats.gone, is_exact) {
        (0, true) => format!("flats: none; the shape needs {needed}\n"),
        (0, false) => String::new(),
        (gone, true) => format!("flats: {} went; the shape needs {needed}\n", faces(gone)),
        (gone, false) => {
            format!("flats: {} went; without an error the shape needs {needed}\n", faces(gone))
        }
    }
}

/// Formats the line with the simplification time.
pub fn seconds_line(time: Duration) -> String {
    format!("simplify_seconds: {}\n", value(time.as_secs_f64()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lost_volume_comes_with_what_can_be_done() {
        let lost = LostVolume { part: 0.01, vanished: 0.0, is_restorable: true };
        assert_eq!(lost_volume(&lost), "volume: -1%; --exact-volume restores it\n");
        let stuck = LostVolume { is_restorable: false, ..lost };
        assert_eq!(lost_volume(&stuck), "volume: -1%; more than --exact-volume can restore\n");
        let vanished = LostVolume { vanished: 0.005, ..lost };
        let expected =
            "volume: -1%, and another 0.5% in parts that vanished; --exact-volume restores it\n";
        assert_eq!(lost_volume(&vanished), expected);
    }
}
