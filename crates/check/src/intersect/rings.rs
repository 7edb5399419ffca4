//! Proves for all faces around a vertex at once that they do not intersect, where that is possible.

use meshlod_mesh::VertexId;

use super::exact::project;
use super::soup::{SearchInput, TriangleSoup, has_distinct_corners};

/// Vertices whose faces are proved to intersect only in the corners and edges they share.
///
/// The proof: in the projection along an axis, all faces around an interior vertex have the same
/// orientation and wind around it once. Then each direction from the vertex is in one face, and two
/// faces of the ring can only meet in the vertex or their common edge. Orientations are the signs
/// of the components of the normals; the winding number is how often the rim of the ring rises
/// through the height of the vertex. One pass over the faces covers all rings.
pub(crate) struct CertifiedRings(Vec<bool>);

/// Summary of a ring: the common signs of its normals, and the rises of its rim.
#[derive(Clone, Copy)]
struct RingSummary {
    /// Two bits an axis: all normals point up the axis; all point down.
    signs: u8,
    /// Number of times the rim rises through the vertex, in x and in y; saturates at 2.
    rises: [u8; 2],
    /// True if the ring is a single closed fan.
    closed: bool,
}

/// Initial signs: neither excluded along any axis.
const UP_OR_DOWN: u8 = 0x3f;
const UP: u8 = 1;
const DOWN: u8 = 2;
/// Magnitude, relative to its terms, from which the sign of a computed 2 × 2 determinant is
/// certain: three rounded operations [She97, section 4.2] and a margin.
const CERTAIN: f64 = 4.5e-16;
/// Product below which digits may have been lost to underflow.
const TINY: f64 = 1e-290;

impl CertifiedRings {
    /// Certifies all vertices whose ring of faces can be proved free of intersections. Excluded
    /// faces are not part of any ring.
    pub(crate) fn of(input: &SearchInput<'_>, soup: &TriangleSoup<'_>) -> Self {
        let mut rings: Vec<RingSummary> = (0..input.positions.len())
            .map(|v| {
                let marks = input.connectivity.marks(VertexId(v as u32));
                let closed = !marks.boundary() && !marks.non_manifold();
                RingSummary { signs: UP_OR_DOWN, rises: [0; 2], closed }
            })
            .collect();
        // Vertices that share a position may have more than one fan between them.
        for duplicate in input.unique.duplicates() {
            rings[input.unique.representative(duplicate).index()].closed = false;
        }
        for face in soup.corners.iter().filter(|face| has_distinct_corners(face)) {
            let points = soup.positions.triangle(*face);
            let signs = signs(&points);
            for (k, &v) in face.iter().enumerate() {
                let [p, a, b] = [points[k], points[(k + 1) % 3], points[(k + 2) % 3]];
                let ring = &mut rings[v.index()];
                ring.signs &= signs;
                for axis in 0..2 {
                    let rises = a[axis] < p[axis] && p[axis] <= b[axis];
                    ring.rises[axis] = (ring.rises[axis] + u8::from(rises)).min(2);
                }
            }
        }
        Self(rings.into_iter().map(RingSummary::certified).collect())
    }

    /// Returns true if the faces around a vertex are proved free of intersections.
    #[inline]
    pub(crate) fn contains(&self, vertex: VertexId) -> bool {
        self.0[vertex.index()]
    }
}

impl RingSummary {
    fn certified(self) -> bool {
        let along = |axis: usize| self.signs >> (2 * axis) & (UP | DOWN) != 0;
        // Seen along x and z the rim rises in y, seen along y in x.
        let [in_x, in_y] = self.rises.map(|rises| rises == 1);
        self.closed && (((along(0) || along(2)) && in_y) || (along(1) && in_x))
    }
}

/// Returns the signs of the components of a normal that are certain.
#[inline]
fn signs(triangle: &[glam::DVec3; 3]) -> u8 {
    let mut signs = 0;
    for axis in 0..3 {
        let [a, b, c] = triangle.map(|p| project(axis, p));
        let (u, v) = (b - a, c - a);
        let (left, right) = (u.x * v.y, u.y * v.x);
        let (area, error) = (left - right, CERTAIN * (left.abs() + right.abs()) + TINY);
        let sign = if area > error {
            UP
        } else if area < -error {
            DOWN
        } else {
            0
        };
        signs |= sign << (2 * axis);
    }
    signs
}
