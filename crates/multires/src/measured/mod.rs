//! Measured errors instead of estimates: how far each update's coarse side is from the input, and
//! the input from it.
//!
//! The contractions are replayed. Points of the input are kept with faces of the current mesh: a
//! contraction hands those of the faces that it removes or changes on to the nearest of the faces
//! that it makes. In every cut each point is with exactly one face that is shown, so its distance is
//! known there ([`handed_on`]). Points of new faces are compared with the input itself ([`probes`]).
//! In between, single places are farther away: who needs a promise checks the cut.
//!
//! Where the mesh is posed ([`posing`]), the same is done once more in every pose, with the corners of
//! all faces where the pose puts their wedges ([`corners`]).

mod corners;
mod handed_on;
mod posing;
mod probes;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::DVec3;
use meshlod_mesh::{Mesh, VertexId};
use meshlod_spatial::Bvh;
use rayon::prelude::*;

use crate::error_kind::ErrorKind;
use crate::forest::{Forest, MonotoneErrors, Stars};
use crate::length16::Length16;
use corners::{AtNodes, Corners, WedgeTable};
use handed_on::HandedOn;
pub use posing::{PosedWedges, Posing};
use probes::Probes;

/// Distances below this fraction of the mesh's size are rounding errors of a model in memory;
/// estimates are kept there.
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
    /// With [poses](Forest::pose_by) that holds in each of them, too, with cut and input posed alike.
    ///
    /// Cost: O(n log n), n = faces; about as long as recording, and up to as long for each pose.
    /// # References
    /// [CMO97] for errors taken from step to step; differs: distances from the input itself, of
    /// points.
    pub fn measure_errors(&mut self) {
        let input = self.input();
        self.measure_against(&input, NOISE);
    }

    /// Gives the mesh poses in which errors are measured, here and when a file is written with
    /// [`StoredErrors::Measured`](crate::StoredErrors::Measured). Estimates and bounds know nothing
    /// of them.
    pub fn pose_by(&mut self, posing: Arc<dyn Posing>) {
        self.posing = Some(posing);
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
        let measure = Measure::new(self, AtNodes(self), (input, &bvh), noise);
        let rounded = Length16::up(noise);
        let errors = measure.replay(|u| (Length16(0), self.updates[u].error.min(rounded)));
        self.set_errors(errors);
        if let Some(posing) = self.posing.clone() {
            self.measure_poses(&*posing, input, noise);
        }
        self.error_kind = ErrorKind::Measured;
    }

    /// Raises all errors to the distances measured in poses. A pose of places that are not finite
    /// makes all errors infinite.
    fn measure_poses(&mut self, posing: &dyn Posing, input: &Mesh, noise: f64) {
        let table = WedgeTable::new(self, input);
        let in_pose = |pose: usize| {
            let input = table.input(self, posing, pose);
            let Ok(bvh) = Bvh::new(&input) else {
                return vec![Length16::INFINITE; self.updates.len()];
            };
            let corners = table.corners(self, posing, pose);
            let measure = Measure::new(self, corners, (&input, &bvh), noise);
            // Only what is farther away than in the pose of the mesh counts.
            measure.replay(|u| (self.updates[u].error, self.updates[u].error))
        };
        let greatest = |mut all: Vec<Length16>, more: Vec<Length16>| {
            all.iter_mut().zip(more).for_each(|(error, more)| *error = (*error).max(more));
            all
        };
        let errors = (0..posing.count()).into_par_iter().map(in_pose).reduce_with(greatest);
        self.set_errors(errors.unwrap_or_default());
    }
}

/// Replay of the contractions that measures distances.
struct Measure<'f, C> {
    forest: &'f Forest,
    stars: Stars,
    corners: C,
    handed_on: HandedOn,
    probes: Probes<'f>,
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

impl<'f, C: Corners> Measure<'f, C> {
    fn new(forest: &'f Forest, corners: C, (input, bvh): (&Mesh, &'f Bvh), noise: f64) -> Self {
        Self {
            forest,
            stars: Stars::new(forest),
            corners,
            handed_on: HandedOn::new(input),
            probes: Probes::new(bvh, forest.positions.len()),
            coarse: Vec::new(),
            noise,
        }
    }

    /// Replays all updates and returns their errors. `known(u)` gives a lower bound of u's error,
    /// and its error if all distances are below the noise.
    fn replay(mut self, known: impl Fn(usize) -> (Length16, Length16)) -> Vec<Length16> {
        let mut errors = MonotoneErrors::new(self.forest);
        for u in 0..self.forest.updates.len() {
            let (known, without) = known(u);
            let apart = self.contract(u, errors.least(self.forest).max(known).get());
            let own = if apart > self.noise { Length16::up(apart).max(known) } else { without };
            errors.push(self.forest, own);
        }
        errors.finish()
    }

    /// Replays an update. Returns the greatest distance found, or anything up to `least` or the
    /// noise if it is no greater.
    fn contract(&mut self, u: usize, least: f64) -> f64 {
        let node = self.forest.node(u) as u32;
        self.stars.contract(self.forest.updates[u].children, node);
        self.corners.contract(&self.stars, node);
        self.coarse.clear();
        for &face in self.stars.changed() {
            let Some(mut nodes) = self.stars.face(face) else { continue };
            let first = nodes.iter().position(|&corner| corner == node).unwrap_or(0);
            let mut corners =
                std::array::from_fn(|corner| self.corners.at(face, corner, nodes[corner]));
            nodes.rotate_left(first);
            corners.rotate_left(first);
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
