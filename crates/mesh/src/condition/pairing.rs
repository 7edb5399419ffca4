//! Pairs of sides that meet at one edge: which face continues which.
//!
//! docs/notes/splitting.md says how this differs from the other splitters and sewers.

use glam::DVec3;

use crate::{Mesh, Side};

/// Largest number of faces at an edge that are paired; at an edge with more all stay apart.
///
/// All pairs are compared, which must not take quadratic time. Real meshes have 3 to 8.
const MOST_SIDES: usize = 32;

/// Worth of one material on both sides of an edge against a smaller angle: as much as the
/// difference between going straight on and turning by 60°.
const SAME_MATERIAL: f64 = 0.5;

/// Pairs sides of opposite directions that lie on one edge, the smoothest first. `may_meet` tells
/// which two may become one edge.
pub(super) fn pair(
    mesh: &Mesh,
    sides: &[Side],
    may_meet: impl Fn(Side, Side) -> bool,
) -> Vec<[Side; 2]> {
    if sides.len() > MOST_SIDES {
        return Vec::new();
    }
    let mut found = Vec::new();
    for (i, &a) in sides.iter().enumerate() {
        for (j, &b) in sides.iter().enumerate().skip(i + 1) {
            if a.face() != b.face() && may_meet(a, b) {
                found.push((smoothness(mesh, a, b), i, j));
            }
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| (a.1, a.2).cmp(&(b.1, b.2))));
    let mut taken = vec![false; sides.len()];
    let mut pairs = Vec::new();
    for (_, i, j) in found {
        if !taken[i] && !taken[j] {
            taken[i] = true;
            taken[j] = true;
            pairs.push([sides[i], sides[j]]);
        }
    }
    pairs
}

/// Returns the cosine of the angle between two faces, with an addition for the same material.
fn smoothness(mesh: &Mesh, a: Side, b: Side) -> f64 {
    let material =
        |side: Side| mesh.materials.as_ref().map(|labels| labels.of(side.face().index()));
    let same = if material(a) == material(b) { SAME_MATERIAL } else { 0.0 };
    normal(mesh, a).dot(normal(mesh, b)) + same
}

/// Returns the unit normal of a side's face; zero if the face has no area.
pub(super) fn normal(mesh: &Mesh, side: Side) -> DVec3 {
    let [a, b, c] = mesh.triangle(mesh.faces[side.face().index()]);
    // Scaled first, for faces so small or large that their areas have no number.
    let [ab, ac] = [b - a, c - a];
    let longest = ab.abs().max_element().max(ac.abs().max_element());
    ((ab / longest).cross(ac / longest)).normalize_or_zero()
}
