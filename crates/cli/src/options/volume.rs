//! Volume of simplified meshes: its exact restoration, and its change as JSON and text.

use clap::Args;
use meshlod::simplify::{Digits, ExactVolumeError, Unconserved, VolumeLoss, VolumeResidual};
use meshlod::{
    ConditionedScene, Mesh, Method, Scene, closed_volume, conserve_volumes, world_bounds,
};
use serde::Serialize;

use crate::session::Session;
use crate::text::numbers::percent;

/// Relative change of volume up to which the text does not mention it.
const UNSEEN: f64 = 1e-4;

/// Option for levels of exactly the original volume.
#[derive(Args)]
#[command(next_help_heading = "Constraints")]
pub struct ExactVolumeArgs {
    /// Move vertices along their normals, by at most 0.5% of the diagonal and mostly by their last
    /// digits, until the closed parts of every mesh have their original volume in the precision that
    /// is written
    #[arg(long)]
    pub exact_volume: bool,
}

impl ExactVolumeArgs {
    /// Restores the volumes of the meshes of a level, if that is asked for. Returns the largest
    /// relative deviation that is left, or `None` if no mesh has a volume.
    pub fn restore(
        &self,
        scene: &ConditionedScene<'_>,
        level: &mut [Mesh],
        digits: Digits,
        session: &Session,
    ) -> Option<f64> {
        if !self.exact_volume {
            return None;
        }
        worst_residual(conserve_volumes(scene, level, digits), session)
    }
}

/// Returns the largest relative deviation from the volumes of meshes; warns of those that could not
/// be restored.
pub fn worst_residual(
    found: Vec<Result<VolumeResidual, ExactVolumeError>>,
    session: &Session,
) -> Option<f64> {
    let several = found.len() > 1;
    let mut worst: Option<f64> = None;
    for (i, residual) in found.into_iter().enumerate() {
        match residual {
            Ok(residual) => worst = Some(residual.after.abs().max(worst.unwrap_or(0.0))),
            Err(error) if several => {
                session.warn(format_args!("--exact-volume: mesh {i}: {error}"));
            }
            Err(error) => session.warn(format_args!("--exact-volume: {error}")),
        }
    }
    worst
}

/// Contractions that could not conserve the volume, with what they owed and the level was repaid.
#[derive(Serialize)]
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

/// Describes the volume that a volume-conserving method has lost in closed parts, relative to the
/// volume of the closed parts of `input`; `None` if it is not worth a line, or `input` has no
/// closed part. What the level was repaid is not lost. `can_restore` says whether `--exact-volume`
/// would restore it.
pub fn lost_text(
    method: Method,
    loss: &VolumeLoss,
    input: &Scene,
    can_restore: impl FnOnce() -> bool,
) -> Option<String> {
    // Most runs lose next to nothing, and need no volume of the input.
    let most = world_bounds(input).diagonal().powi(3);
    if !method.conserves_volume() || loss.lost().abs() < 1e-12 * most {
        return None;
    }
    text(loss, closed_volume(input), can_restore)
}

/// Returns true if the volumes of all meshes of a level that have one can be restored.
pub fn can_restore(scene: &ConditionedScene<'_>, level: &[Mesh]) -> bool {
    let restored = conserve_volumes(scene, &mut level.to_vec(), Digits::F64);
    restored.iter().all(|found| matches!(found, Ok(_) | Err(ExactVolumeError::OpenMesh)))
}

fn text(loss: &VolumeLoss, volume: f64, can_restore: impl FnOnce() -> bool) -> Option<String> {
    let lost = loss.lost() / volume;
    // Without a closed part there is nothing to compare with.
    if !lost.is_finite() || lost.abs() < UNSEEN {
        return None;
    }
    let part = |relative: f64| percent(100.0 * relative);
    let vanished = match loss.vanished / volume {
        gone if gone < UNSEEN => String::new(),
        gone => format!(", {} in parts that vanished", part(gone)),
    };
    let sign = if lost > 0.0 { "-" } else { "+" };
    let advice = match can_restore() {
        true => "--exact-volume restores it",
        false => "more than --exact-volume can restore",
    };
    Some(format!("volume: {sign}{}{vanished}; {advice}", part(lost.abs())))
}

#[cfg(test)]
mod tests {
    use meshlod::mesh::Bounds;

    use super::*;

    #[test]
    fn a_method_that_promises_to_conserve_says_what_it_lost() {
        let bounds = Bounds { min: [0.0, -1.0, 0.5], max: [1.0; 3] };
        let held = Unconserved { contractions: 1, bounds };
        let loss = VolumeLoss {
            running_sum: 0.03,
            owed: 0.02,
            repaid: 0.01,
            held,
            ..VolumeLoss::default()
        };
        let open = text(&loss, 0.0, || true);
        assert_eq!(open, None, "an open mesh has no volume to compare with");
        let stuck = text(&loss, 2.0, || false);
        assert_eq!(stuck.as_deref(), Some("volume: -1%; more than --exact-volume can restore"));
        let text = |loss: &VolumeLoss| text(loss, 2.0, || true);
        let expected = "volume: -1%; --exact-volume restores it";
        assert_eq!(text(&loss).as_deref(), Some(expected));
        let vanished = VolumeLoss { vanished: 0.01, ..loss };
        let expected = "volume: -1%, 0.5% in parts that vanished; --exact-volume restores it";
        assert_eq!(text(&vanished).as_deref(), Some(expected));
        let repaid = VolumeLoss { repaid: 0.03, ..loss };
        assert_eq!(text(&repaid), None);
        let json = |method| serde_json::json!(VolumeNotConserved::of(method, &loss));
        assert_eq!(json(Method::LeeJang)["held"]["contractions"], 1);
        assert_eq!(json(Method::LeeJang)["owed"], 0.02);
        assert!(json(Method::LeeJang)["at_boundaries"]["bounds"].is_null());
        assert!(json(Method::Qem).is_null());
    }
}
