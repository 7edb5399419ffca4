//! An error that is asked for: the room that writing takes of it, and what is proved in the end.

use meshlod_io::Scene;
use meshlod_measure::{CertifiedOptions, PreparedSurface, certified_surface_distance};
use meshlod_mesh::Mesh;
use meshlod_simplify::{Digits, Report, Target};

use crate::jobs::WrittenAs;
use crate::jobs::scene_run::surface_of;
use crate::jobs::written_as::digits;
use crate::scene::{rounding_in_meshes, rounding_of_level};

/// Part of the error that rounding may take before coordinates are written with 64 bits.
const UNSEEN: f64 = 0.005;

/// Largest part of the error that is kept free for rounding.
const MOST_ROOM: f64 = 0.5;

/// Multiple of the rounding that is kept free where the volume is restored.
const MOVES: f64 = 5.0;

/// Relative difference of two lengths that counts as none: the rounding of their computation.
const EQUAL: f64 = 1e-9;

/// An error asked for, in world units.
#[derive(Clone, Copy)]
pub(super) struct BoundToProve {
    asked: f64,
    /// Largest distance by which writing moves a point.
    rounding: f64,
    /// Distance kept free for rounding, and for moves that restore the volume.
    room: f64,
}

/// An error that was asked for with what is proved of it as it is written, in world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProvedError {
    /// Largest distance asked for.
    pub asked: f64,
    /// Upper bound of the distance between the input and what is written, both ways; `None` if
    /// there is none.
    pub proved: Option<f64>,
    /// True if what was asked for is proved.
    pub is_held: bool,
    /// Number of times that contractions were taken back, or the run was repeated, to hold it.
    pub rounds: usize,
    /// Largest distance by which writing moves a point.
    pub rounding: f64,
}

impl ProvedError {
    /// Returns true if writing takes so much of the error that fewer contractions do not help.
    pub fn is_rounded_away(&self) -> bool {
        self.rounding > MOST_ROOM * self.asked
    }
}

impl BoundToProve {
    /// Restoring the volume moves vertices too, mostly by about twice the rounding.
    ///
    /// A file with nodes is proved in its own numbers: what a node far from the origin adds to a
    /// coordinate is rounded by whoever adds it.
    pub fn new(
        asked: f64,
        scene: &Scene,
        written_as: Option<WrittenAs>,
        is_volume_restored: bool,
    ) -> Self {
        let has_nodes = |as_: &WrittenAs| as_.format.is_gltf() && scene.source.is_some();
        let rounding = match digits(written_as) {
            Digits::F32 if written_as.as_ref().is_some_and(has_nodes) => rounding_in_meshes(scene),
            digits => rounding_of_level(scene, digits),
        };
        let room = if is_volume_restored { MOVES * rounding } else { rounding };
        Self { asked, rounding, room }
    }

    /// Returns whether rounding takes more of the error than goes unseen.
    pub fn needs_precision(&self) -> bool {
        self.room > UNSEEN * self.asked
    }

    /// Returns the target that leaves room for rounding.
    pub fn target(&self) -> Target {
        Target::Error(self.asked - self.room.min(MOST_ROOM * self.asked))
    }

    /// Returns what the proof in a report says of the level as it is written, after its vertices
    /// have moved by at most `moved`.
    pub fn by_report(&self, report: &Report, moved: f64) -> ProvedError {
        let changed = self.rounding + moved;
        let proved = report.proof.map(|proof| match proof.proved <= proof.asked {
            true => (proof.asked + changed).max(self.asked),
            false => proof.proved + changed,
        });
        let rounds = report.proof.map_or(0, |proof| proof.rounds);
        self.with(proved, self.is_within(proved), rounds)
    }

    /// Measures an upper bound of the distance between the original surface and a level.
    pub fn by_measuring(
        &self,
        original: Option<&PreparedSurface<'_>>,
        scene: &Scene,
        level: &[Mesh],
    ) -> ProvedError {
        let level = surface_of(scene, level);
        let proved = original.zip(PreparedSurface::new(&level).ok()).map(|(original, level)| {
            let options = CertifiedOptions::up_to(self.asked / original.diagonal());
            let bracket = certified_surface_distance(original, &level, &options).symmetric();
            bracket.upper + self.rounding
        });
        self.with(proved, self.is_within(proved), 0)
    }

    fn is_within(&self, proved: Option<f64>) -> bool {
        proved.is_some_and(|proved| proved <= self.asked * (1.0 + EQUAL))
    }

    fn with(&self, proved: Option<f64>, is_held: bool, rounds: usize) -> ProvedError {
        ProvedError { asked: self.asked, proved, is_held, rounds, rounding: self.rounding }
    }
}

#[cfg(test)]
mod tests {
    use meshlod_io::{Format, Precision, Weld, gltf};
    use meshlod_samples as samples;

    use super::*;

    #[test]
    fn a_node_far_from_the_origin_takes_nothing_of_an_error() {
        let mut scene = Scene::from_mesh("torus", samples::torus(600));
        scene.nodes[0].transform[3] = [4.5e6, 0.0, 0.0, 1.0];
        let bytes = gltf::write_glb(&scene, &[]).unwrap();
        let read = gltf::read(&bytes, &mut |_| None, Weld::Exact).unwrap();
        let room = |scene: &Scene, format| {
            let as_ = WrittenAs { format, precision: Precision::F32 };
            BoundToProve::new(0.01, scene, Some(as_), false).room
        };
        assert!(room(&read, Format::Glb) < 1e-5);
        assert!(room(&read, Format::Ply) > 0.1);
    }
}
