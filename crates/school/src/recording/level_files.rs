//! Level table of a model as files: `levels.json` and the arrays that it names.

use meshlod::flock::levels::{Chain, ChainKind, Differences, FacingLevels, Level, LevelTable};
use meshlod::mesh::LayerKind;
use serde::{Deserialize, Serialize};

use crate::recording::{VERSION, json, npy};

/// Names of the files with fixed names.
pub const FILE: &str = "levels.json";
pub const VERTICES: &str = "vertices.npy";
pub const TRIANGLES: &str = "triangles.npy";
pub const MATERIALS: &str = "triangle_materials.npy";
pub const DIFFERENCES: &str = "differences.npy";
pub const SILHOUETTES: &str = "silhouettes.npy";
pub const DIRECTIONS: &str = "facing_directions.npy";

/// `levels.json`.
#[derive(Serialize, Deserialize)]
pub struct LevelsFile {
    pub version: u32,
    /// Simplified chains, one after the other.
    pub chains: Vec<ChainEntry>,
    /// Facing levels at each depth of the whole chain; they follow the chains.
    pub facing: Vec<FacingEntry>,
    /// Levels of all chains, finest first in each, then the facing ones by direction.
    pub levels: Vec<LevelEntry>,
    pub layers: Vec<LayerEntry>,
    /// Names of the materials, in the order of the model's; `None` without materials.
    pub materials: Option<Vec<String>>,
    pub differences: DifferencesEntry,
}

#[derive(Serialize, Deserialize)]
pub struct ChainEntry {
    pub kind: ChainWord,
    pub first_level: usize,
    pub levels: usize,
}

#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChainWord {
    Whole,
    LeftCoarsened,
    RightCoarsened,
}

/// One level for each direction of a grid; none where the depth has no facing levels.
#[derive(Serialize, Deserialize)]
pub struct FacingEntry {
    /// Cells along the side of the grid.
    pub side: usize,
    pub first_level: usize,
    pub levels: usize,
}

#[derive(Serialize, Deserialize)]
pub struct LevelEntry {
    pub first_triangle: usize,
    pub triangles: usize,
    /// Greatest distance of the model's vertices from the level, in body lengths.
    pub error: f32,
}

#[derive(Serialize, Deserialize)]
pub struct LayerEntry {
    pub kind: LayerWord,
    /// Number of the layer among all of its kind.
    pub set: u8,
    pub name: String,
    pub file: String,
}

#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LayerWord {
    Normal,
    Uv,
    Color,
    Tangent,
    Joints,
    Weights,
    Other,
    Label,
}

/// First and third axis of `differences.npy`; the second is the levels of the whole chain.
#[derive(Serialize, Deserialize)]
pub struct DifferencesEntry {
    /// Unit vector from the member to the eye, in the member's frame.
    pub directions: Vec<[f32; 3]>,
    pub pixels_per_body_length: Vec<f32>,
}

