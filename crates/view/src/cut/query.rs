//! Queries for a follower, and the steps of its answers.

use std::time::Duration;

use meshlod::multires::{Focus, ViewCamera};

use super::fields::MovedVertex;
use super::slots::CutPatch;

/// Query for a [`CutFollower`](super::CutFollower).
#[derive(Clone, Debug)]
pub struct CutQuery {
    /// Region that is fine.
    pub focus: Focus,
    /// Fineness within the focus.
    pub tolerance: CutTolerance,
}

/// Fineness of a cut.
#[derive(Clone, Debug)]
pub enum CutTolerance {
    /// Error in model units.
    Uniform(f64),
    /// Error in pixels of a camera.
    Pixels {
        /// Camera from which it is seen.
        camera: ViewCamera,
        /// Number of pixels.
        pixels: f64,
    },
    /// As fine as a number of faces allows, with one error everywhere.
    Faces(usize),
}

/// Change of a cut: slots of its triangles, and vertices that move.
#[derive(Clone, Debug, Default)]
pub struct CutStep {
    /// Changed slots with their new contents, in the order of groups and slots.
    pub patches: Vec<CutPatch>,
    /// Vertices that have moved.
    pub moved: Vec<MovedVertex>,
    /// Number of faces that are drawn: those of the cut, and with motion also those that still
    /// collapse.
    pub faces: usize,
    /// Number of vertices of the cut.
    pub vertices: usize,
    /// True if the cut satisfies the query; false if a limit was reached first.
    pub is_done: bool,
    /// True if vertices are still on their way: see
    /// [`CutFollower::advance`](super::CutFollower::advance).
    pub is_moving: bool,
    /// Time that the cut took to change, in milliseconds.
    pub milliseconds: f64,
}

/// Limits and motion with which a [`CutFollower`](super::CutFollower) follows queries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FollowOptions {
    /// Most splits and merges in one step, which bounds what a frame uploads: a change touches
    /// about six slots of 12 bytes. `None` answers every query in one step, as the first query and
    /// a search for a number of faces are in any case.
    pub changes: Option<usize>,
    /// Time in which a vertex moves to its new position; `None` for changes at once.
    /// Height fields always change at once.
    pub motion: Option<Duration>,
}
