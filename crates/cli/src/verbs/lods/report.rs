//! Reports on a chain of levels: for people, for programs, and the guide for engines beside it.

use std::path::{Path, PathBuf};

use meshlod::io::WrittenFile;
use meshlod::jobs::LodsReport;
use meshlod::measure::Distance;
use meshlod::mesh::Bounds;
use serde_json::{Value, json};

use super::{ChainLayout, Lods};
use crate::options::topology;
use crate::session::files;
use crate::text::numbers::{count, percent, value};
use crate::text::simplify_report;
use crate::text::table::aligned;

impl Lods {
    /// Describes all levels for engines: files, errors and from where on each is fine enough.
    pub(super) fn guide(&self, report: &LodsReport, bounds: &Bounds, layout: ChainLayout) -> Value {
        let camera = self.camera.camera();
        let level = |number: usize, faces: usize, file: Option<&Path>, error: Option<f64>| {
            let switch = error.map(|error| camera.switch(error, bounds));
            let coverage = |i: usize| report.levels[i].screen_coverage;
            json!({
                "name": format!("LOD{number}"),
                "faces": faces,
                "file": file.and_then(Path::file_name).map(|name| name.to_string_lossy()),
                "error_measured": error,
                "distance": switch.map(|switch| switch.distance),
                "screen_height": switch.map(|switch| switch.screen_height),
                "screen_diameter": switch.map(|switch| switch.screen_diameter),
                "screen_coverage": number.checked_sub(1).map_or(1.0, coverage),
            })
        };
        let finest = self.file_of(0, layout);
        let mut levels = vec![level(0, report.run.input_faces, Some(&finest), Some(0.0))];
        for ((i, coarse), file) in report.levels.iter().enumerate().zip(self.files(report, layout))
        {
            let error = coarse.measured.as_ref().map(Distance::max);
            levels.push(level(i + 1, coarse.run.output_faces, file.as_deref(), error));
        }
        let mut guide = self.camera.json(bounds);
        guide["version"] = 1.into();
        guide["input"] = files::name(&self.input).into();
        guide["layout"] = layout.name().into();
        guide["levels"] = levels.into();
        guide
    }

    /// Returns the report of the job with the files that are written; `all` are those of a layout
    /// that has many.
    pub(super) fn figures(
        &self,
        report: &LodsReport,
        layout: ChainLayout,
        all: &[WrittenFile],
    ) -> Value {
        let mut figures = json!(report);
        for (i, file) in self.files(report, layout).iter().enumerate() {
            figures["levels"][i]["file"] = json!(file.as_deref().map(files::name));
        }
        if layout == ChainLayout::Needle {
            let file = |file: &WrittenFile| json!({ "file": file.name, "bytes": file.bytes });
            figures["files"] = all.iter().map(file).collect();
        }
        figures["layout"] = layout.name().into();
        figures["guide"] = files::name(&self.guide_file()).into();
        figures
    }

    pub(super) fn text(
        &self,
        report: &LodsReport,
        layout: ChainLayout,
        all: &[WrittenFile],
    ) -> String {
        let mut text = aligned(&rows(report));
        text += "mean, RMS, max: measured distance from the input, in % of the diagonal\n";
        text += "coverage: the fraction of the screen below which the level is\n";
        text += &format!("{}\n", self.camera.text());
        text += &topology::to_text(&report.conditioning);
        text += &simplify_report::mesh_notes(&report.run);
        for level in report.levels.iter().filter(|level| level.is_same) {
            text += &format!("{}: not written, the same as the level before\n", level.size);
        }
        if layout == ChainLayout::Files {
            text += &format!("{}\n", files::name(&self.file_of(0, layout)));
        }
        let mut written: Vec<PathBuf> = self.files(report, layout).into_iter().flatten().collect();
        written.dedup();
        for file in written {
            text += &format!("{}\n", files::name(&file));
        }
        text += &parts_line(all);
        text += &format!("{}\n", files::name(&self.guide_file()));
        text + &simplify_report::seconds_line(report.time)
    }

    /// Returns the file that holds each level; `None` for one that is not written.
    fn files(&self, report: &LodsReport, layout: ChainLayout) -> Vec<Option<PathBuf>> {
        let levels = report.levels.iter().enumerate();
        levels.map(|(i, level)| (!level.is_same).then(|| self.file_of(i + 1, layout))).collect()
    }
}

/// Counts the files beside the first: `12 files, 34,567 bytes, in NAME_levels`.
fn parts_line(all: &[WrittenFile]) -> String {
    let parts = all.get(1..).unwrap_or_default();
    let folder = parts.last().and_then(|file| Some(file.name.rsplit_once('/')?.0));
    let Some(folder) = folder else { return String::new() };
    let bytes: usize = parts.iter().map(|file| file.bytes).sum();
    let (number, bytes) = (count(parts.len()), count(bytes));
    let plural = if parts.len() == 1 { "" } else { "s" };
    format!("{number} file{plural}, {bytes} bytes, in {folder}\n")
}

fn rows(report: &LodsReport) -> Vec<[String; 7]> {
    let input_faces = count(report.run.input_faces);
    let mut rows = vec![
        ["level", "target", "faces", "mean", "RMS", "max", "coverage"].map(String::from),
        ["LOD0", "", &input_faces, "", "", "", ""].map(String::from),
    ];
    for (i, level) in report.levels.iter().enumerate() {
        let cell = |length: fn(&Distance) -> f64| {
            let distance = level.measured.as_ref();
            distance.map_or("-".into(), |d| percent(d.percent(length(d))))
        };
        rows.push([
            format!("LOD{}", i + 1),
            level.size.clone(),
            count(level.run.output_faces),
            cell(Distance::mean),
            cell(Distance::rms),
            cell(Distance::max),
            value(level.screen_coverage),
        ]);
    }
    rows
}
