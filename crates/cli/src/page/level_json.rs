//! Measurements of a simplified mesh as JSON.

use meshlod::Method;
use serde_json::{Value, json};

use crate::distance;
use crate::page::chain::Level;
use crate::page::counts::Counts;
use crate::parse::LevelSize;
use crate::simplify_report::{contractions_json, refusals_json};
use crate::volume::unconserved_json;

/// Returns the measurements of a level as JSON. The change of volume is `null` if the original mesh
/// is open, and the unconserved volume if the method does not conserve it.
pub fn level_json(method: Method, level: &Level, input: &Counts) -> Value {
    let report = &level.report;
    json!({
        "size": level.size.to_string(),
        "ratio": match level.size {
            LevelSize::Ratio(ratio) => Some(ratio),
            LevelSize::Faces(_) => None,
        },
        "faces": report.output_faces,
        "reached": report.reached,
        "closed": level.counts.closed,
        "genus": level.counts.genus,
        "components": level.counts.components,
        "area": level.counts.area,
        "volume": level.counts.volume,
        "volume_change_percent": level.volume_change(input),
        "volume_running_sum": report.volume.lost(),
        "volume_not_conserved": unconserved_json(method, &report.volume),
        "quality_mean": level.quality.map(|quality| quality.mean),
        "quality_min": level.quality.map(|quality| quality.min),
        "flip": level.flip,
        "error_estimate": report.error_estimate,
        "error_measured": level.measured.as_ref().ok().map(distance::to_json),
        "not_measured": level.measured.as_ref().err(),
        "simplify_seconds": level.time.as_secs_f64(),
        "contractions": contractions_json(report),
        "refusals": refusals_json(report),
    })
}
