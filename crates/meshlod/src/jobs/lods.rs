//! A chain of coarser levels from one run, each measured against the original.

use std::cell::OnceCell;
use std::time::Duration;

use meshlod_io::Scene;
use meshlod_io::gltf::Level;
use meshlod_measure::{Distance, DistanceOptions, PreparedSurface};
use meshlod_mesh::{Conditioning, Mesh, NearBorders};
use meshlod_simplify::{AttributeWeights, Method, Report, Target};

use crate::Constraints;
use crate::jobs::faceless::refuse_points;
use crate::jobs::scene_run::{self, Original, RunChoice, SceneRun};
use crate::jobs::written_as::digits;
use crate::jobs::{About, JobError, Remark, SwitchCamera, Watch, WrittenAs, cancellable};
use crate::scene::FuseReport;

/// Request to make levels of a scene; see [`lods`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct LodsRequest {
    /// Sizes of the levels, finest first: numbers or ratios of faces.
    pub levels: Vec<Target>,
    /// Camera for which the levels are to be fine enough.
    pub camera: SwitchCamera,
    /// Method that contracts.
    pub method: Method,
    /// Weights of attributes in the costs of the method.
    pub weights: AttributeWeights,
    /// Weight of boundaries in the costs; `None` for that of the method.
    pub boundary: Option<f64>,
    /// True to fit the vertices of each level to the input once more, all together.
    pub polish: bool,
    /// Constraints on every level.
    pub constraints: Constraints,
    /// True to restore the volume of closed parts, exactly in the digits that are written.
    pub exact_volume: bool,
    /// True to measure the distance of each level from the input; without, nothing is known about
    /// where a level is fine enough. Meshes that are shown many times are measured once, each against
    /// its own level.
    pub measured: bool,
    /// True to look for boundary edges near each other, which welding would join.
    pub near_borders: bool,
    /// How the levels will be written; `None` if they stay in memory.
    pub written_as: Option<WrittenAs>,
}

/// Half, a quarter and a tenth of the faces, measured.
impl Default for LodsRequest {
    fn default() -> Self {
        Self {
            levels: [0.5, 0.25, 0.1].map(Target::Ratio).to_vec(),
            camera: SwitchCamera::default(),
            method: Method::default(),
            weights: AttributeWeights::DEFAULT,
            boundary: None,
            polish: false,
            constraints: Constraints::default(),
            exact_volume: false,
            measured: true,
            near_borders: false,
            written_as: None,
        }
    }
}

/// A scene and its coarser levels.
#[derive(Clone, Debug)]
pub struct LodChain {
    /// The scene, fused if that was asked for.
    pub scene: Scene,
    /// The levels, finest first, with the coverage of the screen below which to show them.
    pub levels: Vec<Level>,
}

/// Report of [`lods`]. Serde writes the keys that the command prints.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(into = "crate::jobs::figures::LodsFigures"))]
pub struct LodsReport {
    /// Report of the run up to the coarsest level.
    pub run: Report,
    /// Report of each level, finest first.
    pub levels: Vec<LodReport>,
    /// Changes made by conditioning, before the run.
    pub conditioning: Conditioning,
    /// Boundary edges near each other, if they were looked for and are many.
    pub near_borders: Option<NearBorders>,
    /// Changes made by fusing, before the run, if it was asked for.
    pub fused: Option<FuseReport>,
    /// Time of conditioning, connectivity and contractions.
    pub time: Duration,
}

/// Report of one of several levels. Serde writes the keys that the command prints.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(into = "crate::jobs::figures::LodFigures"))]
pub struct LodReport {
    /// Size that was asked for: `50%` or `500 faces`.
    pub size: String,
    /// Report of the run up to this level.
    pub run: Report,
    /// Measured distance from the input, if it was asked for and can be measured.
    pub measured: Option<Distance>,
    /// Largest relative deviation from the original volumes, if they were restored.
    pub volume_residual: Option<f64>,
    /// Fraction of the screen below which the level is fine enough.
    pub screen_coverage: f64,
    /// True if the level is the one before, or the input, since no contraction was possible.
    pub is_same: bool,
}

