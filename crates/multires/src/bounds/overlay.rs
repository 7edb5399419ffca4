//! The two sides of an update laid over each other in a plane: which points are paired, and what
//! shadow that asks of the new vertex.

use glam::{DVec2, DVec3, Vec3};

use super::enclosing_ball::{EnclosingBall, enclosing_ball};
use super::plane_triangle::{Constraint, PlaneCorner, PlaneTriangle, add_constraints};

/// An update's sides.
pub(super) struct Fragment<'f> {
    /// The faces of its fine side.
    pub(super) fine: &'f [[u32; 3]],
    pub(super) children: [u32; 2],
    pub(super) node: u32,
    pub(super) positions: &'f [[f32; 3]],
}

/// Room for overlays, one after the other.
#[derive(Debug, Default)]
pub(super) struct Overlay {
    coarse: Vec<[u32; 3]>,
    fine_triangles: Vec<PlaneTriangle>,
    coarse_triangles: Vec<PlaneTriangle>,
    constraints: Vec<Constraint>,
    /// What the shadow of the new vertex must hold.
    balls: Vec<EnclosingBall>,
    /// By how much shadows around have to grow.
    growth: Vec<(u32, f64)>,
}

/// What is added for rounding, in sizes of the sides.
const SLACK: f64 = 1.0 / (1 << 28) as f64;

/// Where the new vertex counts less than this, shadows around it grow instead: there its own would have
/// to grow by several times what lacks. Faces of the bunny's and the horse's cut to 1 % of the diagonal
/// for 0.02, 0.15, 0.25, 0.35 and 0.5: 3118, 2738, 2682, 2501, 2992 and 2364, 2328, 2334, 2132, 2478.
const MIN_SHARE: f64 = 0.35;

/// Sides of more faces are not laid into a plane: it costs the square.
const MAX_FACES: usize = 64;

/// Where the place beyond open edges is laid, in sizes of the sides.
const FAR: f64 = 16.0;

impl Overlay {
    /// The shadow of the new vertex. Those around it may have to grow.
    pub(super) fn contract(
        &mut self,
        of: &Fragment<'_>,
        shadows: &mut [EnclosingBall],
    ) -> EnclosingBall {
        self.coarse.clear();
        let coarse = of.fine.iter().filter(|face| !of.is_collapsed(face));
        self.coarse.extend(coarse.map(|face| face.map(|v| of.contracted(v))));
        let (place, size) = (of.place(of.node), of.size());
        let moved = self.ball_by_vertex_motion(of, shadows, size);
        if of.fine.len() > MAX_FACES {
            return moved;
        }
        for direction in of.directions(&self.coarse) {
            if self.project(of, direction, size, shadows).is_none() {
                continue;
            }
            let laid = self.fit_ball(place, size * SLACK);
            let growth = self.growth.iter().map(|grown| grown.1).fold(0.0, f64::max);
            if laid.reach(place) + growth < moved.reach(place) {
                for (node, by) in self.growth.drain(..) {
                    shadows[node as usize].radius += by;
                }
                return laid;
            }
        }
        moved
    }

    /// The shadow if each face is paired with what becomes of it, point by point.
    fn ball_by_vertex_motion(
        &mut self,
        of: &Fragment<'_>,
        shadows: &[EnclosingBall],
        size: f64,
    ) -> EnclosingBall {
        if self.coarse.is_empty() {
            return EnclosingBall { center: of.place(of.node), radius: f64::INFINITY };
        }
        self.balls.clear();
        self.balls.extend(of.children.map(|child| shadows[child as usize]));
        // A face that would become an edge of no face is paired with the new vertex.
        let is_left = |v: u32| self.coarse.iter().any(|face| face.contains(&of.contracted(v)));
        let dying = of.fine.iter().filter(|face| of.is_collapsed(face)).flatten();
        self.balls.extend(dying.filter(|&&v| !is_left(v)).map(|&v| shadows[v as usize]));
        let ball = enclosing_ball(&self.balls);
        EnclosingBall { radius: ball.radius + size * SLACK, ..ball }
    }

