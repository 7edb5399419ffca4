//! Scene of a recording: schools, obstacles, model and seed, as `scene.json`.

use std::ops::Range;

use glam::Vec3;
use meshlod::mesh::{Mesh, VertexId};
use serde::{Deserialize, Serialize};

use crate::recording::limits::FARTHEST;
use crate::recording::{RecordingError, Source, VERSION, json, npy};
use crate::scene::{Scenario, SceneObstacle};
use crate::simulation::SchoolOptions;

/// Name of the file.
pub const FILE: &str = "scene.json";

/// Scene of a recording: everything that stays the same in all frames.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedScene {
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of the simulation.
    pub seed: u64,
    /// Time from frame to frame, in seconds.
    pub frame_s: f64,
    /// File name of the model, if it is not the sample fish.
    pub model: Option<String>,
    /// Number of members in all schools.
    pub members: usize,
    /// Members of each school, and half axes of its ellipsoid along the leader's left, up and
    /// heading.
    pub schools: Vec<(Range<usize>, Vec3)>,
    /// Obstacles, in body lengths.
    pub obstacles: Vec<SceneObstacle>,
}

/// `scene.json`.
#[derive(Serialize, Deserialize)]
struct SceneFile {
    version: u32,
    scenario: String,
    seed: u64,
    seconds_per_frame: f64,
    frames: usize,
    members: usize,
    model: Option<String>,
    schools: Vec<SchoolEntry>,
    obstacles: Vec<ObstacleEntry>,
}

#[derive(Serialize, Deserialize)]
struct SchoolEntry {
    /// First member.
    first: usize,
    members: usize,
    /// Half axes along the leader's left, up and heading.
    radii: [f32; 3],
}

#[derive(Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum ObstacleEntry {
    Sphere { center: [f32; 3], radius: f32 },
    Capsule { ends: [[f32; 3]; 2], radius: f32 },
    Mesh { vertices: String, triangles: String },
}

impl RecordedScene {
    /// Describes a scenario; `model` is the file name of the members' model.
    pub fn of(scenario: &Scenario, model: Option<String>) -> Self {
        let mut first = 0;
        let school = |school: &SchoolOptions| {
            let members = first..first + school.members;
            first = members.end;
            (members, school.radii)
        };
        let schools: Vec<_> = scenario.simulation.schools.iter().map(school).collect();
        Self {
            scenario: scenario.name.name().into(),
            seed: scenario.simulation.seed,
            frame_s: scenario.frame_s,
            model,
            members: schools.last().map_or(0, |(members, _)| members.end),
            schools,
            obstacles: scenario.obstacles.clone(),
        }
    }

