//! Precision of written coordinates, and the bits that a mesh needs.

use glam::DVec3;
use meshlod_mesh::Mesh;
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};

/// Precision of the floating-point coordinates in a written file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// 32-bit floats where they keep the shape, else 64-bit floats.
    ///
    /// The shape is kept if no two vertices at different positions coincide, and no coordinate
    /// moves by more than a thousandth of the mean edge length.
    #[default]
    Auto,
    /// 32-bit floats, which most programs read.
    F32,
    /// 64-bit floats, which keep every coordinate exactly.
    F64,
}

impl Precision {
    /// All precisions, the default first.
    pub const ALL: [Self; 3] = [Self::Auto, Self::F32, Self::F64];

    /// Returns the name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }
}

meshlod_mesh::by_name!(Precision, "precisions");

/// Width of a coordinate in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Width {
    F32,
    F64,
}

/// Largest move of a coordinate, as a fraction of the mean edge length.
const UNSEEN: f64 = 1e-3;

impl Precision {
    /// Returns [`Precision::F32`] or [`Precision::F64`]: for [`Precision::Auto`], the precision
    /// that these meshes need.
    pub fn of<'a>(self, meshes: impl IntoIterator<Item = &'a Mesh>) -> Self {
        match self {
            Self::Auto if meshes.into_iter().all(fits_f32) => Self::F32,
            Self::Auto => Self::F64,
            chosen => chosen,
        }
    }

    /// Returns the width of the coordinates of a mesh.
    pub(crate) fn width(self, mesh: &Mesh) -> Width {
        match self.of([mesh]) {
            Self::F64 => Width::F64,
            Self::F32 | Self::Auto => Width::F32,
        }
    }
}

/// Returns the largest change of a coordinate by rounding to 32 bits, in model units; infinite if a
/// coordinate exceeds their range.
pub(crate) fn rounding(mesh: &Mesh) -> f64 {
    let moves = mesh.positions.as_flattened().iter().map(|&x| (f64::from(x as f32) - x).abs());
    moves.fold(0.0, f64::max)
}

/// Reports whether 32 bits keep the shape of a mesh, as defined by [`Precision::Auto`].
///
/// Cost: one pass over the coordinates if all are exact in 32 bits, else linear in the mesh.
pub(crate) fn fits_f32(mesh: &Mesh) -> bool {
    let moves = rounding(mesh);
    moves == 0.0 || (moves.is_finite() && moves <= UNSEEN * mean_edge(mesh) && !merges(mesh))
}

/// Returns the mean edge length over all faces; infinite without faces.
fn mean_edge(mesh: &Mesh) -> f64 {
    if mesh.faces.is_empty() {
        return f64::INFINITY;
    }
    let count = 3.0 * mesh.faces.len() as f64;
    let length = |[a, b, c]: [DVec3; 3]| (a.distance(b) + b.distance(c) + c.distance(a)) / count;
    mesh.faces.iter().map(|&face| length(mesh.triangle(face))).sum()
}

/// Reports whether rounding to 32 bits makes two distinct positions equal.
fn merges(mesh: &Mesh) -> bool {
    let mut first: FxHashMap<[u32; 3], usize> = FxHashMap::default();
    first.reserve(mesh.positions.len());
    mesh.positions.iter().enumerate().any(|(v, position)| {
        // Adding 0 makes the two zeros one.
        let place = position.map(|x| (x as f32 + 0.0).to_bits());
        mesh.positions[*first.entry(place).or_insert(v)] != *position
    })
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::{grid, mesh, tetrahedron};

    use super::*;

    fn at(mut mesh: Mesh, scale: f64, offset: [f64; 3]) -> Mesh {
        for position in &mut mesh.positions {
            *position = [0, 1, 2].map(|i| position[i] * scale + offset[i]);
        }
        mesh
    }

    #[test]
    fn near_the_origin_32_bits_are_enough() {
        assert_eq!(Precision::Auto.of([&at(tetrahedron(), 0.1, [0.3; 3])]), Precision::F32);
        assert_eq!(Precision::default(), Precision::Auto);
    }

    #[test]
    fn far_coordinates_need_64_bits_unless_they_are_coarse() {
        let utm = [500_000.0, 5_400_000.0, 100.0];
        assert_eq!(Precision::Auto.of([&at(grid(3), 0.01, utm)]), Precision::F64);
        assert_eq!(Precision::Auto.of([&at(grid(3), 1000.1, utm)]), Precision::F32);
        // Exact in 32 bits.
        assert_eq!(Precision::Auto.of([&at(grid(3), 0.5, utm)]), Precision::F32);
        assert_eq!(Precision::F32.of([&at(grid(3), 0.01, utm)]), Precision::F32);
    }

    #[test]
    fn vertices_that_would_become_one_need_64_bits() {
        let near = 0.3 + 1e-12;
        let positions = [[0.3, 0.0, 0.0], [near, 0.0, 0.0], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0]];
        let two = mesh(&positions, &[[0, 2, 3], [1, 3, 2]]);
        assert_eq!(Precision::Auto.of([&two]), Precision::F64);
        let mut one = two;
        one.positions[1][0] = 0.3;
        assert_eq!(Precision::Auto.of([&one]), Precision::F32);
    }

    #[test]
    fn what_is_beyond_32_bits_needs_64() {
        assert_eq!(Precision::Auto.of([&at(tetrahedron(), 1e300, [0.0; 3])]), Precision::F64);
        assert_eq!(Precision::Auto.of([&at(tetrahedron(), 1e-300, [0.0; 3])]), Precision::F64);
    }
}
