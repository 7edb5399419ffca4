//! Simplification of a scene to a number of faces, or to an error that is proved as it is written.

mod proved_error;
mod report;
mod request;

use std::cell::OnceCell;
use std::time::Instant;

use meshlod_io::Scene;
use meshlod_measure::{Distance, DistanceOptions, PreparedSurface};
use meshlod_mesh::Mesh;
use meshlod_simplify::{Report, Target};

use crate::jobs::faceless::refuse_points;
use crate::jobs::scene_run::{self, Original, RunChoice, SceneRun, shown_surface};
use crate::jobs::simplify::proved_error::BoundToProve;
use crate::jobs::written_as::digits;
use crate::jobs::{JobError, Remark, Watch, WrittenAs, cancellable};
use crate::scene::{ConditionedScene, moved_at_most};

pub use proved_error::ProvedError;
pub use report::{LostVolume, SimplifyReport};
pub use request::{Aim, SimplifyRequest};

/// Simplifies all meshes of a scene to one common target, and returns the scene with a report.
///
/// An error is proved of the scene [as it is written](SimplifyRequest::written_as): the run leaves
/// room for the rounding of coordinates, and the report says what holds, in what precision. Flats go
/// first [where that helps](ConditionedScene::flatten_before). See [`ConditionedScene`] for what
/// happens to the meshes before, and [`SceneSimplifier`](crate::scene::SceneSimplifier) for the run.
///
/// Cost: O(n log n), n = faces, and several times that for an error.
/// # Errors
/// A target out of range, an invalid mesh or option, and a scene without faces to contract.
///
/// ```
/// use meshlod::io::Precision;
/// use meshlod::jobs::{Aim, SimplifyRequest, WrittenAs, simplify};
/// use meshlod::{Format, Scene, samples};
///
/// let knot = Scene::from_mesh("knot", samples::knot(4_000));
/// let request = SimplifyRequest {
///     target: Aim::Error("0.5%".parse()?),
///     written_as: Some(WrittenAs { format: Format::Ply, precision: Precision::Auto }),
///     ..SimplifyRequest::default()
/// };
/// let (level, report) = simplify(knot, &request, &())?;
/// assert!(report.run.reached && level.flatten().faces.len() < 2_000);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simplify(
    mut scene: Scene,
    request: &SimplifyRequest,
    watch: &dyn Watch,
) -> Result<(Scene, SimplifyReport), JobError> {
    refuse_points(&scene)?;
    cancellable(|| {
        let fused = scene_run::fuse(&mut scene, request.constraints.fuse, watch);
        let target = request.target.target(&scene);
        let target = fused.map_or(target, |fused| fused.target(target));
        let (asked, written_as) = asked_and_written(request, target, &scene);
        let target = asked.map_or(target, |asked| asked.target());
        let task = Task { scene: &scene, request, asked, written_as, watch };
        let (level, report) = task.run(target)?;
        scene_run::replace(&mut scene, level);
        Ok((scene, SimplifyReport { fused, ..report }))
    })
}

/// A scene that is fused, with what is asked of it.
struct Task<'t> {
    scene: &'t Scene,
    request: &'t SimplifyRequest,
    /// The error that was asked for, if the target is one.
    asked: Option<BoundToProve>,
    written_as: Option<WrittenAs>,
    watch: &'t dyn Watch,
}

/// Returns the error that was asked for, if the target is one, and how to write. Where 32 bits would
/// round the error away, coordinates are written with 64, unless the request says otherwise.
fn asked_and_written(
    request: &SimplifyRequest,
    target: Target,
    scene: &Scene,
) -> (Option<BoundToProve>, Option<WrittenAs>) {
    let of_scene = |as_: Option<WrittenAs>| as_.map(|as_| as_.of(scene));
    let Target::Error(error) = target else {
        // The digits to which a volume is exact are those that are written.
        let as_ = request.written_as;
        return (None, if request.exact_volume { of_scene(as_) } else { as_ });
    };
    let with = |as_| BoundToProve::new(error, scene, as_, request.exact_volume);
    let mut as_ = request.written_as;
    if with(of_scene(as_)).needs_precision() {
        as_ = as_.map(WrittenAs::precise);
    }
    let as_ = of_scene(as_);
    (Some(with(as_)), as_)
}

