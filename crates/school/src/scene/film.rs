//! Film: a scenario that runs, frame by frame.

use glam::Vec3;
use meshlod::flock::Flock;
use meshlod::flock::FlockCamera;

use crate::footage::Footage;
use crate::scene::{Scenario, SceneError};
use crate::simulation::Simulation;

/// Scenario that runs; every frame is a flock and the camera that sees it.
#[derive(Clone, Debug)]
pub struct Film {
    scenario: Scenario,
    simulation: Simulation,
    flock: Flock,
    /// Number of frames returned.
    frames: u64,
    /// Eye of the previous frame.
    eye: Vec3,
}

/// Distance that the camera keeps from obstacles, in body lengths.
const CLEARANCE: f32 = 0.5;

impl Film {
    /// Starts a scenario and lets its schools take shape.
    ///
    /// # Errors
    /// Options that the simulation refuses.
    pub fn new(scenario: Scenario) -> Result<Self, SceneError> {
        let mut simulation = Simulation::new(&scenario.simulation)?;
        simulation.advance(scenario.warm_up_s)?;
        let flock = Flock::default();
        let mut film = Self { scenario, simulation, flock, frames: 0, eye: Vec3::ZERO };
        film.simulation.snapshot(film.simulation.alpha(), &mut film.flock);
        [film.eye, _] = film.look(-film.scenario.frame_s);
        Ok(film)
    }

    /// Advances by the time of a frame and returns the flock and its camera.
    ///
    /// # Errors
    /// A time from frame to frame or a camera outside its range.
    pub fn next_frame(&mut self) -> Result<(&Flock, FlockCamera), SceneError> {
        let frame_s = self.scenario.frame_s;
        self.simulation.advance(frame_s)?;
        self.simulation.snapshot(self.simulation.alpha(), &mut self.flock);
        let [eye, target] = self.look(self.frames as f64 * frame_s);
        let velocity = (eye - self.eye) / frame_s as f32;
        let (fov_rad, size) = (self.scenario.fov_rad, self.scenario.size);
        let camera = FlockCamera::look_at(eye.into(), target.into(), fov_rad, size)?;
        (self.eye, self.frames) = (eye, self.frames + 1);
        Ok((&self.flock, camera.moving(velocity.into())))
    }

    /// Moves an obstacle of the scenario; members make room for it.
    ///
    /// # Errors
    /// An index without an obstacle, and a position that is not finite or too far away; then
    /// nothing has moved.
    pub fn move_obstacle(&mut self, index: usize, by: Vec3) -> Result<(), SceneError> {
        self.simulation.move_obstacle(index, by)?;
        let Scenario { simulation, obstacles, .. } = &mut self.scenario;
        simulation.obstacles[index].translate(by);
        obstacles[index].translate(by);
        Ok(())
    }

    /// Returns the scenario.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// Returns the eye and its target at a time of the film.
    fn look(&self, time_s: f64) -> [Vec3; 2] {
        let [mut eye, target] = self.scenario.shot.look(&self.flock.schools[0], time_s);
        let obstacles = &self.scenario.simulation.obstacles;
        // Twice, since obstacles may be near each other.
        for obstacle in obstacles.iter().chain(obstacles) {
            let found = obstacle.distance(eye);
            eye += found.outward * (CLEARANCE - found.distance).max(0.0);
        }
        [eye, target]
    }
}

impl Scenario {
    /// Runs the scenario and keeps all frames. Takes 28 bytes a member and frame.
    ///
    /// # Errors
    /// A time from frame to frame or a camera outside its range.
    pub fn footage(self, frames: usize) -> Result<Footage, SceneError> {
        let mut footage = Footage {
            name: self.name.name().into(),
            flocks: Vec::new(),
            cameras: Vec::new(),
            obstacles: self.obstacle_meshes(),
            frame_s: self.frame_s as f32,
        };
        let mut film = Film::new(self)?;
        for _ in 0..frames {
            let (flock, camera) = film.next_frame()?;
            footage.flocks.push(flock.clone());
            footage.cameras.push(camera);
        }
        Ok(footage)
    }
}

#[cfg(test)]
mod tests {
    use meshlod::mesh::Mesh;

    use super::*;
    use crate::scene::{ScenarioName, ScenarioOptions, SceneObstacle};
    use crate::simulation::SimulationError;

    fn scenario(name: ScenarioName, members: usize, schools: usize) -> Scenario {
        let terrain: Mesh = meshlod::samples::terrain(2_000);
        let options = ScenarioOptions {
            members,
            schools,
            frame_s: 0.1,
            terrain: Some(&terrain),
            ..ScenarioOptions::default()
        };
        Scenario::named(name, &options).unwrap()
    }

