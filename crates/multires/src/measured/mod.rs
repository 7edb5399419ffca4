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
        self.measure_against(self.input(), NOISE);
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
    pub(crate) fn measure_against(&mut self, input: Mesh, noise: f64) {
        let Ok(bvh) = Bvh::new(&input) else { return };
        let posed = self.posing.clone().map(|posing| (posing, input.clone()));
        let measure = Measure::new(self, AtNodes(self), input, noise);
        let rounded = Length16::up(noise);
        let known = |u: usize| (Length16(0), self.updates[u].error.min(rounded));
        let errors = measure.replay(Probes::new(&bvh, self), known);
        drop(bvh);
        self.set_errors(errors);
        if let Some((posing, input)) = posed {
            self.measure_poses(&*posing, &input, noise);
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
            let measure = Measure::new(self, corners, input, noise);
            // Only what is farther away than in the pose of the mesh counts.
            let known = |u: usize| (self.updates[u].error, self.updates[u].error);
            measure.replay(Probes::new(&bvh, self), known)
        };
        let greatest = |mut all: Vec<Length16>, more: Vec<Length16>| {
            all.iter_mut().zip(more).for_each(|(error, more)| *error = (*error).max(more));
            all
        };
        let errors = (0..posing.count()).into_par_iter().map(in_pose).reduce_with(greatest);
        self.set_errors(errors.unwrap_or_default());
    }
}

/// Number of updates that are replayed together: enough to be worth sharing out.
const BLOCK: usize = 1024;

/// Number of faces at which a block ends early, as at hubs.
const BLOCK_FACES: usize = 1 << 16;

/// Replay of the contractions that measures distances.
struct Measure<'f, C> {
    forest: &'f Forest,
    stars: Stars,
    corners: C,
    handed_on: HandedOn,
    /// Errors by the points of the input alone.
    from_input: MonotoneErrors,
    noise: f64,
}

/// Updates that have been replayed, but not probed.
#[derive(Debug, Default)]
struct Replayed {
    first: usize,
    /// By update: the distance of the input's points, and the least that matters.
    apart: Vec<[f64; 2]>,
    /// By update: the end of its coarse side.
    ends: Vec<usize>,
    coarse: Vec<CoarseFace>,
}

/// Face of a coarse side, with its corners rotated so that the new node's comes first.
#[derive(Clone, Copy, Debug)]
struct CoarseFace {
    face: u32,
    corners: [DVec3; 3],
}

impl Replayed {
    /// Returns the coarse side of the update at this place.
    fn coarse(&self, i: usize) -> &[CoarseFace] {
        let start = i.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.coarse[start..self.ends[i]]
    }
}

impl<'f, C: Corners + Send> Measure<'f, C> {
    fn new(forest: &'f Forest, corners: C, input: Mesh, noise: f64) -> Self {
        Self {
            forest,
            stars: Stars::new(forest),
            corners,
            handed_on: HandedOn::new(input),
            from_input: MonotoneErrors::new(forest),
            noise,
        }
    }

    /// Replays all updates and returns their errors. `known(u)` gives a lower bound of u's error,
    /// and its error if all distances are below the noise.
    ///
    /// While a block is replayed, which goes step by step, the one before it is probed.
    fn replay(
        mut self,
        mut probes: Probes<'_>,
        known: impl Fn(usize) -> (Length16, Length16) + Sync,
    ) -> Vec<Length16> {
        let (forest, noise) = (self.forest, self.noise);
        let own = |u: usize, apart: f64| {
            let (known, without) = known(u);
            if apart > noise { Length16::up(apart).max(known) } else { without }
        };
        let mut errors = MonotoneErrors::new(forest);
        let mut block = Replayed::default();
        loop {
            let next = block.first + block.ends.len();
            let (replayed, found) = rayon::join(
                || self.block(next, |u| known(u).0, own),
                || probes.farthest(forest, &block),
            );
            for (i, &(apart, near)) in found.iter().enumerate() {
                errors.push(forest, own(block.first + i, apart));
                probes.note(forest.node(block.first + i), near);
            }
            if replayed.ends.is_empty() {
                return errors.finish();
            }
            block = replayed;
        }
    }

    /// Replays the next updates, from the `first` one on.
    fn block(
        &mut self,
        first: usize,
        known: impl Fn(usize) -> Length16,
        own: impl Fn(usize, f64) -> Length16,
    ) -> Replayed {
        let mut block = Replayed { first, ..Replayed::default() };
        for u in (first..self.forest.updates.len()).take(BLOCK) {
            let start = block.coarse.len();
            self.contract(u, &mut block.coarse);
            let least = self.from_input.least(self.forest).max(known(u)).get().max(self.noise);
            let apart = match &block.coarse[start..] {
                [] => f64::INFINITY,
                coarse => self.handed_on.pass(self.stars.changed(), coarse, least),
            };
            self.from_input.push(self.forest, own(u, apart));
            block.apart.push([apart, least]);
            block.ends.push(block.coarse.len());
            if block.coarse.len() > BLOCK_FACES {
                break;
            }
        }
        block
    }

    /// Replays an update, and appends its coarse side.
    fn contract(&mut self, u: usize, coarse: &mut Vec<CoarseFace>) {
        let node = self.forest.node(u) as u32;
        self.stars.contract(self.forest.updates[u].children, node);
        self.corners.contract(&self.stars, node);
        for &face in self.stars.changed() {
            let Some(nodes) = self.stars.face(face) else { continue };
            let first = nodes.iter().position(|&corner| corner == node).unwrap_or(0);
            let mut corners =
                std::array::from_fn(|corner| self.corners.at(face, corner, nodes[corner]));
            corners.rotate_left(first);
            coarse.push(CoarseFace { face, corners });
        }
    }
}