    /// Lays both sides into the plane at right angles to a direction; none where a triangle is turned
    /// over or thin there.
    fn project(
        &mut self,
        of: &Fragment<'_>,
        direction: DVec3,
        size: f64,
        shadows: &[EnclosingBall],
    ) -> Option<()> {
        let (right, up) = direction.any_orthonormal_pair();
        let origin = of.place(of.node);
        let laid = |node: u32| {
            let from_here = of.place(node) - origin;
            let at = DVec2::new(right.dot(from_here), up.dot(from_here));
            if node == of.node {
                return PlaneCorner { node, at, share: 1.0, ..PlaneCorner::default() };
            }
            let EnclosingBall { center, radius } = shadows[node as usize];
            PlaneCorner { node, at, center: center - origin, radius, share: 0.0 }
        };
        let sides = [
            (of.fine, &of.children[..], &mut self.fine_triangles),
            (&self.coarse[..], &[of.node][..], &mut self.coarse_triangles),
        ];
        let mut open = [const { Vec::new() }; 2];
        for ((faces, inner, cells), open) in sides.into_iter().zip(&mut open) {
            cells.clear();
            for face in faces {
                cells.push(PlaneTriangle::new(face.map(laid), false)?);
            }
            *open = open_edges(faces, inner);
        }
        // All open edges of the coarse side turn the same way about a place far enough outside.
        let along = |&[a, b]: &[u32; 2]| (laid(a).at - laid(b).at).normalize_or_zero();
        let outside = open[1].iter().map(along).sum::<DVec2>().perp().normalize_or_zero();
        let beyond = |[a, b]: [u32; 2], inner: &[u32]| {
            let edge = [b, a].map(laid);
            let inner = edge.iter().filter(|corner| inner.contains(&corner.node));
            let end = PlaneCorner::between(inner.copied(), outside * (FAR * size));
            PlaneTriangle::new([edge[0], edge[1], end], true)
        };
        for &edge in &open[0] {
            self.fine_triangles.push(beyond(edge, &of.children)?);
        }
        for &edge in &open[1] {
            self.coarse_triangles.push(beyond(edge, &[of.node])?);
        }
        Some(())
    }

    /// The shadow that the new vertex must have, and by how much those around it must grow.
    fn fit_ball(&mut self, place: DVec3, slack: f64) -> EnclosingBall {
        self.constraints.clear();
        for fine in &self.fine_triangles {
            for (i, coarse) in self.coarse_triangles.iter().enumerate() {
                if !(fine.is_virtual && coarse.is_virtual) {
                    add_constraints(fine, coarse, i, &mut self.constraints);
                }
            }
        }
        self.balls.clear();
        let own = self.constraints.iter().filter(|constraint| constraint.share >= MIN_SHARE);
        self.balls.extend(own.map(|Constraint { ball, share, .. }| EnclosingBall {
            center: ball.center / share,
            radius: ball.radius / share,
        }));
        let ball = enclosing_ball(&self.balls);
        let radius = ball.radius + slack / MIN_SHARE;
        self.growth.clear();
        for constraint in self.constraints.iter().filter(|constraint| constraint.share < MIN_SHARE)
        {
            let Constraint { ball: asked, share, coarse } = constraint;
            let lack = asked.reach(share * ball.center) - share * radius + slack;
            let others = self.coarse_triangles[*coarse].corners.iter().filter(|c| c.share == 0.0);
            for other in others {
                grow(&mut self.growth, other.node, lack / (1.0 - share));
            }
        }
        EnclosingBall { center: place + ball.center, radius }
    }
}

impl Fragment<'_> {
    fn place(&self, node: u32) -> DVec3 {
        Vec3::from(self.positions[node as usize]).as_dvec3()
    }

    /// What a node of the fine side becomes.
    fn contracted(&self, node: u32) -> u32 {
        if self.children.contains(&node) { self.node } else { node }
    }

    /// Whether a face of the fine side becomes an edge.
    fn is_collapsed(&self, face: &[u32; 3]) -> bool {
        self.children.iter().all(|child| face.contains(child))
    }

    /// How far its vertices are from the new one.
    fn size(&self) -> f64 {
        let to = self.place(self.node);
        self.fine.iter().flatten().map(|&v| self.place(v).distance(to)).fold(0.0, f64::max)
    }

    /// From where all its triangles may be seen from outside: their normals' mean by area, and that of
    /// all alike.
    fn directions(&self, coarse: &[[u32; 3]]) -> impl Iterator<Item = DVec3> + use<> {
        let normals = self.fine.iter().chain(coarse).map(|face| {
            let [a, b, c] = face.map(|v| self.place(v));
            (b - a).cross(c - a)
        });
        let add = |[by_area, alike]: [DVec3; 2], normal: DVec3| {
            [by_area + normal, alike + normal.normalize_or_zero()]
        };
        let sums = normals.fold([DVec3::ZERO; 2], add);
        sums.into_iter().filter_map(DVec3::try_normalize)
    }
}

/// The edges at some inner nodes that have no face behind, from end to end as their face has them.
fn open_edges(faces: &[[u32; 3]], inner: &[u32]) -> Vec<[u32; 2]> {
    let mut open: Vec<[u32; 2]> = Vec::new();
    for &[a, b, c] in faces {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            if !inner.contains(&from) && !inner.contains(&to) {
                continue;
            }
            match open.iter().position(|&edge| edge == [to, from]) {
                Some(at) => drop(open.swap_remove(at)),
                None => open.push([from, to]),
            }
        }
    }
    open
}

