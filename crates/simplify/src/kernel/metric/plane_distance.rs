//! The metric of `qem` [GH97]: squared distances from the planes of all faces merged into a vertex.
//! As in the policy engine's `methods/qem.rs`, planes are weighted by area and memory fades.
//!
//! The remembered planes do not pass through the vertex, so its quadric has all terms of x'Ax −
//! 2b·x + c, relative to the vertex. Relative to the middle of an edge with ends at −h and h, the
//! sum of both is
//!
//! ```text
//! x'(A₀ + A₁)x − 2 ((A₁ − A₀)h + b₀ + b₁)·x + h'(A₀ + A₁)h + 2 (b₁ − b₀)·h + c₀ + c₁
//! ```
//!
//! At a new vertex that was free to move, b is almost zero, and c is what was lost on the way.

use glam::{DMat3, DVec3, Vec3};

use crate::kernel::collapse::Collapse;
use crate::kernel::collapse::edge_ring::{EdgeRing, row3};
use crate::kernel::mesh::one_ring::Vertices;
use crate::kernel::mesh::vertex::{Bf16, FullQuadric, Vertex, VertexFlags, VertexQuadric};
use crate::kernel::metric::edge_quadric::{
    EdgeQuadrics, PULL, SymmetricMatrix, VertexQuadrics, lane_of, outer,
};
use crate::kernel::metric::edge_quadric_f64::{EdgeQuadricF64, matrix};
use crate::kernel::metric::{Metric, VANISHING};
use crate::kernel::simd::{LANES, TINY, select_max, sum_of};
use crate::method::Method;
use crate::methods::qem::{BOUNDARY_WEIGHT, MEMORY};

/// Weight of an edge between two charts, as in the policy engine.
const SEAM_WEIGHT: f32 = 1.0;

/// Area-weighted squared distances from planes, with fading memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneDistance;

impl PlaneDistance {
    /// Returns the quadric of one edge in f64 from those of its ends.
    #[inline(always)]
    fn along(end0: &Vertex, end1: &Vertex) -> EdgeQuadricF64 {
        let half = (end1.place() - end0.place()).as_dvec3() * 0.5;
        let (a0, a1) = (matrix(&end0.quadric), matrix(&end1.quadric));
        let (b0, b1) = (end0.quadric.vector().as_dvec3(), end1.quadric.vector().as_dvec3());
        let constant = f64::from(end0.constant.get()) + f64::from(end1.constant.get());
        EdgeQuadricF64 {
            half,
            sum: a0 + a1,
            slope: (a1 - a0) * half + (b0 + b1),
            at_middle: half.dot((a0 + a1) * half) + 2.0 * (b1 - b0).dot(half) + constant,
            normal: DVec3::ZERO,
            level: 0.0,
        }
    }
}

impl Metric for PlaneDistance {
    const IS_MEMORYLESS: bool = false;

    const METHOD: Method = Method::Qem;

    const BOUNDARY_WEIGHT: f32 = BOUNDARY_WEIGHT as f32;

    /// Mean error of horse-97k at 10 % and 1 %, and of igea at 10 %: 0 .00882, .0714, .00510; 1
    /// .00883, .0726, .00509; 2 .00885, .0732, .00511; 4 .00895, .0747, .00516, for 6 % fewer
    /// instructions than 1; all with a length weight of 1e-7.
    const SLACK: u16 = 1;

    /// Mean error of fandisk-32k, half of which is flat, and of igea at 10 %: 1e-9 .00589, .00510;
    /// 1e-7 .00584, .00509; 3e-7 .00582, .00509; 1e-6 .00553, .00510.
    const SHORT_FIRST: f32 = 1e-6;

    #[inline(always)]
    fn face(normal: Vec3) -> VertexQuadric {
        VertexQuadric::new(Vec3::ZERO, plane(normal))
    }

