//! Which faces at an edge of three or more go on into each other.

use std::cmp::Ordering;

use glam::DVec3;
use meshlod_mesh::{Mesh, Side};

/// The most faces at an edge that are compared each with each.
const MOST: usize = 16;

/// A face as it leaves the edge, seen along it.
#[derive(Clone, Copy)]
struct Leaf {
    side: Side,
    /// Where it goes, around the edge, from 0 to 2π.
    angle: f64,
    /// Whether the inside lies behind it in the sense of the angle.
    opens: bool,
}

/// Pairs up the sides of one edge; a side may be left.
///
/// Where the faces enclose the inside in turns, each pair encloses one part of it, so that solids
/// that touch in the edge come apart. Else those faces go on into each other that lie flattest, the
/// flattest first. Only faces that agree are paired.
pub fn pair_up(mesh: &Mesh, edge: &[Side]) -> Vec<[Side; 2]> {
    let mut leaves = leaves(mesh, edge);
    // What closes comes before what opens at the same angle: so the two walls of two rooms that
    // stand back to back each go with their own room.
    let order = |a: &Leaf, b: &Leaf| -> Ordering {
        a.angle.total_cmp(&b.angle).then(a.opens.cmp(&b.opens)).then(a.side.cmp(&b.side))
    };
    leaves.sort_unstable_by(order);
    let turns = leaves.len().is_multiple_of(2)
        && (0..leaves.len()).all(|i| leaves[i].opens != leaves[(i + 1) % leaves.len()].opens);
    if turns {
        let first = usize::from(!leaves[0].opens);
        leaves.rotate_left(first);
        return leaves.chunks_exact(2).map(|pair| [pair[0].side, pair[1].side]).collect();
    }
    if leaves.len() > MOST { Vec::new() } else { flattest(&leaves) }
}

fn leaves(mesh: &Mesh, edge: &[Side]) -> Vec<Leaf> {
    let ends = |side: Side| side.ends(&mesh.faces);
    let Some(&first) = edge.first() else { return Vec::new() };
    let low = ends(first).into_iter().min().unwrap_or_default();
    let at = |side: Side, k: usize| {
        let face = mesh.faces[side.face().index()];
        DVec3::from(mesh.positions[face[(side.corner() + k) % 3].index()])
    };
    let from_low = |side: Side| if ends(side)[0] == low { [0, 1] } else { [1, 0] };
    let [a, b] = from_low(first).map(|k| at(first, k));
    let axis = (b - a).normalize_or_zero();
    let x = axis.any_orthonormal_vector();
    let y = axis.cross(x);
    edge.iter()
        .map(|&side| {
            let tip = at(side, 2) - a;
            let angle = tip.dot(y).atan2(tip.dot(x));
            // A face that runs along the axis has its back, the inside, towards lesser angles.
            Leaf { side, angle, opens: ends(side)[0] != low }
        })
        .collect()
}

fn flattest(leaves: &[Leaf]) -> Vec<[Side; 2]> {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (i, a) in leaves.iter().enumerate() {
        for (j, b) in leaves.iter().enumerate().skip(i + 1) {
            if a.opens != b.opens {
                pairs.push(((a.angle - b.angle).cos(), i, j));
            }
        }
    }
    pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut free = vec![true; leaves.len()];
    let mut found = Vec::new();
    for (_, i, j) in pairs {
        if free[i] && free[j] {
            (free[i], free[j]) = (false, false);
            found.push([leaves[i].side, leaves[j].side]);
        }
    }
    found
}
