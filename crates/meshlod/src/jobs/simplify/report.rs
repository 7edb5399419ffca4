//! The report of a simplification.

use std::time::Duration;

use meshlod_io::Scene;
use meshlod_measure::Distance;
use meshlod_mesh::{Conditioning, Mesh, NearBorders};
use meshlod_simplify::{Digits, ExactVolumeError, Report, VolumeLoss};

use crate::jobs::{ProvedError, WrittenAs};
use crate::scene::{
    ConditionedScene, FlatFaces, FuseReport, closed_volume, closed_volume_of_distinct,
    conserve_volumes, world_bounds,
};

/// Report of [`simplify`](super::simplify). Serde writes the keys that the command prints.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(into = "crate::jobs::figures::SimplifyFigures"))]
pub struct SimplifyReport {
    /// Report of the run; [`reached`](Report::reached) says whether the target holds as written.
    pub run: Report,
    /// Measured distance from the input, if it was asked for and can be measured.
    pub measured: Option<Distance>,
    /// Changes made by conditioning, before the run.
    pub conditioning: Conditioning,
    /// Faces of flats that went before the run, and those that the shape needs; `None` if they did not
    /// go first.
    pub flats: Option<FlatFaces>,
    /// Boundary edges near each other, if they were looked for and are many.
    pub near_borders: Option<NearBorders>,
    /// Changes made by fusing, before the run, if it was asked for.
    pub fused: Option<FuseReport>,
    /// The proof of the error, if one was asked for.
    pub error: Option<ProvedError>,
    /// Largest relative deviation from the original volumes, if they were restored.
    pub volume_residual: Option<f64>,
    /// Volume that closed parts have lost, if the method is to conserve it and it is worth a line.
    pub lost_volume: Option<LostVolume>,
    /// How the result has to be written for the error and the volume to hold.
    pub written_as: Option<WrittenAs>,
    /// Time of conditioning, connectivity, contractions, and restoring the volume.
    pub time: Duration,
}

/// Volume that a method which conserves it has lost in closed parts, as parts of that of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LostVolume {
    /// Part lost by the components in the level; negative if their volume has grown.
    pub part: f64,
    /// Part that was in components that vanished.
    pub vanished: f64,
    /// True if [`exact_volume`](super::SimplifyRequest::exact_volume) would restore it.
    pub is_restorable: bool,
}

/// Relative change of volume that is not worth a line.
pub(super) const UNSEEN: f64 = 1e-4;

