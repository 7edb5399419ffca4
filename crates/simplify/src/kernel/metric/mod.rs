//! The error metric of a method: the quadrics of vertices and edges, their minimum, and their
//! update by a contraction.
//!
//! | | [`SweptVolume`](crate::kernel::SweptVolume) | [`PlaneDistance`](crate::kernel::PlaneDistance) |
//! |---|---|---|
//! | square of | the volume swept by a face | the distance from a plane, weighted by area |
//! | minimized | on the plane of equal volume | anywhere |
//! | new vertex | the quadrics of its faces | nine tenths of its faces', a tenth of its ends' |
//! | vertices around | the quadrics of their faces | unchanged |

pub(crate) mod edge_quadric;
pub(crate) mod edge_quadric_f64;
pub(crate) mod plane_distance;
pub(crate) mod swept_volume;

use glam::{DVec3, Vec3};

use crate::kernel::collapse::Collapse;
use crate::kernel::collapse::edge_ring::EdgeRing;
use crate::kernel::mesh::one_ring::Vertices;
use crate::kernel::mesh::vertex::{FullQuadric, Vertex, VertexQuadric};
use crate::kernel::metric::edge_quadric::{EdgeQuadrics, SymmetricMatrix, VertexQuadrics, lane_of};
use crate::kernel::metric::edge_quadric_f64::EdgeQuadricF64;
use crate::kernel::simd::{LANES, Row};
use crate::method::Method;

/// Error metric of a method.
pub(crate) trait Metric: Copy + Send + Sync {
    /// True if a vertex has the quadrics of its current faces and lines, and nothing else.
    const IS_MEMORYLESS: bool;

    /// The method.
    const METHOD: Method;

    /// Default weight of a boundary edge.
    const BOUNDARY_WEIGHT: f32;

    /// Number of buckets, four to the octave, by which a cost may have risen since its vertex was
    /// costed.
    const SLACK: u16;

    /// Weight of the square of half the edge length. Short edges go first where all costs are
    /// rounding errors.
    const SHORT_FIRST: f32;

    /// Returns what a face adds to each of its vertices. The normal is twice the area long.
    fn face(normal: Vec3) -> VertexQuadric;

    /// Returns what a boundary edge adds to both ends. The normal is that of its face, twice the
    /// area long.
    fn boundary(along: Vec3, normal: Vec3, weight: f32) -> VertexQuadric;

    /// Adds the linear and constant terms of the ends to the quadric of one of eight edges.
    fn add_linear_terms(
        edges: &mut EdgeQuadrics,
        lane: usize,
        first: &VertexQuadrics,
        second: &VertexQuadrics,
    );

    /// Returns the weight of a face for attributes from the square of twice its area, and the
    /// weight divided by that square. Weights are those of [`Self::face`].
    fn face_weight(squared: f32) -> (f32, f32);

    /// Returns what an edge between two charts adds to both ends, which otherwise could move across
    /// the surface at no cost.
    fn seam(along: Vec3) -> VertexQuadric;

    /// Returns the part of the seam quadrics that a new vertex takes in addition to what
    /// [`Self::merged_quadric`] keeps. `seams` is the sum over its own edges; `open` is true at a
    /// boundary.
    fn renewed_seams(seams: VertexQuadric, open: bool) -> VertexQuadric;

    /// Returns the linear and constant part of the cost of one of eight edges when the second end
    /// is contracted onto the first. `half` is half the edge vector.
    fn offsets_onto(
        first: &VertexQuadrics,
        second: &VertexQuadrics,
        lane: usize,
        half: Vec3,
    ) -> f32;

    /// Returns the minimum of the quadric of one of eight edges.
    fn min_cost(edges: &EdgeQuadrics, lane: usize) -> f32;

    /// Returns the cost of contracting `end1` onto `end0`.
    fn cost_onto(end0: &Vertex, end1: &Vertex) -> f32;

    /// Returns the cost of removing a component of this area, with `faces` faces left, at a mean
    /// square distance from what remains: that of the contractions which would remove as many faces
    /// and move the surface as far.
    fn vanishing_cost(area: f32, faces: f32, mean_square: f32) -> f32;

    /// Returns the quadric of a gathered edge in f64.
    fn edge_quadric(edge_ring: &EdgeRing, end0: &Vertex, end1: &Vertex) -> EdgeQuadricF64;

    /// Returns the best place, relative to the middle of the edge; not finite if there is none. The
    /// volume is preserved as far as that adds no more than `allowed` to the mean square distance.
    fn optimum(quadric: &EdgeQuadricF64, allowed: f64) -> DVec3;

    /// Returns the best place on the line through the first end along the surface's normal,
    /// relative to the middle of the edge: the first end itself unless the volume is preserved.
    fn optimum_along_normal(quadric: &EdgeQuadricF64, _end0: &Vertex, _allowed: f64) -> DVec3 {
        -quadric.half
    }

    /// Returns the quadric of the new vertex, before any vertex is changed. Also updates the
    /// boundary edges that move with the new vertex.
    fn merged_quadric(
        vertices: &mut Vertices,
        edge_ring: &mut EdgeRing,
        quadric: &EdgeQuadricF64,
        collapse: &Collapse,
    ) -> FullQuadric;

    /// Applies to a ring vertex the changes of its two incident spokes. `kept` is the new vertex.
    fn update_neighbour(vertex: &mut Vertex, changes: [&VertexQuadric; 2], kept: u32);

    /// Subtracts a dying face from a ring vertex.
    fn remove_face(vertex: &mut Vertex, normal: Vec3);
}

/// Squared distance that preserving the volume may add, as a fraction of the usual one or of the
/// step's own.
///
/// Part of its volume that armadillo-52k loses at 1 %: no limit 1.5e-8; .5 1.6e-8; .2 1.4e-4.
/// Geometric means over four levels of nineteen models, relative to no limit: 1 .993 in the mean,
/// .996 in the maximum; .2 .994, .961. These were measured with squared volumes, and before only
/// places more than half an edge away were limited.
pub(crate) const VOLUME_SHARE: f64 = 0.5;

/// Factor on the cost of a component that vanishes. Mean and maximum of skyscraper at 25 %, and of
/// city at 10 %, in % of the diagonal: 12 .199, 5.98, .161, 4.2; 3 .078, 2.3, .150, 3.0; 1 .091,
/// 1.9, .169, 2.3; .3 .104, 1.4, .184, 2.4.
pub(crate) const VANISHING: f32 = 3.0;

/// Returns the quadrics of eight edges from those of their ends.
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

/// Returns the cost of each of eight edges.
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
