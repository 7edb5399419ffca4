//! A proof that all cuts of a packed model are sound, in one pass.
//!
//! Every update is made once, those of high levels first. At each the triangles around its vertex are
//! held against those that replace them, and its level against those of all around. The notes show why
//! what holds here once holds in every cut.

use thiserror::Error;

use super::front::Front;
use super::triangles::Spoke;
use crate::forest::MAX_LEVELS;
use crate::forest::by_level;
use crate::implicit::{Implicit, Wing, has_three_corners};

/// What was proved of every cut of a model, whatever is asked of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Certificate {
    /// Updates whose two sides have one boundary and whose wings are two vertices: no cut has a crack
    /// there or is less manifold than the input.
    pub sound: usize,
    /// Updates next to what is not manifold, or not oriented, in the input already. Their levels were
    /// proved, so they are the same in every cut; and that on both sides, the children taken for one,
    /// the same edges have an odd number of faces. Nothing is said of how manifold they are.
    pub non_manifold: usize,
}

/// Why a model is not sound.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum CertifyError {
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

impl Implicit {
    /// Proves that no cut has a crack and that each is as manifold as the input, but beside what is
    /// [`odd`](Certificate::odd).
    ///
    /// Cost: linear.
    /// # Errors
    /// The first update of which that cannot be said.
    pub fn certify(&self) -> Result<Certificate, CertifyError> {
        let mut proof = Proof::new(self);
        let mut certificate = Certificate::default();
        for update in by_level(self.update_count(), |update| MAX_LEVELS - self.level(update)) {
            match proof.check(update) {
                Ok(true) => certificate.sound += 1,
                Ok(false) => certificate.non_manifold += 1,
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

/// A cut that is refined, and room for the two sides of the update made last.
struct Proof<'m> {
    front: Front<'m>,
    coarse: Side,
    fine: Side,
    /// The places of the coarse side's triangles.
    around: Vec<u32>,
    /// What should have been made first: nothing.
    first: Vec<u32>,
}

impl<'m> Proof<'m> {
    fn new(mt: &'m Implicit) -> Self {
        Self {
            front: Front::new(mt),
            coarse: Side::default(),
            fine: Side::default(),
            around: Vec::new(),
            first: Vec::new(),
        }
    }

    /// Makes an update and says whether it is an ordinary one.
    fn check(&mut self, update: u32) -> Result<bool, Flaw> {
        self.make(update)?;
        let Self { front, coarse, fine, .. } = self;
        let mt = front.mt;
        let (node, children) = (mt.parent(update), mt.children(update));
        if !fine.triangles.iter().all(has_three_corners) {
            return Err(Flaw::NoArea);
        }
        let has_both = |t: &&[u32; 3]| children.iter().all(|child| t.contains(child));
        let between = fine.triangles.iter().filter(has_both).count();
        let created = created(mt, update);
        if fine.triangles.len() != coarse.triangles.len() + created || between != created {
            return Err(Flaw::NoWing);
        }
        let up = |end: u32| if children.contains(&end) { node } else { end };
        if mt.non_fan_split(update).is_some() || !coarse.find_open() {
            coarse.find_odd(up);
            fine.find_odd(up);
            return if coarse.edges == fine.edges { Ok(false) } else { Err(Flaw::Boundary) };
        }
        if !fine.find_open() {
            return Err(Flaw::TwoOnOneSide);
        }
        // The same edges around, and at the vertex the same open ends, between which only the edge of
        // the children may have come.
        let is_open = coarse.edges.iter().any(|edge| edge.ends().contains(&node));
        let all = fine.edges.len();
        fine.edges.retain_mut(|edge| {
            let [from, to] = edge.ends();
            *edge = Edge::new(up(from), up(to));
            !(children.contains(&from) && children.contains(&to))
        });
        let between = all - fine.edges.len();
        fine.edges.sort_unstable();
        if coarse.edges != fine.edges || between > usize::from(is_open) {
            return Err(Flaw::Boundary);
        }
        Ok(true)
    }

    /// Makes an update, if it may be made, and keeps the triangles of its two sides.
    fn make(&mut self, update: u32) -> Result<(), Flaw> {
        let Self { front, coarse, fine, around, first } = self;
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
        // What has two corners at the vertex is met at both.
        let is_first = |spoke: &&Spoke| {
            let (t, k) = (spoke.triangle(), spoke.corner as usize % 3);
            !front.triangles.nodes(t)[..k].contains(&node)
        };
        around.extend(star.iter().filter(is_first).map(Spoke::triangle));
        coarse.take(front, around.iter().copied());
        let created = front.triangles.slots() as u32;
        front.make(update);
        let created = created..front.triangles.slots() as u32;
        fine.take(front, around.iter().copied().chain(created));
        if mt.is_fused_with_child(update) {
            let is_next = mt.update_of(mt.children(update)[0]) == Some(update + 1);
            let are_two = !mt.is_fused_with_parent(update) && !mt.is_fused_with_child(update + 1);
            if !is_next || !are_two || !front.may_split(update + 1, first) {
                return Err(Flaw::Torn);
            }
        }
        Ok(())
    }
}

/// How many faces an update brings.
fn created(mt: &Implicit, update: u32) -> usize {
    let wings = || mt.wings(update).iter().filter(|&&wing| wing != Wing::None).count();
    mt.non_fan_split(update).map_or_else(wings, |non_fan| non_fan.created_faces.len())
}

/// One side of an update.
#[derive(Default)]
struct Side {
    triangles: Vec<[u32; 3]>,
    /// Those of its edges that are looked for, in order.
    edges: Vec<Edge>,
    /// Room for all of them.
    all: Vec<Edge>,
}

impl Side {
    fn take(&mut self, front: &Front<'_>, places: impl Iterator<Item = u32>) {
        self.triangles.clear();
        self.triangles.extend(places.map(|t| front.triangles.nodes(t)));
    }

    /// Finds the directed edges without an opposite one; false where one is there twice.
    fn find_open(&mut self) -> bool {
        self.sort(|end| end);
        self.edges.clear();
        let mut all = self.all.as_slice();
        // An edge and its opposite stand side by side.
        while let [edge, rest @ ..] = all {
            all = match rest {
                [next, ..] if next == edge => return false,
                [next, rest @ ..] if edge.is_beside(*next) => rest,
                _ => {
                    self.edges.extend((!edge.is_loop()).then_some(*edge));
                    rest
                }
            };
        }
        true
    }

    /// Finds the edges with an odd number of faces after moving up; what is within one vertex then is
    /// none.
    fn find_odd(&mut self, up: impl Fn(u32) -> u32) {
        self.sort(up);
        self.edges.clear();
        let odd = self.all.chunk_by(|a, b| a.is_beside(*b)).filter(|same| same.len() % 2 == 1);
        self.edges.extend(odd.map(|same| same[0].undirected()).filter(|edge| !edge.is_loop()));
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

/// A directed edge in one number: its lesser node, its greater one, and whether it comes from that.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
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

    /// The same, wherever it goes.
    fn undirected(self) -> Self {
        Self(self.0 & !1)
    }

    /// Whether both join the same nodes.
    #[inline]
    fn is_beside(self, other: Self) -> bool {
        self.0 | 1 == other.0 | 1
    }

    fn is_loop(self) -> bool {
        let [from, to] = self.ends();
        from == to
    }
}
