//! The number of handles of a surface, by its Euler characteristic.

use crate::kernel::mesh::one_ring::{GHOST, Vertices};

/// Returns the number of handles of all components together, given the number of components.
///
/// Cost: O(n), n = vertices.
pub(crate) fn genus(vertices: &Vertices<'_>, components: usize) -> usize {
    let (mut used, mut ends, mut faces) = (0i64, 0i64, 0i64);
    let mut open = Vec::new();
    for v in vertices.ids() {
        let ring = vertices.neighbours(v);
        if ring.is_empty() {
            continue;
        }
        let is_open = ring.contains(&GHOST);
        let neighbours = ring.len() as i64 - i64::from(is_open);
        used += 1;
        ends += neighbours;
        faces += neighbours - i64::from(is_open);
        if is_open {
            open.push(v);
        }
    }
    let euler = used - ends / 2 + faces / 3;
    let most = (2 * components as i64 - euler) / 2;
    if most <= 0 {
        return 0;
    }
    let holes = holes(vertices, &open);
    ((2 * components as i64 - holes as i64 - euler) / 2).max(0) as usize
}

/// Returns the number of boundary loops, given all vertices on them in order.
fn holes(vertices: &Vertices<'_>, open: &[u32]) -> usize {
    let mut is_seen = vec![false; open.len()];
    let mut holes = 0;
    for start in 0..open.len() {
        let mut at = start;
        holes += usize::from(!is_seen[at]);
        while !std::mem::replace(&mut is_seen[at], true) {
            let Ok(next) = open.binary_search(&after_ghost(vertices.neighbours(open[at]))) else {
                break;
            };
            at = next;
        }
    }
    holes
}

/// Returns the neighbour that follows the ghost in a ring.
fn after_ghost(ring: &[u32]) -> u32 {
    let ghost = ring.iter().position(|&w| w == GHOST).unwrap_or(0);
    ring[(ghost + 1) % ring.len()]
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
            assert_eq!(genus(&fans.store.whole(), 1), 1, "{left_out} faces left out");
        }
    }
}