impl LostVolume {
    /// Returns what a run has lost; what its level was repaid is not lost.
    pub(super) fn of(
        report: &Report,
        input: &Scene,
        (ready, level): (&ConditionedScene<'_>, &[Mesh]),
    ) -> Option<Self> {
        let lost = report.volume.lost().abs() + report.volume.vanished;
        // What is flat has no volume but rounding.
        if !report.method.conserves_volume()
            || lost == 0.0
            || lost < 1e-12 * world_bounds(input).diagonal().powi(3)
        {
            return None;
        }
        let of_input = match are_distinct(report, ready) {
            true => closed_volume_of_distinct(input),
            false => closed_volume(input),
        };
        Self::relative(&report.volume, of_input, || can_restore(ready, level))
    }

    fn relative(
        loss: &VolumeLoss,
        volume: f64,
        can_restore: impl FnOnce() -> bool,
    ) -> Option<Self> {
        let [part, vanished] = [loss.lost(), loss.vanished].map(|lost| lost / volume);
        // Without a closed part there is nothing to compare with.
        let is_seen = part.is_finite() && part.abs().max(vanished) >= UNSEEN;
        is_seen.then(|| Self { part, vanished, is_restorable: can_restore() })
    }
}

/// Returns true if no face repeats another for sure: their edges would have four faces.
fn are_distinct(report: &Report, ready: &ConditionedScene<'_>) -> bool {
    let split = ready.counts().split_vertices;
    [report.duplicate_faces, report.non_manifold_vertices, split] == [0; 3]
}

/// Returns true if the volumes of all meshes of a level that have one can be restored.
fn can_restore(ready: &ConditionedScene<'_>, level: &[Mesh]) -> bool {
    let restored = conserve_volumes(ready, &mut level.to_vec(), Digits::F64);
    restored.iter().all(|found| matches!(found, Ok(_) | Err(ExactVolumeError::OpenMesh)))
}

impl FlatFaces {
    /// Returns the figures without the faces that a run has left out, but for a number of those that are
    /// there twice and had been left out before: no shape needs them.
    pub(crate) fn without(self, report: &Report, before: usize) -> Self {
        let left_out = (report.degenerate_faces + report.duplicate_faces).saturating_sub(before);
        Self { needed: self.needed.saturating_sub(left_out), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_that_are_there_twice_are_needed_once() {
        use meshlod_samples as samples;

        use crate::jobs::{Aim, SimplifyRequest, simplify};

        let mut cube = samples::cube(600);
        let once = cube.faces.len();
        (cube.attributes, cube.faces) = (None, cube.faces.repeat(2));
        let scene = Scene::from_mesh("cube", cube);
        for error in ["0", "1e-6"] {
            let target = Aim::Error(error.parse().unwrap());
            let request = SimplifyRequest { target, ..SimplifyRequest::default() };
            let (level, report) = simplify(scene.clone(), &request, &()).unwrap();
            let needed = report.flats.unwrap().needed;
            // Within a tolerance they stay as they are, but no shape needs them twice.
            assert_eq!(needed, if error == "0" { 12 } else { once });
            assert!(level.flatten().faces.len() <= needed);
        }
    }

    #[test]
    fn faces_that_are_there_twice_are_not_taken_for_distinct() {
        use meshlod_mesh::{Borders, Labels};
        use meshlod_samples as samples;
        use meshlod_simplify::{Options, Target};

        use crate::scene::SceneSimplifier;

        let ball = Mesh { attributes: None, ..samples::sphere(400) };
        let mut twice = ball.clone();
        twice.faces.extend(&ball.faces);
        let names = ["a", "b"].map(str::to_owned).to_vec();
        let of_face = [0, 1].map(|label| vec![label; ball.faces.len()]).concat();
        twice.materials = Some(Labels { names, of_face });
        for (mesh, expected) in [(ball, true), (twice, false)] {
            let scene = Scene::from_mesh("", mesh);
            let ready =
                ConditionedScene::new(&scene, &Options::default(), Borders::Stitch).unwrap();
            let mut simplifier = SceneSimplifier::new(&ready).unwrap();
            let report = simplifier.run(Target::Ratio(0.5), &mut ()).unwrap();
            assert_eq!(are_distinct(&report, &ready), expected);
            if expected {
                assert_eq!(closed_volume_of_distinct(&scene), closed_volume(&scene));
            }
        }
    }

    #[test]
    fn a_volume_is_lost_if_it_is_not_repaid() {
        let loss = VolumeLoss { running_sum: 0.03, repaid: 0.01, ..VolumeLoss::default() };
        let open = LostVolume::relative(&loss, 0.0, || true);
        assert_eq!(open, None, "an open mesh has no volume to compare with");
        let stuck = LostVolume::relative(&loss, 2.0, || false).unwrap();
        assert!((stuck.part - 0.01).abs() < 1e-12 && !stuck.is_restorable, "{stuck:?}");
        let repaid = VolumeLoss { repaid: 0.03, ..loss };
        assert_eq!(LostVolume::relative(&repaid, 2.0, || true), None);
        let gone = VolumeLoss { vanished: 0.5, ..repaid };
        let gone = LostVolume::relative(&gone, 2.0, || true).unwrap();
        assert_eq!((gone.part, gone.vanished), (0.0, 0.25), "what vanished is counted apart");
    }
}
