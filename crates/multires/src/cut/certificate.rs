//! Proof, in one pass, that every cut of a packed model is sound.
//!
//! Each update is applied once, in the order of falling levels. The triangles around its vertex are
//! compared with those that replace them, and its level with those of its neighbours.
//! docs/notes/multires.md shows why what holds here once holds in every cut.

use thiserror::Error;

use super::coarse_wedges::{self, CoarseWedges};
use super::front::Front;
use super::triangles::Spoke;
use crate::forest::MAX_LEVELS;
use crate::forest::by_level;
use crate::implicit::{Implicit, has_three_corners};

/// Result of certifying a multiresolution model: what has been proved about its updates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Certificate {
    /// Number of updates proved sound: they open no crack and keep every cut as manifold as the
    /// input.
    ///
    /// Their two sides have the same boundary, and their wings are distinct.
    pub sound: usize,
    /// Number of odd updates, where the input is already non-manifold or inconsistently oriented,
    /// so that manifoldness is not proved.
    ///
    /// Their levels are proved, so they are the same in every cut; and with the children
    /// identified, both sides have the same edges of an odd number of faces.
    pub odd: usize,
}

/// Reason why a multiresolution model cannot be certified.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum CertifyError {
    /// An update has a flaw that would show in some cut of the model.
    #[error("update {update} is not sound: {why}")]
    Update {
        /// Index of the flawed update.
        update: u32,
        /// Flaw of the update.
        why: Flaw,
    },
    /// A face of the base mesh has a wedge that does not belong to it.
    #[error(
        "a face of the coarsest mesh has a wedge of another vertex, or of another material or object"
    )]
    BaseWedges,
    /// The finest mesh does not have the number of faces that the model states.
    #[error("the finest mesh has {found} faces where the model says {expected}")]
    FullFaces {
        /// Number of faces after all updates have been applied.
        found: usize,
        /// Number of faces that the model states.
        expected: usize,
    },
}

/// Flaws that an update of a multiresolution model can have.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Flaw {
    /// The update may be applied before the vertex that it splits exists.
    #[error("its vertex is created by an update of the same or a lower level")]
    VertexLater,
    /// The update may be applied before a neighbour of its vertex has been created.
    #[error("a neighbour of its vertex is created by an update of the same or a lower level")]
    NeighbourLater,
    /// The update may be applied after a neighbour of its vertex has been split.
    #[error("a neighbour of its vertex is split by an update of a higher level")]
    NeighbourEarlier,
    /// The update may be applied too early: its vertex may have a neighbour that no face follows,
    /// for which only updates marked as open wait.
    #[error("its vertex is on a boundary, and it is not marked as open")]
    NotMarkedOpen,
    /// The update is fused with the one that follows it, which cannot be applied.
    #[error("it is fused with a split that cannot follow it")]
    FusedBlocked,
    /// The update creates a triangle with two corners at the same vertex.
    #[error("it creates a triangle with a repeated corner")]
    RepeatedCorner,
    /// A wing of the update is not a neighbour of the vertex that the update splits.
    #[error("it creates fewer faces than stated, or removes some")]
    NoWing,
    /// The update creates an edge with three faces, or with two of opposite orientation.
    #[error("it creates a non-manifold or inconsistently oriented edge")]
    BadEdge,
    /// The update opens a crack: its coarse and its fine side have different boundaries.
    #[error("its two sides have different boundaries")]
    Crack,
    /// The update gives a face a wedge that is not its own, so that attributes depend on the cut.
    #[error("it gives a face a wedge of another vertex, or of another material or object")]
    BadWedge,
}

impl Implicit {
    /// Proves that no cut has a crack, and that each is as manifold as the input except at
    /// [`odd`](Certificate::odd) updates.
    ///
    /// Cost: linear.
    /// # Errors
    /// The first update that fails.
    pub fn certify(&self) -> Result<Certificate, CertifyError> {
        let mut proof = Proof::new(self);
        proof.front.triangles.reserve(self.full_faces().min(2 * self.update_count()));
        if !coarse_wedges::are_of_their_nodes(&proof.front, 0..self.base_faces() as u32) {
            return Err(CertifyError::BaseWedges);
        }
        let mut certificate = Certificate::default();
        for update in by_level(self.update_count(), |update| MAX_LEVELS - self.level(update)) {
            match proof.check(update) {
                Ok(true) => certificate.sound += 1,
                Ok(false) => certificate.odd += 1,
                Err(why) => return Err(CertifyError::Update { update, why }),
            }
        }
        let (found, expected) = (proof.front.triangles.len(), self.full_faces());
        if found != expected {
            return Err(CertifyError::FullFaces { found, expected });
        }
        Ok(certificate)
    }
}

