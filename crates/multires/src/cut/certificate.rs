//! A proof that all cuts of a packed model are sound, in one pass.
//!
//! Every update is made once, those of high levels first. At each the triangles around its vertex are
//! held against those that replace them, and its level against those of all around. The notes show why
//! what holds here once holds in every cut.

use thiserror::Error;

use super::front::Front;
use crate::implicit::{Implicit, Wing};

/// What was proved of every cut of a model, whatever is asked of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Certificate {
    /// Updates whose two sides have one boundary and whose wings are two vertices: no cut has a crack
    /// there or is less manifold than the input.
    pub sound: usize,
    /// Updates next to what is not manifold, or not oriented, in the input already. Their levels were
    /// proved, so they are the same in every cut; and that on both sides, the children taken for one,
    /// the same edges have an odd number of faces. Nothing is said of how manifold they are.
    pub odd: usize,
}

/// Why a model is not sound.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum Unsound {
    /// Some cut has a flaw.
    #[error("update {update} is not sound: {why}")]
    Update {
        /// The update.
        update: u32,
        /// What does not hold.
        why: Flaw,
    },
    /// The finest mesh is another.
    #[error("the finest mesh has {found} faces where the model says {expected}")]
    FullFaces {
        /// How many faces all updates make.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
}

/// What does not hold of an update.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq, PartialOrd, Ord)]
pub enum Flaw {
    /// It may be made before its vertex is there.
    #[error("its vertex is made by an update of no higher level")]
    VertexLater,
    /// It may be made before what is around it is as it was recorded.
    #[error("something around it is made by an update of no higher level")]
    NeighbourLater,
    /// It may be made after what is around it is not as it was recorded any more.
    #[error("something around it is split by an update of a higher level")]
    NeighbourEarlier,
    /// It is one with the next update, which cannot be made.
    #[error("what should be split in the same go cannot be")]
    Torn,
    /// A triangle with two corners at one vertex.
    #[error("it makes a triangle without area")]
    NoArea,
    /// A wing is not around its vertex.
    #[error("it brings fewer faces than it says, or loses some")]
    NoWing,
    /// Three faces at an edge, or two that are turned against each other.
    #[error("it makes an edge with two faces on one side")]
    TwoOnOneSide,
    /// A crack.
    #[error("its two sides have not the same boundary")]
    Boundary,
}

/// A directed edge, by nodes.
type Edge = [u32; 2];

impl Implicit {
    /// Proves that no cut has a crack and that each is as manifold as the input, but beside what is
    /// [`odd`](Certificate::odd).
    ///
    /// Cost: linear.
    /// # Errors
    /// The first update of which that cannot be said.
    pub fn certify(&self) -> Result<Certificate, Unsound> {
        let mut front = Front::new(self);
        let mut certificate = Certificate::default();
        let mut order: Vec<u32> = (0..self.update_count() as u32).collect();
        order.sort_by_key(|&update| std::cmp::Reverse(self.level(update)));
        for update in order {
            match check(&mut front, update) {
                Ok(true) => certificate.sound += 1,
                Ok(false) => certificate.odd += 1,
                Err(why) => return Err(Unsound::Update { update, why }),
            }
        }
        let (found, expected) = (front.triangles.len(), self.full_faces());
        if found != expected {
            return Err(Unsound::FullFaces { found, expected });
        }
        Ok(certificate)
    }
}

/// Makes an update and says whether it is an ordinary one.
fn check(front: &mut Front<'_>, update: u32) -> Result<bool, Flaw> {
    let mt = front.mt;
    let (node, level) = (mt.parent(update), mt.level(update));
    if !front.is_there(node) {
        return Err(Flaw::VertexLater);
    }
    let is_later = |node: u32| mt.family(node).is_some_and(|up| mt.level(up) <= level);
    if is_later(node) || front.around(node).iter().any(|&other| is_later(other)) {
        return Err(Flaw::NeighbourLater);
    }
    let coarse = front.triangles_at(&[node]);
    let children = mt.children(update);
    if !front.split(update, &mut Vec::new()) {
        return Err(Flaw::NeighbourEarlier);
    }
    if mt.is_glued(update) {
        let is_next = mt.update_of(mt.children(update)[0]) == Some(update + 1);
        let are_two = !mt.is_inner(update) && !mt.is_glued(update + 1);
        if !is_next || !are_two || !front.may_split(update + 1, &mut Vec::new()) {
            return Err(Flaw::Torn);
        }
    }
    let fine = front.triangles_at(&children);
    if fine.iter().any(|t| t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
        return Err(Flaw::NoArea);
    }
    let has_both = |t: &&[u32; 3]| children.iter().all(|child| t.contains(child));
    let (between, brought) = (fine.iter().filter(has_both).count(), brought(mt, update));
    if fine.len() != coarse.len() + brought || between != brought {
        return Err(Flaw::NoWing);
    }
    let Some(before) = open_edges(&coarse).filter(|_| mt.odd(update).is_none()) else {
        let up = |end: u32| if children.contains(&end) { node } else { end };
        let is_same = odd_edges(&coarse, up) == odd_edges(&fine, up);
        return if is_same { Ok(false) } else { Err(Flaw::Boundary) };
    };
    compare(before, &fine, node, children)?;
    Ok(true)
}

/// How many faces an update brings.
fn brought(mt: &Implicit, update: u32) -> usize {
    let wings = || mt.wings(update).iter().filter(|&&wing| wing != Wing::None).count();
    mt.odd(update).map_or_else(wings, |odd| odd.brought.len())
}

/// Whether the fine side has the boundary of the coarse one: the same edges around, and at the vertex
/// the same open ends, between which only the edge of the children may have come.
fn compare(
    mut before: Vec<Edge>,
    fine: &[[u32; 3]],
    node: u32,
    children: Edge,
) -> Result<(), Flaw> {
    let after = open_edges(fine).ok_or(Flaw::TwoOnOneSide)?;
    let is_between = |edge: &&Edge| edge.iter().all(|end| children.contains(end));
    let between = after.iter().filter(is_between).count();
    let is_open = before.iter().any(|edge| edge.contains(&node));
    let up = |end: u32| if children.contains(&end) { node } else { end };
    let outer = after.iter().filter(|edge| !is_between(edge));
    let mut outer: Vec<Edge> = outer.map(|edge| edge.map(up)).collect();
    before.sort_unstable();
    outer.sort_unstable();
    if before != outer || between > usize::from(is_open) {
        return Err(Flaw::Boundary);
    }
    Ok(())
}

/// The directed edges without an opposite one; `None` where one is there twice.
fn open_edges(triangles: &[[u32; 3]]) -> Option<Vec<Edge>> {
    let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
    let mut edges: Vec<Edge> = triangles.iter().flat_map(sides).collect();
    edges.sort_unstable();
    if edges.windows(2).any(|pair| pair[0] == pair[1]) {
        return None;
    }
    let is_open = |&&[a, b]: &&Edge| edges.binary_search(&[b, a]).is_err();
    Some(edges.iter().filter(is_open).copied().collect())
}

/// The edges with an odd number of faces after moving up; what is within one vertex then is none.
fn odd_edges(triangles: &[[u32; 3]], up: impl Fn(u32) -> u32) -> Vec<Edge> {
    let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
    let edges = triangles.iter().flat_map(sides).map(|edge| edge.map(&up));
    let mut edges: Vec<Edge> = edges.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.retain(|[a, b]| a != b);
    edges.sort_unstable();
    let odd = edges.chunk_by(|a, b| a == b).filter(|same| same.len() % 2 == 1);
    odd.map(|same| same[0]).collect()
}
