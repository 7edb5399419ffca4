//! Flock and camera in every frame.

use std::ops::Range;

use glam::Vec3;
use meshlod::flock::FlockCamera;
use meshlod::flock::{Flock, School};

use crate::footage::Footage;
use crate::recording::limits::FARTHEST;
use crate::recording::{RecordedScene, RecordingError, Source, cameras, npy};
use crate::scene::{Scenario, SceneObstacle};

/// Recorded flock and camera of every frame, with their scene.
///
/// Takes 28 bytes a member and frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    scene: RecordedScene,
    /// Position of every member in every frame.
    positions: Vec<f32>,
    /// Heading of every member in every frame.
    headings: Vec<f32>,
    /// Speed of every member in every frame.
    speeds: Vec<f32>,
    /// Position and heading of every leader in every frame.
    leaders: Vec<f32>,
    cameras: Vec<FlockCamera>,
}

/// Greatest deviation of the length of a heading from 1.
const SLACK: f32 = 1e-3;

impl Recording {
    /// Creates a recording without frames; `model` is the file name of the members' model.
    pub fn new(scenario: &Scenario, model: Option<String>) -> Self {
        Self {
            scene: RecordedScene::of(scenario, model),
            positions: Vec::new(),
            headings: Vec::new(),
            speeds: Vec::new(),
            leaders: Vec::new(),
            cameras: Vec::new(),
        }
    }

    /// Adds a frame.
    ///
    /// # Panics
    /// If the numbers of members and schools differ from the scenario's.
    pub fn push(&mut self, flock: &Flock, camera: &FlockCamera) {
        let counts = (flock.members.len(), flock.schools.len());
        assert_eq!(counts, (self.scene.members, self.scene.schools.len()), "members, schools");
        for member in 0..flock.members.len() {
            self.positions.extend(flock.members.position(member).to_array());
            self.headings.extend(flock.members.heading(member).to_array());
        }
        self.speeds.extend_from_slice(&flock.members.speed);
        for school in &flock.schools {
            self.leaders.extend(school.leader.to_array());
            self.leaders.extend(school.heading.to_array());
        }
        self.cameras.push(*camera);
    }

    /// Returns the recorded scene.
    pub fn scene(&self) -> &RecordedScene {
        &self.scene
    }

    /// Returns the number of frames.
    pub fn frames(&self) -> usize {
        self.cameras.len()
    }

