//! Vertices of the input, each kept with a face of the current mesh.

use glam::DVec3;
use meshlod_mesh::Mesh;
use meshlod_spatial::closest_point;

use super::CoarseFace;
use crate::forest::NONE;

/// A face within this fraction of the relevant distance is near enough for a vertex. A vertex that
/// is not handed to its nearest face has less room later.
const NEAR_FRACTION: f64 = 0.5;

/// Number of vertices at a coarse side beyond which every other one is dropped for good, if they
/// are closer to each other than the relevant distance.
const THIN_OUT_ABOVE: usize = 100;

/// Vertices of the input by the face of the current mesh that they were handed to.
#[derive(Debug)]
pub(super) struct HandedOn {
    places: Vec<[f64; 3]>,
    /// By face: its first vertex.
    first: Vec<u32>,
    /// By vertex: the next one of its face.
    next: Vec<u32>,
    /// Vertices of the last coarse side.
    passed: Vec<u32>,
}

impl HandedOn {
    /// Hands each vertex of the input to one of its faces.
    pub(super) fn new(input: Mesh) -> Self {
        let mut first = vec![NONE; input.faces.len()];
        let mut next = vec![NONE; input.positions.len()];
        let mut taken = vec![false; input.positions.len()];
        for (first, face) in first.iter_mut().zip(&input.faces) {
            for v in face {
                if !std::mem::replace(&mut taken[v.index()], true) {
                    next[v.index()] = std::mem::replace(first, v.0);
                }
            }
        }
        Self { places: input.positions, first, next, passed: Vec::new() }
    }

    /// Hands the vertices of the changed faces on to the coarse side, each to the nearest face, or
    /// to any that is well within `least`. Returns the greatest of their distances.
    pub(super) fn pass(&mut self, changed: &[u32], coarse: &[CoarseFace], least: f64) -> f64 {
        self.passed.clear();
        for &face in changed {
            let mut v = std::mem::replace(&mut self.first[face as usize], NONE);
            while v != NONE {
                self.passed.push(v);
                v = self.next[v as usize];
            }
        }
        let reach = coarse.iter().map(|face| face.corners[0].distance_squared(face.corners[1]));
        let reach = reach.fold(0.0, f64::max).sqrt();
        while self.passed.len() > THIN_OUT_ABOVE
            && least * (self.passed.len() as f64).sqrt() > reach
        {
            let mut keep = false;
            self.passed.retain(|_| {
                keep = !keep;
                keep
            });
        }
        let enough = (NEAR_FRACTION * least).powi(2);
        let (mut farthest, mut near) = (0f64, 0);
        for &v in &self.passed {
            let squared;
            // Vertices of one face are together, so the last one's face comes first.
            (squared, near) = nearest(self.places[v as usize].into(), coarse, near, enough);
            farthest = farthest.max(squared);
            let first = &mut self.first[coarse[near].face as usize];
            self.next[v as usize] = std::mem::replace(first, v);
        }
        farthest.sqrt()
    }
}

/// Returns the squared distance of a point from the nearest face, or from any within `enough`, with
/// the index of that face. The face at `hint` is tried first.
fn nearest(at: DVec3, coarse: &[CoarseFace], hint: usize, enough: f64) -> (f64, usize) {
    let mut best = (f64::INFINITY, hint);
    for i in (hint..coarse.len()).chain(0..hint) {
        let squared = at.distance_squared(closest_point(at, &coarse[i].corners));
        if squared < best.0 {
            best = (squared, i);
            if squared <= enough {
                break;
            }
        }
    }
    best
}
