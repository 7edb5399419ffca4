//! Neighbours of a member, among runs of candidates that are examined in lanes.

use std::ops::Range;

use glam::{Vec3, Vec4};

use crate::simulation::options::Behaviour;
use crate::simulation::swarm::Motion;

/// Candidates examined together: the registers of the baseline hold four numbers. With eight the
/// sums would not fit into its sixteen registers.
pub const LANES: usize = 4;
/// Greatest number of candidates in a run; where members are denser, some are left out.
const MOST: usize = 256;
/// Lane numbers.
const LANE: Vec4 = Vec4::new(0.0, 1.0, 2.0, 3.0);

/// Members among which neighbours are searched, in the order of the grid.
///
/// There are [`LANES`] entries more than members, so that the last group of a run can be read.
#[derive(Clone, Copy)]
pub struct Candidates<'a> {
    pub motion: &'a Motion,
    pub school: &'a [f32],
}

/// Neighbours that a member has, summed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Neighbours {
    /// Number of neighbours of all schools.
    pub count: f32,
    /// Number of neighbours of the member's school.
    pub own: f32,
    /// Sum of offsets to neighbours of the school.
    pub offset: Vec3,
    /// Sum of velocities of neighbours of the school.
    pub velocity: Vec3,
    /// Sum of offsets away from neighbours that are too near, weighted by how near they are.
    pub away: Vec3,
}

impl Candidates<'_> {
    /// Sums the neighbours of the member at `position` of a school, itself included, over runs.
    ///
    /// If there are not `MANY` schools, all neighbours are of the member's.
    #[inline]
    pub fn around<const MANY: bool>(
        &self,
        runs: &[Range<u32>],
        position: Vec3,
        school: f32,
        behaviour: &Behaviour,
    ) -> Neighbours {
        let p = position.to_array().map(Vec4::splat);
        let near = Vec4::splat(behaviour.neighbour_radius * behaviour.neighbour_radius);
        let too_near = Vec4::splat(-behaviour.separation_radius.max(1e-3).powi(2).recip());
        let school = Vec4::splat(school);
        let (mut count, mut own) = (Vec4::ZERO, Vec4::ZERO);
        let zero = [Vec4::ZERO; 3];
        let (mut offset, mut velocity, mut away) = (zero, zero, zero);
        let position_of = self.motion.position.each_ref();
        let velocity_of = self.motion.velocity.each_ref();
        for run in runs {
            let length = run.len().min(MOST);
            let groups = length.div_ceil(LANES);
            let range = run.start as usize..run.start as usize + groups * LANES;
            // Slices of one known length, so that bounds are checked once.
            let [x, y, z] = position_of.map(|axis| &axis[range.clone()].as_chunks().0[..groups]);
            let [u, v, w] = velocity_of.map(|axis| &axis[range.clone()].as_chunks().0[..groups]);
            let s = &self.school[range].as_chunks::<LANES>().0[..groups];
            let mut left = Vec4::splat(length as f32);
            for g in 0..groups {
                let [x, y, z] = [x[g], y[g], z[g]].map(Vec4::from_array);
                let d = [x - p[0], y - p[1], z - p[2]];
                let squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
                // What is after the end of the run may belong to another, and must not count twice.
                let is_in = LANE.cmplt(left);
                left -= Vec4::splat(LANES as f32);
                let mut one = Vec4::select(squared.cmplt(near) & is_in, Vec4::ONE, Vec4::ZERO);
                let overlap = (Vec4::ONE + squared * too_near).max(Vec4::ZERO) * one;
                let square = overlap * overlap;
                let push = square * square;
                count += one;
                if MANY {
                    one = Vec4::select(Vec4::from_array(s[g]).cmpeq(school), one, Vec4::ZERO);
                    own += one;
                }
                for (axis, values) in [u[g], v[g], w[g]].into_iter().enumerate() {
                    offset[axis] += one * d[axis];
                    velocity[axis] += one * Vec4::from_array(values);
                    away[axis] += push * d[axis];
                }
            }
        }
        let vector = |lanes: [Vec4; 3]| Vec3::from(lanes.map(total));
        Neighbours {
            count: total(count),
            own: total(if MANY { own } else { count }),
            offset: vector(offset),
            velocity: vector(velocity),
            away: -vector(away),
        }
    }
}

/// Adds lanes in a fixed order.
#[inline]
fn total(lanes: Vec4) -> f32 {
    (lanes.x + lanes.z) + (lanes.y + lanes.w)
}