/// Writes the level table of a model; `levels.json` comes last.
///
/// # Errors
/// Those of `put`, which gets the name and the bytes of each file.
pub fn write_levels<E>(
    table: &LevelTable,
    mut put: impl FnMut(&str, &[u8]) -> Result<(), E>,
) -> Result<(), E> {
    let vertices = table.positions.len();
    let floats = |shape: &[usize], values: &[f32]| npy::write(shape, values.iter().copied());
    put(VERTICES, &floats(&[vertices, 3], table.positions.as_flattened()))?;
    let corners = table.triangles.as_flattened();
    put(TRIANGLES, &npy::write(&[table.triangles.len(), 3], corners.iter().copied()))?;
    let mut layers = Vec::new();
    for (i, layer) in table.layers.iter().enumerate() {
        let (kind, set) = words_of(layer.kind);
        let file = format!("layer_{i}.npy");
        put(&file, &floats(&[vertices, layer.width], &layer.values))?;
        layers.push(LayerEntry { kind, set, name: layer.name.clone(), file });
    }
    if let Some(labels) = &table.materials {
        put(MATERIALS, &npy::write(&[labels.of_face.len()], labels.of_face.iter().copied()))?;
    }
    let (areas, silhouettes) = table.differences.arrays();
    let grid = table.differences.directions();
    let shape = [grid.len(), table.depth(), Differences::SIZES];
    put(DIFFERENCES, &floats(&shape, areas))?;
    put(SILHOUETTES, &floats(&[grid.len()], silhouettes))?;
    let directions: Vec<f32> = table.facing.iter().flat_map(cells).collect();
    put(DIRECTIONS, &floats(&[directions.len() / 4, 4], &directions))?;
    let file = LevelsFile {
        version: VERSION,
        chains: table.chains.iter().map(chain_entry).collect(),
        facing: table.facing.iter().map(facing_entry).collect(),
        levels: levels(table),
        layers,
        materials: table.materials.as_ref().map(|labels| labels.names.clone()),
        differences: DifferencesEntry {
            directions: (0..grid.len()).map(|cell| grid.axis(cell).to_array()).collect(),
            pixels_per_body_length: Differences::pixels_per_body_length().to_vec(),
        },
    };
    put(FILE, &json::compact(&file))
}

fn chain_entry(chain: &Chain) -> ChainEntry {
    let kind = match chain.kind {
        ChainKind::LeftCoarsened => ChainWord::LeftCoarsened,
        ChainKind::RightCoarsened => ChainWord::RightCoarsened,
        ChainKind::Whole | ChainKind::Facing(_) => ChainWord::Whole,
    };
    ChainEntry { kind, first_level: chain.levels.start, levels: chain.levels.len() }
}

fn facing_entry(facing: &FacingLevels) -> FacingEntry {
    FacingEntry {
        side: facing.directions.len().isqrt(),
        first_level: facing.levels.start,
        levels: facing.levels.len(),
    }
}

/// Returns the axis of each facing level, the unit vector towards the eye, and the greatest angle
/// between the axis and an eye for which the level is meant.
pub fn cells(facing: &FacingLevels) -> impl Iterator<Item = f32> {
    let grid = &facing.directions;
    (0..facing.levels.len()).flat_map(move |cell| {
        let [x, y, z] = grid.axis(cell).to_array();
        [x, y, z, grid.half_angle_rad(cell)]
    })
}

fn levels(table: &LevelTable) -> Vec<LevelEntry> {
    let entry = |level: &Level| LevelEntry {
        first_triangle: level.triangles.start,
        triangles: level.triangles.len(),
        error: level.error,
    };
    table.levels.iter().map(entry).collect()
}

fn words_of(kind: LayerKind) -> (LayerWord, u8) {
    match kind {
        LayerKind::Normal => (LayerWord::Normal, 0),
        LayerKind::Uv(set) => (LayerWord::Uv, set),
        LayerKind::Color(set) => (LayerWord::Color, set),
        LayerKind::Tangent => (LayerWord::Tangent, 0),
        LayerKind::Joints(set) => (LayerWord::Joints, set),
        LayerKind::Weights(set) => (LayerWord::Weights, set),
        LayerKind::Other => (LayerWord::Other, 0),
        LayerKind::Label => (LayerWord::Label, 0),
    }
}

impl LayerEntry {
    /// Returns the type of the layer.
    pub fn kind(&self) -> LayerKind {
        match self.kind {
            LayerWord::Normal => LayerKind::Normal,
            LayerWord::Uv => LayerKind::Uv(self.set),
            LayerWord::Color => LayerKind::Color(self.set),
            LayerWord::Tangent => LayerKind::Tangent,
            LayerWord::Joints => LayerKind::Joints(self.set),
            LayerWord::Weights => LayerKind::Weights(self.set),
            LayerWord::Other => LayerKind::Other,
            LayerWord::Label => LayerKind::Label,
        }
    }
}
