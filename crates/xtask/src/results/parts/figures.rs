//! Size of a level and its distance from the input.

use std::path::Path;

use anyhow::{Context, Result};
use meshlod::measure::{DistanceOptions, PreparedSurface, surface_distance};
use meshlod::mesh::{Mesh, face_components, weld};
use meshlod::{ReadOptions, Scene, WriteOptions};
use serde_json::{Value, json};

/// Faces of a level, and its distance from the input both ways in percent of the diagonal.
#[derive(Clone, Copy, Debug)]
pub struct Figures {
    /// Number of faces of the level.
    pub faces: usize,
    /// Mean distance.
    pub mean: f64,
    /// Maximum distance.
    pub max: f64,
}

/// Difference in percent of the diagonal up to which two distances are equal, for the rounding of
/// coordinates in files.
const NOISE: f64 = 1e-5;

impl Figures {
    /// Measures a level as `meshlod measure` does; `None` if it has no surface.
    pub fn of(input: &PreparedSurface<'_>, level: &Mesh) -> Result<Option<Self>> {
        let Ok(surface) = PreparedSurface::new(level) else { return Ok(None) };
        let apart = surface_distance(input, &surface, &DistanceOptions::default())?;
        let [mean, max] = [apart.mean(), apart.max()].map(|x| apart.percent(x));
        Ok(Some(Self { faces: level.faces.len(), mean, max }))
    }

    /// Restores figures from what [`Figures::to_json`] gave; `None` for anything else.
    pub fn from_json(json: &Value) -> Option<Self> {
        let number = |name: &str| json[name].as_f64();
        let faces = json["faces"].as_u64()? as usize;
        Some(Self { faces, mean: number("mean")?, max: number("max")? })
    }

    /// Returns the figures as a JSON object.
    pub fn to_json(self) -> Value {
        json!({ "faces": self.faces, "mean": self.mean, "max": self.max })
    }

    /// Formats the mean and the maximum distance.
    pub fn distances(&self) -> String {
        format!("{:.4} / {:.2}", self.mean, self.max)
    }
}

/// Formats figures as a cell of a table, with the number of faces where it is not `wanted`.
pub fn cell(figures: Option<Figures>, wanted: usize) -> String {
    match figures {
        None => "–".to_owned(),
        Some(level) if level.faces > wanted => {
            format!("{} faces: {}", level.faces, level.distances())
        }
        Some(level) => level.distances(),
    }
}

/// Returns whether a distance is at most `times` another, or equal but for rounding.
pub fn is_at_most(ours: f64, times: f64, theirs: f64) -> bool {
    ours <= times * theirs + NOISE
}

/// Formats the ratio of two distances.
pub fn ratio(ours: f64, theirs: f64) -> String {
    format!("{:.2} ×", ours / theirs.max(NOISE))
}

/// Reads a file as one mesh in world space.
pub fn read(path: &Path) -> Result<Mesh> {
    Ok(meshlod::read(path, &ReadOptions::default())?.into_mesh())
}

/// Drops everything but positions, rounded as files hold them, and faces, and welds vertices at
/// one place.
pub fn bare(mesh: Mesh) -> Mesh {
    let rounded = mesh.positions.iter().map(|p| p.map(|x| f64::from(x as f32))).collect();
    let mut bare = Mesh::new(rounded, mesh.faces);
    weld(&mut bare, 0.0);
    bare.compact();
    bare
}

/// Returns the number of connected components of a mesh as its file has them, which may be many
/// although a welded copy is of one.
pub fn part_count(mesh: &Mesh) -> usize {
    face_components(&mesh.faces, mesh.positions.len()).1
}

/// Writes a mesh to a file of its own.
pub fn write(path: &Path, mesh: &Mesh) -> Result<()> {
    let scene = Scene::from_mesh("mesh", mesh.clone());
    meshlod::write(path, &scene, &WriteOptions::default())
        .with_context(|| path.display().to_string())
}
