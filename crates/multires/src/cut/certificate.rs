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
    /// Updates next to what is not manifold, or not oriented, in the input already. Only their levels
    /// were proved: they are the same in every cut.
    pub odd: usize,
}

/// Why a model is not sound.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("update {update} is not sound: {why}")]
pub struct Unsound {
    /// The update.
    pub update: u32,
    /// What does not hold.
    pub why: &'static str,
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
                Err(why) => return Err(Unsound { update, why }),
            }
        }
        if front.triangles.len() != self.full_faces() {
            let why = "the finest mesh has not the faces that it should";
            return Err(Unsound { update: self.update_count() as u32, why });
        }
        Ok(certificate)
    }
}

/// Makes an update and says whether it is an ordinary one.
fn check(front: &mut Front<'_>, update: u32) -> Result<bool, &'static str> {
    let mt = front.mt;
    let (node, level) = (mt.parent(update), mt.level(update));
    if !front.is_there(node) {
        return Err("its vertex is made by an update of no higher level");
    }
    let is_later = |node: u32| mt.family(node).is_some_and(|up| mt.level(up) <= level);
    if is_later(node) || front.around(node).iter().any(|&other| is_later(other)) {
        return Err("something around it is made by an update of no higher level");
    }
    let coarse = front.triangles_at(&[node]);
    let children = mt.children(update);
    if !front.split(update, &mut Vec::new()) {
        return Err("something around it is split by an update of a higher level");
    }
    if mt.is_glued(update) {
        let is_next = mt.update_of(mt.children(update)[0]) == Some(update + 1);
        if !is_next || !front.may_split(update + 1, &mut Vec::new()) {
            return Err("what should be split in the same go cannot be");
        }
    }
    let Some(before) = open_edges(&coarse).filter(|_| mt.odd(update).is_none()) else {
        return Ok(false);
    };
    let fine = front.triangles_at(&children);
    if fine.iter().any(|t| t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
        return Err("it makes a triangle without area");
    }
    let wings = mt.wings(update).iter().filter(|&&wing| wing != Wing::None).count();
    if fine.len() != coarse.len() + wings {
        return Err("its wings are one vertex");
    }
    compare(before, &fine, node, children)?;
    Ok(true)
}

/// Whether the fine side has the boundary of the coarse one: the same edges around, and at the vertex
/// the same open ends, between which only the edge of the children may have come.
fn compare(
    mut before: Vec<Edge>,
    fine: &[[u32; 3]],
    node: u32,
    children: Edge,
) -> Result<(), &'static str> {
    let after = open_edges(fine).ok_or("it makes an edge with two faces on one side")?;
    let is_between = |edge: &&Edge| edge.iter().all(|end| children.contains(end));
    let between = after.iter().filter(is_between).count();
    let is_open = before.iter().any(|edge| edge.contains(&node));
    let up = |end: u32| if children.contains(&end) { node } else { end };
    let outer = after.iter().filter(|edge| !is_between(edge));
    let mut outer: Vec<Edge> = outer.map(|edge| edge.map(up)).collect();
    before.sort_unstable();
    outer.sort_unstable();
    if before != outer || between > usize::from(is_open) {
        return Err("its two sides have not the same boundary");
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
