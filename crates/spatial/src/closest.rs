//! Closest point queries on a mesh: conservative box tests in `f32`, triangle distances in `f64`.

use glam::{DVec3, Vec4};
use meshlod_mesh::FaceId;

use crate::Bvh;
use crate::box3::{round_down, round_up};
use crate::build::MAX_DEPTH;
use crate::bvh::{INNER, Node};
use crate::triangle::closest_point;

/// Point of a mesh closest to a query point, with its face and distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// Position of the closest point on the mesh, in model units.
    pub point: [f64; 3],
    /// Face that the closest point lies on; the lowest-numbered one if several are equally close.
    pub face: FaceId,
    /// Squared distance from the query point to the closest point, in square model units.
    pub distance_squared: f64,
}

/// Tolerance on squared distances, relative and absolute, by which a box may seem too far and is
/// entered all the same. In local coordinates, where the mesh is about 4 wide.
///
/// Box distances round to within five parts in 2^24 of themselves. Triangle distances are off by
/// up to 1e-15, and (d + 1e-15)² is at most d² (1 + 2^-21) + 1e-23.
const SLACK_RELATIVE: f64 = 1.0 + 1.0 / (1 << 20) as f64;
const SLACK: f64 = 1e-23;

/// Size of the stack: three children of every node on the path may be waiting.
const STACK: usize = 3 * MAX_DEPTH + 4;

impl Bvh {
    /// Returns the point on the mesh closest to `point`, which must be finite.
    ///
    /// `hint` is a face thought to be near, such as the answer to a neighbouring query: a good one
    /// saves time, and none changes the answer. Exact up to `f64` rounding relative to the size of
    /// the mesh. Among equal distances the face of lowest id wins.
    ///
    /// Cost: O(log n) for points near the surface, n = faces.
    pub fn closest(&self, point: [f64; 3], hint: Option<FaceId>) -> ClosestPoint {
        let p = self.frame.local(point);
        let mut best = self.first(p, hint);
        self.descend::<false>(p, &mut best, [0.0; 2]);
        self.in_model(&best)
    }

    /// Returns the squared distance, in square model units, of `point` from one face.
    pub fn distance_squared_to(&self, point: [f64; 3], face: FaceId) -> f64 {
        let slot = self.slots[face.index()] as usize;
        self.frame.model_squared(self.candidate(self.frame.local(point), slot).distance_squared)
    }

    /// Returns a point on the mesh within the distance `most` of `point`, which must be finite;
    /// `None` if there is no such point.
    ///
    /// The search stops at any point within `enough`, else it returns the closest. `hint` works as
    /// in [`Self::closest`]. Lengths are in model units.
    ///
    /// Cost: at most that of [`Self::closest`].
    pub fn near(
        &self,
        point: [f64; 3],
        hint: Option<FaceId>,
        [enough, most]: [f64; 2],
    ) -> Option<ClosestPoint> {
        let p = self.frame.local(point);
        let squared = |length: f64| (length * self.frame.scale()).powi(2);
        let (enough, most) = (squared(enough.min(most)), squared(most));
        let mut best = self.first(p, hint);
        if best.distance_squared > enough {
            self.descend::<true>(p, &mut best, [enough, most]);
        }
        (best.distance_squared <= most).then(|| self.in_model(&best))
    }

    fn first(&self, p: DVec3, hint: Option<FaceId>) -> Candidate {
        let start = hint.and_then(|face| self.slots.get(face.index())).map_or(0, |&slot| slot);
        self.candidate(p, start as usize)
    }

    fn in_model(&self, found: &Candidate) -> ClosestPoint {
        ClosestPoint {
            point: self.frame.model(found.point),
            face: found.face,
            distance_squared: self.frame.model_squared(found.distance_squared),
        }
    }

    fn candidate(&self, p: DVec3, slot: usize) -> Candidate {
        let point = closest_point(p, &self.triangles[slot]);
        Candidate { point, face: self.faces[slot], distance_squared: p.distance_squared(point) }
    }

    /// Improves `best` to the closest point of all, visiting near boxes first and none beyond the
    /// best so far.
    ///
    /// If `LIMITED`, stops once `best` is within `enough` and visits no box beyond `most`; both are
    /// squared.
    fn descend<const LIMITED: bool>(
        &self,
        p: DVec3,
        best: &mut Candidate,
        [enough, most]: [f64; 2],
    ) {
        let query = Query::new(p);
        let reach_of = |squared: f64| reach(if LIMITED { squared.min(most) } else { squared });
        let mut reach = reach_of(best.distance_squared);
        let mut stack = [(0.0, 0); STACK];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let (distance_squared, index) = stack[waiting];
            if distance_squared > reach {
                continue;
            }
            let node: &Node = &self.nodes[index as usize];
            let distances = query.distances_squared(node);
            let bottom = waiting;
            for child in within(distances, reach) {
                let distance_squared = distances[child];
                if node.count[child] == INNER {
                    let mut i = waiting;
                    // Farthest at the bottom, so that the nearest is popped first.
                    while i > bottom && stack[i - 1].0 < distance_squared {
                        stack[i] = stack[i - 1];
                        i -= 1;
                    }
                    stack[i] = (distance_squared, node.first[child]);
                    waiting += 1;
                } else if distance_squared <= reach {
                    let first = node.first[child] as usize;
                    for slot in first..first + usize::from(node.count[child]) {
                        if best.improve(self.candidate(p, slot)) {
                            if LIMITED && best.distance_squared <= enough {
                                return;
                            }
                            reach = reach_of(best.distance_squared);
                        }
                    }
                }
            }
        }
    }
}

/// Candidate for the closest point, in local coordinates.
struct Candidate {
    point: DVec3,
    face: FaceId,
    distance_squared: f64,
}

impl Candidate {
    /// Becomes `other` if that is nearer, or as near and on a face of lower id; returns true if so.
    #[inline]
    fn improve(&mut self, other: Self) -> bool {
        let nearer = other.distance_squared < self.distance_squared
            || (other.distance_squared == self.distance_squared && other.face < self.face);
        if nearer {
            *self = other;
        }
        nearer
    }
}

/// Returns the greatest squared box distance at which a point as near as `distance_squared` may be.
#[inline]
fn reach(distance_squared: f64) -> f32 {
    round_up(distance_squared * SLACK_RELATIVE + SLACK)
}

/// Iterates over the children at most `reach` away.
#[inline]
fn within(distances_squared: Vec4, reach: f32) -> impl Iterator<Item = usize> {
    let mut mask = distances_squared.cmple(Vec4::splat(reach)).bitmask();
    std::iter::from_fn(move || {
        let child = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (child < 4).then_some(child)
    })
}

/// Query point bracketed by two `f32` points, each coordinate in four lanes.
struct Query {
    below: [Vec4; 3],
    above: [Vec4; 3],
}

impl Query {
    fn new(p: DVec3) -> Self {
        Self {
            below: p.to_array().map(|x| Vec4::splat(round_down(x))),
            above: p.to_array().map(|x| Vec4::splat(round_up(x))),
        }
    }

    /// Returns lower bounds on the squared distances to the four boxes of a node.
    #[inline]
    fn distances_squared(&self, node: &Node) -> Vec4 {
        let along = |axis: usize| {
            let distance = (node.lo[axis] - self.above[axis])
                .max(self.below[axis] - node.hi[axis])
                .max(Vec4::ZERO);
            distance * distance
        };
        along(0) + along(1) + along(2)
    }
}
