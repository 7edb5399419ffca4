//! Size of a level and its distance from the input.

use anyhow::Result;
use meshlod::measure::{DistanceOptions, PreparedSurface, surface_distance};
use meshlod::mesh::Mesh;
use serde_json::{Value, json};

/// Faces of a level, and its distance from the input both ways in percent of the diagonal.
#[derive(Clone, Copy, Debug)]
pub struct Deviation {
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

impl Deviation {
    /// Measures a level as `meshlod measure` does; `None` if it has no surface.
    pub fn of(input: &PreparedSurface<'_>, level: &Mesh) -> Result<Option<Self>> {
        let Ok(surface) = PreparedSurface::new(level) else { return Ok(None) };
        let apart = surface_distance(input, &surface, &DistanceOptions::default())?;
        let [mean, max] = [apart.mean(), apart.max()].map(|x| apart.percent(x));
        Ok(Some(Self { faces: level.faces.len(), mean, max }))
    }

    /// Restores a deviation from what [`Deviation::to_json`] gave; `None` for anything else.
    pub fn from_json(json: &Value) -> Option<Self> {
        let number = |name: &str| json[name].as_f64();
        let faces = json["faces"].as_u64()? as usize;
        Some(Self { faces, mean: number("mean")?, max: number("max")? })
    }

    /// Returns the deviation as a JSON object.
    pub fn to_json(self) -> Value {
        json!({ "faces": self.faces, "mean": self.mean, "max": self.max })
    }

    /// Formats the mean and the maximum distance.
    pub fn distances(&self) -> String {
        format!("{:.4} / {:.2}", self.mean, self.max)
    }
}

/// Formats a deviation as a cell of a table, with the number of faces where it is not `wanted`.
pub fn cell(deviation: Option<Deviation>, wanted: usize) -> String {
    match deviation {
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
