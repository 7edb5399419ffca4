//! Reports on a chain of levels: for people, for programs, and the guide for engines beside it.

use std::path::Path;
use std::time::Duration;

use meshlod::measure::Distance;
use meshlod::mesh::Bounds;
use serde_json::{Value, json};

use super::{ChainLayout, LodLevel, Lods};
use crate::distance;
use crate::files;
use crate::locks;
use crate::numbers::{count, percent, value};
use crate::simplify_report;
use crate::simplify_run::{ReadyScene, Simplified};
use crate::table::aligned;
use crate::topology;

impl Lods {
    /// Describes all levels for engines: files, errors and from where on each is fine enough.
    pub(super) fn guide(&self, chain: &[LodLevel], bounds: &Bounds, layout: ChainLayout) -> Value {
        let level = |number: usize, faces: usize, file: Option<&Path>, error: Option<f64>| {
            let switch = error.map(|error| self.camera.switch(error, bounds));
            json!({
                "name": format!("LOD{number}"),
                "faces": faces,
                "file": file.and_then(Path::file_name).map(|name| name.to_string_lossy()),
                "error_measured": error,
                "distance": switch.map(|switch| switch.distance),
                "screen_height": switch.map(|switch| switch.screen_height),
                "screen_diameter": switch.map(|switch| switch.screen_diameter),
                "screen_coverage": number.checked_sub(1).map_or(1.0, |i| chain[i].screen_coverage),
            })
        };
        let input = chain.first().map_or(0, |level| level.simplified.report.input_faces);
        let finest = self.file_of(0, layout);
        let mut levels = vec![level(0, input, Some(&finest), Some(0.0))];
        for (i, coarse) in chain.iter().enumerate() {
            let Simplified { report, measured, .. } = &coarse.simplified;
            let error = measured.as_ref().map(Distance::max);
            levels.push(level(i + 1, report.output_faces, coarse.file.as_deref(), error));
        }
        let mut guide = self.camera.json(bounds);
        guide["version"] = 1.into();
        guide["input"] = files::name(&self.input).into();
        guide["layout"] = layout.name().into();
        guide["levels"] = levels.into();
        guide
    }

    pub(super) fn json(&self, chain: &[LodLevel], time: Duration) -> Value {
        let level = |level: &LodLevel| {
            let report = &level.simplified.report;
            json!({
                "size": level.size.to_string(),
                "faces": report.output_faces,
                "reached": report.reached,
                "error_estimate": report.error_estimate,
                "error_measured": level.simplified.measured.as_ref().map(distance::to_json),
                "volume_residual": level.volume_residual,
                "screen_coverage": level.screen_coverage,
                "file": level.file.as_deref().map(files::name),
            })
        };
        let report = chain.last().map(|level| &level.simplified.report);
        json!({
            "method": report.map(|report| report.method.name()),
            "input_faces": report.map(|report| report.input_faces),
            "levels": chain.iter().map(level).collect::<Vec<_>>(),
            "simplify_seconds": time.as_secs_f64(),
            "degenerate_faces": report.map(|report| report.degenerate_faces),
            "duplicate_faces": report.map(|report| report.duplicate_faces),
            "non_manifold_vertices": report.map(|report| report.non_manifold_vertices),
            "held": report.map(locks::to_json),
            "vanished": report.map(|report| report.vanished),
            "vanished_volume": report.map(|report| report.volume.vanished),
            "refusals": report.map(simplify_report::refusals_json),
        })
    }

    pub(super) fn text(
        &self,
        chain: &[LodLevel],
        ready: &ReadyScene<'_>,
        (layout, time): (ChainLayout, Duration),
    ) -> String {
        let input_faces = chain.first().map_or(0, |level| level.simplified.report.input_faces);
        let mut rows = vec![
            ["level", "target", "faces", "mean", "RMS", "max", "coverage"].map(String::from),
            ["LOD0", "", &count(input_faces), "", "", "", ""].map(String::from),
        ];
        for (i, level) in chain.iter().enumerate() {
            let cell = |length: fn(&Distance) -> f64| {
                let distance = level.simplified.measured.as_ref();
                distance.map_or("-".into(), |d| percent(d.percent(length(d))))
            };
            rows.push([
                format!("LOD{}", i + 1),
                level.size.to_string(),
                count(level.simplified.report.output_faces),
                cell(Distance::mean),
                cell(Distance::rms),
                cell(Distance::max),
                value(level.screen_coverage),
            ]);
        }
        let notes = chain.last().map(|level| simplify_report::mesh_notes(&level.simplified.report));
        let mut text = aligned(&rows);
        text += "mean, RMS, max: measured distance from the input, in % of the diagonal\n";
        text += "coverage: the fraction of the screen below which the level is\n";
        text += &format!("{}\n", self.camera.text());
        text += &topology::to_text(&ready.scene);
        text += &notes.unwrap_or_default();
        for level in chain.iter().filter(|level| level.file.is_none()) {
            text += &format!("{}: not written, the same as the level before\n", level.size);
        }
        if layout == ChainLayout::Files {
            text += &format!("{}\n", files::name(&self.file_of(0, layout)));
        }
        for file in written(chain) {
            text += &format!("{}\n", files::name(file));
        }
        text += &format!("{}\n", files::name(&self.guide_file()));
        text + &simplify_report::seconds_line(time)
    }
}

/// Lists the files written, each once.
fn written(chain: &[LodLevel]) -> Vec<&Path> {
    let mut files: Vec<&Path> = chain.iter().filter_map(|level| level.file.as_deref()).collect();
    files.dedup();
    files
}
