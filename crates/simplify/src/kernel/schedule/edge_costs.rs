//! What the edges of a vertex cost: the least that their squares come to, by the [rule](Metric), and a
//! little for their length.
//!
//! All from the squares at the two ends. Of planes through them, seen from the middle of the edge, with
//! ends at −h and h and matrices A₀ and A₁, those are x'Sx − 2q·x + h'Sh, S = A₀ + A₁, q = (A₁ − A₀)h; the
//! rule adds the rest.

use crate::kernel::attributes::AttributeModel;
use crate::kernel::mesh::one_ring::{LONG, MAX_RING, Vertices};
use crate::kernel::mesh::vertex::{NO_VERTEX, VertexFlags};
use crate::kernel::metric::edge_quadric::{Costs, EdgeSide, SymmetricMatrix, VertexQuadrics};
use crate::kernel::metric::{Metric, edges_between, least_costs, protection};
use crate::kernel::schedule::bucket_queue::{NONE, bucket};
use crate::kernel::simd::{LANES, Row, select_max};

/// A vertex's cheapest edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Cheapest {
    /// Of its cost; `NONE` if there is no edge.
    pub(crate) bucket: u16,
    /// Its other end.
    pub(crate) target: u32,
}

/// The cheapest edge from `u`, of those above its floor; its ring is up to date.
#[inline(always)]
pub(crate) fn cheapest(vertices: &Vertices, model: &impl AttributeModel, u: u32) -> Cheapest {
    let vertex = vertices.get(u);
    match vertex.len {
        LONG => cheapest_of_many(vertices, model, u),
        len => cheapest_of(vertices, model, u, &vertex.ring, len.into()),
    }
}

#[cold]
fn cheapest_of_many(vertices: &Vertices, model: &impl AttributeModel, u: u32) -> Cheapest {
    let mut ring = [NO_VERTEX; MAX_RING];
    let all = vertices.neighbours(u);
    ring.iter_mut().zip(all).for_each(|(to, &w)| *to = w);
    cheapest_of(vertices, model, u, &ring, all.len().min(MAX_RING))
}

#[inline(always)]
fn cheapest_of<const ROOM: usize>(
    vertices: &Vertices,
    model: &impl AttributeModel,
    u: u32,
    ring: &[u32; ROOM],
    len: usize,
) -> Cheapest {
    let (mut least, mut left) = (Rank::LAST, len as u32);
    for some in ring.as_chunks::<LANES>().0 {
        // Lanes beyond the end look at the first one again.
        let mut ids = *some;
        for (lane, id) in (0..).zip(&mut ids) {
            *id = if lane < left { *id } else { some[0] };
        }
        let costs = costs(vertices, model, EdgeSide::Of(u), &ids);
        for (cost, id) in costs.into_iter().zip(ids) {
            least = least.min(Rank::new(cost, id));
        }
        left = left.saturating_sub(LANES as u32);
        if left == 0 {
            break;
        }
    }
    least.cheapest()
}

/// An edge among others of its vertex, by its cost, then by its end. A number, since which one is less
/// is not to be guessed by a branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Rank(u64);

impl Rank {
    /// Behind all edges.
    pub(crate) const LAST: Self = Self(u64::MAX);

    /// What is no number costs more than anything.
    #[inline(always)]
    pub(crate) fn new(cost: f32, to: u32) -> Self {
        let cost = if cost < f32::INFINITY { select_max(cost, 0.0) } else { f32::INFINITY };
        Self((u64::from(cost.to_bits()) << 32) | u64::from(to))
    }

    #[inline(always)]
    pub(crate) fn cheapest(self) -> Cheapest {
        match bucket(f32::from_bits((self.0 >> 32) as u32)) {
            NONE => Cheapest { bucket: NONE, target: NO_VERTEX },
            bucket => Cheapest { bucket, target: self.0 as u32 },
        }
    }
}

/// What eight edges cost; infinite where an edge may not be contracted, or costs no more than has been
/// refused at its first end.
#[inline(always)]
pub(crate) fn costs<A: AttributeModel>(
    vertices: &Vertices,
    model: &A,
    us: EdgeSide<u32>,
    vs: &[u32; LANES],
) -> Row {
    let mut found = match model.seam_costs(vertices, us, vs) {
        Some(found) => found,
        None => {
            let (first, second) = (
                VertexQuadrics::of(vertices, us),
                VertexQuadrics::of(vertices, EdgeSide::Each(*vs)),
            );
            let mut edges = edges_between::<A::Metric>(&first, &second);
            model.add_attribute_quadrics([us, EdgeSide::Each(*vs)], &mut edges);
            let any_special = VertexFlags(first.flags | second.flags).any(VertexFlags::SPECIAL)
                || first.floor > 0;
            Costs { costs: least_costs::<A::Metric>(&edges), any_special }
        }
    };
    if found.any_special {
        correct(&mut found.costs, vertices, model, us, vs);
    }
    found.costs
}

/// Costs of edges with an end that stays where it is or goes late, or that may not be contracted, or
/// not now.
#[cold]
fn correct<A: AttributeModel>(
    costs: &mut Row,
    vertices: &Vertices,
    model: &A,
    us: EdgeSide<u32>,
    vs: &[u32; LANES],
) {
    for (lane, (cost, &v)) in costs.iter_mut().zip(vs).enumerate() {
        let u = us.get(lane);
        let floor = vertices.get(u).floor;
        let flags = VertexFlags(vertices.get(u).flags.0 | vertices.get(v).flags.0);
        if !flags.any(VertexFlags::SPECIAL) && floor == 0 {
            continue;
        }
        if flags.any(VertexFlags::SHUT) {
            *cost = f32::INFINITY;
            continue;
        }
        if flags.any(VertexFlags::HELD) && !flags.any(VertexFlags::SEAM) {
            *cost = match model.orient(vertices, u, v) {
                Err(_) => f32::INFINITY,
                Ok(ends) if ends.free => *cost,
                Ok(ends) => {
                    let (end0, end1) = (vertices.get(ends.v0), vertices.get(ends.v1));
                    let weight = SymmetricMatrix(end1.quadric.squares()).trace();
                    let length = end0.place().distance_squared(end1.place());
                    let short = A::Metric::SHORT_FIRST * weight * length;
                    A::Metric::cost_onto(end0, end1) + short + model.cost_onto(vertices, &ends)
                }
            };
        }
        if flags.any(VertexFlags::PROTECTED) {
            *cost *= protection::<A::Metric>();
        }
        if floor > 0 && bucket(*cost) <= floor {
            *cost = f32::INFINITY;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_comes_last() {
        let rank = |cost| Rank::new(cost, 7);
        assert!(
            rank(-1.0) == rank(0.0) && rank(0.0) < rank(1e-30) && rank(2.0) < Rank::new(2.0, 8)
        );
        for cost in [f32::NAN, f32::INFINITY] {
            assert_eq!(rank(cost).cheapest(), Cheapest { bucket: NONE, target: NO_VERTEX });
            assert!(rank(f32::MAX) < rank(cost));
        }
    }
}
