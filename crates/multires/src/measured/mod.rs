//! Measured errors instead of estimates: how far each update's coarse side is from the input, and
//! the input from it.
//!
//! The contractions are replayed. Points of the input are kept with faces of the current mesh: a
//! contraction hands those of the faces that it removes or changes on to the nearest of the faces
//! that it makes. In every cut each point is with exactly one face that is shown, so its distance is
//! known there ([`handed_on`]). Points of new faces are compared with the input itself ([`probes`]).
//! In between, single places are farther away: who needs a promise checks the cut.

mod handed_on;
mod probes;
#[cfg(test)]
mod tests;

use glam::DVec3;
use meshlod_mesh::{Mesh, VertexId};
use meshlod_spatial::Bvh;

use crate::bounds::ErrorKind;
use crate::forest::{Forest, Stars};
use crate::length16::Length16;
use handed_on::HandedOn;
use probes::Probes;

/// Distances below this part of the mesh's size are not told apart from none, and estimates are
/// kept: the rounding of a model in memory.
const NOISE: f64 = 1e-5;

impl Forest {
    /// Replaces the error of every update by the greatest distance measured between its coarse side
    /// and the input, both ways.
    ///
    /// Take any cut, and let *t* be the greatest error of the updates it leaves unrefined. Every
    /// measured point of the cut is then within *t* of the input, and every measured point of the
    /// input within *t* of the cut: the input's vertices one way, and the vertices of the cut with the
    /// middles of new edges the other. Errors never grow from an update to one that
    /// depends on it. Where all distances are below a hundred-thousandth of the mesh's size the
    /// estimates stay. An update whose coarse side has no face left gets an infinite error.
    ///
    /// Cost: O(n log n), n = faces; about as long as recording.
    /// # References
    /// [CMO97] for errors taken from step to step; differs: distances from the input itself, of
    /// points.
    pub fn measure_errors(&mut self) {
        let input = self.input();
        self.measure_against(&input, NOISE);
    }

    /// Returns the input: the finest mesh, in stored units.
    pub(crate) fn input(&self) -> Mesh {
        let leaves = (0..self.vertices as u32).map(|leaf| self.exact_stored(leaf).to_array());
        Mesh::new(leaves.collect(), self.faces.iter().map(|face| face.map(VertexId)).collect())
    }

    /// Replaces all errors by measured distances from `input`, given in stored units with the
    /// leaves as vertices; distances up to `noise` count as none.
    pub(crate) fn measure_against(&mut self, input: &Mesh, noise: f64) {
        let Ok(bvh) = Bvh::new(input) else { return };
        let mut measure = Measure {
            stars: Stars::new(self),
            handed_on: HandedOn::new(input),
            probes: Probes::new(&bvh, self.positions.len()),
            coarse: Vec::new(),
            noise,
        };
        // By node: the greatest error of the updates that depend on the one that contracts it.
        let mut lower_bounds = vec![Length16::default(); self.positions.len()];
        for u in 0..self.updates.len() {
            let [a, b] = self.updates[u].children.map(|child| lower_bounds[child as usize]);
            let least = a.max(b);
            let apart = measure.contract(self, u, least.get());
            let own = if apart > noise {
                Length16::up(apart)
            } else {
                self.updates[u].error.min(Length16::up(noise))
            };
            self.set_error(u, own.max(least), &mut lower_bounds);
        }
        self.error_kind = ErrorKind::Measured;
    }
}

/// Replay of the contractions that measures distances.
struct Measure<'b> {
    stars: Stars,
    handed_on: HandedOn,
    probes: Probes<'b>,
    /// Coarse side of the current update: faces, by number and corners.
    coarse: Vec<CoarseFace>,
    noise: f64,
}

/// Face of a coarse side, with its corners rotated so that the new node's comes first.
#[derive(Clone, Copy, Debug)]
struct CoarseFace {
    face: u32,
    nodes: [u32; 3],
    corners: [DVec3; 3],
}

impl Measure<'_> {
    /// Replays an update. Returns the greatest distance found, or anything up to `least` or the
    /// noise if it is no greater.
    fn contract(&mut self, forest: &Forest, u: usize, least: f64) -> f64 {
        let node = forest.node(u) as u32;
        self.stars.contract(forest.updates[u].children, node);
        self.coarse.clear();
        for &face in self.stars.changed() {
            let Some(mut nodes) = self.stars.face(face) else { continue };
            let first = nodes.iter().position(|&corner| corner == node).unwrap_or(0);
            nodes.rotate_left(first);
            let corners = nodes.map(|corner| forest.exact_stored(corner));
            self.coarse.push(CoarseFace { face, nodes, corners });
        }
        if self.coarse.is_empty() {
            return f64::INFINITY;
        }
        let least = least.max(self.noise);
        let farthest = self.handed_on.pass(self.stars.changed(), &self.coarse, least);
        farthest.max(self.probes.farthest(&self.coarse, farthest.max(least)))
    }
}
