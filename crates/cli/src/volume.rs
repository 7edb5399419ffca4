//! Volume of simplified meshes: its exact restoration, and its change as JSON and text.

use clap::Args;
use meshlod::mesh::closed_faces;
use meshlod::simplify::{Digits, ExactVolumeError, Unconserved, VolumeLoss, VolumeResidual};
use meshlod::{
    ConditionedScene, Mesh, Method, Scene, closed_volume, conserve_volumes, world_bounds,
};
use serde_json::{Value, json};

use crate::numbers::percent;
use crate::session::Session;

/// Relative change of volume up to which the text does not mention it.
const UNSEEN: f64 = 1e-4;

/// Option for levels of exactly the original volume.
#[derive(Args)]
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

/// Warns of a mesh whose levels cannot get its volume because no part of it is closed.
pub fn warn_if_open(mesh: &Mesh, session: &Session) {
    if !closed_faces(&mesh.faces, mesh.positions.len()).contains(&true) {
        session.warn(format_args!("--exact-volume: {}", ExactVolumeError::OpenMesh));
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

/// Returns the contractions that could not conserve the volume as JSON, with what they owed and the
/// level was repaid; `null` for a method that does not aim to.
pub fn unconserved_json(method: Method, loss: &VolumeLoss) -> Value {
    let json = || {
        json!({
            "at_boundaries": with_bounds(&loss.open),
            "behind_boundary_cones": loss.at_boundaries,
            "held": with_bounds(&loss.held),
            "owed": loss.owed,
            "repaid": loss.repaid,
        })
    };
    method.conserves_volume().then(json).into()
}

fn with_bounds(some: &Unconserved) -> Value {
    let bounds =
        (some.contractions > 0).then(|| json!({ "min": some.bounds.min, "max": some.bounds.max }));
    json!({ "contractions": some.contractions, "bounds": bounds })
}

/// Describes the volume that a volume-conserving method has lost in closed parts, relative to the
/// volume of the closed parts of `input`; `None` if it is not worth a line. What the level was repaid
/// is not lost.
pub fn lost_text(method: Method, loss: &VolumeLoss, input: &Scene) -> Option<String> {
    // Most runs lose next to nothing, and need no volume of the input.
    let most = world_bounds(input).diagonal().powi(3);
    if !method.conserves_volume() || loss.lost().abs() < 1e-12 * most {
        return None;
    }
    text(loss, closed_volume(input))
}

fn text(loss: &VolumeLoss, volume: f64) -> Option<String> {
    let lost = loss.lost() / volume;
    if lost.is_nan() || lost.abs() < UNSEEN {
        return None;
    }
    let part = |relative: f64| percent(100.0 * relative);
    let vanished = match loss.vanished / volume {
        gone if gone < UNSEEN => String::new(),
        gone => format!(", {} in parts that vanished", part(gone)),
    };
    let sign = if lost > 0.0 { "-" } else { "+" };
    Some(format!("volume: {sign}{}{vanished}; --exact-volume restores it", part(lost.abs())))
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
        let text = |loss: &VolumeLoss| text(loss, 2.0);
        let expected = "volume: -1%; --exact-volume restores it";
        assert_eq!(text(&loss).as_deref(), Some(expected));
        let vanished = VolumeLoss { vanished: 0.01, ..loss };
        let expected = "volume: -1%, 0.5% in parts that vanished; --exact-volume restores it";
        assert_eq!(text(&vanished).as_deref(), Some(expected));
        let repaid = VolumeLoss { repaid: 0.03, ..loss };
        assert_eq!(text(&repaid), None);
        let json = |method| unconserved_json(method, &loss);
        assert_eq!(json(Method::LeeJang)["held"]["contractions"], 1);
        assert_eq!(json(Method::LeeJang)["owed"], 0.02);
        assert!(json(Method::LeeJang)["at_boundaries"]["bounds"].is_null());
        assert!(json(Method::Qem).is_null());
    }
}
