//! Allowance for the rounding of `f64` in certified distances.

use glam::DVec3;
use meshlod_mesh::Mesh;
use rayon::prelude::*;

/// Roundings to allow for, in units in the last place of the largest coordinate: midpoints of
/// midpoints, and a distance.
const ULPS: f64 = 64.0;

/// Bounds on the rounding errors of distances, in model units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rounding {
    /// Largest error of a point and of its distance from one face.
    pub(super) point: f64,
    /// Largest length by which a face may be nearer than the closest one found.
    pub(super) closest: f64,
}

impl Rounding {
    /// Returns the allowance for points on `from` and their distances from `to`.
    pub(super) fn between(from: &Mesh, to: &Mesh) -> Self {
        let closest = to
            .faces
            .par_iter()
            .map(|face| missed_at(face.map(|v| DVec3::from(to.positions[v.index()]))));
        Self { point: Self::of_points(from, to), closest: closest.reduce(|| 0.0, f64::max) }
    }

    /// Returns the least distance that can be proved.
    pub(super) fn least(&self) -> f64 {
        16.0 * self.point
    }

    /// Returns the largest error of a point on `from` and of its distance from one face of `to`.
    pub(super) fn of_points(from: &Mesh, to: &Mesh) -> f64 {
        ULPS * f64::EPSILON * largest_coordinate(from).max(largest_coordinate(to))
    }
}

fn largest_coordinate(mesh: &Mesh) -> f64 {
    let used = mesh.faces.par_iter().flatten_iter().map(|v| mesh.positions[v.index()]);
    used.map(|at| at.into_iter().fold(0.0, |most: f64, x| most.max(x.abs())))
        .reduce(|| 0.0, f64::max)
}

/// Returns how much nearer than `closest_point` says a point of the triangle may be: 2e-16 of its
/// size over the least sine of its angles, and at most 1e-8 of it.
fn missed_at([a, b, c]: [DVec3; 3]) -> f64 {
    let mut sides = [b - a, c - b, a - c];
    sides.sort_unstable_by(|u, v| v.length_squared().total_cmp(&u.length_squared()));
    let size = sides[0].length();
    if size == 0.0 {
        return 0.0;
    }
    let [long, middle, short] = sides.map(|side| side / size);
    let sine = middle.cross(short).length() / (long.length() * middle.length());
    size * (2e-16 / sine).min(1e-8)
}