/// Makes all levels of a scene in one run, each from the one before. Flats go first where that helps
/// [the finest](crate::scene::ConditionedScene::flatten_before).
///
/// Cost: O(n log n), n = faces, and a measurement for each level.
/// # Errors
/// Levels that are not coarser one after the other, an invalid mesh or option, and a scene without
/// faces to contract.
///
/// ```
/// use meshlod::io::gltf::LodLayout;
/// use meshlod::jobs::{LodsRequest, lods};
/// use meshlod::{Output, Scene, samples};
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("torus.glb");
///
/// let torus = Scene::from_mesh("torus", samples::torus(4_000));
/// let (chain, report) = lods(torus, &LodsRequest::default(), &())?;
/// assert!(report.levels[2].run.output_faces <= 400);
/// Output::new(path)?.write_levels(&chain.scene, &chain.levels, LodLayout::default())?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn lods(
    mut scene: Scene,
    request: &LodsRequest,
    watch: &dyn Watch,
) -> Result<(LodChain, LodsReport), JobError> {
    refuse_points(&scene)?;
    cancellable(|| {
        let fused = scene_run::fuse(&mut scene, request.constraints.fuse, watch);
        let (levels, report) = made(&scene, request, fused, watch)?;
        Ok((LodChain { scene, levels }, report))
    })
}

fn made(
    scene: &Scene,
    request: &LodsRequest,
    fused: Option<FuseReport>,
    watch: &dyn Watch,
) -> Result<(Vec<Level>, LodsReport), JobError> {
    let LodsRequest { method, weights, boundary, polish, ref constraints, .. } = *request;
    let choice = RunChoice { method, weights, boundary, polish, constraints };
    let (ready, time) = choice.condition(scene, watch)?;
    let target = |size| fused.map_or(size, |fused| fused.target(size));
    let digits = digits(request.written_as.map(|as_| as_.of(scene)));
    let mut run = SceneRun::start(&ready, time, watch)?;
    check_order(&request.levels, run.input_faces())?;
    let mut made: Vec<Made> = Vec::with_capacity(request.levels.len());
    for &size in &request.levels {
        let mut report = run.simplify_to(target(size))?;
        let mut meshes = run.level(&mut report);
        let volume_residual = match request.exact_volume {
            true => scene_run::restore_volumes(&ready, &mut meshes, digits, watch),
            false => None,
        };
        made.push((size, meshes, report, volume_residual));
    }
    let time = run.time();
    // Measuring takes as much memory as a run, so this one ends first.
    drop(run);
    let (levels, reports) = measured(scene, request, made, watch);
    choice.remark(watch);
    let last = reports.last().ok_or_else(|| JobError::request("levels", "give at least one"))?;
    let report = LodsReport {
        run: last.run,
        conditioning: ready.counts(),
        near_borders: request.near_borders.then(|| ready.near_borders()).flatten(),
        fused,
        time,
        levels: reports,
    };
    Ok((levels, report))
}

/// Level that has not been measured: its size as asked for, its meshes, the report of its run, and
/// what is left to its volumes.
type Made = (Target, Vec<Mesh>, Report, Option<f64>);

/// Measures levels, if that is asked for, and says from where each is fine enough.
fn measured(
    scene: &Scene,
    request: &LodsRequest,
    made: Vec<Made>,
    watch: &dyn Watch,
) -> (Vec<Level>, Vec<LodReport>) {
    let whole = OnceCell::new();
    let original = request.measured.then(|| ready_to_measure(scene, &whole, watch)).flatten();
    let (mut levels, mut reports): (Vec<Level>, Vec<LodReport>) = Default::default();
    for (size, meshes, report, volume_residual) in made {
        let measured = original
            .as_ref()
            .and_then(|original| original.measure(&samples_for(original.faces()), &meshes, watch));
        let finer = reports.last().map_or(1.0, |level| level.screen_coverage);
        let coverage = measured.as_ref().map(|measured| request.camera.screen_coverage(measured));
        let screen_coverage = coverage.unwrap_or(finer).min(finer);
        let is_same = is_same(&report, reports.last().map(|level| &level.run));
        let size = size_text(size);
        levels.push(Level { meshes, screen_coverage });
        reports.push(LodReport {
            size,
            run: report,
            measured,
            volume_residual,
            screen_coverage,
            is_same,
        });
    }
    (levels, reports)
}

fn ready_to_measure<'m>(
    scene: &'m Scene,
    whole: &'m OnceCell<Mesh>,
    watch: &dyn Watch,
) -> Option<Original<'m>> {
    let ready = Original::new(scene, whole);
    let told = ready.inspect_err(|error| {
        watch.remark(&Remark::new(About::Input, format_args!("not measured: {error}")));
    });
    told.ok()
}

