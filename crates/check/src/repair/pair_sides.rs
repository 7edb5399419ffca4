//! Pairs the faces at a non-manifold edge.
//!
//! docs/notes/splitting.md says how this differs from the other splitters and sewers.

use std::cmp::Ordering;

use glam::DVec3;
use meshlod_mesh::{Mesh, Side};

/// Maximum number of faces at an edge up to which all pairs are compared.
const MAX_COMPARED: usize = 16;

/// A face at a non-manifold edge, seen along the edge.
#[derive(Clone, Copy)]
struct EdgeFace {
    side: Side,
    /// Angle of the face around the edge, from -π to π.
    angle: f64,
    /// True if the inside lies beyond the face in the direction of increasing angle.
    opens: bool,
}

/// Pairs the face sides at one non-manifold edge, to be split apart; some may stay unpaired.
///
/// If the faces around the edge alternate in orientation, each pair encloses one part of the
/// inside, so that solids that touch along the edge are separated. Else the flattest pairs are
/// taken first. Only consistently oriented faces are paired.
pub fn pair_sides(mesh: &Mesh, edge: &[Side]) -> Vec<[Side; 2]> {
    let mut edge_faces = edge_faces(mesh, edge);
    // At equal angles a closing face comes before an opening one, so that two coincident walls each
    // stay with their own solid.
    let order = |a: &EdgeFace, b: &EdgeFace| -> Ordering {
        a.angle.total_cmp(&b.angle).then(a.opens.cmp(&b.opens)).then(a.side.cmp(&b.side))
    };
    edge_faces.sort_unstable_by(order);
    let alternates = edge_faces.len().is_multiple_of(2)
        && (0..edge_faces.len())
            .all(|i| edge_faces[i].opens != edge_faces[(i + 1) % edge_faces.len()].opens);
    if alternates {
        let first = usize::from(!edge_faces[0].opens);
        edge_faces.rotate_left(first);
        return edge_faces.chunks_exact(2).map(|pair| [pair[0].side, pair[1].side]).collect();
    }
    if edge_faces.len() > MAX_COMPARED { Vec::new() } else { flattest(&edge_faces) }
}

fn edge_faces(mesh: &Mesh, edge: &[Side]) -> Vec<EdgeFace> {
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
            // A face that traverses the edge along the axis has the inside towards smaller angles.
            EdgeFace { side, angle, opens: ends(side)[0] != low }
        })
        .collect()
}

fn flattest(edge_faces: &[EdgeFace]) -> Vec<[Side; 2]> {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (i, a) in edge_faces.iter().enumerate() {
        for (j, b) in edge_faces.iter().enumerate().skip(i + 1) {
            if a.opens != b.opens {
                pairs.push(((a.angle - b.angle).cos(), i, j));
            }
        }
    }
    pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut free = vec![true; edge_faces.len()];
    let mut found = Vec::new();
    for (_, i, j) in pairs {
        if free[i] && free[j] {
            (free[i], free[j]) = (false, false);
            found.push([edge_faces[i].side, edge_faces[j].side]);
        }
    }
    found
}
