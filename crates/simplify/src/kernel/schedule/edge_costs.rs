//! Costs of the edges of a vertex: the minimum of the edge's quadric by the [metric](Metric), plus
//! a small term for its length.
//!
//! All of it comes from the quadrics at the two ends. For planes through the ends at −h and h, with
//! matrices A₀ and A₁, the quadric relative to the middle is x'Sx − 2q·x + h'Sh, where S = A₀ + A₁
//! and q = (A₁ − A₀)h. The metric adds the rest.

use crate::kernel::attributes::AttributeModel;
use crate::kernel::mesh::one_ring::{LONG, MAX_RING, Vertices};
use crate::kernel::mesh::vertex::{NO_VERTEX, VertexFlags};
use crate::kernel::metric::edge_quadric::{Costs, EdgeSide, SymmetricMatrix, VertexQuadrics};
use crate::kernel::metric::{Metric, edges_between, least_costs};
use crate::kernel::schedule::bucket_queue::{NONE, bucket};
use crate::kernel::simd::{LANES, Row, select_max};

/// Cheapest edge of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Cheapest {
    /// Bucket of the cost; `NONE` if there is no edge.
    pub(crate) bucket: u16,
    /// Other end of the edge.
    pub(crate) target: u32,
}

/// Returns the cheapest edge of `u` above its floor. The ring must be up to date.
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
        // Lanes beyond the end repeat the first edge.
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

/// Order of the edges of one vertex: by cost, then by the other end. An integer, so that the
/// minimum takes no branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Rank(u64);

impl Rank {
    /// Rank behind all edges.
    pub(crate) const LAST: Self = Self(u64::MAX);

    /// Ranks an edge. NaN counts as infinite.
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

/// Returns the costs of eight edges. The cost is infinite if an edge must not be contracted, or if
/// its bucket is not above the floor of its first end.
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

/// Corrects the costs of edges with an end that stays in place or goes late, and of those that must
/// not be contracted, or not now.
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
                Ok(ends) if ends.is_free() => *cost,
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
            *cost *= vertices.protection;
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
    fn nan_and_infinite_costs_come_last() {
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
