//! Measurements of a simplified mesh, under the keys of JSON.

use meshlod::Method;
use meshlod::jobs::figures::{ContractionFigures, DistanceFigures, VolumeNotConserved};
use meshlod::simplify::Refusals;
use serde::Serialize;

use crate::options::parse::LevelSize;
use crate::page::chain::Level;
use crate::page::counts::Counts;

/// Measurements of a level for programs.
#[derive(Serialize)]
pub struct LevelFigures {
    size: String,
    ratio: Option<f64>,
    faces: usize,
    reached: bool,
    closed: bool,
    genus: Option<usize>,
    components: usize,
    area: f64,
    volume: f64,
    /// `None` if the original mesh is open.
    volume_change_percent: Option<f64>,
    volume_running_sum: f64,
    /// `None` if the method does not conserve the volume.
    volume_not_conserved: Option<VolumeNotConserved>,
    quality_mean: Option<f64>,
    quality_min: Option<f64>,
    flip: Option<f64>,
    error_estimate: f64,
    error_measured: Option<DistanceFigures>,
    /// Reason why there is no distance.
    not_measured: Option<String>,
    simplify_seconds: f64,
    contractions: ContractionFigures,
    refusals: Refusals,
    file: String,
}

impl LevelFigures {
    /// Returns the measurements of a level of `input` that was written to `file`.
    pub fn of(method: Method, level: &Level, input: &Counts, file: String) -> Self {
        let Level { report, counts, measured, .. } = level;
        Self {
            size: level.size.to_string(),
            ratio: match level.size {
                LevelSize::Ratio(ratio) => Some(ratio),
                LevelSize::Faces(_) => None,
            },
            faces: report.output_faces,
            reached: report.reached,
            closed: counts.closed,
            genus: counts.genus,
            components: counts.components,
            area: counts.area,
            volume: counts.volume,
            volume_change_percent: level.volume_change(input),
            volume_running_sum: report.volume.lost(),
            volume_not_conserved: VolumeNotConserved::of(method, &report.volume),
            quality_mean: level.quality.map(|quality| quality.mean),
            quality_min: level.quality.map(|quality| quality.min),
            flip: level.flip,
            error_estimate: report.error_estimate,
            error_measured: measured.as_ref().ok().map(DistanceFigures::from),
            not_measured: measured.as_ref().err().cloned(),
            simplify_seconds: level.time.as_secs_f64(),
            contractions: report.contractions.into(),
            refusals: report.refusals,
            file,
        }
    }
}
