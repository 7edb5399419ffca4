//! Level table of a model as files: `levels.json` and the arrays that it names.

use meshlod_mesh::LayerKind;
use serde::{Deserialize, Serialize};

use crate::levels::{Chain, ChainKind, Differences, Level, LevelTable};
use crate::recording::{VERSION, cameras::json_lines, npy};

/// Names of the files with fixed names.
pub const FILE: &str = "levels.json";
pub const VERTICES: &str = "vertices.npy";
pub const TRIANGLES: &str = "triangles.npy";
pub const MATERIALS: &str = "triangle_materials.npy";
pub const DIFFERENCES: &str = "differences.npy";
pub const SILHOUETTES: &str = "silhouettes.npy";

/// `levels.json`.
#[derive(Serialize, Deserialize)]
pub struct LevelsFile {
    pub version: u32,
    /// Cells along the side of the grid of directions of the facing chains.
    pub direction_side: usize,
    /// Chains, one after the other.
    pub chains: Vec<ChainEntry>,
    /// Levels of all chains, finest first in each.
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
    /// Unit vector from the member to the eyes that a facing chain is for, in the member's frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f32; 3]>,
    /// Greatest angle between that vector and the eyes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub half_angle_rad: Option<f32>,
}

#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChainWord {
    Whole,
    LeftCoarsened,
    RightCoarsened,
    Facing,
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
    /// Number of the layer among those of its kind.
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
}

/// What the axes of `differences.npy` mean: direction, level of the whole chain, size.
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
    let file = LevelsFile {
        version: VERSION,
        direction_side: table.directions.len().isqrt(),
        chains: chains(table),
        levels: levels(table),
        layers,
        materials: table.materials.as_ref().map(|labels| labels.names.clone()),
        differences: DifferencesEntry {
            directions: (0..grid.len()).map(|cell| grid.axis(cell).to_array()).collect(),
            pixels_per_body_length: Differences::pixels_per_body_length().to_vec(),
        },
    };
    put(FILE, &json_lines(&file))
}

fn chains(table: &LevelTable) -> Vec<ChainEntry> {
    let entry = |chain: &Chain| {
        let (kind, cell) = match chain.kind {
            ChainKind::Whole => (ChainWord::Whole, None),
            ChainKind::LeftCoarsened => (ChainWord::LeftCoarsened, None),
            ChainKind::RightCoarsened => (ChainWord::RightCoarsened, None),
            ChainKind::Facing(cell) => (ChainWord::Facing, Some(cell)),
        };
        ChainEntry {
            kind,
            first_level: chain.levels.start,
            levels: chain.levels.len(),
            direction: cell.map(|cell| table.directions.axis(cell).to_array()),
            half_angle_rad: cell.map(|cell| table.directions.half_angle_rad(cell)),
        }
    };
    table.chains.iter().map(entry).collect()
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
        }
    }
}