/// Lets a shadow grow, if it does not yet as much.
fn grow(growth: &mut Vec<(u32, f64)>, node: u32, by: f64) {
    if by <= 0.0 {
        return;
    }
    match growth.iter_mut().find(|grown| grown.0 == node) {
        Some(grown) => grown.1 = grown.1.max(by),
        None => growth.push((node, by)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::stars::Stars;
    use super::*;
    use crate::tests::walks::{Dice, each};

    /// Places in a cell, on its edges and at its corners too.
    fn places<'c>(cell: &'c PlaneTriangle, dice: &'c mut Dice) -> impl Iterator<Item = DVec2> + 'c {
        (0..12).map(|i| {
            let mut weights = [0; 3].map(|_| dice.roll());
            weights[i % 3] *= f64::from(u8::from(i > 2));
            weights[(i + 1) % 3] *= f64::from(u8::from(i > 5));
            let all: f64 = weights.iter().sum::<f64>().max(1e-9);
            cell.corners.iter().zip(weights).map(|(corner, w)| corner.at * (w / all)).sum()
        })
    }

    fn covers(cell: &PlaneTriangle, place: DVec2) -> bool {
        cell.weights.iter().all(|(slope, rest)| slope.dot(place) + rest > -1e-9)
    }

    /// Each place of each triangle is covered by the other side, and wherever both are, the shadow on
    /// the coarse side holds that on the fine side.
    fn check(overlay: &Overlay, place: DVec3, shadows: &[EnclosingBall], dice: &mut Dice) {
        let mut coarse = overlay.coarse_triangles.clone();
        for corner in coarse.iter_mut().flat_map(|cell| &mut cell.corners) {
            let EnclosingBall { center, radius } = shadows[corner.node as usize];
            (corner.center, corner.radius) = (center - place, radius);
        }
        let sides = [(&overlay.fine_triangles, &coarse), (&coarse, &overlay.fine_triangles)];
        for (i, (from, to)) in sides.into_iter().enumerate() {
            for cell in from.iter().filter(|cell| !cell.is_virtual) {
                for place in places(cell, dice) {
                    let mut pairs = 0;
                    for other in to.iter().filter(|other| covers(other, place)) {
                        pairs += 1;
                        let [fine, coarse] = if i == 0 { [cell, other] } else { [other, cell] };
                        let ((center, radius, _), (around, most, _)) =
                            (fine.at(place), coarse.at(place));
                        let lack = center.distance(around) + radius - most;
                        assert!(lack < 1e-9, "{lack:e}");
                    }
                    assert!(pairs > 0, "{place} of {cell:?} has no pair");
                }
            }
        }
    }

    #[test]
    fn sides_that_are_laid_cover_each_other_and_shadows_hold_what_is_paired() {
        each(|what, _, forest| {
            let mut dice = Dice(1);
            let mut stars = Stars::new(forest);
            let mut overlay = Overlay::default();
            let mut shadows: Vec<EnclosingBall> = (0..forest.vertices as u32)
                .map(|leaf| EnclosingBall::point(forest.place(leaf)))
                .collect();
            let mut count = [0; 2];
            for u in 0..forest.updates.len() {
                let (node, children) = (forest.node(u) as u32, forest.updates[u].children);
                let fine = stars.contract(children, node);
                let fragment = Fragment { fine, children, node, positions: &forest.positions };
                let before = shadows.clone();
                let shadow = overlay.contract(&fragment, &mut shadows);
                shadows.push(shadow);
                if shadow != overlay.ball_by_vertex_motion(&fragment, &before, fragment.size()) {
                    // What it was laid in last is what it has taken.
                    check(&overlay, fragment.place(node), &shadows, &mut dice);
                    count[0] += 1;
                    count[1] += usize::from(overlay.fine_triangles.iter().any(|c| c.is_virtual));
                }
            }
            let updates = forest.updates.len();
            assert!(updates < 100 || count[0] > updates / 2, "{what}: {count:?} of {updates}");
            if what == "grid by qem" {
                assert!(count[1] > 20, "{count:?}");
            }
        });
    }

    #[test]
    fn a_face_that_would_be_an_edge_of_no_face_goes_to_the_new_vertex() {
        let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 9.0, 0.0], [0.0, 1.0, 0.0]];
        let positions: Vec<_> = positions.into_iter().chain([[-1.0, 0.0, 0.0], [0.5; 3]]).collect();
        let of = |fine| Fragment { fine, children: [0, 1], node: 5, positions: &positions };
        let shadows: Vec<EnclosingBall> =
            (0..5).map(|node| EnclosingBall::point(of(&[]).place(node))).collect();
        let radius = |fine| Overlay::default().contract(&of(fine), &mut shadows.clone()).radius;
        assert!(radius(&[[0, 1, 2], [0, 3, 4]]) > 4.5);
        assert!(radius(&[[0, 1, 3], [0, 3, 4]]) < 0.6);
        assert_eq!(radius(&[[0, 1, 2]]), f64::INFINITY);
    }
}