    #[test]
    fn cameras_move_smoothly_and_keep_clear_of_obstacles() {
        for name in ScenarioName::ALL {
            let mut film = Film::new(scenario(name, 20, 1)).unwrap();
            let mut before: Option<FlockCamera> = None;
            for frame in 0..600 {
                let (_, camera) = film.next_frame().unwrap();
                let place = format!("{} {frame}", name.name());
                for obstacle in &film.scenario().simulation.obstacles {
                    assert!(obstacle.distance(camera.eye()).distance > 0.2, "{place}");
                }
                if let Some(before) = before {
                    let jerk = (camera.velocity() - before.velocity()).length();
                    assert!(jerk < 2.5, "{place}: velocity changes by {jerk}");
                    let turn = camera.axes()[2].angle_between(before.axes()[2]);
                    assert!(turn < 0.12, "{place}: turns by {turn}");
                }
                before = Some(camera);
            }
        }
    }

    #[test]
    fn the_school_is_in_the_middle_of_the_picture() {
        for name in ScenarioName::ALL {
            for members in [1, 2, 300] {
                let mut film = Film::new(scenario(name, members, 1)).unwrap();
                let (flock, camera) = film.next_frame().unwrap();
                assert_eq!(flock.members.len(), members);
                let [right, up, forward] = camera.axes();
                let [across, down] = camera.tangents();
                let seen = (0..members).filter(|&i| {
                    let offset = flock.members.position(i) - camera.eye();
                    let depth = offset.dot(forward);
                    offset.dot(right).abs() < across * depth && offset.dot(up).abs() < down * depth
                });
                let share = seen.count() as f32 / members as f32;
                let least = if name == ScenarioName::Inside { 0.0 } else { 0.7 };
                assert!(share >= least, "{} of {members}: {share}", name.name());
            }
        }
    }

    #[test]
    fn members_share_out_among_schools_that_keep_apart() {
        for name in ScenarioName::ALL {
            let mut film = Film::new(scenario(name, 100, 12)).unwrap();
            let schools = &film.next_frame().unwrap().0.schools;
            assert_eq!((schools.len(), schools[11].members.end), (12, 100));
            for (i, a) in schools.iter().enumerate() {
                for b in &schools[..i] {
                    let apart = a.leader.distance(b.leader);
                    assert!(apart > 2.0 * a.radii.y, "{}: {apart}", name.name());
                }
            }
        }
    }

    #[test]
    fn members_make_room_for_an_obstacle_that_moves() {
        let mut film = Film::new(scenario(ScenarioName::Obstacles, 60, 1)).unwrap();
        let leader = film.next_frame().unwrap().0.schools[0].leader;
        let ball = |obstacle: &SceneObstacle| match obstacle {
            SceneObstacle::Sphere { center, .. } => Some(*center),
            _ => None,
        };
        let obstacles = &film.scenario().obstacles;
        let (index, center) =
            obstacles.iter().enumerate().find_map(|(i, o)| Some((i, ball(o)?))).unwrap();
        film.move_obstacle(index, leader - center).unwrap();
        assert!(ball(&film.scenario().obstacles[index]).unwrap().distance(leader) < 1e-3);
        for _ in 0..20 {
            let members = film.next_frame().unwrap().0.members.clone();
            let obstacle = &film.scenario().simulation.obstacles[index];
            for i in 0..members.len() {
                assert!(obstacle.distance(members.position(i)).distance > 0.0, "member {i}");
            }
        }
        let none = film.move_obstacle(99, Vec3::ZERO);
        assert!(matches!(none, Err(SceneError::Simulation(SimulationError::NoObstacle { .. }))));
        assert!(film.move_obstacle(index, Vec3::NAN).is_err());
    }

    #[test]
    fn footage_is_the_same_again() {
        let film = || scenario(ScenarioName::Obstacles, 30, 2).footage(4).unwrap();
        let (one, other) = (film(), film());
        assert_eq!((&one.flocks, &one.cameras), (&other.flocks, &other.cameras));
        assert_eq!((one.len(), one.obstacles.len() > 3), (4, true));
    }

    #[test]
    fn what_cannot_be_filmed_is_refused() {
        let named = |options: ScenarioOptions<'_>| Scenario::named(ScenarioName::Terrain, &options);
        let options = ScenarioOptions::default();
        assert_eq!(named(options), Err(SceneError::NoTerrain));
        let flat = Mesh::default();
        let over = ScenarioOptions { terrain: Some(&flat), ..options };
        assert_eq!(named(over), Err(SceneError::FlatTerrain));
        let none = ScenarioOptions { members: 0, ..options };
        assert_eq!(named(none), Err(SceneError::NoMembers));
        let still = ScenarioOptions { frame_s: f64::NAN, ..options };
        assert!(matches!(named(still), Err(SceneError::FrameTime(_))));
    }
}
