//! One step of all members, in parallel over ranges of cells.

use std::ops::Range;

use glam::Vec3;

use crate::simulation::avoid::Waters;
use crate::simulation::grid::{Grid, Runs};
use crate::simulation::motion::{Lead, Member};
use crate::simulation::neighbours::{Candidates, Neighbours};
use crate::simulation::options::{Behaviour, SteerEvery};
use crate::simulation::swarm::{Axes, Kept, Motion, Swarm, at};

/// State that all members share in a step.
pub struct Moment<'a> {
    pub grid: &'a Grid,
    pub behaviour: &'a Behaviour,
    pub waters: Waters<'a>,
    pub leads: &'a [Lead],
    pub steer_every: Option<SteerEvery>,
    /// Number of the step.
    pub step: u64,
    pub step_s: f32,
    /// Time at the end of the step.
    pub time_s: f32,
}

/// Counts over the members that looked at their neighbours in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Looks {
    /// Number of members that looked.
    pub members: u64,
    /// Sum of the numbers of neighbours that they had.
    pub neighbours: u64,
}

/// Members below which a range of cells is not divided among threads.
const LEAF: usize = 1024;

impl Moment<'_> {
    /// Moves all members from `swarm.from` to `swarm.to`; both must be in the order of the grid.
    pub fn advance(&self, swarm: &mut Swarm) -> Looks {
        let Swarm { from, to, kept, .. } = swarm;
        let Kept { id, school, slot, social } = kept;
        let still = Still { from, id, school, slot };
        let moved = Moved {
            position: to.position.each_mut().map(Vec::as_mut_slice),
            velocity: to.velocity.each_mut().map(Vec::as_mut_slice),
            social: social.each_mut().map(Vec::as_mut_slice),
        };
        self.divide(0..self.grid.len(), &still, moved)
    }

    /// Divides cells into ranges of about equally many members, and moves each range.
    fn divide(&self, cells: Range<usize>, still: &Still<'_>, moved: Moved<'_>) -> Looks {
        let members = self.grid.members(cells.clone());
        let middle = self.grid.cell_of(cells.clone(), members.start + members.len() / 2);
        if members.len() <= LEAF || middle >= cells.end {
            return self.range(cells, still, moved);
        }
        let first = self.grid.members(cells.start..middle).len();
        let (near, far) = moved.split_at(first);
        let (a, b) = rayon::join(
            || self.divide(cells.start..middle, still, near),
            || self.divide(middle..cells.end, still, far),
        );
        Looks { members: a.members + b.members, neighbours: a.neighbours + b.neighbours }
    }

    fn range(&self, cells: Range<usize>, still: &Still<'_>, mut moved: Moved<'_>) -> Looks {
        let candidates = Candidates { motion: still.from, school: still.school };
        let mut runs = Runs::default();
        let mut looks = Looks::default();
        let first = self.grid.members(cells.clone()).start;
        for cell in cells {
            let mut is_found = false;
            for i in self.grid.members(cell..cell + 1) {
                let mut member = still.member(i, moved.social(i - first));
                let school = still.school[i];
                if self.looks(member.id, member.position) {
                    if !is_found {
                        self.grid.find_runs(cell, &mut runs);
                        is_found = true;
                    }
                    let around = if self.leads.len() > 1 {
                        Candidates::around::<true>
                    } else {
                        Candidates::around::<false>
                    };
                    let (runs, position) = (runs.as_slice(), member.position);
                    let found = around(&candidates, runs, position, school, self.behaviour);
                    member.social = self.behaviour.social(&found, member.velocity);
                    looks.add(&found);
                }
                let lead = &self.leads[school as usize];
                let times = [self.step_s, self.time_s];
                let (to, velocity) = self.behaviour.swim(&member, lead, &self.waters, times);
                moved.set(i - first, to, velocity, member.social);
            }
        }
        looks
    }

    /// Returns true if a member looks at its neighbours in this step.
    #[inline]
    fn looks(&self, id: u32, position: Vec3) -> bool {
        let Some(SteerEvery { eye, distances }) = self.steer_every else { return true };
        let squared = position.distance_squared(eye);
        let level = distances.iter().filter(|&&far| squared > far * far).count();
        (self.step + u64::from(id)) & ((1 << level) - 1) == 0
    }
}

impl Looks {
    #[inline]
    fn add(&mut self, found: &Neighbours) {
        self.members += 1;
        self.neighbours += found.count as u64 - 1;
    }
}

/// State of a member that a step does not change.
struct Still<'a> {
    from: &'a Motion,
    id: &'a [u32],
    school: &'a [f32],
    slot: &'a Axes,
}

impl Still<'_> {
    #[inline]
    fn member(&self, i: usize, social: Vec3) -> Member {
        let Self { from, id, slot, .. } = self;
        let (position, velocity) = (at(&from.position, i), at(&from.velocity, i));
        Member { id: id[i], position, velocity, slot: at(slot, i), social }
    }
}

/// State of some members that a step changes.
struct Moved<'a> {
    position: [&'a mut [f32]; 3],
    velocity: [&'a mut [f32]; 3],
    social: [&'a mut [f32]; 3],
}

impl<'a> Moved<'a> {
    fn split_at(self, middle: usize) -> (Self, Self) {
        let split = |axes: [&'a mut [f32]; 3]| {
            let [(a, d), (b, e), (c, f)] = axes.map(|axis| axis.split_at_mut(middle));
            ([a, b, c], [d, e, f])
        };
        let (position, velocity, social) =
            (split(self.position), split(self.velocity), split(self.social));
        (
            Self { position: position.0, velocity: velocity.0, social: social.0 },
            Self { position: position.1, velocity: velocity.1, social: social.1 },
        )
    }

    #[inline]
    fn social(&self, i: usize) -> Vec3 {
        Vec3::from([0, 1, 2].map(|axis| self.social[axis][i]))
    }

    #[inline]
    fn set(&mut self, i: usize, position: Vec3, velocity: Vec3, social: Vec3) {
        for axis in 0..3 {
            self.position[axis][i] = position[axis];
            self.velocity[axis][i] = velocity[axis];
            self.social[axis][i] = social[axis];
        }
    }
}
