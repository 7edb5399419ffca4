//! Clipping of faces that cross the near plane or exceed the range of fixed-point coordinates.

use glam::DVec3;

use crate::project::{GUARD, Point, snap};

/// Maximum number of corners of a triangle clipped by five planes.
const MAX_CORNERS: usize = 8;

/// Clips a triangle in homogeneous grid coordinates at the near plane and the guard band, and emits
/// the rest as triangles of the same orientation.
///
/// Faces with a common edge are clipped at identical points: every intersection is computed from
/// the inner to the outer end, which are the same for both.
pub(crate) fn clip(corners: [DVec3; 3], near: f64, mut emit: impl FnMut([Point; 3])) {
    if !corners.iter().all(|corner| corner.is_finite()) {
        return;
    }
    let mut polygon = Polygon::default();
    corners.into_iter().for_each(|corner| polygon.push(corner));
    polygon = polygon.cut(|p| p.z - near);
    polygon = polygon.cut(|p| GUARD * p.z - p.x);
    polygon = polygon.cut(|p| GUARD * p.z + p.x);
    polygon = polygon.cut(|p| GUARD * p.z - p.y);
    polygon = polygon.cut(|p| GUARD * p.z + p.y);
    let corners = polygon.corners();
    for i in 2..corners.len() {
        emit([corners[0], corners[i - 1], corners[i]].map(|corner| snap(corner, near)));
    }
}

#[derive(Default)]
struct Polygon {
    corners: [DVec3; MAX_CORNERS],
    len: usize,
}

impl Polygon {
    fn corners(&self) -> &[DVec3] {
        &self.corners[..self.len]
    }

    fn push(&mut self, corner: DVec3) {
        // Through rounding, a sliver can cross a plane once more than a convex shape may; what is
        // dropped then is below the resolution of the coordinates.
        if self.len < MAX_CORNERS {
            self.corners[self.len] = corner;
            self.len += 1;
        }
    }

    /// Clips to the half-space where `inside` is not negative ([SH74]).
    fn cut(&self, inside: impl Fn(DVec3) -> f64) -> Self {
        let mut kept = Self::default();
        let corners = self.corners();
        for (i, &here) in corners.iter().enumerate() {
            let next = corners[(i + 1) % corners.len()];
            let (a, b) = (inside(here), inside(next));
            if a >= 0.0 {
                kept.push(here);
            }
            if a >= 0.0 && b < 0.0 {
                kept.push(crossing(here, a, next, b));
            } else if a < 0.0 && b >= 0.0 {
                kept.push(crossing(next, b, here, a));
            }
        }
        kept
    }
}

fn crossing(inner: DVec3, a: f64, outer: DVec3, b: f64) -> DVec3 {
    inner + (outer - inner) * (a / (a - b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pieces(corners: [DVec3; 3]) -> Vec<[Point; 3]> {
        let mut pieces = Vec::new();
        clip(corners, 1.0, |piece| pieces.push(piece));
        pieces
    }

    #[test]
    fn one_corner_behind_leaves_two_triangles() {
        let [a, b] = [DVec3::new(0.0, 0.0, 3.0), DVec3::new(3.0, 0.0, 3.0)];
        let behind = DVec3::new(0.0, 3.0, -1.0);
        let pieces = pieces([a, b, behind]);
        assert_eq!(pieces.len(), 2);
        let nearest = pieces.iter().flatten().map(|p| p.nearness).fold(0.0, f32::max);
        assert_eq!(nearest, 1.0, "cut at the near plane");
    }

    #[test]
    fn all_behind_leaves_nothing() {
        assert!(
            pieces([DVec3::NEG_Z, DVec3::new(1.0, 0.0, -2.0), DVec3::new(0.0, 1.0, 0.5)])
                .is_empty()
        );
    }

    #[test]
    fn endless_coordinates_leave_nothing() {
        assert!(pieces([DVec3::Z, DVec3::new(f64::INFINITY, 0.0, 2.0), DVec3::Y]).is_empty());
    }

    #[test]
    fn far_out_is_cut_to_the_guard() {
        let far = 1e12;
        let pieces = pieces([
            DVec3::new(-far, -far, 2.0),
            DVec3::new(far, -far, 2.0),
            DVec3::new(0.0, far, 2.0),
        ]);
        assert!(!pieces.is_empty());
        assert!(pieces.iter().flatten().all(|p| p.x.abs() <= 1 << 29 && p.y.abs() <= 1 << 29));
    }
}