    /// Returns the quadric of a plane through the edge, perpendicular to the face.
    fn boundary(along: Vec3, normal: Vec3, weight: f32) -> VertexQuadric {
        let across = along.cross(normal.normalize_or_zero()) * weight.sqrt();
        VertexQuadric::new(Vec3::ZERO, outer(across))
    }

    #[inline(always)]
    fn add_linear_terms(
        edges: &mut EdgeQuadrics,
        lane: usize,
        first: &VertexQuadrics,
        second: &VertexQuadrics,
    ) {
        let (b0, b1) = (first.vector.get(lane), second.vector.get(lane));
        let (c0, c1) = (first.constant[lane], second.constant[lane]);
        let h = edges.half.get(lane);
        edges.slope.set(lane, edges.slope.get(lane) + (b0 + b1));
        edges.at_middle[lane] += 2.0 * (b1 - b0).dot(h) + (c0 + c1);
    }

    /// Solves by S = L D L', with a pull to the middle on the diagonal. No entry of D is smaller
    /// than the pull, so rounding cannot make one too small.
    #[inline(always)]
    fn min_cost(edges: &EdgeQuadrics, lane: usize) -> f32 {
        let [xx, yy, zz, xy, xz, yz] = lane_of(&edges.sum, lane);
        let Vec3 { x, y, z } = edges.slope.get(lane);
        let pull = PULL * (xx + yy + zz) + TINY;
        let d1 = (xx + pull).recip();
        let (l21, l31) = (xy * d1, xz * d1);
        let d2 = select_max(yy + pull - l21 * xy, pull).recip();
        let left = yz - l21 * xz;
        let l32 = left * d2;
        let d3 = select_max(zz + pull - l31 * xz - l32 * left, pull).recip();
        let y = y - l21 * x;
        let z = z - l31 * x - l32 * y;
        edges.at_middle[lane] - (x * x * d1 + y * y * d2 + z * z * d3)
    }

    /// The weight is the area.
    #[inline(always)]
    fn face_weight(squared: f32) -> (f32, f32) {
        let per_square = 0.5 * (squared + TINY).sqrt().recip();
        (squared * per_square, per_square)
    }

    /// Returns the squared distance from the edge's line.
    fn seam(along: Vec3) -> VertexQuadric {
        let [xx, yy, zz, xy, xz, yz] = outer(along);
        let squared = along.length_squared();
        let across = [squared - xx, squared - yy, squared - zz, -xy, -xz, -yz];
        VertexQuadric::new(Vec3::ZERO, across.map(|x| SEAM_WEIGHT * x))
    }

    /// As for faces: everything is remembered at a boundary, most is forgotten elsewhere.
    #[inline(always)]
    fn renewed_seams(seams: VertexQuadric, open: bool) -> VertexQuadric {
        let share = if open { 0.0 } else { (1.0 - MEMORY) as f32 };
        VertexQuadric(seams.0.map(|four| four * share))
    }

    #[inline(always)]
    fn offsets_onto(
        first: &VertexQuadrics,
        second: &VertexQuadrics,
        lane: usize,
        half: Vec3,
    ) -> f32 {
        let linear = 4.0 * second.vector.get(lane).dot(half);
        linear + (first.constant[lane] + second.constant[lane])
    }

    fn cost_onto(end0: &Vertex, end1: &Vertex) -> f32 {
        let (to, quadric) = (end0.place() - end1.place(), &end1.quadric);
        let moved = SymmetricMatrix(quadric.squares()).at(to) - 2.0 * quadric.vector().dot(to);
        moved + (end0.constant.get() + end1.constant.get())
    }

    fn vanishing_cost(area: f32, faces: f32, mean_square: f32) -> f32 {
        VANISHING * mean_square * area / faces
    }

    #[inline(always)]
    fn edge_quadric(edge_ring: &EdgeRing, end0: &Vertex, end1: &Vertex) -> EdgeQuadricF64 {
        let (normal, level) = edge_ring.volume_plane(edge_ring.dying_normals());
        EdgeQuadricF64 { normal, level, ..Self::along(end0, end1) }
    }

