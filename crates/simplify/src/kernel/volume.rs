//! Accounting of the volume lost by contractions.

use glam::{DVec3, Vec3};
use meshlod_mesh::Bounds;

use crate::history::volume::{Unconserved, VolumeLoss};
use crate::kernel::mesh::local_frame::Frame;

/// Volume lost so far, and the contractions that could not preserve it, in the frame.
///
/// Places are rounded, so free contractions lose a little too.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct VolumeTally {
    sixfold: f64,
    /// Six times the volume of the closed components that have vanished.
    vanished: f64,
    open: Unchosen,
    held: Unchosen,
}

/// Fraction of half an edge by which a place may miss the plane of equal volume without a debt, so
/// that rounding leaves none.
const NO_DEBT: f64 = 1e-4;

/// Volume that contractions at each vertex of a part still owe, six times, in the frame. The next
/// contraction whose ring has the vertex takes the debt over and aims to repay it, so that a debt
/// goes where contractions go on. Vertices outside the part owe nothing.
///
/// Empty as long as nothing is owed, as on most scans.
#[derive(Debug, Default)]
pub(crate) struct VolumeDebts(Vec<f32>);

impl VolumeDebts {
    /// Returns the sum of what vertices owe, given by their indices in the part.
    #[inline(always)]
    pub(crate) fn owed(&self, around: impl Iterator<Item = usize>) -> f64 {
        match &self.0[..] {
            [] => 0.0,
            all => around.map(|v| all.get(v).map_or(0.0, |&debt| f64::from(debt))).sum(),
        }
    }

    /// Takes what vertices owe, given by their indices in the part.
    #[inline(always)]
    pub(crate) fn take(&mut self, around: impl Iterator<Item = usize>) -> f64 {
        match &mut self.0[..] {
            [] => 0.0,
            all => around
                .map(|v| all.get_mut(v).map_or(0.0, |debt| f64::from(std::mem::take(debt))))
                .sum(),
        }
    }

    /// Sets what a vertex owes in a part of `len` vertices after a contraction that lost `lost` and
    /// took over `owed`. Faces with the sum `normal` moved, and half the edge is as long as `half`.
    #[inline(always)]
    pub(crate) fn settle(
        &mut self,
        (vertex, len): (usize, usize),
        (owed, lost): (f64, f64),
        (normal, half): (DVec3, DVec3),
    ) {
        let least = NO_DEBT * NO_DEBT * normal.length_squared() * half.length_squared();
        if owed != 0.0 || lost * lost > least {
            self.0.resize(len, 0.0);
            self.0[vertex] = (owed + lost) as f32;
        }
    }

    /// Returns the vertices that owe volume, by their indices in the part, and how much.
    pub(crate) fn all(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let owes = |&(_, &debt): &(usize, &f32)| debt != 0.0;
        self.0.iter().enumerate().filter(owes).map(|(v, &debt)| (v, debt.into()))
    }

    /// Appends the debts of the next part. The parts have these numbers of vertices.
    pub(crate) fn append(&mut self, len: usize, next: Self, next_len: usize) {
        if !(self.0.is_empty() && next.0.is_empty()) {
            self.0.resize(len, 0.0);
            self.0.extend(next.0);
            self.0.resize(len + next_len, 0.0);
        }
    }
}

/// Number of contractions, and the bounding box of where they were.
#[derive(Clone, Copy, Debug)]
struct Unchosen {
    contractions: usize,
    min: Vec3,
    max: Vec3,
}

impl Default for Unchosen {
    fn default() -> Self {
        Self { contractions: 0, min: Vec3::INFINITY, max: Vec3::NEG_INFINITY }
    }
}

impl VolumeTally {
    /// Counts a contraction to `place` that loses a sixth of `sixfold`.
    #[inline(always)]
    pub(crate) fn add(&mut self, place: Vec3, sixfold: f64, is_open: bool, is_held: bool) {
        if is_open {
            return self.open.add(place);
        }
        self.sixfold += sixfold;
        if is_held {
            self.held.add(place);
        }
    }

    /// Counts a vanished component with these vertices and a sixth of `sixfold` as its volume,
    /// beside a sixth of what it owes.
    pub(crate) fn add_component(
        &mut self,
        places: &[Vec3],
        [sixfold, owed]: [f64; 2],
        is_open: bool,
    ) {
        let kind = if is_open { &mut self.open } else { &mut self.held };
        kind.contractions += 1;
        for &place in places {
            (kind.min, kind.max) = (kind.min.min(place), kind.max.max(place));
        }
        self.sixfold -= owed;
        if !is_open {
            self.vanished += (sixfold + owed).abs();
        }
    }

