//! What the engine asks of attributes; [`Bare`] where there are none, and nothing is left of it in the
//! code.

use glam::{DVec3, Vec3};
use meshlod_mesh::{Attributes, WedgeId};

use crate::fast::cost::{Costs, Edges, Side};
use crate::fast::hood::Hood;
use crate::fast::meet::Meeting;
use crate::fast::place::Swept;
use crate::fast::ring::Vertices;
use crate::fast::rule::Rule;
use crate::fast::vertex::{Flags, Star};
use crate::fast::wide::LANES;
use crate::refusal::Refusal;

/// The ends of an edge that may be contracted: `v1` goes into `v0`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Ends {
    pub(super) v0: u32,
    pub(super) v1: u32,
    /// Whether the new vertex may go anywhere, or is where `v0` is.
    pub(super) free: bool,
    /// Which of their slots become one.
    pub(super) met: Meeting,
}

impl Ends {
    /// Where nothing is in the way.
    #[inline(always)]
    pub(super) fn free(v0: u32, v1: u32) -> Self {
        Self { v0, v1, free: true, met: Meeting::smooth(v0, v1) }
    }
}

/// A contraction that is about to be carried out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    pub(super) ends: Ends,
    /// Half the edge.
    pub(super) half: DVec3,
    /// The new place as seen from the middle.
    pub(super) best: DVec3,
    /// The new place, as rounded.
    pub(super) place: Vec3,
    /// The same as seen from `v0`.
    pub(super) by: Vec3,
}

/// Attributes, as costs and contractions have to do with them.
pub(super) trait Looks: Sized + Send + Sync {
    /// What the surface itself costs.
    type Rule: Rule;

    /// Whether the surface may be worked on in parts.
    const IN_PARTS: bool;

    /// What each of so many parts looks like.
    fn side_by_side(self, parts: usize) -> Vec<Self>;

    /// Adds to the squares of edges what attributes leave of them where they are best.
    fn join(&self, sides: [Side<u32>; 2], edges: &mut Edges);

    /// What eight edges cost if any of their vertices is on a seam. Of those without such an end,
    /// what they cost if both may go anywhere.
    fn at_seams(&self, vertices: &Vertices, us: Side<u32>, vs: &[u32; LANES]) -> Option<Costs>;

    /// Which end of an edge goes into which.
    fn order(&self, vertices: &Vertices, v: u32, target: u32) -> Result<Ends, Refusal>;

    /// The squares of an edge with free ends, by those of the geometry.
    fn whole(&self, ends: &Ends, geometry: Swept) -> Swept;

    /// What attributes cost where `v1` goes to the place of `v0`.
    fn onto(&self, vertices: &Vertices, ends: &Ends) -> f32;

    /// Finds what a contraction that may be otherwise makes of attributes; whether it turns a face over
    /// in its texture.
    fn look_ahead(&mut self, vertices: &Vertices, hood: &Hood, placed: &Placed) -> bool;

    /// Carries out what was last looked ahead to, before the vertices themselves change; gives what the
    /// star of the new vertex has beside its faces.
    fn contract(&mut self, vertices: &mut Vertices, hood: &Hood, placed: &Placed) -> Star;

    /// Reads what is wanted of a vertex soon.
    fn warm(&self, v: u32) -> u32;

    /// What faces have by now, by their numbers and their corners as the engine was given them.
    fn attributes(&self, faces: impl Iterator<Item = (u32, [u32; 3])>) -> Option<Attributes>;

    /// The same of all faces, dead ones too, with every wedge in its place.
    fn all_attributes(&self, faces: impl Iterator<Item = [u32; 3]>) -> Option<Attributes>;

    /// Takes down the values that a contraction has given to a vertex: the next of those that are logged.
    fn record(&mut self, vertex: u32);

    /// What was taken down.
    fn recorded(&mut self) -> Vec<Revalued>;
}

/// The values that a wedge has after a contraction, by the number of that in the log.
#[derive(Clone, Debug)]
pub(super) struct Revalued {
    pub(super) number: usize,
    pub(super) wedge: WedgeId,
    /// In all layers, one after the other.
    pub(super) values: Vec<f32>,
}

/// No attributes, and what costs by this rule.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bare<R>(pub(super) R);

impl<R: Rule> Looks for Bare<R> {
    type Rule = R;

    const IN_PARTS: bool = true;

    fn side_by_side(self, parts: usize) -> Vec<Self> {
        vec![self; parts]
    }

    #[inline(always)]
    fn join(&self, _: [Side<u32>; 2], _: &mut Edges) {}

    #[inline(always)]
    fn at_seams(&self, _: &Vertices, _: Side<u32>, _: &[u32; LANES]) -> Option<Costs> {
        None
    }

    #[inline(always)]
    fn order(&self, vertices: &Vertices, v: u32, target: u32) -> Result<Ends, Refusal> {
        by_pins(vertices, v, target)
    }

    #[inline(always)]
    fn whole(&self, _: &Ends, geometry: Swept) -> Swept {
        geometry
    }

    #[inline(always)]
    fn onto(&self, _: &Vertices, _: &Ends) -> f32 {
        0.0
    }

    #[inline(always)]
    fn look_ahead(&mut self, _: &Vertices, _: &Hood, _: &Placed) -> bool {
        false
    }

    #[inline(always)]
    fn contract(&mut self, _: &mut Vertices, _: &Hood, _: &Placed) -> Star {
        Star::default()
    }

    #[inline(always)]
    fn warm(&self, _: u32) -> u32 {
        0
    }

    fn attributes(&self, _: impl Iterator<Item = (u32, [u32; 3])>) -> Option<Attributes> {
        None
    }

    fn all_attributes(&self, _: impl Iterator<Item = [u32; 3]>) -> Option<Attributes> {
        None
    }

    #[inline(always)]
    fn record(&mut self, _: u32) {}

    fn recorded(&mut self) -> Vec<Revalued> {
        Vec::new()
    }
}

/// What goes where, if pins alone decide.
#[inline(always)]
pub(super) fn by_pins(vertices: &Vertices, v: u32, target: u32) -> Result<Ends, Refusal> {
    let pinned = |v: u32| vertices.get(v).flags.any(Flags::PINNED);
    match (pinned(v), pinned(target)) {
        (false, false) => Ok(Ends::free(v, target)),
        (true, false) => Ok(Ends { free: false, ..Ends::free(v, target) }),
        (false, true) => Ok(Ends { free: false, ..Ends::free(target, v) }),
        (true, true) => Err(Refusal::Locked),
    }
}
