//! What the loop asks of a method: the squares that vertices and edges have, what they cost at their
//! least, and what a contraction makes of them.
//!
//! | | [`Memoryless`](crate::fast::memoryless::Memoryless) | [`Quadrics`](crate::fast::quadrics::Quadrics) |
//! |---|---|---|
//! | squares | of the volumes that faces sweep | of distances from planes, times areas |
//! | where they are least | on the plane of equal volumes | anywhere |
//! | a new vertex has those of | its faces | its faces, and a tenth of what its ends had |
//! | the vertices around it, of | their faces | what they had |

use glam::{DVec3, Vec3};

use crate::fast::cost::{Edges, Stars};
use crate::fast::hood::Hood;
use crate::fast::looks::Placed;
use crate::fast::place::Swept;
use crate::fast::ring::Vertices;
use crate::fast::vertex::{Seen, Star, Vertex};
use crate::locks;

/// A method, by its squares.
pub(super) trait Rule: Copy + Send + Sync {
    /// With which power of a length costs grow.
    const POWER: i32;

    /// What a boundary edge counts, unless another weight is asked for.
    const BOUNDARY_WEIGHT: f32;

    /// By how many buckets of a quarter octave a cost may have risen since its vertex was looked at.
    const SLACK: u16;

    /// What the square of half the length of an edge counts. Short edges go first where all costs are
    /// rounding.
    const SHORT_FIRST: f32;

    /// What a face adds to each of its vertices, by twice its area along its normal.
    fn face(normal: Vec3) -> Star;

    /// What an edge of the boundary adds to both of its ends, by the same of its face.
    fn boundary(along: Vec3, normal: Vec3, weight: f32) -> Star;

    /// Adds to the squares of one of eight edges what the ends have beside planes through them.
    fn complete(edges: &mut Edges, lane: usize, first: &Stars, second: &Stars);

    /// What they are at their least.
    fn least(edges: &Edges, lane: usize) -> f32;

    /// What they are where `end1` goes to the place of `end0`.
    fn onto(end0: &Vertex, end1: &Vertex) -> f32;

    /// Those of a gathered edge, in doubles.
    fn swept(hood: &Hood, end0: &Vertex, end1: &Vertex) -> Swept;

    /// Where they are least, as seen from the middle; not a number where there is no such place.
    fn best(swept: &Swept) -> DVec3;

    /// What the vertex of a contraction has from now on, before any has moved. Boundary edges around
    /// that move with it are brought up to date.
    fn merge(vertices: &mut Vertices, hood: &mut Hood, swept: &Swept, placed: &Placed) -> Seen;

    /// Does to a vertex of the ring what the spokes on its two sides change; `kept` is the new vertex.
    fn renew(vertex: &mut Vertex, changes: [&Star; 2], kept: u32);

    /// Takes a face that goes out of a vertex of the ring.
    fn lose(vertex: &mut Vertex, normal: Vec3);
}

/// What an edge to a protected vertex costs, times: as if all moved so much farther.
pub(super) fn protection<R: Rule>() -> f32 {
    locks::PROTECTION.powi(R::POWER) as f32
}