/// Number of samples each way for every face of a chain's original, and limits on all of them. At
/// ten a face, means were within .3 % of those by half a million; the maximum, a lower bound, was up
/// to 8 % lower.
const SAMPLES_PER_FACE: usize = 10;
const CHAIN_SAMPLES: [usize; 2] = [50_000, 500_000];

/// Returns options for measuring many levels, with as many samples as the size of the original calls
/// for.
pub fn chain_samples(original: &PreparedSurface<'_>) -> DistanceOptions {
    samples_for(original.mesh().faces.len())
}

fn samples_for(faces: usize) -> DistanceOptions {
    let [least, most] = CHAIN_SAMPLES;
    let samples = faces.saturating_mul(SAMPLES_PER_FACE).clamp(least, most);
    DistanceOptions { samples, ..DistanceOptions::default() }
}

/// Returns whether a level is that before it, or the input.
fn is_same(level: &Report, before: Option<&Report>) -> bool {
    // No contraction leaves the number of faces as it is.
    match before {
        Some(before) => level.output_faces == before.output_faces,
        None => level.output_faces == level.input_faces && !level.reached,
    }
}

/// Refuses a level that is not coarser than the one before.
fn check_order(levels: &[Target], input_faces: usize) -> Result<(), JobError> {
    let faces = |size: Target| match size {
        Target::Faces(faces) => faces as f64,
        Target::Ratio(ratio) => ratio * input_faces as f64,
        Target::Error(_) => f64::NAN,
    };
    if levels.iter().any(|size| faces(*size).is_nan()) {
        return Err(JobError::request("levels", "give numbers or ratios of faces"));
    }
    match levels.windows(2).find(|pair| faces(pair[1]) >= faces(pair[0])) {
        None => Ok(()),
        Some(pair) => {
            let [finer, coarser] = [pair[0], pair[1]].map(size_text);
            let reason =
                format_args!("{coarser} is not coarser than {finer}; list the finest first");
            Err(JobError::request("levels", reason))
        }
    }
}

/// Formats a size: `50%` or `500 faces`.
fn size_text(size: Target) -> String {
    match size {
        Target::Faces(1) => "1 face".into(),
        Target::Faces(faces) => format!("{faces} faces"),
        // Rounded so that 12.5% does not print as 12.500000000000002%.
        Target::Ratio(ratio) => format!("{}%", (ratio * 1e8).round() / 1e6),
        Target::Error(error) => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use meshlod_samples as samples;

    use super::*;

    fn run(levels: Vec<Target>, constraints: Constraints) -> Result<LodsReport, JobError> {
        let scene = Scene::from_mesh("knot", samples::knot(2_000));
        let request = LodsRequest { levels, constraints, ..LodsRequest::default() };
        lods(scene, &request, &()).map(|(_, report)| report)
    }

    #[test]
    fn levels_grow_coarser_and_are_measured() {
        let report = run([0.5, 0.1].map(Target::Ratio).to_vec(), Constraints::default()).unwrap();
        let [fine, coarse] = &report.levels[..] else { panic!("{report:?}") };
        assert!(fine.run.output_faces <= 1_000 && coarse.run.output_faces <= 200);
        assert!(fine.measured.unwrap().max() < coarse.measured.unwrap().max());
        assert!(coarse.screen_coverage < fine.screen_coverage && !coarse.is_same);
        assert_eq!([&fine.size, &coarse.size], ["50%", "10%"]);
    }

    #[test]
    fn what_is_not_coarser_is_refused() {
        for levels in [vec![], vec![Target::Error(1.0)], [0.1, 0.5].map(Target::Ratio).to_vec()] {
            let refused = run(levels, Constraints::default()).unwrap_err();
            assert!(matches!(refused, JobError::Request { field: "levels", .. }), "{refused}");
        }
    }

    #[test]
    fn a_level_that_no_contraction_makes_is_that_before() {
        let constraints = Constraints { topology: crate::Topology::Keep, ..Default::default() };
        let report = run(vec![Target::Faces(4), Target::Faces(3)], constraints).unwrap();
        assert!(report.levels[1].is_same || report.levels[0].run.reached, "{report:?}");
    }
}
