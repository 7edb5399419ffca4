//! Vertices in blocks of one size, each close together.

use glam::DVec3;
use meshlod_mesh::{Mesh, VertexId};

/// How many vertices a block has: more share a header, fewer lie closer together. At 11 bits and a little more 24
/// take as much on the mean of ten meshes, and 48 take 1.3 % more.
pub(crate) const BLOCK: usize = 32;

/// The vertices that faces use, every [`BLOCK`] in a row close together.
///
/// What is no number is put somewhere.
/// Cost: O(n log n).
pub(crate) fn blocks_of(mesh: &Mesh) -> Vec<VertexId> {
    let used = mesh.used_vertices();
    let mut vertices: Vec<u32> =
        (0..).zip(used).filter(|(_, used)| *used).map(|(v, _)| v).collect();
    in_blocks(&mesh.positions, &mut vertices, BLOCK);
    vertices.into_iter().map(VertexId).collect()
}

/// The vertices in an order in which every `size` of them in a row are close together:
/// halved again and again across the direction in which they are longest.
///
/// Cost: O(n log n).
fn in_blocks(places: &[[f64; 3]], vertices: &mut [u32], size: usize) {
    if vertices.len() <= size {
        return;
    }
    let along = longest(places, vertices);
    let far = |v: u32| DVec3::from(places[v as usize]).dot(along);
    // Whole blocks on the first side.
    let middle = (vertices.len() / 2).next_multiple_of(size).min(vertices.len() - 1);
    vertices.select_nth_unstable_by(middle, |&a, &b| far(a).total_cmp(&far(b)).then(a.cmp(&b)));
    let (first, second) = vertices.split_at_mut(middle);
    in_blocks(places, first, size);
    in_blocks(places, second, size);
}

/// So often the direction is turned by the spread: it need not be exact.
const TURNS: usize = 8;

/// About the direction of their greatest spread.
fn longest(places: &[[f64; 3]], vertices: &[u32]) -> DVec3 {
    let place = |&v: &u32| DVec3::from(places[v as usize]);
    let mean = vertices.iter().map(place).sum::<DVec3>() / vertices.len() as f64;
    let (mut square, mut mixed) = (DVec3::ZERO, DVec3::ZERO);
    for away in vertices.iter().map(|v| place(v) - mean) {
        square += away * away;
        mixed += DVec3::new(away.y * away.z, away.z * away.x, away.x * away.y);
    }
    let axis = square.max_position();
    let mut along = DVec3::from([0, 1, 2].map(|k| if k == axis { 1.0 } else { 0.1 }));
    for _ in 0..TURNS {
        let turned = square * along
            + DVec3::new(
                mixed.z * along.y + mixed.y * along.z,
                mixed.z * along.x + mixed.x * along.z,
                mixed.y * along.x + mixed.x * along.y,
            );
        along = turned.try_normalize().unwrap_or(along);
    }
    along
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::{Bounds, sample};

    use super::*;

    #[test]
    fn blocks_are_small_and_each_vertex_is_in_one() {
        let places = sample::sphere(8000).positions;
        let mut vertices: Vec<u32> = (0..places.len() as u32).collect();
        in_blocks(&places, &mut vertices, 32);
        let size =
            |block: &[u32]| Bounds::of(block.iter().map(|&v| &places[v as usize])).diagonal();
        let mean = vertices.chunks(32).map(size).sum::<f64>() / (places.len() / 32) as f64;
        // A square of 32 of 4,000 vertices on a sphere of radius 1 is .45 wide across its corners.
        assert!(mean < 0.5 * Bounds::of(&places).diagonal() / 3f64.sqrt(), "{mean}");
        vertices.sort_unstable();
        assert!(vertices.iter().zip(0..).all(|(&v, i)| v == i));
    }

    #[test]
    fn vertices_in_one_place_are_parted_all_the_same() {
        let mut vertices: Vec<u32> = (0..100).collect();
        in_blocks(&[[1.0; 3]; 100], &mut vertices, 32);
        vertices.sort_unstable();
        assert!(vertices.iter().zip(0..).all(|(&v, i)| v == i));
    }
}
