//! Random numbers that are the same on every run, and what is made of them.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};
use meshlod_mesh::Mesh;

/// Sequence of random numbers (SplitMix64).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Returns a number from 0 to 1, without 1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns a whole number from `least` to `most`.
    pub(crate) fn whole(&mut self, least: usize, most: usize) -> usize {
        least + (self.unit() * (most - least + 1) as f64) as usize
    }

    /// Returns a number from `least` to `most` whose logarithm is uniform.
    pub(crate) fn scale(&mut self, least: f64, most: f64) -> f64 {
        least * (most / least).powf(self.unit())
    }

    /// Returns a uniformly random rotation.
    ///
    /// # References
    /// [Sho92], Uniform Random Rotations.
    pub(crate) fn rotation(&mut self) -> DQuat {
        let [part, first, second] = [(); 3].map(|()| self.unit());
        let [(sine, cosine), (far_sine, far_cosine)] =
            [first, second].map(|turn| (TAU * turn).sin_cos());
        let [near, far] = [(1.0 - part).sqrt(), part.sqrt()];
        DQuat::from_xyzw(near * sine, near * cosine, far * far_sine, far * far_cosine).normalize()
    }
}

/// Returns a mesh rotated about the origin by a uniformly random rotation, so that no plane of it is
/// at right angles to an axis any more.
pub fn turned(mesh: &Mesh, seed: u64) -> Mesh {
    let turn = Random::new(seed ^ 0x7475_726e).rotation();
    let positions = mesh.positions.iter().map(|&at| (turn * DVec3::from(at)).into()).collect();
    Mesh { positions, ..mesh.clone() }
}
