//! Reverses closed shells that point inwards.

use meshlod_mesh::{Bounds, Mesh};

use super::reverse::reverse_faces;
use crate::check::shells::Shells;

/// Limit on the shells considered as enclosing others; the largest are taken.
const MOST_ENCLOSING: usize = 512;

/// Reverses every closed shell that points inwards; returns the number of shells reversed.
///
/// A shell that another closed shell may enclose is kept, since it may be the wall of a cavity,
/// which rightly points inwards. Bounding boxes decide, so some shells are kept that could be
/// reversed.
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
    let mut enclosing: Vec<usize> = closed.collect();
    enclosing.sort_by(|&a, &b| boxes[b].diagonal().total_cmp(&boxes[a].diagonal()));
    enclosing.truncate(MOST_ENCLOSING);
    let in_another = |shell: usize| {
        enclosing.iter().any(|&other| other != shell && contains(&boxes[other], &boxes[shell]))
    };
    let turns: Vec<bool> = (0..boxes.len())
        .map(|shell| volumes[shell].is_some_and(|volume| volume < 0.0) && !in_another(shell))
        .collect();
    let of_face = shells.of_face.iter();
    let turned: Vec<bool> =
        of_face.map(|&shell| turns.get(shell as usize).copied().unwrap_or(false)).collect();
    reverse_faces(mesh, &turned);
    turns.iter().filter(|turns| **turns).count()
}

fn contains(outer: &Bounds, inner: &Bounds) -> bool {
    (0..3).all(|axis| outer.min[axis] <= inner.min[axis] && inner.max[axis] <= outer.max[axis])
}