impl Task<'_> {
    fn run(&self, target: Target) -> Result<(Vec<Mesh>, SimplifyReport), JobError> {
        let Self { scene, request, watch, .. } = *self;
        let choice = request.choice();
        let (mut ready, mut time) = choice.condition(scene, watch)?;
        let start = Instant::now();
        ready.flatten_before(target);
        time += start.elapsed();
        let mut run = SceneRun::start(&ready, time, watch)?;
        let mut report = run.simplify_to(target)?;
        let mut level = run.level(&mut report);
        let mut time = run.time();
        drop(run);
        let start = Instant::now();
        let (volume_residual, moved) = self.restore_volume(&ready, &mut level);
        time += start.elapsed();
        let (measured, error) = self.measure(&report, &level, moved)?;
        choice.remark(watch);
        if request.polish && matches!(request.target, Aim::Error(_)) {
            watch.remark(&Remark::field("polish", "a level within an error is left as it is"));
        }
        report.reached &= error.is_none_or(|error| error.is_held);
        let lost = || LostVolume::of(&report, scene, (&ready, &level));
        let report = SimplifyReport {
            measured,
            conditioning: ready.counts(),
            flats: ready
                .flat_faces()
                .map(|flats| flats.without(&report, ready.duplicates_before_flats())),
            near_borders: request.near_borders.then(|| ready.near_borders()).flatten(),
            fused: None,
            error,
            volume_residual,
            lost_volume: if request.exact_volume { None } else { lost() },
            written_as: self.written_as,
            time,
            run: report,
        };
        drop(ready);
        Ok((level, report))
    }

    /// Restores the volume, if that is asked for. Returns the relative deviation that is left, and
    /// how far vertices have moved.
    fn restore_volume(
        &self,
        ready: &ConditionedScene<'_>,
        level: &mut [Mesh],
    ) -> (Option<f64>, f64) {
        if !self.request.exact_volume {
            return (None, 0.0);
        }
        let before = level.to_vec();
        let residual =
            scene_run::restore_volumes(ready, level, digits(self.written_as), self.watch);
        (residual, moved_at_most(self.scene, &before, level))
    }

    /// Measures the result if that was asked for. Returns what holds of an error that was asked
    /// for: by the proof of the run before vertices moved by up to `moved`, or by a measurement.
    fn measure(
        &self,
        report: &Report,
        level: &[Mesh],
        moved: f64,
    ) -> Result<(Option<Distance>, Option<ProvedError>), JobError> {
        let by_report = self.asked.filter(|_| report.proof.is_some());
        let proved = by_report.map(|asked| asked.by_report(report, moved));
        if !self.request.measured && (self.asked.is_none() || proved.is_some()) {
            return Ok((None, proved));
        }
        let whole = OnceCell::new();
        let original = match Original::new(self.scene, &whole) {
            Ok(original) => Some(original),
            Err(error) if self.asked.is_none() => return Err(JobError::input(error)),
            Err(_) => None,
        };
        let options = DistanceOptions::default();
        let wanted = original.as_ref().filter(|_| self.request.measured);
        let measured = wanted.and_then(|original| original.measure(&options, level, self.watch));
        let by_measuring = |asked: BoundToProve| {
            let whole = original.as_ref().map(|_| shown_surface(self.scene, &whole));
            let whole = whole.and_then(|whole| PreparedSurface::new(whole).ok());
            asked.by_measuring(whole.as_ref(), self.scene, level)
        };
        Ok((measured, proved.or_else(|| self.asked.map(by_measuring))))
    }
}

impl SimplifyRequest {
    fn choice(&self) -> RunChoice<'_> {
        let Self { method, weights, boundary, polish, ref constraints, .. } = *self;
        RunChoice { method, weights, boundary, polish, constraints }
    }
}