    /// Returns the flock in a frame.
    ///
    /// # Panics
    /// If there is no such frame.
    pub fn flock(&self, frame: usize) -> Flock {
        let (members, schools) = (self.scene.members, self.scene.schools.len());
        let part = |values: &'_ [f32], each: usize| -> Range<usize> {
            debug_assert_eq!(values.len(), self.frames() * each);
            frame * each..(frame + 1) * each
        };
        let positions = &self.positions[part(&self.positions, 3 * members)];
        let headings = &self.headings[part(&self.headings, 3 * members)];
        let leaders = &self.leaders[part(&self.leaders, 6 * schools)];
        let mut flock = Flock::default();
        for (position, heading) in positions.as_chunks().0.iter().zip(headings.as_chunks().0) {
            flock.members.push(*position, *heading);
        }
        flock.members.speed.copy_from_slice(&self.speeds[part(&self.speeds, members)]);
        let school = |((members, radii), leader): (&(Range<usize>, Vec3), &[f32; 6])| School {
            members: members.clone(),
            leader: Vec3::from_slice(&leader[..3]),
            heading: Vec3::from_slice(&leader[3..]),
            radii: *radii,
        };
        flock.schools = self.scene.schools.iter().zip(leaders.as_chunks().0).map(school).collect();
        flock
    }

    /// Returns the cameras of all frames.
    pub fn cameras(&self) -> &[FlockCamera] {
        &self.cameras
    }

    /// Returns the recording for an evaluation.
    pub fn footage(&self) -> Footage {
        Footage {
            name: self.scene.scenario.clone(),
            flocks: (0..self.frames()).map(|frame| self.flock(frame)).collect(),
            cameras: self.cameras.clone(),
            obstacles: self.scene.obstacles.iter().map(SceneObstacle::mesh).collect(),
            frame_s: self.scene.frame_s as f32,
        }
    }

    /// Writes all files; `scene.json` comes last, so that a folder with one is complete.
    ///
    /// # Errors
    /// Those of `put`, which gets the name and the bytes of each file.
    pub fn write<E>(&self, mut put: impl FnMut(&str, &[u8]) -> Result<(), E>) -> Result<(), E> {
        let (frames, members) = (self.frames(), self.scene.members);
        let bytes = |shape: &[usize], values: &[f32]| npy::write(shape, values.iter().copied());
        put("positions.npy", &bytes(&[frames, members, 3], &self.positions))?;
        put("headings.npy", &bytes(&[frames, members, 3], &self.headings))?;
        put("speeds.npy", &bytes(&[frames, members], &self.speeds))?;
        put("leaders.npy", &bytes(&[frames, self.scene.schools.len(), 6], &self.leaders))?;
        put("cameras.json", &cameras::write(&self.cameras))?;
        self.scene.write(frames, &mut put)
    }

    /// Reads a recording.
    ///
    /// # Errors
    /// Files that are missing, damaged or inconsistent, and values that are not finite.
    pub fn read(source: &mut Source<'_>) -> Result<Self, RecordingError> {
        let (scene, frames) = RecordedScene::read(source)?;
        let (members, schools) = (scene.members, scene.schools.len());
        let mut array = |file: &str, more: &[usize]| {
            let shape: Vec<_> = [frames].iter().chain(more).copied().map(Some).collect();
            source.array::<f32>(file, &shape).map(|array| array.values)
        };
        let positions = array("positions.npy", &[members, 3])?;
        let headings = array("headings.npy", &[members, 3])?;
        let speeds = array("speeds.npy", &[members])?;
        let leaders = array("leaders.npy", &[schools, 6])?;
        check_each("positions.npy", &positions, members, is_near, NEAR)?;
        check_each("headings.npy", &headings, members, is_unit, UNIT)?;
        check_each(
            "speeds.npy",
            &speeds,
            members,
            |[s]: [f32; 1]| (0.0..=1e7).contains(&s),
            SPEED,
        )?;
        let is_leader = |[x, y, z, u, v, w]: [f32; 6]| is_near([x, y, z]) && is_unit([u, v, w]);
        check_each("leaders.npy", &leaders, schools, is_leader, LEADER)?;
        let cameras = cameras::read(source, frames)?;
        Ok(Self { scene, positions, headings, speeds, leaders, cameras })
    }
}

/// Name of the entries of an array, and the rule that they keep.
const NEAR: [&str; 2] = ["member", "a position must be finite and within 1e7 of the origin"];
const UNIT: [&str; 2] = ["member", "a heading must be a unit vector"];
const SPEED: [&str; 2] = ["member", "a speed must be between 0 and 1e7"];
const LEADER: [&str; 2] = ["leader", "it must have a finite position and a unit vector as heading"];

fn is_near(position: [f32; 3]) -> bool {
    position.iter().all(|x| x.abs() <= FARTHEST)
}

fn is_unit(heading: [f32; 3]) -> bool {
    (Vec3::from(heading).length() - 1.0).abs() <= SLACK
}

/// Checks the entries of an array, `each` a frame and `N` values an entry.
fn check_each<const N: usize>(
    file: &str,
    values: &[f32],
    each: usize,
    is_valid: impl Fn([f32; N]) -> bool,
    [what, reason]: [&str; 2],
) -> Result<(), RecordingError> {
    match values.as_chunks().0.iter().position(|entry| !is_valid(*entry)) {
        None => Ok(()),
        Some(at) => {
            let place = format!("frame {}, {what} {}", at / each, at % each);
            Err(RecordingError::value(file, place, reason))
        }
    }
}