/// A cut under refinement, and the two sides of the last update.
struct Proof<'m> {
    front: Front<'m>,
    coarse: Side,
    fine: Side,
    wedges: CoarseWedges,
    /// Slots of the coarse side's triangles.
    around: Vec<u32>,
    /// Missing dependencies; stays empty if the update may be applied.
    first: Vec<u32>,
}

impl<'m> Proof<'m> {
    fn new(mt: &'m Implicit) -> Self {
        Self {
            front: Front::new(mt),
            coarse: Side::default(),
            fine: Side::default(),
            wedges: CoarseWedges::default(),
            around: Vec::new(),
            first: Vec::new(),
        }
    }

    /// Applies an update and checks it; returns true if it is manifold.
    fn check(&mut self, update: u32) -> Result<bool, Flaw> {
        self.apply(update)?;
        let Self { front, coarse, fine, .. } = self;
        let mt = front.mt;
        let (node, children) = (mt.parent(update), mt.children(update));
        if !fine.triangles.iter().all(has_three_corners) {
            return Err(Flaw::RepeatedCorner);
        }
        let has_both = |t: &&[u32; 3]| children.iter().all(|child| t.contains(child));
        let between = fine.triangles.iter().filter(has_both).count();
        let created = mt.created_count(update);
        if fine.triangles.len() != coarse.triangles.len() + created || between != created {
            return Err(Flaw::NoWing);
        }
        let up = |end: u32| if children.contains(&end) { node } else { end };
        if mt.non_fan_split(update).is_some() || !coarse.find_open() {
            coarse.find_odd(up);
            fine.find_odd(up);
            if !mt.is_open(update) && !coarse.is_balanced(node) {
                return Err(Flaw::NotMarkedOpen);
            }
            return if coarse.edges == fine.edges { Ok(false) } else { Err(Flaw::Crack) };
        }
        let is_open = coarse.edges.iter().any(|edge| edge.ends().contains(&node));
        if is_open && !mt.is_open(update) {
            return Err(Flaw::NotMarkedOpen);
        }
        if !fine.find_open() {
            return Err(Flaw::BadEdge);
        }
        // Both sides must have the same surrounding edges, and the same open ends at the vertex,
        // between which only the edge of the children may be new.
        let all = fine.edges.len();
        fine.edges.retain_mut(|edge| {
            let [from, to] = edge.ends();
            *edge = Edge::new(up(from), up(to));
            !(children.contains(&from) && children.contains(&to))
        });
        let between = all - fine.edges.len();
        fine.edges.sort_unstable();
        if coarse.edges != fine.edges || between > usize::from(is_open) {
            return Err(Flaw::Crack);
        }
        Ok(true)
    }

    /// Applies an update if its dependencies are met, and keeps the triangles of both sides.
    fn apply(&mut self, update: u32) -> Result<(), Flaw> {
        let Self { front, coarse, fine, wedges, around, first } = self;
        // Nobody asks which slots have changed.
        front.triangles.mark();
        let mt = front.mt;
        let (node, level) = (mt.parent(update), mt.level(update));
        if !front.is_active(node) {
            return Err(Flaw::VertexLater);
        }
        first.clear();
        let may_split = front.may_split(update, first);
        let is_later = |node: u32| !front.is_made_above(node, level);
        let star = front.last_star();
        if is_later(node) || star.iter().any(|spoke| is_later(spoke.a) || is_later(spoke.b)) {
            return Err(Flaw::NeighbourLater);
        }
        if !may_split {
            return Err(Flaw::NeighbourEarlier);
        }
        around.clear();
        // A triangle with two corners at the vertex is met at both.
        let is_first = |spoke: &&Spoke| {
            let (t, k) = (spoke.triangle(), spoke.corner as usize % 3);
            !front.triangles.nodes(t)[..k].contains(&node)
        };
        around.extend(star.iter().filter(is_first).map(Spoke::triangle));
        coarse.take(front, around.iter().copied());
        wedges.take(front, around);
        let created = front.triangles.slots() as u32;
        front.apply(update);
        let created = created..front.triangles.slots() as u32;
        fine.take(front, around.iter().copied().chain(created.clone()));
        if !wedges.continue_in(front, update, around, created) {
            return Err(Flaw::BadWedge);
        }
        if mt.is_fused_with_child(update) {
            let is_next = mt.update_of(mt.children(update)[0]) == Some(update + 1);
            let are_two = !mt.is_fused_with_parent(update) && !mt.is_fused_with_child(update + 1);
            if !is_next || !are_two || !front.may_split(update + 1, first) {
                return Err(Flaw::FusedBlocked);
            }
        }
        Ok(())
    }
}

