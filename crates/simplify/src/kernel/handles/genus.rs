//! The number of handles of a surface, by its Euler characteristic.

use crate::kernel::mesh::one_ring::{GHOST, Vertices};

/// Returns the number of handles of all components together, given the numbers of faces and of
/// components. Rings are those that were just built: an open one ends with the ghost.
///
/// Cost: O(n), n = vertices.
pub(crate) fn genus(vertices: &Vertices<'_>, faces: usize, components: usize) -> usize {
    let (mut used, mut open) = (0usize, Vec::new());
    for v in vertices.ids() {
        if let Some(&last) = vertices.neighbours(v).last() {
            used += 1;
            if last == GHOST {
                open.push(v);
            }
        }
    }
    // An edge has two faces, one at the boundary, where there are as many edges as vertices.
    let edges = (3 * faces + open.len()) / 2;
    let euler = used as i64 - edges as i64 + faces as i64;
    let of_closed = 2 * components as i64 - euler;
    if of_closed <= 0 {
        return 0;
    }
    ((of_closed - holes(vertices, &open) as i64) / 2).max(0) as usize
}

/// Returns the number of boundary loops, given all vertices on them in order.
fn holes(vertices: &Vertices<'_>, open: &[u32]) -> usize {
    let mut is_seen = vec![false; open.len()];
    let mut holes = 0;
    for start in 0..open.len() {
        let mut at = start;
        holes += usize::from(!is_seen[at]);
        while !std::mem::replace(&mut is_seen[at], true) {
            let next = vertices.neighbours(open[at]).first();
            let Some(Ok(next)) = next.map(|next| open.binary_search(next)) else { break };
            at = next;
        }
    }
    holes
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::kernel::SweptVolume;
    use crate::kernel::setup::build_rings::Fans;

    /// Returns the faces of a grid that is closed in both directions, but for the first `left_out`.
    fn torus(left_out: usize) -> Vec<[u32; 3]> {
        let id = |i: u32, j: u32| (i % 5) * 5 + j % 5;
        let quad = |i: u32, j: u32| {
            let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
            [[a, b, c], [a, c, d]]
        };
        (0..25).flat_map(|k| quad(k / 5, k % 5)).skip(left_out).collect()
    }

    #[test]
    fn handles_are_counted_with_and_without_holes() {
        for left_out in [0, 1, 2] {
            let faces = torus(left_out);
            let places = vec![Vec3::ZERO; 25];
            let mut fans =
                Fans::new::<SweptVolume>((&places, Vec::new()), faces.len(), |i| faces[i], 1.0);
            assert_eq!(genus(&fans.store.whole(), faces.len(), 1), 1, "{left_out} faces left out");
        }
    }
}
