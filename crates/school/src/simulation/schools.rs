//! Schools in motion, in steps of fixed length.

use glam::Vec3;
use meshlod::flock::frame_of;

use crate::simulation::avoid::Waters;
use crate::simulation::error::SimulationError;
use crate::simulation::grid::Grid;
use crate::simulation::motion::Lead;
use crate::simulation::obstacle::Obstacle;
use crate::simulation::options::{SchoolOptions, SimulationOptions};
use crate::simulation::start;
use crate::simulation::step::{Looks, Moment};
use crate::simulation::swarm::Swarm;

/// Schools in motion, in steps of fixed length.
///
/// Two simulations of the same options are equal bit for bit after the same number of steps, for
/// any number of threads. No position or heading is ever NaN, headings are unit vectors, and no
/// member is ever inside an obstacle.
#[derive(Clone, Debug)]
pub struct Simulation {
    pub(super) options: SimulationOptions,
    /// Centre and radius of a ball around each obstacle.
    balls: Vec<(Vec3, f32)>,
    pub(super) swarm: Swarm,
    grid: Grid,
    pub(super) leads: Vec<Lead>,
    /// Place of each member, by id.
    pub(super) places: Vec<u32>,
    /// Number of completed steps.
    step: u64,
    /// Time left over from [`Self::advance`], shorter than a step.
    pending_s: f64,
    looks: Looks,
}

/// Longest time to advance by in one call.
const LONGEST_S: f64 = 3600.0;

impl Simulation {
    /// Creates a simulation whose members are in their slots, or near them where there are
    /// obstacles, and head the way of their leaders.
    ///
    /// # Errors
    /// An option outside its range or not a number, or a step so long that members would pass
    /// through obstacles.
    pub fn new(options: &SimulationOptions) -> Result<Self, SimulationError> {
        options.validate()?;
        let balls: Vec<_> = options.obstacles.iter().map(Obstacle::ball).collect();
        let swarm = start::swarm(options, &balls);
        let places = (0..swarm.len() as u32).collect();
        let mut simulation = Self {
            options: options.clone(),
            balls,
            swarm,
            grid: Grid::default(),
            leads: Vec::new(),
            places,
            step: 0,
            pending_s: 0.0,
            looks: Looks::default(),
        };
        simulation.move_leaders();
        Ok(simulation)
    }

    /// Moves all members by one step.
    ///
    /// Cost: O(n k), n = members, k = candidates in the 27 cells around one; in parallel.
    pub fn step(&mut self) {
        self.step += 1;
        self.move_leaders();
        let behaviour = &self.options.behaviour;
        self.grid.sort(&self.swarm.to.position, behaviour.neighbour_radius);
        self.swarm.begin(self.grid.order());
        let moment = Moment {
            grid: &self.grid,
            behaviour,
            waters: Waters::new(&self.options.obstacles, &self.balls, behaviour),
            leads: &self.leads,
            steer_every: self.options.steer_every,
            step: self.step,
            step_s: self.options.step_s,
            time_s: self.time_s() as f32,
        };
        self.looks = moment.advance(&mut self.swarm);
        for (place, &id) in self.swarm.kept.id.iter().enumerate() {
            self.places[id as usize] = place as u32;
        }
    }

    /// Advances by a time in whole steps, and returns their number. The rest is kept for the next
    /// call; [`Self::alpha`] returns it.
    ///
    /// # Errors
    /// A time that is negative, not a number, or more than an hour.
    pub fn advance(&mut self, seconds: f64) -> Result<usize, SimulationError> {
        if !(0.0..=LONGEST_S).contains(&seconds) {
            return Err(SimulationError::Time(seconds));
        }
        let step_s = f64::from(self.options.step_s);
        self.pending_s += seconds;
        let mut steps = 0;
        // A step short of time by rounding alone is made.
        while self.pending_s >= step_s * (1.0 - 1e-4) {
            self.step();
            self.pending_s -= step_s;
            steps += 1;
        }
        Ok(steps)
    }

    /// Returns the time left over by [`Self::advance`] as a fraction of a step, the parameter of
    /// [`Self::snapshot`].
    pub fn alpha(&self) -> f32 {
        (self.pending_s / f64::from(self.options.step_s)).clamp(0.0, 1.0) as f32
    }

    /// Returns the time at the end of the last step.
    pub fn time_s(&self) -> f64 {
        self.step as f64 * f64::from(self.options.step_s)
    }

    /// Returns the number of members.
    pub fn len(&self) -> usize {
        self.swarm.len()
    }

    /// Returns true if there are no members.
    pub fn is_empty(&self) -> bool {
        self.swarm.len() == 0
    }

    /// Returns the counts of members that looked at their neighbours in the last step.
    pub fn looks(&self) -> Looks {
        self.looks
    }

    /// Returns the options of the simulation.
    pub fn options(&self) -> &SimulationOptions {
        &self.options
    }

    /// Moves the eye from which [`SteerEvery`](crate::simulation::SteerEvery) measures distances;
    /// one that is not finite is ignored.
    pub fn set_eye(&mut self, eye: Vec3) {
        if let Some(steer_every) = &mut self.options.steer_every
            && eye.is_finite()
        {
            steer_every.eye = eye;
        }
    }

    /// Moves an obstacle, and the members in its new place to the nearest free water.
    ///
    /// # Errors
    /// An index without an obstacle, and a position that is not finite or too far away; then
    /// nothing has moved.
    pub fn move_obstacle(&mut self, index: usize, by: Vec3) -> Result<(), SimulationError> {
        let count = self.options.obstacles.len();
        let found = self.options.obstacles.get_mut(index);
        let obstacle = found.ok_or(SimulationError::NoObstacle { index, count })?;
        let mut moved = obstacle.clone();
        moved.translate(by);
        if !moved.is_valid() {
            return Err(SimulationError::Obstacle(index));
        }
        self.balls[index] = moved.ball();
        *obstacle = moved;
        let SimulationOptions { obstacles, behaviour, .. } = &self.options;
        self.swarm.make_room(&Waters::new(obstacles, &self.balls, behaviour));
        Ok(())
    }

    /// Moves the leaders to the end of this step.
    fn move_leaders(&mut self) {
        let step_s = self.options.step_s;
        let time_s = self.time_s();
        let lead = |school: &SchoolOptions| {
            let after = |time_s: f64| school.leader.after(f64::from(school.speed) * time_s);
            let (before, heading_before) = after((time_s - f64::from(step_s)).max(0.0));
            let (position, heading) = after(time_s);
            let (frame, frame_before) = (frame_of(heading), frame_of(heading_before));
            Lead {
                position,
                frame,
                heading_before,
                position_before: before,
                velocity: (position - before) / step_s,
                turning: (frame - frame_before) * step_s.recip(),
            }
        };
        self.leads.clear();
        self.leads.extend(self.options.schools.iter().map(lead));
    }
}
