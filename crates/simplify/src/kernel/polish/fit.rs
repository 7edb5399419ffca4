//! Least squares: moves of vertices that bring faces to the points of the input nearest to them.

use glam::{DMat3, DVec3, Vec3};
use meshlod_mesh::{Connectivity, VertexId};

use super::nearest::{Hit, NearestFaces};

/// Weight that holds a vertex where it is, as a part of that of its points: along the surface nothing
/// else does.
const HOLD: f64 = 0.03;

/// Largest displacement of a vertex, as a multiple of the root of the mean squared height of the points
/// around.
const FARTHEST: f64 = 2.0;

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
    /// Σ h², and the sum of the weights of points.
    heights: [f64; 2],
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
        sum.heights[0] += f64::from(hit.area) * height * height;
        sum.heights[1] += f64::from(hit.area);
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
                let by = self.best(VertexId::new(v), (connectivity, faces), &moves);
                moves[v] = if by.is_finite() { by } else { DVec3::ZERO };
            }
        }
        moves
    }

    /// Returns the best move of a vertex, given those of the others.
    fn best(
        &self,
        v: VertexId,
        (connectivity, faces): (&Connectivity, &[[VertexId; 3]]),
        moves: &[DVec3],
    ) -> DVec3 {
        let (mut matrix, mut pull, mut weight, mut heights) =
            (DMat3::ZERO, DVec3::ZERO, 0.0, [0.0; 2]);
        for face in connectivity.star(v) {
            let (corners, sum) = (faces[face.index()], &self.sums[face.index()]);
            let normal = self.normals[face.index()].as_dvec3();
            let own = corners.iter().position(|&w| w == v).expect("it is in its star");
            let others = (0..3).filter(|&k| k != own);
            let by_others: f64 =
                others.map(|k| sum.squares[own][k] * normal.dot(moves[corners[k].index()])).sum();
            let square = sum.squares[own][own];
            pull += normal * (sum.pulls[own] - by_others);
            matrix +=
                DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z) * square;
            weight += square;
            heights = [heights[0] + sum.heights[0], heights[1] + sum.heights[1]];
        }
        let held = matrix + DMat3::from_diagonal(DVec3::splat(HOLD * weight));
        let most = FARTHEST * (heights[0] / heights[1]).sqrt();
        if weight > 0.0 { (held.inverse() * pull).clamp_length_max(most) } else { DVec3::ZERO }
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
