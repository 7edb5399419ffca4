//! Answer of `flock --evaluate`, and its file for programs.

use std::path::Path;

use meshlod_school::evaluate::Interval;
use serde_json::{Value, json};

use crate::flock::evaluate::{BUDGET, FLIPS, OURS, OURS_VISIBLE, Report, SCREEN_ERROR};
use crate::session::files;
use crate::text::numbers::count;
use crate::text::table::aligned;

/// Pairs of arms whose triangles at equal image error are compared.
pub const PAIRS: [[&str; 2]; 5] = [
    [OURS, SCREEN_ERROR],
    [OURS_VISIBLE, SCREEN_ERROR],
    [OURS, BUDGET],
    ["paper, occluded skipped", SCREEN_ERROR],
    ["screen-error, facing chains", "screen-error"],
];

/// Returns the names of the arms in the order of the evaluation.
pub fn arms(report: &Report<'_>) -> Vec<String> {
    let mut arms: Vec<String> = Vec::new();
    for row in &report.evaluation.rows {
        if !arms.contains(&row.arm) {
            arms.push(row.arm.clone());
        }
    }
    arms
}

/// Returns the triangles that an arm needs for an image error over those of full detail, as a mean
/// over the scenes, if it reaches the error in all of them.
pub fn needed_share(report: &Report<'_>, arm: &str, flip: f64) -> Option<f64> {
    let full = &report.evaluation.full_triangles;
    let needed = report.evaluation.needed.iter();
    let of_arm = needed.filter(|needed| needed.arm == arm && needed.flip == flip);
    let share = |needed: &meshlod_school::evaluate::Needed| {
        let (_, full) = full.iter().find(|(scene, _)| *scene == needed.scene)?;
        Some(needed.triangles? / full)
    };
    let shares: Option<Vec<f64>> = of_arm.map(share).collect();
    shares.filter(|s| !s.is_empty()).map(|s| s.iter().sum::<f64>() / s.len() as f64)
}

/// Returns the object that is printed.
pub fn json(report: &Report<'_>, folder: &Path) -> Value {
    let arm = |arm: String| {
        let needed = |flip: f64| json!({ "flip": flip, "share": needed_share(report, &arm, flip) });
        json!({ "arm": arm, "needed": FLIPS.map(needed) })
    };
    let ratio = |[arm, other]: [&str; 2]| {
        let at =
            |flip: f64| json!({ "flip": flip, "ratio": report.evaluation.ratio(arm, other, flip) });
        json!({ "arm": arm, "over": other, "at": FLIPS.map(at) })
    };
    json!({
        "model": report.model.name,
        "faces": report.model.faces,
        "members": report.members,
        "size": report.size,
        "quick": report.is_quick,
        "floors": report.evaluation.floors,
        "full_triangles": report.evaluation.full_triangles,
        "arms": arms(report).into_iter().map(arm).collect::<Vec<_>>(),
        "ratios": PAIRS.map(ratio),
        "out": files::name(folder),
    })
}

/// Returns everything that was measured.
pub fn full_json(report: &Report<'_>) -> Value {
    json!({
        "model": report.model.name,
        "members": report.members,
        "size": report.size,
        "quick": report.is_quick,
        "evaluation": report.evaluation,
        "over_time": report.tracks,
        "seconds_per_frame": report.frame_s,
    })
}

/// Returns a share in percent, or a dash.
pub fn share_text(share: Option<f64>) -> String {
    share.map_or("-".into(), |share| format!("{:.1} %", 100.0 * share))
}

/// Returns a ratio with its interval, or a dash.
pub fn ratio_text(ratio: Option<Interval>) -> String {
    ratio.map_or("-".into(), |r| format!("{:.2} ({:.2} to {:.2})", r.mean, r.low, r.high))
}

pub fn text(report: &Report<'_>, folder: &Path) -> String {
    let head = ["arm", "FLIP 0.01", "FLIP 0.02", "FLIP 0.05"].map(String::from);
    let row = |arm: String| {
        let [a, b, c] = FLIPS.map(|flip| share_text(needed_share(report, &arm, flip)));
        [arm, a, b, c]
    };
    let rows: Vec<_> = std::iter::once(head).chain(arms(report).into_iter().map(row)).collect();
    let mut text = format!(
        "{} members of {}, {} scenes: triangles needed for an image error, of those of full detail\n",
        count(report.members),
        report.model.name,
        report.evaluation.full_triangles.len()
    );
    text += &aligned(&rows);
    text += "-: not reached in every scene\n";
    for [arm, other] in PAIRS {
        let ratio = ratio_text(report.evaluation.ratio(arm, other, 0.02));
        text += &format!("{arm} / {other} at FLIP 0.02: {ratio}\n");
    }
    text + &format!("{}\n", files::name(&folder.join("index.html")))
}
