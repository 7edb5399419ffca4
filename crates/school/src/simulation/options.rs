//! Options of a simulation and their ranges.

use std::f32::consts::PI;

use glam::Vec3;

use crate::simulation::error::SimulationError;
use crate::simulation::leader::{Leader, LeaderPath};
use crate::simulation::obstacle::Obstacle;
use crate::simulation::range::{FARTHEST, is_near};

/// Options of a simulation; lengths are in body lengths, times in seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationOptions {
    /// Schools, in the order in which their members are numbered.
    pub schools: Vec<SchoolOptions>,
    /// Obstacles, which may overlap.
    pub obstacles: Vec<Obstacle>,
    /// Number that determines the members' slots and how they drift.
    pub seed: u64,
    /// Length of a step.
    pub step_s: f32,
    /// How members swim.
    pub behaviour: Behaviour,
    /// Distances beyond which members look at their neighbours less often; none by default.
    pub steer_every: Option<SteerEvery>,
}

/// Options of one school.
#[derive(Clone, Debug, PartialEq)]
pub struct SchoolOptions {
    /// Number of members.
    pub members: usize,
    /// Half axes of the ellipsoid along the leader's left, up and heading.
    pub radii: Vec3,
    /// Leader of the school.
    pub leader: Leader,
    /// Speed of the leader.
    pub speed: f32,
}

/// How members swim: the range of their senses, the strength of their responses, their limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Behaviour {
    /// Distance within which others are neighbours.
    pub neighbour_radius: f32,
    /// Distance within which neighbours are too near.
    pub separation_radius: f32,
    /// Speed per body length of overlap with which a member leaves neighbours that are too near.
    pub separation: f32,
    /// Fraction of the neighbours' mean relative velocity that a member adopts.
    pub alignment: f32,
    /// Speed per body length with which a member approaches its neighbours' centre.
    pub cohesion: f32,
    /// Speed per body length with which a member approaches its slot.
    pub keeping: f32,
    /// Greatest speed relative to its slot with which a member approaches it.
    pub catch_up: f32,
    /// Distance by which a slot drifts, so that members do not seem fixed.
    pub drift: f32,
    /// Time constant with which the velocity follows the wanted one.
    pub response_s: f32,
    /// Greatest change of velocity per second.
    pub max_acceleration: f32,
    /// Least speed.
    pub min_speed: f32,
    /// Greatest speed.
    pub max_speed: f32,
    /// Greatest angle per second by which a heading turns; a step turns by a right angle at most.
    pub turn_rad_s: f32,
    /// Distance that a member's centre keeps from every obstacle.
    pub clearance: f32,
    /// Distance from an obstacle within which members begin to swim round it.
    pub berth: f32,
    /// Time for which members look ahead along their velocity for obstacles.
    pub look_ahead_s: f32,
}

/// Distances from an eye beyond which members look at their neighbours less often.
///
/// Between looks they keep their last response; slots and obstacles count in every step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteerEvery {
    /// Position of the eye, at the beginning; see
    /// [`Simulation::set_eye`](super::Simulation::set_eye).
    pub eye: Vec3,
    /// Distances beyond which members look every 2nd, 4th and 8th step, in this order.
    pub distances: [f32; 3],
}

impl Default for SimulationOptions {
    /// Returns the options of the paper's evaluation: one school of 150 without obstacles, in steps
    /// of 1/60 s.
    fn default() -> Self {
        Self {
            schools: vec![SchoolOptions::of(150)],
            obstacles: Vec::new(),
            seed: 1,
            step_s: 1.0 / 60.0,
            behaviour: Behaviour::default(),
            steer_every: None,
        }
    }
}

/// Proportions of an ellipsoid: width, height, length.
const PROPORTIONS: Vec3 = Vec3::new(1.0, 0.6, 1.6);
/// Volume of the ellipsoid per member, at which nearest neighbours are 1.2 body lengths apart.
const VOLUME_PER_MEMBER: f32 = 1.9;
/// Radius of the default path over the length of the school's longest half axis, and its least
/// value, so that members on the outside can follow.
const PATH_OVER_LENGTH: f32 = 4.0;
const PATH_LEAST: f32 = 24.0;

impl SchoolOptions {
    /// Returns a school whose members are spaced about 1.2 body lengths apart and which is longer
    /// than wide, and wider than high, swimming round the origin.
    ///
    /// The path is a slightly tilted ring wide enough that the school can follow.
    pub fn of(members: usize) -> Self {
        let volume = VOLUME_PER_MEMBER * members.max(1) as f32;
        let scale = (volume / (4.0 / 3.0 * PI * PROPORTIONS.element_product())).cbrt();
        let radii = PROPORTIONS * scale;
        let around = (PATH_OVER_LENGTH * radii.z).max(PATH_LEAST);
        let leader = Leader::Path(LeaderPath::ring(Vec3::ZERO, around, 0.15));
        Self { members, radii, leader, speed: 2.0 }
    }
}

