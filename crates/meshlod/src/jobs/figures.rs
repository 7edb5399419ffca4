//! Parts of reports under the keys that the command prints with `--json`.

use meshlod_measure::{Bracket, CertifiedDistance, Distance, OneSidedDistance, Place};
use meshlod_mesh::Conditioning;
use meshlod_simplify::{
    Contractions, HandleCounts, Held, Method, Refusals, Report, Unconserved, VolumeLoss,
};
use serde::{Serialize, Serializer};

use crate::jobs::{LodReport, LodsReport, SimplifyReport};
use crate::scene::FuseReport;

/// A measured distance in each direction and combined, in model units and percent of the diagonal.
#[derive(Clone, Debug, Serialize)]
pub struct DistanceFigures {
    #[serde(flatten)]
    both: Lengths,
    diagonal: f64,
    forward: OneWay,
    backward: OneWay,
}

#[derive(Clone, Debug, Serialize)]
struct OneWay {
    #[serde(flatten)]
    lengths: Lengths,
    place: Place,
}

#[derive(Clone, Debug, Serialize)]
struct Lengths {
    mean: f64,
    rms: f64,
    max: f64,
    mean_percent: f64,
    rms_percent: f64,
    max_percent: f64,
}

impl From<&Distance> for DistanceFigures {
    fn from(distance: &Distance) -> Self {
        let lengths = |[mean, rms, max]: [f64; 3]| {
            let [mean_percent, rms_percent, max_percent] =
                [mean, rms, max].map(|length| distance.percent(length));
            Lengths { mean, rms, max, mean_percent, rms_percent, max_percent }
        };
        let way = |way: &OneSidedDistance| OneWay {
            lengths: lengths([way.mean, way.rms, way.max]),
            place: way.place,
        };
        Self {
            both: lengths([distance.mean(), distance.rms(), distance.max()]),
            diagonal: distance.diagonal,
            forward: way(&distance.forward),
            backward: way(&distance.backward),
        }
    }
}

/// Writes a measured distance as [`DistanceFigures`].
pub(super) fn distance<S: Serializer>(distance: &Distance, to: S) -> Result<S::Ok, S::Error> {
    DistanceFigures::from(distance).serialize(to)
}

/// Bounds of the maximum distance in each direction and combined, in model units and percent of the
/// diagonal.
#[derive(Serialize)]
struct CertifiedFigures {
    #[serde(flatten)]
    both: BracketFigures,
    forward: BracketFigures,
    backward: BracketFigures,
}

#[derive(Serialize)]
struct BracketFigures {
    lower: f64,
    upper: f64,
    lower_percent: f64,
    upper_percent: f64,
    reached: bool,
    place: Place,
}

impl From<&CertifiedDistance> for CertifiedFigures {
    fn from(distance: &CertifiedDistance) -> Self {
        let way = |Bracket { lower, upper, place, reached, .. }: Bracket| {
            let [lower_percent, upper_percent] = [lower, upper].map(|l| distance.percent(l));
            BracketFigures { lower, upper, lower_percent, upper_percent, reached, place }
        };
        Self {
            both: way(distance.symmetric()),
            forward: way(distance.forward),
            backward: way(distance.backward),
        }
    }
}

/// Writes the bounds of a distance, if they were asked for, in percent too.
#[cfg(feature = "multires")]
pub(super) fn certified<S: Serializer>(
    distance: &Option<CertifiedDistance>,
    to: S,
) -> Result<S::Ok, S::Error> {
    distance.as_ref().map(CertifiedFigures::from).serialize(to)
}

/// Numbers of edges and faces contracted, with the share of edges.
#[derive(Clone, Debug, Serialize)]
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

/// Contractions that could not conserve the volume, with what they owed and the level was repaid.
#[derive(Clone, Debug, Serialize)]
pub struct VolumeNotConserved {
    at_boundaries: Unconserved,
    behind_boundary_cones: Option<f64>,
    held: Unconserved,
    owed: f64,
    repaid: f64,
}

impl VolumeNotConserved {
    /// Returns the figures of a run; `None` for a method that does not aim to conserve the volume.
    pub fn of(method: Method, loss: &VolumeLoss) -> Option<Self> {
        let VolumeLoss { at_boundaries, behind_boundary_cones, held, owed, repaid, .. } = *loss;
        let figures = Self { at_boundaries, behind_boundary_cones, held, owed, repaid };
        method.conserves_volume().then_some(figures)
    }
}

/// Time that a run took, and what its input had that is left out or kept in place.
#[derive(Clone, Debug, Serialize)]
struct InputFigures {
    simplify_seconds: f64,
    degenerate_faces: usize,
    duplicate_faces: usize,
    non_manifold_vertices: usize,
}

impl InputFigures {
    fn of(report: &Report, simplify_seconds: f64) -> Self {
        let Report { degenerate_faces, duplicate_faces, non_manifold_vertices, .. } = *report;
        Self { simplify_seconds, degenerate_faces, duplicate_faces, non_manifold_vertices }
    }
}