/// One side of an update.
#[derive(Default)]
struct Side {
    triangles: Vec<[u32; 3]>,
    /// Edges that were searched for, sorted.
    edges: Vec<Edge>,
    /// Scratch memory for all edges.
    all: Vec<Edge>,
}

impl Side {
    fn take(&mut self, front: &Front<'_>, places: impl Iterator<Item = u32>) {
        self.triangles.clear();
        self.triangles.extend(places.map(|t| front.triangles.nodes(t)));
    }

    /// Finds the directed edges without an opposite one, or returns false if an edge occurs twice.
    fn find_open(&mut self) -> bool {
        self.sort(|end| end);
        self.edges.clear();
        let mut all = self.all.as_slice();
        // An edge and its opposite are adjacent after sorting.
        while let [edge, rest @ ..] = all {
            all = match rest {
                [next, ..] if next == edge => return false,
                [next, third, ..] if edge.is_beside(*next) && next == third => return false,
                [next, rest @ ..] if edge.is_beside(*next) => rest,
                _ => {
                    self.edges.extend((!edge.is_loop()).then_some(*edge));
                    rest
                }
            };
        }
        true
    }

    /// Finds the edges with an odd number of faces after mapping nodes by `up`. Edges that collapse
    /// to a vertex do not count.
    fn find_odd(&mut self, up: impl Fn(u32) -> u32) {
        self.sort(up);
        self.edges.clear();
        let odd = self.all.chunk_by(|a, b| a.is_beside(*b)).filter(|same| same.len() % 2 == 1);
        self.edges.extend(odd.map(|same| same[0].undirected()).filter(|edge| !edge.is_loop()));
    }

    /// Returns true if at a node as many faces enter each edge as leave it, in a sorted side.
    ///
    /// That stays so when other nodes are merged, and then each neighbour has a face after it.
    fn is_balanced(&self, node: u32) -> bool {
        let edges = self.all.chunk_by(|a, b| a.is_beside(*b));
        edges.filter(|same| same[0].ends().contains(&node)).all(|same| {
            let leaving = same.iter().filter(|edge| edge.ends()[0] == node).count();
            2 * leaving == same.len()
        })
    }

    fn sort(&mut self, up: impl Fn(u32) -> u32) {
        self.all.clear();
        for &[a, b, c] in &self.triangles {
            let (a, b, c) = (up(a), up(b), up(c));
            self.all.extend([Edge::new(a, b), Edge::new(b, c), Edge::new(c, a)]);
        }
        self.all.sort_unstable();
    }
}

/// A directed edge in one number: its lesser node, its greater node, and whether it starts at the
/// greater one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Edge(u64);

impl Edge {
    #[inline]
    fn new(from: u32, to: u32) -> Self {
        // Nodes have 31 bits.
        Self(u64::from(from.min(to)) << 32 | u64::from(from.max(to)) << 1 | u64::from(from > to))
    }

    #[inline]
    fn ends(self) -> [u32; 2] {
        let (low, high) = ((self.0 >> 32) as u32, self.0 as u32 >> 1);
        if self.0 & 1 == 0 { [low, high] } else { [high, low] }
    }

    /// Returns the edge without its direction.
    fn undirected(self) -> Self {
        Self(self.0 & !1)
    }

    /// Returns true if both edges join the same nodes.
    #[inline]
    fn is_beside(self, other: Self) -> bool {
        self.0 | 1 == other.0 | 1
    }

    fn is_loop(self) -> bool {
        let [from, to] = self.ends();
        from == to
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_with_a_face_on_either_side_have_no_third() {
        let side =
            |triangles: &[[u32; 3]]| Side { triangles: triangles.to_vec(), ..Side::default() };
        let mut fan = side(&[[0, 1, 2], [0, 2, 3]]);
        assert!(fan.find_open());
        let open = [[0, 1], [3, 0], [1, 2], [2, 3]].map(|[from, to]| Edge::new(from, to));
        assert_eq!(fan.edges, open);
        for third in [[0, 2, 4], [2, 0, 4]] {
            assert!(!side(&[[0, 1, 2], [0, 2, 3], third]).find_open(), "{third:?}");
        }
    }
}
