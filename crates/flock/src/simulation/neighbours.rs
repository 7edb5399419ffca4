//! Neighbours of a member: candidates gathered once for a cell and examined in lanes.

use glam::Vec3;

use super::options::Behaviour;

/// Candidates examined together, in two registers of the baseline.
const LANES: usize = 8;
/// Greatest number of candidates around a cell; where members are denser, some are left out.
pub const MOST: usize = 2048;

type Lanes = [f32; LANES];

/// Members in a cell and around it, by coordinate, in groups of [`LANES`].
pub struct Candidates {
    /// Position and velocity by axis, and the school.
    values: [Vec<Lanes>; VALUES],
    len: usize,
}

/// Position and velocity by axis, and the school.
const VALUES: usize = 7;
/// Coordinate of the lanes after the last candidate, which are nobody's neighbours.
const NOWHERE: f32 = 1e18;

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

impl Candidates {
    pub fn new() -> Self {
        Self { values: std::array::from_fn(|_| vec![[0.0; LANES]; MOST / LANES + 1]), len: 0 }
    }

    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Appends members of a run as far as there is room.
    #[inline]
    pub fn extend(&mut self, run: [&[f32]; VALUES]) {
        let count = run[0].len().min(MOST - self.len);
        for (to, from) in self.values.iter_mut().zip(run) {
            to.as_flattened_mut()[self.len..self.len + count].copy_from_slice(&from[..count]);
        }
        self.len += count;
    }

    /// Fills the last group of lanes; to be called before [`Self::around`].
    #[inline]
    pub fn finish(&mut self) {
        let end = self.len.next_multiple_of(LANES);
        for to in &mut self.values {
            to.as_flattened_mut()[self.len..end].fill(NOWHERE);
        }
    }

    /// Sums the neighbours of the member at `position` of a school, itself included.
    #[inline]
    pub fn around(&self, position: Vec3, school: f32, behaviour: &Behaviour) -> Neighbours {
        let groups = self.len.div_ceil(LANES);
        let near = behaviour.neighbour_radius * behaviour.neighbour_radius;
        let too_near = -behaviour.separation_radius.max(1e-3).powi(2).recip();
        let [x, y, z, u, v, w, s] = self.values.each_ref().map(|lanes| &lanes[..groups]);
        let mut sums = [[0.0_f32; LANES]; 11];
        for g in 0..groups {
            let (x, y, z) = (&x[g], &y[g], &z[g]);
            let (u, v, w, s) = (&u[g], &v[g], &w[g], &s[g]);
            for l in 0..LANES {
                let (dx, dy, dz) = (x[l] - position.x, y[l] - position.y, z[l] - position.z);
                let squared = dx * dx + dy * dy + dz * dz;
                let one = if squared < near { 1.0 } else { 0.0 };
                let own = if s[l] == school { one } else { 0.0 };
                let overlap = (1.0 + squared * too_near).max(0.0);
                let push = overlap * overlap;
                let terms = [
                    one,
                    own,
                    own * dx,
                    own * dy,
                    own * dz,
                    own * u[l],
                    own * v[l],
                    own * w[l],
                    push * dx,
                    push * dy,
                    push * dz,
                ];
                for (sum, term) in sums.iter_mut().zip(terms) {
                    sum[l] += term;
                }
            }
        }
        let [count, own, ox, oy, oz, vx, vy, vz, ax, ay, az] = sums.map(total);
        Neighbours {
            count,
            own,
            offset: Vec3::new(ox, oy, oz),
            velocity: Vec3::new(vx, vy, vz),
            away: -Vec3::new(ax, ay, az),
        }
    }
}

/// Adds lanes in a fixed order.
#[inline]
fn total([a, b, c, d, e, f, g, h]: Lanes) -> f32 {
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}
