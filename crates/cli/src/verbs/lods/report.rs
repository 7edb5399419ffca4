//! Reports on a chain of levels: for people, for programs, and the guide for engines beside it.

use std::path::Path;
use std::time::Duration;

use meshlod::Method;
use meshlod::measure::Distance;
use meshlod::mesh::Bounds;
use serde::Serialize;
use serde_json::{Value, json};

use super::{ChainLayout, LodLevel, Lods};
use crate::options::topology::{self, ConditioningFigures};
use crate::session::files;
use crate::simplify_run::{ReadyScene, Simplified};
use crate::text::distance::DistanceFigures;
use crate::text::numbers::{count, percent, value};
use crate::text::simplify_report::{self, InputFigures, RunFigures};
use crate::text::table::aligned;

/// Figures of a chain for programs.
#[derive(Serialize)]
pub(super) struct LodsFigures {
    method: Option<Method>,
    input_faces: Option<usize>,
    levels: Vec<LodFigures>,
    #[serde(flatten)]
    input: Option<InputFigures>,
    #[serde(flatten)]
    run: Option<RunFigures>,
    #[serde(flatten)]
    conditioning: ConditioningFigures,
    layout: &'static str,
    guide: String,
}

#[derive(Serialize)]
struct LodFigures {
    size: String,
    faces: usize,
    reached: bool,
    error_estimate: f64,
    error_measured: Option<DistanceFigures>,
    volume_residual: Option<f64>,
    screen_coverage: f64,
    file: Option<String>,
}

impl From<&LodLevel> for LodFigures {
    fn from(level: &LodLevel) -> Self {
        let Simplified { report, measured, .. } = &level.simplified;
        Self {
            size: level.size.to_string(),
            faces: report.output_faces,
            reached: report.reached,
            error_estimate: report.error_estimate,
            error_measured: measured.as_ref().map(DistanceFigures::from),
            volume_residual: level.volume_residual,
            screen_coverage: level.screen_coverage,
            file: level.file.as_deref().map(files::name),
        }
    }
}

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

    pub(super) fn figures(
        &self,
        chain: &[LodLevel],
        ready: &ReadyScene<'_>,
        (layout, time): (ChainLayout, Duration),
    ) -> LodsFigures {
        // A chain is one run, and its last report is that of the whole run.
        let report = chain.last().map(|level| &level.simplified.report);
        LodsFigures {
            method: report.map(|report| report.method),
            input_faces: report.map(|report| report.input_faces),
            levels: chain.iter().map(LodFigures::from).collect(),
            input: report.map(|report| InputFigures::of(report, time)),
            run: report.map(RunFigures::from),
            conditioning: ConditioningFigures::of(&ready.scene),
            layout: layout.name(),
            guide: files::name(&self.guide_file()),
        }
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