    /// Writes the meshes of obstacles, and then `scene.json`.
    pub(super) fn write<E>(
        &self,
        frames: usize,
        put: &mut impl FnMut(&str, &[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        let school = |(members, radii): &(Range<usize>, Vec3)| SchoolEntry {
            first: members.start,
            members: members.len(),
            radii: radii.to_array(),
        };
        let mut obstacles = Vec::new();
        for (i, obstacle) in self.obstacles.iter().enumerate() {
            obstacles.push(write_obstacle(obstacle, i, put)?);
        }
        let file = SceneFile {
            version: VERSION,
            scenario: self.scenario.clone(),
            seed: self.seed,
            seconds_per_frame: self.frame_s,
            frames,
            members: self.members,
            model: self.model.clone(),
            schools: self.schools.iter().map(school).collect(),
            obstacles,
        };
        put(FILE, &json::pretty(&file))
    }

    /// Reads the scene and the number of its frames.
    pub(super) fn read(source: &mut Source<'_>) -> Result<(Self, usize), RecordingError> {
        let file: SceneFile = source.json(FILE)?;
        let wrong = |place: String, reason| Err(RecordingError::value(FILE, place, reason));
        if !(1e-6..=3600.0).contains(&file.seconds_per_frame) {
            return wrong("seconds_per_frame".into(), "it must be between 0.000001 and 3600");
        }
        if file.members == 0 {
            return wrong("members".into(), "there must be at least one");
        }
        let mut next = 0;
        let mut schools = Vec::new();
        for (i, SchoolEntry { first, members, radii }) in file.schools.iter().enumerate() {
            let radii = Vec3::from(*radii);
            let end = first.checked_add(*members).filter(|end| *end <= file.members);
            let Some(end) = end.filter(|_| *first >= next) else {
                let reason = "its members must follow those of the school before, and be there";
                return wrong(format!("school {i}"), reason);
            };
            if !(radii.min_element() >= 0.0 && radii.max_element() <= FARTHEST) {
                return wrong(format!("school {i}"), "its radii must be between 0 and 1e7");
            }
            next = end;
            schools.push((*first..end, radii));
        }
        let obstacle = |(i, entry)| read_obstacle(entry, i, source);
        let obstacles = file.obstacles.into_iter().enumerate().map(obstacle);
        let scene = Self {
            scenario: file.scenario,
            seed: file.seed,
            frame_s: file.seconds_per_frame,
            model: file.model,
            members: file.members,
            schools,
            obstacles: obstacles.collect::<Result<_, _>>()?,
        };
        Ok((scene, file.frames))
    }
}

fn write_obstacle<E>(
    obstacle: &SceneObstacle,
    number: usize,
    put: &mut impl FnMut(&str, &[u8]) -> Result<(), E>,
) -> Result<ObstacleEntry, E> {
    Ok(match obstacle {
        SceneObstacle::Sphere { center, radius } => {
            ObstacleEntry::Sphere { center: center.to_array(), radius: *radius }
        }
        SceneObstacle::Capsule { ends, radius } => {
            ObstacleEntry::Capsule { ends: ends.map(|end| end.to_array()), radius: *radius }
        }
        SceneObstacle::Solid(mesh) => {
            let vertices = format!("obstacle_{number}_vertices.npy");
            let triangles = format!("obstacle_{number}_triangles.npy");
            let positions: Vec<f32> = mesh.positions.iter().flatten().map(|&x| x as f32).collect();
            put(&vertices, &npy::write(&[mesh.positions.len(), 3], positions.into_iter()))?;
            let corners: Vec<u32> = mesh.faces.iter().flatten().map(|v| v.0).collect();
            put(&triangles, &npy::write(&[mesh.faces.len(), 3], corners.into_iter()))?;
            ObstacleEntry::Mesh { vertices, triangles }
        }
    })
}

fn read_obstacle(
    entry: ObstacleEntry,
    number: usize,
    source: &mut Source<'_>,
) -> Result<SceneObstacle, RecordingError> {
    let near = |point: Vec3| point.abs().max_element() <= FARTHEST;
    let obstacle = match entry {
        ObstacleEntry::Sphere { center, radius } => {
            SceneObstacle::Sphere { center: center.into(), radius }
        }
        ObstacleEntry::Capsule { ends, radius } => {
            SceneObstacle::Capsule { ends: ends.map(Vec3::from), radius }
        }
        ObstacleEntry::Mesh { vertices, triangles } => {
            return read_mesh(&vertices, &triangles, source).map(SceneObstacle::Solid);
        }
    };
    let is_valid = match &obstacle {
        SceneObstacle::Sphere { center, radius } => near(*center) && is_wide(*radius),
        SceneObstacle::Capsule { ends, radius } => {
            near(ends[0]) && near(ends[1]) && is_wide(*radius)
        }
        SceneObstacle::Solid(_) => true,
    };
    match is_valid {
        true => Ok(obstacle),
        false => {
            let reason = "its coordinates must be within 1e7, and its radius over 0";
            Err(RecordingError::value(FILE, format!("obstacle {number}"), reason))
        }
    }
}

fn is_wide(radius: f32) -> bool {
    radius > 0.0 && radius <= FARTHEST
}

fn read_mesh(
    vertices: &str,
    triangles: &str,
    source: &mut Source<'_>,
) -> Result<Mesh, RecordingError> {
    let positions = source.array::<f32>(vertices, &[None, Some(3)])?;
    let corners = source.array::<u32>(triangles, &[None, Some(3)])?;
    let positions = positions.values.as_chunks().0.iter().map(|p: &[f32; 3]| p.map(f64::from));
    let faces = corners.values.as_chunks().0.iter().map(|t: &[u32; 3]| t.map(VertexId));
    let mesh = Mesh::new(positions.collect(), faces.collect());
    match mesh.validate() {
        Ok(()) => Ok(mesh),
        Err(error) => Err(RecordingError::value(triangles, vertices, error)),
    }
}