impl Default for Behaviour {
    fn default() -> Self {
        Self {
            neighbour_radius: 2.25,
            separation_radius: 1.6,
            separation: 6.0,
            alignment: 0.4,
            cohesion: 0.05,
            keeping: 0.8,
            catch_up: 1.5,
            drift: 0.3,
            response_s: 0.3,
            max_acceleration: 10.0,
            min_speed: 0.5,
            max_speed: 5.0,
            turn_rad_s: 3.0,
            clearance: 0.3,
            berth: 2.0,
            look_ahead_s: 2.0,
        }
    }
}

impl SimulationOptions {
    /// Checks all options.
    pub(super) fn validate(&self) -> Result<(), SimulationError> {
        let Self { step_s, behaviour, .. } = self;
        within("step_s", *step_s, 1e-5..=0.25, "between 0.00001 and 0.25 s")?;
        behaviour.validate()?;
        let Behaviour { max_speed, clearance, .. } = *behaviour;
        // Then whatever is between the ends of a step is outside the obstacles too: see `avoid`.
        if step_s * max_speed > clearance {
            return Err(SimulationError::StepTooLong { step_s: *step_s, max_speed, clearance });
        }
        for (i, school) in self.schools.iter().enumerate() {
            school.validate(i, behaviour)?;
        }
        if let Some(i) = self.obstacles.iter().position(|obstacle| !obstacle.is_valid()) {
            return Err(SimulationError::Obstacle(i));
        }
        if let Some(SteerEvery { eye, distances }) = &self.steer_every {
            if !is_near(*eye) {
                let (option, range) = ("steer_every.eye", "within 1e6 of the origin");
                return Err(SimulationError::Option { option, range, value: eye.length() });
            }
            let [near, middle, far] = *distances;
            let order = "0 or more, and in ascending order";
            within("steer_every.distances", near, 0.0..=middle, order)?;
            within("steer_every.distances", middle, near..=far, order)?;
        }
        let members = self.schools.iter().try_fold(0_usize, |sum, s| sum.checked_add(s.members));
        match members {
            Some(count) if count < u32::MAX as usize => Ok(()),
            count => Err(SimulationError::TooManyMembers(count.unwrap_or(usize::MAX))),
        }
    }
}

impl SchoolOptions {
    fn validate(&self, school: usize, behaviour: &Behaviour) -> Result<(), SimulationError> {
        let fail =
            |option, range, value| Err(SimulationError::School { school, option, range, value });
        for radius in self.radii.to_array() {
            if !(0.0..=FARTHEST).contains(&radius) {
                return fail("radii", "between 0 and 1e6", radius);
            }
        }
        if !(behaviour.min_speed..=behaviour.max_speed).contains(&self.speed) {
            return fail("speed", "between min_speed and max_speed", self.speed);
        }
        if let Leader::Line { from, direction } = &self.leader {
            if !is_near(*from) {
                return fail("leader.from", "within 1e6 of the origin", from.length());
            }
            if direction.try_normalize().is_none() {
                return fail("leader.direction", "a direction", direction.length());
            }
        }
        Ok(())
    }
}

impl Behaviour {
    fn validate(&self) -> Result<(), SimulationError> {
        let at_most_a_million = [
            ("separation", self.separation),
            ("alignment", self.alignment),
            ("cohesion", self.cohesion),
            ("keeping", self.keeping),
            ("catch_up", self.catch_up),
            ("drift", self.drift),
            ("separation_radius", self.separation_radius),
            ("max_acceleration", self.max_acceleration),
            ("turn_rad_s", self.turn_rad_s),
            ("look_ahead_s", self.look_ahead_s),
        ];
        for (option, value) in at_most_a_million {
            within(option, value, 0.0..=FARTHEST, "between 0 and 1e6")?;
        }
        let positive = [
            ("neighbour_radius", self.neighbour_radius),
            ("response_s", self.response_s),
            ("min_speed", self.min_speed),
            ("clearance", self.clearance),
        ];
        for (option, value) in positive {
            within(option, value, 1e-3..=FARTHEST, "between 0.001 and 1e6")?;
        }
        let Self { min_speed, neighbour_radius, clearance, .. } = *self;
        within("max_speed", self.max_speed, min_speed..=FARTHEST, "between min_speed and 1e6")?;
        let range = 0.0..=neighbour_radius;
        within("separation_radius", self.separation_radius, range, "at most neighbour_radius")?;
        within("berth", self.berth, clearance..=FARTHEST, "between clearance and 1e6")
    }
}

fn within(
    option: &'static str,
    value: f32,
    values: std::ops::RangeInclusive<f32>,
    range: &'static str,
) -> Result<(), SimulationError> {
    let is_within = values.contains(&value);
    if is_within { Ok(()) } else { Err(SimulationError::Option { option, range, value }) }
}
