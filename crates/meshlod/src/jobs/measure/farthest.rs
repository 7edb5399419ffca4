//! Two scenes posed alike by their animations, in the pose in which they are farthest apart.

use meshlod_io::Scene;
use meshlod_io::gltf::{Animator, Moment};
use meshlod_mesh::Mesh;

use super::{MeasureRequest, apart, prepared};
use crate::jobs::{About, JobError, Remark, Watch};
use crate::model::posed_mesh;

/// Pose in which two scenes are farthest apart.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FarthestPose {
    /// Number of poses that were compared.
    pub measured: usize,
    /// Index of the animation.
    pub animation: usize,
    /// Time in the animation, in seconds.
    pub seconds: f64,
}

/// Compares two scenes at `most` moments of the animations of the first, and returns the surfaces
/// of both at the moment at which they are farthest apart.
pub(super) fn pose(
    scenes: [&Scene; 2],
    most: usize,
    request: &MeasureRequest,
    watch: &dyn Watch,
) -> Result<([Mesh; 2], FarthestPose), JobError> {
    let animators = animators(scenes, watch)?;
    let moments = moments(scenes, &animators, most)?;
    let mut farthest: Option<(f64, [Mesh; 2], Moment)> = None;
    for (done, &at) in moments.iter().enumerate() {
        watch.step(done, Some(moments.len()));
        if watch.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        let surfaces = [0, 1].map(|k| posed_mesh(scenes[k], &animators[k], Some(at)));
        let far = apart(&prepared(&surfaces)?, request)?.max();
        if farthest.as_ref().is_none_or(|(most, ..)| far > *most) {
            farthest = Some((far, surfaces, at));
        }
    }
    let (_, surfaces, Moment { animation, seconds }) =
        farthest.ok_or_else(|| no_animations("A"))?;
    Ok((surfaces, FarthestPose { measured: moments.len(), animation, seconds }))
}

fn animators([a, b]: [&Scene; 2], watch: &dyn Watch) -> Result<[Animator; 2], JobError> {
    let of = |scene, name| Animator::new(scene).ok_or_else(|| no_animations(name));
    let animators = [of(a, "A")?, of(b, "B")?];
    for (animator, about) in animators.iter().zip([About::Input, About::Second]) {
        animator.notes.iter().for_each(|note| watch.remark(&Remark::new(about, note)));
    }
    Ok(animators)
}

/// Returns the moments at which both scenes can be posed alike.
fn moments(
    [a, b]: [&Scene; 2],
    animators: &[Animator; 2],
    most: usize,
) -> Result<Vec<Moment>, JobError> {
    let [moments, others] = animators.each_ref().map(|animator| animator.moments(most));
    if moments.is_empty() {
        return Err(no_animations("A"));
    }
    if moments != others || a.nodes.len() != b.nodes.len() {
        let must = "both need the same nodes and animations, as a scene and its levels have them";
        return Err(JobError::request("poses", must));
    }
    Ok(moments)
}

fn no_animations(name: &str) -> JobError {
    JobError::request("poses", format_args!("{name} has no animations"))
}
