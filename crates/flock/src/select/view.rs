//! Flock as a camera sees it, eight members at a time.
// Loops over lanes become vector code, closures over arrays need not; and `clamp` keeps a NaN.
#![allow(clippy::needless_range_loop, clippy::manual_clamp)]

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use crate::camera::FlockCamera;
use crate::flock::Flock;
use crate::levels::LevelTable;
use crate::select::{Budget, InstanceLevel};

/// Number of members that are looked at together.
pub const LANES: usize = 8;

/// Members that one task handles; fewer are handled by the calling thread.
const TASK: usize = 1 << 14;

/// Basis of a policy's choice: the flock, the camera, the levels and the budget of a frame.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// Flock to draw.
    pub flock: &'a Flock,
    /// Camera that sees it.
    pub camera: &'a FlockCamera,
    /// Levels of the members.
    pub table: &'a LevelTable,
    /// Limits of the frame.
    pub budget: &'a Budget,
    /// For every member, whether it may be visible; `None` if that is not known.
    pub visible: Option<&'a [bool]>,
    /// Radius of a member over the cosines of half the fields of view, in body lengths.
    margins: [f32; 2],
}

/// Eight members as the camera sees them; the last ones of a flock are repeated.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lanes {
    /// Offset of each member from the eye, by axis of the world, in body lengths.
    pub offset: [[f32; LANES]; 3],
    /// Offset of each member to the right of the eye, up, and along the view.
    pub seen: [[f32; LANES]; 3],
    /// Square of the distance of each member from the eye.
    pub distance_squared: [f32; LANES],
    /// True for members whose bounding ball meets the view frustum.
    pub in_frustum: [bool; LANES],
}

impl<'a> View<'a> {
    pub(crate) fn new(
        flock: &'a Flock,
        camera: &'a FlockCamera,
        table: &'a LevelTable,
        budget: &'a Budget,
        visible: Option<&'a [bool]>,
    ) -> Self {
        let margins = camera.tangents().map(|t| table.radius * (1.0 + t * t).sqrt());
        Self { flock, camera, table, budget, visible, margins }
    }

    /// Returns the fineness of the budget, above zero.
    pub fn detail(&self) -> f32 {
        if self.budget.detail > 0.0 { self.budget.detail } else { f32::MIN_POSITIVE }
    }

    /// Returns the next eight members from `first` on, as the camera sees them.
    #[inline(always)]
    pub fn lanes(&self, first: usize) -> Lanes {
        let eye = self.camera.eye().to_array();
        let mut lanes = Lanes::default();
        for (axis, eye) in eye.into_iter().enumerate() {
            let values = load(&self.flock.members.position[axis], first);
            for (offset, value) in lanes.offset[axis].iter_mut().zip(values) {
                *offset = value - eye;
            }
        }
        lanes.look(self.camera.axes(), self.camera.tangents(), self.margins, self.table.radius);
        lanes
    }

    /// Chooses the levels of all members eight by eight; `choose` gets the index of the first of
    /// the eight and writes their levels. Members outside the frustum are hidden afterwards.
    ///
    /// Runs on all threads if the flock is large. What `choose` does must not depend on the order.
    #[inline]
    pub fn assign(
        &self,
        levels: &mut [InstanceLevel],
        choose: impl Fn(usize, &Lanes, &mut [InstanceLevel; LANES]) + Sync,
    ) {
        self.assign_range(0..levels.len(), levels, choose);
    }

    /// Chooses the levels of a range of members, as [`View::assign`] does; `levels` are those of
    /// all members.
    #[inline]
    pub fn assign_range(
        &self,
        range: Range<usize>,
        levels: &mut [InstanceLevel],
        choose: impl Fn(usize, &Lanes, &mut [InstanceLevel; LANES]) + Sync,
    ) {
        let begin = range.start;
        let levels = &mut levels[range];
        let task = |start: usize, levels: &mut [InstanceLevel]| {
            for (i, chunk) in levels.chunks_mut(LANES).enumerate() {
                let first = start + i * LANES;
                let lanes = self.lanes(first);
                let mut chosen = [InstanceLevel::HIDDEN; LANES];
                chosen[..chunk.len()].copy_from_slice(chunk);
                choose(first, &lanes, &mut chosen);
                for (lane, level) in chunk.iter_mut().enumerate() {
                    *level =
                        if lanes.in_frustum[lane] { chosen[lane] } else { InstanceLevel::HIDDEN };
                }
            }
        };
        if levels.len() <= TASK {
            task(begin, levels);
        } else {
            let tasks = levels.par_chunks_mut(TASK).enumerate();
            tasks.for_each(|(i, levels)| task(begin + i * TASK, levels));
        }
    }
}

/// Returns the next eight values from `first` on; the last one is repeated at the end.
#[inline(always)]
pub(crate) fn load(values: &[f32], first: usize) -> [f32; LANES] {
    match values.get(first..first + LANES) {
        Some(eight) => eight.try_into().expect("there are eight"),
        None => padded(values, first),
    }
}

#[cold]
fn padded(values: &[f32], first: usize) -> [f32; LANES] {
    std::array::from_fn(|lane| values[(first + lane).min(values.len() - 1)])
}

impl Lanes {
    /// Computes all that follows from the offsets.
    #[inline(always)]
    fn look(&mut self, axes: [Vec3; 3], tangents: [f32; 2], margins: [f32; 2], radius: f32) {
        let [x, y, z] = self.offset;
        for lane in 0..LANES {
            for (seen, axis) in self.seen.iter_mut().zip(axes) {
                seen[lane] = x[lane] * axis.x + y[lane] * axis.y + z[lane] * axis.z;
            }
            self.distance_squared[lane] = x[lane] * x[lane] + y[lane] * y[lane] + z[lane] * z[lane];
        }
        let [right, up, depth] = self.seen;
        for lane in 0..LANES {
            let across = right[lane].abs() <= depth[lane] * tangents[0] + margins[0];
            let down = up[lane].abs() <= depth[lane] * tangents[1] + margins[1];
            self.in_frustum[lane] = across & down & (depth[lane] > -radius);
        }
    }
}
