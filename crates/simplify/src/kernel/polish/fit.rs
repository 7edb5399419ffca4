//! Least squares: moves of vertices that bring faces to the points of the input nearest to them.

use glam::{DMat3, DVec3, Vec3};
use meshlod_mesh::{Connectivity, VertexId};

use super::nearest::{Hit, NearestFaces};

/// Weight that holds a vertex where it is, as a part of that of its points: along the surface nothing
/// else does.
const HOLD: f64 = 0.03;

/// Number of times that all vertices are moved one after the other.
const SWEEPS: usize = 3;

/// Part of the greatest height of all beyond which that of a face must not grow.
const WORST: f64 = 0.5;

/// Sums over the points of a face, of weights b of the corners and heights h above its plane. A move
/// of the corners along the normal by s makes their squares Σ (h − b·s)².
#[derive(Clone, Copy, Default)]
struct FaceSum {
    /// Σ b b'.
    squares: [[f64; 3]; 3],
    /// Σ b h.
    pulls: [f64; 3],
    /// Weights and height of the highest point, above or below.
    worst: ([f64; 3], f64),
}

/// Sums over the points of all faces of a level.
pub(super) struct LevelFit<'n> {
    normals: &'n [Vec3],
    sums: Vec<FaceSum>,
}

impl<'n> LevelFit<'n> {
    pub(super) fn new(nearest: &'n NearestFaces<'_>) -> Self {
        let normals = &nearest.normals[..];
        Self { normals, sums: vec![FaceSum::default(); normals.len()] }
    }

    pub(super) fn add(&mut self, hit: &Hit) {
        let sum = &mut self.sums[hit.face as usize];
        let (weights, height) = (hit.weights.map(f64::from), f64::from(hit.height));
        for i in 0..3 {
            let own = f64::from(hit.area) * weights[i];
            sum.pulls[i] += own * height;
            (0..3).for_each(|k| sum.squares[i][k] += own * weights[k]);
        }
        if height.abs() > sum.worst.1.abs() {
            sum.worst = (weights, height);
        }
    }

    /// Returns the moves of the vertices, each in turn to where it fits best, given the others.
    pub(super) fn moves(
        &self,
        connectivity: &Connectivity,
        faces: &[[VertexId; 3]],
        free: &[bool],
    ) -> Vec<DVec3> {
        let mut moves = vec![DVec3::ZERO; free.len()];
        for _ in 0..SWEEPS {
            for v in (0..free.len()).filter(|&v| free[v]) {
                let v = VertexId::new(v);
                let (mut matrix, mut pull, mut weight) = (DMat3::ZERO, DVec3::ZERO, 0.0);
                for face in connectivity.star(v) {
                    let (normal, sum) = (self.normals[face.index()], &self.sums[face.index()]);
                    let normal = normal.as_dvec3();
                    let corners = faces[face.index()];
                    let own = corners.iter().position(|&w| w == v).expect("it is in its star");
                    let others = (0..3).filter(|&k| k != own);
                    let by_others =
                        others.map(|k| sum.squares[own][k] * normal.dot(moves[corners[k].index()]));
                    pull += normal * (sum.pulls[own] - by_others.sum::<f64>());
                    let square = sum.squares[own][own];
                    weight += square;
                    let scaled = normal * square;
                    matrix +=
                        DMat3::from_cols(scaled * normal.x, scaled * normal.y, scaled * normal.z);
                }
                if weight > 0.0 {
                    matrix += DMat3::from_diagonal(DVec3::splat(HOLD * weight));
                    let by = matrix.inverse() * pull;
                    moves[v.index()] = if by.is_finite() { by } else { DVec3::ZERO };
                }
            }
        }
        moves
    }

    /// Leaves out moves of the vertices of faces whose highest point would be higher, and so high that
    /// it may be the highest of all.
    pub(super) fn hold_worst(&self, moves: &mut [DVec3], faces: &[[VertexId; 3]], unit: f64) {
        let worst = self.sums.iter().map(|sum| sum.worst.1.abs()).fold(0.0, f64::max);
        let mut held = Vec::new();
        for ((sum, face), normal) in self.sums.iter().zip(faces).zip(self.normals) {
            let (weights, height) = sum.worst;
            let normal = normal.as_dvec3();
            let by: f64 = (0..3).map(|k| weights[k] * normal.dot(moves[face[k].index()])).sum();
            let left = (height - by / unit).abs();
            if left > height.abs() && left > WORST * worst {
                held.extend(*face);
            }
        }
        held.iter().for_each(|v| moves[v.index()] = DVec3::ZERO);
    }
}