    /// The place is unconstrained; the middle if there are no planes.
    #[inline(always)]
    fn optimum(quadric: &EdgeQuadricF64, _: f64) -> DVec3 {
        quadric.minimum()
    }

    /// At a boundary everything is remembered, as its planes are not those of the faces around.
    #[inline(always)]
    fn merged_quadric(
        _: &mut Vertices,
        edge_ring: &mut EdgeRing,
        quadric: &EdgeQuadricF64,
        collapse: &Collapse,
    ) -> FullQuadric {
        let x = collapse.displacement.as_dvec3() - quadric.half;
        let memory = if edge_ring.ghost.is_some() { 1.0 } else { MEMORY };
        let slope = (quadric.slope - quadric.sum * x) * memory;
        let DMat3 { x_axis, y_axis, z_axis } = quadric.sum * memory;
        let squares = [x_axis.x, y_axis.y, z_axis.z, x_axis.y, x_axis.z, y_axis.z];
        let mut star = VertexQuadric::new(slope.as_vec3(), squares.map(|x| x as f32));
        if edge_ring.ghost.is_none() {
            star.add(&faces(edge_ring, (1.0 - MEMORY) as f32));
        }
        FullQuadric { star, constant: Bf16::new((quadric.at(x) * memory) as f32) }
    }

    /// Marks the vertex if its edge to the new vertex is its cheapest: the geometry of no other edge
    /// has changed. Edges that attributes made cheaper are recosted when the entry comes up.
    #[inline(always)]
    fn update_neighbour(vertex: &mut Vertex, _: [&VertexQuadric; 2], kept: u32) {
        if vertex.target == kept {
            vertex.flags.set(VertexFlags::STALE);
        }
    }

    #[inline(always)]
    fn remove_face(_: &mut Vertex, _: Vec3) {}
}

/// Returns the weighted sum of the plane quadrics of the new vertex's faces.
#[inline(always)]
fn faces(edge_ring: &EdgeRing, weight: f32) -> VertexQuadric {
    let mut sums = [[0.0; LANES]; 6];
    for start in edge_ring.lane_starts() {
        let new = row3(&edge_ring.new, start);
        for lane in 0..LANES {
            let squares = plane(new.get(lane));
            for k in 0..6 {
                sums[k][lane] += squares[k];
            }
        }
    }
    let mut squares = [0.0; 6];
    for (square, lanes) in squares.iter_mut().zip(&sums) {
        *square = weight * sum_of(lanes);
    }
    VertexQuadric::new(Vec3::ZERO, squares)
}

