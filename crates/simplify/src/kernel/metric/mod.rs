//! What the loop asks of a method: the squares that vertices and edges have, what they cost at their
//! least, and what a contraction makes of them.
//!
//! | | [`SweptVolume`](crate::kernel::memoryless::SweptVolume) | [`PlaneDistance`](crate::kernel::quadrics::PlaneDistance) |
//! |---|---|---|
//! | squares | of the volumes that faces sweep | of distances from planes, times areas |
//! | where they are least | on the plane of equal volumes | anywhere |
//! | a new vertex has those of | its faces | its faces, and a tenth of what its ends had |
//! | the vertices around it, of | their faces | what they had |

pub(crate) mod edge_quadric;
pub(crate) mod edge_quadric_f64;
pub(crate) mod plane_distance;
pub(crate) mod swept_volume;

use crate::kernel::collapse::Collapse;
use crate::kernel::collapse::edge_ring::EdgeRing;
use crate::kernel::mesh::one_ring::Vertices;
use crate::kernel::mesh::vertex::{FullQuadric, Vertex, VertexQuadric};
use crate::kernel::metric::edge_quadric::{EdgeQuadrics, SymmetricMatrix, VertexQuadrics, lane_of};
use crate::kernel::metric::edge_quadric_f64::EdgeQuadricF64;
use crate::kernel::simd::{LANES, Row};
use glam::{DVec3, Vec3};

use crate::engine::locks;
use crate::options::Method;

/// A method, by its squares.
pub(crate) trait Metric: Copy + Send + Sync {
    /// Whether a vertex has nothing but the squares of the faces and lines around it as they are.
    const IS_MEMORYLESS: bool;

    /// The method by its name.
    const METHOD: Method;

    /// What a boundary edge counts, unless another weight is asked for.
    const BOUNDARY_WEIGHT: f32;

    /// By how many buckets of a quarter octave a cost may have risen since its vertex was looked at.
    const SLACK: u16;

    /// What the square of half the length of an edge counts. Short edges go first where all costs are
    /// rounding.
    const SHORT_FIRST: f32;

    /// What a face adds to each of its vertices, by twice its area along its normal.
    fn face(normal: Vec3) -> VertexQuadric;

    /// What an edge of the boundary adds to both of its ends, by the same of its face.
    fn boundary(along: Vec3, normal: Vec3, weight: f32) -> VertexQuadric;

    /// Adds to the squares of one of eight edges what the ends have beside planes through them.
    fn add_linear_terms(
        edges: &mut EdgeQuadrics,
        lane: usize,
        first: &VertexQuadrics,
        second: &VertexQuadrics,
    );

    /// The weight of a face for attributes, by the square of twice its area, and that weight by the
    /// square: in the terms of [`Self::face`].
    fn face_weight(squared: f32) -> (f32, f32);

    /// What an edge between two charts adds to both of its ends, which otherwise would cost nothing
    /// to move across the surface.
    fn seam(along: Vec3) -> VertexQuadric;

    /// What of [`Self::seam`] a new vertex takes beside what [`Self::merge`] keeps, where the sum over
    /// its own edges is `seams`; `open` where the surface ends at it.
    fn renewed_seams(seams: VertexQuadric, open: bool) -> VertexQuadric;

    /// What one of eight edges costs beside planes through its second end, where that goes to the
    /// place of the first: `half` is half the edge.
    fn offsets_onto(
        first: &VertexQuadrics,
        second: &VertexQuadrics,
        lane: usize,
        half: Vec3,
    ) -> f32;

    /// What they are at their least.
    fn min_cost(edges: &EdgeQuadrics, lane: usize) -> f32;

    /// What they are where `end1` goes to the place of `end0`.
    fn cost_onto(end0: &Vertex, end1: &Vertex) -> f32;

    /// Those of a gathered edge, in doubles.
    fn edge_quadric(edge_ring: &EdgeRing, end0: &Vertex, end1: &Vertex) -> EdgeQuadricF64;

    /// Where they are least, as seen from the middle; not a number where there is no such place.
    fn optimum(quadric: &EdgeQuadricF64) -> DVec3;

    /// What the vertex of a contraction has from now on, before any has moved. Boundary edges around
    /// that move with it are brought up to date.
    fn merged_quadric(
        vertices: &mut Vertices,
        edge_ring: &mut EdgeRing,
        quadric: &EdgeQuadricF64,
        collapse: &Collapse,
    ) -> FullQuadric;

    /// Does to a vertex of the ring what the spokes on its two sides change; `kept` is the new vertex.
    fn update_neighbour(vertex: &mut Vertex, changes: [&VertexQuadric; 2], kept: u32);

    /// Takes a face that goes out of a vertex of the ring.
    fn remove_face(vertex: &mut Vertex, normal: Vec3);
}

/// What an edge to a protected vertex costs, times: as if all moved so much farther.
pub(crate) fn protection<M: Metric>() -> f32 {
    locks::PROTECTION.powi(M::METHOD.cost_power()) as f32
}

#[inline(always)]
pub(crate) fn edges_between<M: Metric>(
    first: &VertexQuadrics,
    second: &VertexQuadrics,
) -> EdgeQuadrics {
    let mut edges = EdgeQuadrics::ZERO;
    for lane in 0..LANES {
        let h = (second.place.get(lane) - first.place.get(lane)) * 0.5;
        let a0 = SymmetricMatrix(lane_of(&first.squares, lane));
        let a1 = SymmetricMatrix(lane_of(&second.squares, lane));
        let (a0h, a1h) = (a0.apply(h), a1.apply(h));
        for (sum, (a0, a1)) in edges.sum.iter_mut().zip(a0.0.into_iter().zip(a1.0)) {
            sum[lane] = a0 + a1;
        }
        edges.half.set(lane, h);
        edges.slope.set(lane, a1h - a0h);
        edges.at_middle[lane] = (a1h + a0h).dot(h);
        M::add_linear_terms(&mut edges, lane, first, second);
    }
    edges
}

/// What each costs.
#[inline(always)]
pub(crate) fn least_costs<M: Metric>(edges: &EdgeQuadrics) -> Row {
    let mut costs = [0.0; LANES];
    for (lane, cost) in costs.iter_mut().enumerate() {
        let h = edges.half.get(lane);
        let trace = SymmetricMatrix(lane_of(&edges.sum, lane)).trace();
        *cost = M::min_cost(edges, lane) + M::SHORT_FIRST * trace * h.dot(h);
    }
    costs
}
