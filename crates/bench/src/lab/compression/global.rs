//! Rounding to a global grid of cubic cells, the baseline for the compression schemes.

use meshlod::Mesh;

/// Position that stands for a grid cell.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Rounding {
    /// The lowest corner of the cell.
    Down,
    /// The centre of the cell.
    Nearest,
}

/// Rounds the vertices of a mesh to a grid of 2^bits - 1 cells along the longest side of its
/// bounding box.
pub fn global(mesh: &Mesh, bits: u32, rounding: Rounding) -> Mesh {
    let (numbers, cell) = numbers(mesh, bits, rounding);
    let least = mesh.bounds().min;
    let place = |number: [u32; 3]| [0, 1, 2].map(|k| least[k] + cell * f64::from(number[k]));
    Mesh::new(numbers.into_iter().map(place).collect(), mesh.faces.clone())
}

/// Returns the grid cell of each vertex, and the side length of a cell.
pub fn numbers(mesh: &Mesh, bits: u32, rounding: Rounding) -> (Vec<[u32; 3]>, f64) {
    let bounds = mesh.bounds();
    let longest = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
    let cell = longest / f64::from((1u32 << bits) - 1);
    let half = if rounding == Rounding::Nearest { 0.5 } else { 0.0 };
    let number = |p: &[f64; 3]| {
        [0, 1, 2].map(|k| (((p[k] - bounds.min[k]) / cell).max(0.0) + half).floor() as u32)
    };
    (mesh.positions.iter().map(number).collect(), cell)
}

/// Smallest part of a face's area that counts as area.
const NO_AREA: f64 = 1e-9;

/// Counts faces that are flipped or degenerate in `moved`, a copy of `mesh` with moved vertices.
pub fn turned_over(mesh: &Mesh, moved: &Mesh) -> usize {
    let normal = |mesh: &Mesh, face: usize| {
        let [a, b, c] = mesh.triangle(mesh.faces[face]);
        (b - a).cross(c - a)
    };
    (0..mesh.faces.len())
        .filter(|&f| {
            let was = normal(mesh, f);
            let area = was.length_squared();
            area > 0.0 && was.dot(normal(moved, f)) <= NO_AREA * area
        })
        .count()
}
