//! State of all members as structure of arrays, in the order of the grid's cells.

use glam::Vec3;
use rayon::prelude::*;

use crate::simulation::avoid::Waters;
use crate::simulation::neighbours::LANES;

/// Arrays by axis.
pub type Axes = [Vec<f32>; 3];

/// Positions and velocities of all members at one moment.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    pub position: Axes,
    pub velocity: Axes,
}

/// All members, in the order of the cells in which the last step found them.
#[derive(Clone, Debug, Default)]
pub struct Swarm {
    /// Motion at the beginning of the last step, with [`LANES`] entries after the last member.
    pub from: Motion,
    /// Motion at the end of the last step.
    pub to: Motion,
    /// State of each member that it keeps from step to step.
    pub kept: Kept,
    spare: Kept,
}

/// State of each member that it keeps from step to step.
#[derive(Clone, Debug, Default)]
pub struct Kept {
    /// Number of the member.
    pub id: Vec<u32>,
    /// Index of the member's school, a number so that lanes can compare it, with [`LANES`] entries
    /// after the last member.
    pub school: Vec<f32>,
    /// Offset of the slot from the leader, in the leader's frame.
    pub slot: Axes,
    /// Velocity that the last look at the neighbours added.
    pub social: Axes,
}

/// Members that a thread takes at once.
const CHUNK: usize = 8192;

impl Swarm {
    /// Adds a member at rest in its slot; the next member gets the next id.
    pub fn push(&mut self, position: Vec3, velocity: Vec3, school: usize, slot: Vec3) {
        self.kept.id.push(self.kept.id.len() as u32);
        self.kept.school.push(school as f32);
        for axis in 0..3 {
            self.to.position[axis].push(position[axis]);
            self.to.velocity[axis].push(velocity[axis]);
            self.kept.slot[axis].push(slot[axis]);
            self.kept.social[axis].push(0.0);
        }
    }

    /// Moves the members that an obstacle holds to free water near them.
    pub fn make_room(&mut self, waters: &Waters<'_>) {
        let [x, y, z] = &mut self.to.position;
        let members = self.kept.id.len();
        for ((x, y), z) in x.iter_mut().zip(y).zip(z).take(members) {
            let at = Vec3::new(*x, *y, *z);
            [*x, *y, *z] = waters.find_free(at).to_array();
        }
    }

    /// Prepares for the first step, once all members are there: the beginning is the end.
    pub fn start(&mut self) {
        self.from = self.to.clone();
        let Motion { position, velocity } = &mut self.from;
        for values in position.iter_mut().chain(velocity).chain([&mut self.kept.school]) {
            values.extend([0.0; LANES]);
        }
        self.spare = self.kept.clone();
    }

    pub fn len(&self) -> usize {
        self.kept.id.len()
    }

    /// Begins a step: what was at the end becomes the beginning, with `order[place]` at each place.
    pub fn begin(&mut self, order: &[u32]) {
        let Self { from, to, kept, spare } = self;
        for axis in 0..3 {
            reorder(&mut from.position[axis], &to.position[axis], order);
            reorder(&mut from.velocity[axis], &to.velocity[axis], order);
            reorder(&mut spare.slot[axis], &kept.slot[axis], order);
            reorder(&mut spare.social[axis], &kept.social[axis], order);
        }
        reorder(&mut spare.id, &kept.id, order);
        reorder(&mut spare.school, &kept.school, order);
        std::mem::swap(kept, spare);
    }
}

fn reorder<T: Copy + Send + Sync>(to: &mut [T], from: &[T], order: &[u32]) {
    to.par_chunks_mut(CHUNK).zip(order.par_chunks(CHUNK)).for_each(|(to, order)| {
        for (to, &place) in to.iter_mut().zip(order) {
            *to = from[place as usize];
        }
    });
}

/// Returns a point of arrays by axis.
#[inline]
pub fn at(axes: &Axes, i: usize) -> Vec3 {
    Vec3::new(axes[0][i], axes[1][i], axes[2][i])
}
