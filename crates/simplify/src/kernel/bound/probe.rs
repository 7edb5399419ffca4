//! Measures distances between points on new faces and the input.

use glam::Vec3;
use meshlod_mesh::FaceId;

use crate::kernel::bound::input_surface::InputSurface;

/// Largest number of times that a segment is halved.
const HALVINGS: u32 = 4;

/// A segment is halved while a point on it may exceed the bound by more than this factor.
const OVER: f32 = 1.1;

/// A segment is not halved further if its ends and its middle are within this part of the bound,
/// and closer points of the input are not searched for. CPU time of the bunny within .1 %: .25 1.2,
/// .4 1.0; at .6 fandisk-32k deviates by 1.24 times .3 % instead of 1.1.
const CALM: f32 = 0.4;

/// Measures distances to the input for points near each other.
pub(crate) struct Probe<'v> {
    input: &'v InputSurface,
    max_error: f32,
    near: Option<FaceId>,
    farthest: f32,
}

/// A position, and its distance from the input.
pub(crate) type Probed = (Vec3, f32);

impl<'v> Probe<'v> {
    /// Starts measuring distances with this error bound, in the frame's units.
    pub(crate) fn new(input: &'v InputSurface, max_error: f32) -> Self {
        Self { input, max_error, near: None, farthest: 0.0 }
    }

    /// Returns the largest distance measured so far.
    pub(crate) fn farthest(&self) -> f32 {
        self.farthest
    }

    /// Returns an upper bound on the distance of a position from the input; `None` if it is beyond
    /// the error bound.
    pub(crate) fn at(&mut self, place: Vec3) -> Option<f32> {
        let limits = [CALM * self.max_error, self.max_error];
        let apart = self.input.distance(place, &mut self.near, limits)?;
        self.farthest = self.farthest.max(apart);
        Some(apart)
    }

    /// Measures distances at points between two positions; `None` if one is beyond the error bound.
    pub(crate) fn along(&mut self, ends: [Probed; 2]) -> Option<()> {
        self.halve(ends, HALVINGS)
    }

    fn halve(&mut self, [a, b]: [Probed; 2], times: u32) -> Option<()> {
        // The distance is 1-Lipschitz.
        let highest = (a.1 + b.1 + a.0.distance(b.0)) / 2.0;
        if times == 0 || highest <= OVER * self.max_error {
            return Some(());
        }
        let place = a.0.midpoint(b.0);
        let middle = (place, self.at(place)?);
        let is_calm = a.1.max(b.1).max(middle.1) <= CALM * self.max_error;
        if is_calm && times < HALVINGS {
            return Some(());
        }
        self.halve([a, middle], times - 1)?;
        self.halve([middle, b], times - 1)
    }
}