/// Returns the area-weighted plane quadric of a face. The normal is twice the area long.
#[inline(always)]
fn plane(normal: Vec3) -> [f32; 6] {
    let by = 0.5 * (normal.dot(normal) + TINY).sqrt().recip();
    let [xx, yy, zz, xy, xz, yz] = outer(normal);
    [xx * by, yy * by, zz * by, xy * by, xz * by, yz * by]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::attributes::bare::NoAttributes;
    use crate::kernel::metric::edge_quadric::EdgeSide;
    use crate::kernel::schedule::edge_costs::costs;

    /// A normal, and a point of the plane.
    type Plane = (Vec3, Vec3);

    const ENDS: [Vec3; 2] = [Vec3::new(3.0, -1.0, 2.0), Vec3::new(3.5, -0.5, 1.25)];

    /// Returns a vertex with the quadric of these planes, wherever they are.
    fn vertex(place: Vec3, planes: &[Plane]) -> Vertex {
        let (mut star, mut constant) = (VertexQuadric::default(), 0.0);
        for &(normal, point) in planes {
            let level = normal.dot(point - place);
            star.add(&VertexQuadric::new(normal * level, outer(normal)));
            constant += level * level;
        }
        let mut vertex = Vertex::at(place);
        vertex.put(place, FullQuadric { star, constant: Bf16::new(constant) });
        vertex
    }

    fn squares(planes: &[Plane], at: DVec3) -> f64 {
        let off = |(normal, point): &Plane| (at - point.as_dvec3()).dot(normal.as_dvec3());
        planes.iter().map(|plane| off(plane).powi(2)).sum()
    }

    /// Planes of two ends on a flat, at an edge and at a corner. Some pass through their ends, some
    /// do not.
    fn cases() -> [[Vec<Plane>; 2]; 3] {
        let up = Vec3::new(0.2, 1.0, -0.5);
        let (left, right) = (Vec3::new(1.0, 0.3, 0.1), Vec3::new(-0.2, 0.1, 0.8));
        let [at0, at1] = ENDS;
        let off = at1 + Vec3::new(0.1, 0.05, -0.2);
        [
            [vec![(up, at0)], vec![(2.0 * up, at1)]],
            [vec![(up, at0), (left, at1)], vec![(up, off)]],
            [vec![(up, at0), (right, off)], vec![(left, at1), (up, off), (right, at0)]],
        ]
    }

    #[test]
    fn an_edge_has_the_quadric_of_all_planes_of_its_ends() {
        for planes in cases() {
            let (end0, end1) = (vertex(ENDS[0], &planes[0]), vertex(ENDS[1], &planes[1]));
            let quadric = PlaneDistance::along(&end0, &end1);
            let middle = (ENDS[0] + ENDS[1]).as_dvec3() / 2.0;
            for x in [DVec3::ZERO, DVec3::X, DVec3::new(-1.0, 2.0, 0.5)] {
                let expected = squares(&planes.concat(), middle + x);
                assert!(
                    (quadric.at(x) / expected - 1.0).abs() < 0.01,
                    "{} {expected}",
                    quadric.at(x)
                );
            }
            let expected = squares(&planes.concat(), ENDS[0].into());
            let onto = f64::from(PlaneDistance::cost_onto(&end0, &end1));
            assert!((onto - expected).abs() < 0.01 * expected + 1e-5, "{onto} {expected}");
        }
    }

    #[test]
    fn rows_give_the_same_minimum_as_f64() {
        for planes in cases() {
            let mut all = [0, 1].map(|end| vertex(ENDS[end], &planes[end]));
            let quadric = PlaneDistance::along(&all[0], &all[1]);
            let short = f64::from(PlaneDistance::SHORT_FIRST) * quadric.weight();
            let least = quadric.at(PlaneDistance::optimum(&quadric, 0.0))
                + short * quadric.half.length_squared();
            let mut long = Vec::new();
            let vertices = Vertices::new(&mut all, 0, &mut long);
            let rows = costs(&vertices, &NoAttributes(PlaneDistance), EdgeSide::Of(0), &[1; LANES]);
            for cost in rows {
                assert!((f64::from(cost) - least).abs() < 1e-3 * least + 1e-6, "{cost} {least}");
            }
        }
    }

    #[test]
    fn the_optimum_is_the_corner_or_the_middle_on_a_flat() {
        let corner = Vec3::new(3.2, -0.9, 1.5);
        let planes = [Vec3::X, Vec3::Y, Vec3::Z].map(|normal| (normal, corner));
        let best = |planes: [&[Plane]; 2]| {
            let [end0, end1] = [0, 1].map(|end| vertex(ENDS[end], planes[end]));
            PlaneDistance::optimum(&PlaneDistance::along(&end0, &end1), 0.0)
        };
        let middle = (ENDS[0] + ENDS[1]) / 2.0;
        let found = best([&planes[..2], &planes[2..]]);
        assert!(found.distance((corner - middle).into()) < 1e-4, "{found}");
        let flat = (ENDS[1] - ENDS[0]).any_orthogonal_vector();
        assert!(best([&[(flat, ENDS[0])], &[(flat, ENDS[1])]]).length() < 1e-2);
        assert_eq!(best([&[], &[]]), DVec3::ZERO);
    }
}
