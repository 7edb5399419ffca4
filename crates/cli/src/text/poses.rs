//! Two scenes posed alike by their animations, in the pose in which they are farthest apart.

use meshlod::io::gltf::{Animator, Moment};
use meshlod::measure::{DistanceOptions, surface_distance};
use meshlod::model::posed_mesh;
use meshlod::{Mesh, Scene};
use serde::Serialize;

use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::distance;
use crate::text::numbers::{count, plural, value};

/// Pose in which two scenes are farthest apart.
pub struct FarthestPose {
    pub meshes: [Mesh; 2],
    at: Moment,
    /// Number of poses that were compared.
    poses: usize,
}

/// Number of poses that were compared, and the moment at which two scenes are farthest apart.
#[derive(Serialize)]
pub struct FarthestFigures {
    measured: usize,
    animation: usize,
    seconds: f64,
}

impl FarthestPose {
    /// Compares two scenes at `most` moments of the animations of the first.
    pub fn of(
        scenes: [&Scene; 2],
        paths: [&std::path::Path; 2],
        (most, options): (usize, &DistanceOptions),
        session: &Session,
    ) -> Result<Self, Failure> {
        let none =
            |path| Failure::usage(format_args!("--poses: {} has no animations", files::name(path)));
        let read = |k: usize| Animator::new(scenes[k]).ok_or_else(|| none(paths[k]));
        let animators = [read(0)?, read(1)?];
        for (animator, path) in animators.iter().zip(paths) {
            animator.notes.iter().for_each(|note| session.warn(Failure::at(path, note)));
        }
        let [moments, others] = [0, 1].map(|k| animators[k].moments(most));
        if moments.is_empty() {
            return Err(none(paths[0]));
        }
        if moments != others || scenes[0].nodes.len() != scenes[1].nodes.len() {
            return Err(Failure::usage(
                "--poses: both need the same nodes and animations, as a scene and its levels have them",
            ));
        }
        let mut farthest: Option<(f64, Self)> = None;
        for at in moments.iter().copied() {
            let meshes = [0, 1].map(|k| posed_mesh(scenes[k], &animators[k], Some(at)));
            let ready =
                [distance::ready(&meshes[0], paths[0])?, distance::ready(&meshes[1], paths[1])?];
            let apart = surface_distance(&ready[0], &ready[1], options).map_err(Failure::new)?;
            let far = apart.forward.max.max(apart.backward.max);
            drop(ready);
            if farthest.as_ref().is_none_or(|(most, _)| far > *most) {
                farthest = Some((far, Self { meshes, at, poses: moments.len() }));
            }
        }
        farthest.map(|(_, pose)| pose).ok_or_else(|| none(paths[0]))
    }

    pub fn figures(&self) -> FarthestFigures {
        let Moment { animation, seconds } = self.at;
        FarthestFigures { measured: self.poses, animation, seconds }
    }

    pub fn to_text(&self) -> String {
        format!(
            "the farthest of {} pose{}: animation {} at {} s\n\n",
            count(self.poses),
            plural(self.poses),
            self.at.animation,
            value(self.at.seconds),
        )
    }
}
