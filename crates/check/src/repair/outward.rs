//! Closed shells that look inwards are turned over.

use meshlod_mesh::{Bounds, Mesh};

use super::turn::turn;
use crate::check::shells::Shells;

/// The most shells that are asked whether they go around another. Beyond, the largest are.
const MOST_AROUND: usize = 512;

/// Turns every closed shell over that looks inwards, and says how many.
///
/// But not one that another closed shell may go around: it may be the wall of a hollow, which does
/// look inwards. Boxes decide that, so that some stay which could be turned.
pub fn turn_outward(mesh: &mut Mesh) -> usize {
    let shells = Shells::of_mesh(mesh);
    let volumes: Vec<Option<f64>> = shells.all.iter().map(|shell| shell.volume()).collect();
    if volumes.iter().all(|volume| volume.is_none_or(|volume| volume > 0.0)) {
        return 0;
    }
    let mut boxes = vec![Bounds::EMPTY; shells.all.len()];
    for (face, &shell) in mesh.faces.iter().zip(shells.of_face.iter()) {
        if let Some(bounds) = boxes.get_mut(shell as usize) {
            face.iter().for_each(|v| bounds.add(mesh.positions[v.index()]));
        }
    }
    let closed = (0..boxes.len()).filter(|&shell| volumes[shell].is_some());
    let mut around: Vec<usize> = closed.collect();
    around.sort_by(|&a, &b| boxes[b].diagonal().total_cmp(&boxes[a].diagonal()));
    around.truncate(MOST_AROUND);
    let in_another = |shell: usize| {
        around.iter().any(|&other| other != shell && holds(&boxes[other], &boxes[shell]))
    };
    let turns: Vec<bool> = (0..boxes.len())
        .map(|shell| volumes[shell].is_some_and(|volume| volume < 0.0) && !in_another(shell))
        .collect();
    let of_face = shells.of_face.iter();
    let turned: Vec<bool> =
        of_face.map(|&shell| turns.get(shell as usize).copied().unwrap_or(false)).collect();
    turn(mesh, &turned);
    turns.iter().filter(|turns| **turns).count()
}

fn holds(outer: &Bounds, inner: &Bounds) -> bool {
    (0..3).all(|axis| outer.min[axis] <= inner.min[axis] && inner.max[axis] <= outer.max[axis])
}
