//! Handles that close where that costs least: tunnels are filled, arms of rings are cut.
//!
//! An edge whose ends have a neighbour in common beyond its wings must not be contracted: the
//! triangle of the three is not a face, and would become an edge of four faces. Around a handle
//! there is nothing but such edges in the end. There the surface is cut along the triangle, and both
//! sides are closed with a face. Then both copies of the edge are contracted, which takes these two
//! faces away again: a level never has a face that the input does not have.
//!
//! ```text
//!      near side        the triangle v0 v1 w goes around          far side
//!     v0 —— w           the handle: two tubes that end in it         c0 —— cw
//!      \   /            are left, each with its own copy              \   /
//!       v1              of the three vertices                          c1
//! ```
//!
//! A cut costs what the two contractions do, and what a component of the area of both faces would
//! cost to remove that is as far away as they are from the edges around them. So it has its place in
//! the queue like any other step.

mod closing;
mod faces;
mod genus;
mod neck;

use std::ops::Range;

use crate::kernel::handles::faces::HandleFaces;
use crate::kernel::handles::neck::Neck;
use crate::kernel::mesh::one_ring::Vertices;
use crate::options::HandleCounts;

pub(crate) use crate::kernel::handles::genus::genus;
pub(crate) use crate::kernel::handles::neck::PER_CUT;

/// Handles that may close, and those that have closed.
pub(crate) struct Handles {
    /// Number of handles of the input.
    genus: usize,
    first_spare: u32,
    closed: usize,
    faces: HandleFaces,
}

impl Handles {
    /// Prepares for closing up to `genus` handles. `faces` are those of the input in the kernel's
    /// vertices; vertices from `first_spare` on are for cuts.
    pub(crate) fn new(genus: usize, faces: Vec<[u32; 3]>, first_spare: u32) -> Self {
        Self { genus, first_spare, closed: 0, faces: HandleFaces::new(faces) }
    }

    /// Returns the faces of the input, with the vertices of the cuts at their corners.
    pub(crate) fn faces(&self) -> &[[u32; 3]] {
        self.faces.all()
    }

    /// Returns the first of three vertices for a cut, if a handle is left.
    fn spare(&self) -> Option<u32> {
        (self.closed < self.genus).then_some(self.copies().end)
    }

    /// Returns the vertices of the cuts so far.
    pub(crate) fn copies(&self) -> Range<u32> {
        self.first_spare..self.first_spare + (PER_CUT * self.closed) as u32
    }

    /// Notes that a handle has been cut along a neck, whose copies are from `first_copy` on.
    fn close(&mut self, vertices: &mut Vertices<'_>, neck: &Neck, first_copy: u32) {
        for (k, (copy, v)) in (first_copy..).zip(neck.vertices).enumerate() {
            self.faces.part(vertices, [v, copy], |follows| neck.is_far(k, follows, first_copy));
        }
        self.closed += 1;
    }

    /// Returns the numbers of handles of the input and of those that have closed.
    pub(crate) fn counts(&self) -> HandleCounts {
        HandleCounts { before: self.genus, closed: self.closed }
    }

    /// Notes that a vertex has been contracted into another.
    #[inline(always)]
    pub(crate) fn merge(&mut self, kept: u32, gone: u32) {
        self.faces.merge(kept, gone);
    }
}
