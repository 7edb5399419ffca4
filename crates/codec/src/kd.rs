//! Partition of vertices into blocks of equal size, each of vertices close together.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::{DMat3, DVec3};
use meshlod_mesh::{Bounds, Mesh, VertexId};

/// Vertices per block. More would share a header, fewer would lie closer together. On the lattice,
/// before blocks were bent, 24 took as much on the mean of ten meshes, and 48 took 1.3 % more.
pub(crate) const BLOCK: usize = 32;

/// Orders the vertices that faces use, so that every [`BLOCK`] of them are close together.
///
/// Coordinates that are not finite do not affect the order of the others.
/// Cost: O(n log n).
pub(crate) fn blocks_of(mesh: &Mesh) -> Vec<VertexId> {
    let used = mesh.used_vertices();
    let mut vertices: Vec<u32> =
        (0..).zip(used).filter(|(_, used)| *used).map(|(v, _)| v).collect();
    in_blocks(&mesh.positions, &mut vertices, BLOCK);
    vertices.into_iter().map(VertexId).collect()
}

/// Orders vertices so that every `size` of them are close together: halved recursively across the
/// longest direction, and finally across the one that leaves the smallest boxes.
///
/// Cost: O(n log n).
fn in_blocks(places: &[[f64; 3]], vertices: &mut [u32], size: usize) {
    let bounds = Bounds::of(vertices.iter().map(|&v| &places[v as usize]));
    let halving = Halving { places, size, grain: GRAIN * bounds.diagonal() };
    halving.halve(vertices);
}

/// Parameters of the recursion.
struct Halving<'p> {
    places: &'p [[f64; 3]],
    size: usize,
    /// Minimum thickness of a box.
    grain: f64,
}

/// Grain relative to the mesh: about a cell of 11 bits.
const GRAIN: f64 = 1.0 / 4096.0;
/// Number of blocks up to which several directions are tried. From 8 on down, they take 2.3 % less
/// on the lattice, on the mean of ten meshes, than with the longest direction only; from 64 on down
/// 2.6 %.
const MAX_TRIED_BLOCKS: usize = 64;

impl Halving<'_> {
    fn halve(&self, vertices: &mut [u32]) {
        if vertices.len() <= self.size {
            return;
        }
        // Whole blocks on the first side.
        let middle = (vertices.len() / 2).next_multiple_of(self.size).min(vertices.len() - 1);
        let [along, across, _] = self.axes(vertices);
        let mut best = (f64::INFINITY, along);
        if vertices.len() <= MAX_TRIED_BLOCKS * self.size {
            for [cos, sin] in TURNS {
                let turned = along * cos + across * sin;
                self.part(vertices, middle, turned);
                let (first, second) = vertices.split_at(middle);
                let volume = self.volume(first) * self.volume(second);
                if volume < best.0 {
                    best = (volume, turned);
                }
            }
        }
        self.part(vertices, middle, best.1);
        let (first, second) = vertices.split_at_mut(middle);
        rayon::join(|| self.halve(first), || self.halve(second));
    }

    fn place(&self, v: u32) -> DVec3 {
        DVec3::from(self.places[v as usize])
    }

    /// Partitions vertices about the `middle`-th along a direction.
    fn part(&self, vertices: &mut [u32], middle: usize, along: DVec3) {
        let far = |v: u32| self.place(v).dot(along);
        vertices.select_nth_unstable_by(middle, |&a, &b| far(a).total_cmp(&far(b)).then(a.cmp(&b)));
    }

    /// Estimates the volume of the smallest box around vertices.
    fn volume(&self, vertices: &[u32]) -> f64 {
        let [along, across, normal] = self.axes(vertices);
        let mut low = [f64::INFINITY; TURNS.len() + 1];
        let mut high = [f64::NEG_INFINITY; TURNS.len() + 1];
        for place in vertices.iter().map(|&v| self.place(v)) {
            let (x, y) = (place.dot(along), place.dot(across));
            let turned = TURNS.map(|[cos, sin]| x * cos + y * sin);
            for (k, x) in turned.into_iter().chain([place.dot(normal)]).enumerate() {
                low[k] = low[k].min(x);
                high[k] = high[k].max(x);
            }
        }
        let reach = |k: usize| high[k] - low[k] + self.grain;
        let quarter = TURNS.len() / 2;
        let area =
            (0..quarter).map(|k| reach(k) * reach(k + quarter)).fold(f64::INFINITY, f64::min);
        area * reach(TURNS.len())
    }

    /// Estimates the principal directions, by decreasing spread.
    fn axes(&self, vertices: &[u32]) -> [DVec3; 3] {
        let mean = vertices.iter().map(|&v| self.place(v)).sum::<DVec3>() / vertices.len() as f64;
        let mut spread = DMat3::ZERO;
        for away in vertices.iter().map(|&v| self.place(v) - mean) {
            spread += DMat3::from_cols(away * away.x, away * away.y, away * away.z);
        }
        let along = greatest(&spread);
        // The spread that is left across it.
        let flat =
            DMat3::IDENTITY - DMat3::from_cols(along * along.x, along * along.y, along * along.z);
        let across = greatest(&(flat * spread * flat));
        let across = (across - along * across.dot(along)).try_normalize();
        let across = across.unwrap_or_else(|| along.any_orthonormal_vector());
        [along, across, along.cross(across)]
    }
}

/// Cosines and sines of eighths of a half turn, as constants so that all machines agree.
const TURNS: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [0.923_879_532_511_286_7, 0.382_683_432_365_089_8],
    [FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [0.382_683_432_365_089_8, 0.923_879_532_511_286_7],
    [0.0, 1.0],
    [-0.382_683_432_365_089_8, 0.923_879_532_511_286_7],
    [-FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [-0.923_879_532_511_286_7, 0.382_683_432_365_089_8],
];

/// Power iterations: the direction need not be exact.
const STEPS: usize = 8;

/// Estimates the direction of greatest spread.
fn greatest(spread: &DMat3) -> DVec3 {
    let longer = |a: DVec3, b: DVec3| if b.length_squared() > a.length_squared() { b } else { a };
    let mut along = longer(longer(spread.x_axis, spread.y_axis), spread.z_axis);
    for _ in 0..STEPS {
        // For a zero matrix any direction will do.
        along = *spread * along.try_normalize().unwrap_or(DVec3::X);
    }
    along.try_normalize().unwrap_or(DVec3::X)
}

#[cfg(test)]
mod tests {
    use meshlod_samples as samples;

    use super::*;

    #[test]
    fn blocks_are_small_and_each_vertex_is_in_one() {
        let places = samples::sphere(8000).positions;
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
    fn coincident_vertices_are_still_split_into_blocks() {
        let mut vertices: Vec<u32> = (0..100).collect();
        in_blocks(&[[1.0; 3]; 100], &mut vertices, 32);
        vertices.sort_unstable();
        assert!(vertices.iter().zip(0..).all(|(&v, i)| v == i));
    }
}
