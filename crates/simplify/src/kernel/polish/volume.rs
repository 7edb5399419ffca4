//! Volume of components, restored by a move of all vertices along their normals by a common factor.

use glam::DVec3;
use meshlod_mesh::{Mesh, VertexId, joined_vertices};

/// Number of steps of Newton's method, which converges quadratically from a step this small.
const NEWTON_STEPS: usize = 4;

/// Part of the sum of cones by which a volume may be off: rounding.
const ROUNDING: f64 = 1e-9;

/// Components of a level, and six times the volume of each.
pub(super) struct Volumes {
    /// Component of each vertex.
    of_vertex: Vec<u32>,
    /// Place from which the volume of each component is measured: that of one of its vertices.
    origins: Vec<DVec3>,
    /// Six times the volume of each component.
    sixfold: Vec<f64>,
    /// Sum of the cones of each component, all counted as positive.
    sizes: Vec<f64>,
}

impl Volumes {
    pub(super) fn new(level: &Mesh) -> Self {
        let mut joined = joined_vertices(&level.faces, level.positions.len());
        let of_vertex = (0..level.positions.len() as u32).map(|v| joined.find(v)).collect();
        let origins = level.positions.iter().map(|&at| at.into()).collect();
        let mut volumes = Self { of_vertex, origins, sixfold: Vec::new(), sizes: Vec::new() };
        volumes.sixfold = volumes.sums(level, |cone| cone);
        volumes.sizes = volumes.sums(level, f64::abs);
        volumes
    }

    /// Returns the sum of each component over its faces: six times the volume of the cone from a place
    /// that stays, as `term` counts it.
    fn sums(&self, level: &Mesh, term: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut sixfold = vec![0.0; self.of_vertex.len()];
        for face in &level.faces {
            let of = self.of_vertex[face[0].index()] as usize;
            let origin = self.origins[of];
            let [a, b, c] = face.map(|v| DVec3::from(level.positions[v.index()]) - origin);
            sixfold[of] += term(a.cross(b).dot(c));
        }
        sixfold
    }

    /// Gives each component the volume that it had. Only vertices that have moved move.
    pub(super) fn restore(&self, level: &mut Mesh, moves: &[DVec3]) {
        for _ in 0..NEWTON_STEPS {
            let now = self.sums(level, |cone| cone);
            let mut normals = vec![DVec3::ZERO; level.positions.len()];
            for face in &level.faces {
                let [a, b, c] = face.map(|v| DVec3::from(level.positions[v.index()]));
                let normal = (b - a).cross(c - a);
                face.iter().for_each(|v| normals[v.index()] += normal);
            }
            let mut slopes = vec![0.0; level.positions.len()];
            for (v, normal) in normals.iter().enumerate().filter(|(v, _)| moves[*v] != DVec3::ZERO)
            {
                slopes[self.of_vertex[v] as usize] += normal.length_squared();
            }
            for (v, normal) in normals.iter().enumerate().filter(|(v, _)| moves[*v] != DVec3::ZERO)
            {
                let of = self.of_vertex[v] as usize;
                let factor = (self.sixfold[of] - now[of]) / slopes[of];
                let at = DVec3::from(level.positions[v]) + *normal * factor;
                if at.is_finite() {
                    level.positions[v] = at.into();
                }
            }
        }
    }

    /// Puts the vertices back of components that do not have their volume now, or a bad face.
    pub(super) fn put_back(
        &self,
        level: &mut Mesh,
        before: &[[f64; 3]],
        is_bad: impl Fn(&[VertexId; 3], &[[f64; 3]]) -> bool,
    ) {
        let now = self.sums(level, |cone| cone);
        let is_off = |of: usize| {
            let off = (now[of] - self.sixfold[of]).abs();
            off.is_nan() || off > ROUNDING * self.sizes[of]
        };
        let mut is_out: Vec<bool> = (0..now.len()).map(is_off).collect();
        for face in level.faces.iter().filter(|face| is_bad(face, &level.positions)) {
            is_out[self.of_vertex[face[0].index()] as usize] = true;
        }
        for (v, at) in level.positions.iter_mut().enumerate() {
            if is_out[self.of_vertex[v] as usize] {
                *at = before[v];
            }
        }
    }
}
