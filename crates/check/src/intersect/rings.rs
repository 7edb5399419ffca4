//! Faces around one place: certified as a whole where that is possible.

use meshlod_mesh::VertexId;

use super::exact::without;
use super::soup::{Ground, Soup, whole};

/// Places whose faces meet only where they share corners.
///
/// Looked at along an axis, the faces around an inner vertex turn the same way, all of them, and go
/// round it once: then each direction from the vertex is in one face, and two faces of the ring can
/// only meet in the vertex or their common edge. The turns are the signs of the components of the
/// normals; how often the faces go round is how often the rim rises through the height of the vertex.
/// All of it is done for all rings at once in one pass over the faces.
pub(crate) struct Certified(Vec<bool>);

/// What is known of a ring: the signs that all its normals have, and rises of its rim.
#[derive(Clone, Copy)]
struct Ring {
    /// Two bits an axis: all normals point up it; all point down it.
    signs: u8,
    /// How often the rim rises through the vertex, in x and in y; 2 stands for more.
    rises: [u8; 2],
    /// One fan that is closed.
    closed: bool,
}

/// Either sign along each axis: nothing is known to be against it.
const UP_OR_DOWN: u8 = 0x3f;
const UP: u8 = 1;
const DOWN: u8 = 2;
/// A computed 2 × 2 determinant has the right sign when it is this much larger than its terms: three
/// rounded operations [She97, section 4.2], and a little more.
const SURE: f64 = 4.5e-16;
/// Products below this may have lost digits to underflow.
const TINY: f64 = 1e-290;

impl Certified {
    /// Certifies all rings that it can; faces that have no part are left out of them.
    pub(crate) fn of(ground: &Ground<'_>, soup: &Soup<'_>) -> Self {
        let mut rings: Vec<Ring> = (0..ground.positions.len())
            .map(|v| {
                let marks = ground.connectivity.marks(VertexId(v as u32));
                let closed = !marks.boundary() && !marks.non_manifold();
                Ring { signs: UP_OR_DOWN, rises: [0; 2], closed }
            })
            .collect();
        // Where vertices share a place, what is around it may be more than one fan.
        for double in ground.places.doubles() {
            rings[ground.places.first(double).index()].closed = false;
        }
        for face in soup.corners.iter().filter(|face| whole(face)) {
            let points = soup.points.triangle(*face);
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
        Self(rings.into_iter().map(Ring::certified).collect())
    }

    /// Whether the faces around a place are known to meet only where they share corners.
    #[inline]
    pub(crate) fn holds(&self, place: VertexId) -> bool {
        self.0[place.index()]
    }
}

impl Ring {
    fn certified(self) -> bool {
        let along = |axis: usize| self.signs >> (2 * axis) & (UP | DOWN) != 0;
        // Along x and z the rim is seen to rise in y, along y in x.
        let [in_x, in_y] = self.rises.map(|rises| rises == 1);
        self.closed && (((along(0) || along(2)) && in_y) || (along(1) && in_x))
    }
}

/// The signs of the components of a normal that are beyond doubt.
#[inline]
fn signs(triangle: &[glam::DVec3; 3]) -> u8 {
    let mut signs = 0;
    for axis in 0..3 {
        let [a, b, c] = triangle.map(|p| without(axis, p));
        let (u, v) = (b - a, c - a);
        let (left, right) = (u.x * v.y, u.y * v.x);
        let (turn, doubt) = (left - right, SURE * (left.abs() + right.abs()) + TINY);
        let sign = if turn > doubt {
            UP
        } else if turn < -doubt {
            DOWN
        } else {
            0
        };
        signs |= sign << (2 * axis);
    }
    signs
}