/// Vertices that a run held, components that vanished, and contractions that were refused.
#[derive(Clone, Debug, Serialize)]
struct RunFigures {
    held: Held,
    vanished: usize,
    vanished_volume: f64,
    handles: Option<HandleCounts>,
    near_limit: bool,
    refusals: Refusals,
}

impl From<&Report> for RunFigures {
    fn from(report: &Report) -> Self {
        let Report { held, vanished, handles, near_limit, refusals, volume, .. } = *report;
        let vanished_volume = volume.vanished;
        Self { held, vanished, vanished_volume, handles, near_limit, refusals }
    }
}

/// Numbers of edges and vertices that conditioning has changed in a scene.
#[derive(Clone, Debug, Serialize)]
struct ConditioningFigures {
    stitched_edges: usize,
    stitched_vertices: usize,
    split_vertices: usize,
}

impl From<Conditioning> for ConditioningFigures {
    fn from(counts: Conditioning) -> Self {
        let Conditioning { stitched_edges, stitched_vertices, split_vertices, .. } = counts;
        Self { stitched_edges, stitched_vertices, split_vertices }
    }
}

/// Keys of the report of `simplify`.
#[derive(Serialize)]
pub(super) struct SimplifyFigures {
    method: Method,
    input_faces: usize,
    output_faces: usize,
    reached: bool,
    error_estimate: f64,
    error_measured: Option<DistanceFigures>,
    volume_running_sum: f64,
    contractions: ContractionFigures,
    volume_not_conserved: Option<VolumeNotConserved>,
    #[serde(flatten)]
    input: InputFigures,
    #[serde(flatten)]
    conditioning: ConditioningFigures,
    flat_faces: Option<usize>,
    needed_faces: Option<usize>,
    fused: Option<FuseReport>,
    #[serde(flatten)]
    run: RunFigures,
    error_asked: Option<f64>,
    error_proved: Option<f64>,
    error_rounds: Option<usize>,
    volume_residual: Option<f64>,
}

impl From<SimplifyReport> for SimplifyFigures {
    fn from(done: SimplifyReport) -> Self {
        let report = &done.run;
        Self {
            method: report.method,
            input_faces: report.input_faces,
            output_faces: report.output_faces,
            reached: report.reached,
            error_estimate: report.error_estimate,
            error_measured: done.measured.as_ref().map(DistanceFigures::from),
            volume_running_sum: report.volume.lost(),
            contractions: report.contractions.into(),
            volume_not_conserved: VolumeNotConserved::of(report.method, &report.volume),
            input: InputFigures::of(report, done.time.as_secs_f64()),
            conditioning: done.conditioning.into(),
            flat_faces: done.flats.map(|flats| flats.gone),
            needed_faces: done.flats.map(|flats| flats.needed),
            fused: done.fused,
            run: report.into(),
            error_asked: done.error.map(|error| error.asked),
            error_proved: done.error.and_then(|error| error.proved),
            error_rounds: done.error.map(|error| error.rounds),
            volume_residual: done.volume_residual,
        }
    }
}

/// Keys of the report of `lods`.
#[derive(Serialize)]
pub(super) struct LodsFigures {
    method: Method,
    input_faces: usize,
    levels: Vec<LodReport>,
    #[serde(flatten)]
    input: InputFigures,
    #[serde(flatten)]
    run: RunFigures,
    #[serde(flatten)]
    conditioning: ConditioningFigures,
}

impl From<LodsReport> for LodsFigures {
    fn from(done: LodsReport) -> Self {
        let report = &done.run;
        Self {
            method: report.method,
            input_faces: report.input_faces,
            input: InputFigures::of(report, done.time.as_secs_f64()),
            run: report.into(),
            conditioning: done.conditioning.into(),
            levels: done.levels,
        }
    }
}

/// Keys of one level in the report of `lods`.
#[derive(Serialize)]
pub(super) struct LodFigures {
    size: String,
    faces: usize,
    reached: bool,
    error_estimate: f64,
    error_measured: Option<DistanceFigures>,
    volume_residual: Option<f64>,
    screen_coverage: f64,
}

impl From<LodReport> for LodFigures {
    fn from(level: LodReport) -> Self {
        Self {
            size: level.size,
            faces: level.run.output_faces,
            reached: level.run.reached,
            error_estimate: level.run.error_estimate,
            error_measured: level.measured.as_ref().map(DistanceFigures::from),
            volume_residual: level.volume_residual,
            screen_coverage: level.screen_coverage,
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_method_that_promises_to_conserve_says_what_it_could_not() {
        let held = Unconserved { contractions: 1, ..Unconserved::default() };
        let loss = VolumeLoss { running_sum: 0.03, owed: 0.02, held, ..VolumeLoss::default() };
        let keys = |method| json!(VolumeNotConserved::of(method, &loss));
        assert_eq!(keys(Method::LeeJang)["held"]["contractions"], 1);
        assert_eq!(keys(Method::LeeJang)["owed"], 0.02);
        assert!(keys(Method::LeeJang)["at_boundaries"]["bounds"].is_null());
        assert!(keys(Method::Qem).is_null());
    }
}