    /// Adds the tally of another part.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.sixfold += other.sixfold;
        self.vanished += other.vanished;
        self.open.merge(&other.open);
        self.held.merge(&other.held);
    }

    /// Converts the tally to model units. `owed` is six times the volume still owed.
    pub(crate) fn loss(&self, frame: &Frame, owed: f64) -> VolumeLoss {
        let sixth = frame.unit.powi(3) / 6.0;
        VolumeLoss {
            running_sum: self.sixfold * sixth,
            owed: owed * sixth,
            repaid: 0.0,
            vanished: self.vanished * sixth,
            behind_boundary_cones: None,
            at_boundaries: self.open.to_model(frame),
            held: self.held.to_model(frame),
        }
    }
}

impl Unchosen {
    #[cold]
    fn add(&mut self, place: Vec3) {
        self.contractions += 1;
        (self.min, self.max) = (self.min.min(place), self.max.max(place));
    }

    fn merge(&mut self, other: &Self) {
        self.contractions += other.contractions;
        (self.min, self.max) = (self.min.min(other.min), self.max.max(other.max));
    }

    fn to_model(self, frame: &Frame) -> Unconserved {
        let Self { contractions, min, max } = self;
        let mut bounds = Bounds::EMPTY;
        if contractions > 0 {
            [min, max].iter().for_each(|&corner| bounds.add(frame.to_model(corner)));
        }
        Unconserved { contractions, bounds }
    }
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::cube;

    use super::*;

    #[test]
    fn open_and_held_contractions_are_counted_apart() {
        let mesh = cube();
        let frame = Frame::new(&mesh, &mesh.bounds());
        let mut volume = VolumeTally::default();
        volume.add(Vec3::ZERO, 6.0, false, false);
        volume.add(Vec3::ONE, 7.0, true, false);
        volume.add(Vec3::ONE, 6.0, false, true);
        let loss = volume.loss(&frame, 3.0);
        assert!((loss.running_sum / frame.unit.powi(3) - 2.0).abs() < 1e-12);
        assert!((loss.owed / frame.unit.powi(3) - 0.5).abs() < 1e-12);
        assert_eq!([loss.at_boundaries.contractions, loss.held.contractions], [1, 1]);
        assert_eq!(loss.held.bounds.min, frame.to_model(Vec3::ONE));
    }

    #[test]
    fn debts_are_those_of_both_ends_and_none_beyond_the_last_vertex() {
        let (mut debts, plane) = (VolumeDebts::default(), (DVec3::X, DVec3::X));
        assert_eq!(debts.owed([0, 7].into_iter()), 0.0);
        debts.settle((1, 3), (0.0, 0.5 * NO_DEBT), plane);
        assert!(debts.0.is_empty(), "rounding is no debt");
        debts.settle((1, 3), (0.0, 0.5), plane);
        debts.settle((2, 3), (0.0, -0.125), plane);
        assert_eq!(
            [[1, 2], [0, 2], [1, 3], [3, 4]].map(|v| debts.owed(v.into_iter())),
            [0.375, -0.125, 0.5, 0.0]
        );
        debts.settle((1, 3), (0.375, -0.375), plane);
        assert_eq!(debts.owed([0, 1].into_iter()), 0.0, "a debt that is repaid is gone");
        assert_eq!(debts.all().collect::<Vec<_>>(), [(2, -0.125)]);
        assert_eq!(debts.take([2, 7].into_iter()), -0.125);
        assert_eq!(debts.all().count(), 0, "a debt that is taken over is gone");
    }

    #[test]
    fn debts_of_parts_follow_each_other() {
        let mut debts = VolumeDebts::default();
        debts.append(0, VolumeDebts::default(), 2);
        debts.append(2, VolumeDebts::default(), 1);
        assert!(debts.0.is_empty(), "no part owes anything");
        debts.append(3, VolumeDebts(vec![1.0, 2.0]), 2);
        debts.append(5, VolumeDebts::default(), 1);
        debts.append(6, VolumeDebts(vec![3.0]), 1);
        assert_eq!(debts.0, [0.0, 0.0, 0.0, 1.0, 2.0, 0.0, 3.0]);
    }
}
