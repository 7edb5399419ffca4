//! Quantization of positions: the grid of each mesh, and the nodes and skins that scale it back.

pub(crate) mod grid;
pub(crate) mod nodes;
pub(crate) mod skins;

use std::collections::BTreeSet;

use meshlod_mesh::Mesh;
use serde_json::Value;

use crate::gltf::document::Document;
use crate::gltf::document::primitive_kind::is_surface;
use crate::gltf::document::schema::parse_target_name;
use crate::gltf::write::levels::Level;
use crate::gltf::write::quantized::grid::QuantizationGrid;
use crate::gltf::write::settings::{Compression, PositionGrid};
use crate::scene::Scene;
use skins::SkinMatrices;

/// Quantization grids of the meshes of a scene, and the skins that scale them back.
pub(crate) struct Grids {
    /// Grid of each mesh, shared with its levels; `None` if its positions stay floats.
    pub of_mesh: Vec<Option<QuantizationGrid>>,
    /// New matrices of skins.
    pub skins: SkinMatrices,
    /// Meshes without a grid, with the reasons.
    pub kept: Vec<String>,
}

impl Grids {
    /// Returns no grids, for an uncompressed file.
    pub fn none(scene: &Scene) -> Self {
        let of_mesh = vec![None; scene.meshes.len()];
        Self { of_mesh, skins: SkinMatrices::default(), kept: Vec::new() }
    }

    /// Chooses the grids of a scene to be written as this JSON, made from the document, if any.
    pub fn choose(
        (json, document): (&Value, Option<&Document<'_>>),
        scene: &Scene,
        levels: &[Level],
        compression: &Compression,
    ) -> Self {
        let mut kept = Vec::new();
        let mut of_mesh = Vec::new();
        for (index, mesh) in scene.meshes.iter().map(|mesh| &mesh.mesh).enumerate() {
            let coarser = levels.iter().filter_map(|level| level.meshes.get(index));
            let meshes: Vec<&Mesh> = std::iter::once(mesh).chain(coarser).collect();
            let grid = match why_floats(json, index) {
                _ if mesh.faces.is_empty() => Ok(None),
                Some(why) => Err(why),
                None => grid_over(&meshes, compression).map(Some),
            };
            if let Err(why) = grid {
                kept.push(format!("mesh {index}: positions stay floats, because it {why}"));
            }
            of_mesh.push(grid.unwrap_or_default());
        }
        let skins = match document {
            Some(document) => SkinMatrices::of(document, &mut of_mesh, &mut kept),
            None => SkinMatrices::default(),
        };
        Self { of_mesh, skins, kept }
    }
}

/// Largest delta of a morph target, in cells.
const MOST_CELLS: f64 = 1e9;

/// Builds the grid over the positions of a mesh and its levels, or returns the reason against it.
fn grid_over(
    meshes: &[&Mesh],
    compression: &Compression,
) -> Result<QuantizationGrid, &'static str> {
    let points = meshes.iter().flat_map(|mesh| &mesh.positions);
    let grid = match compression.grid {
        Some(PositionGrid { origin, cell }) => {
            Some(QuantizationGrid { origin, cell, most: u16::MAX })
        }
        None => QuantizationGrid::over(points, compression.position_bits),
    };
    let grid = grid.ok_or("is too large or too small for a node's scale")?;
    let layers = meshes.iter().filter_map(|mesh| mesh.attributes.as_ref()).flat_map(|a| &a.layers);
    let mut deltas = layers
        .filter(|layer| matches!(parse_target_name(&layer.name), Some((_, "POSITION"))))
        .flat_map(|layer| &layer.values);
    match deltas.all(|&x| (f64::from(x) / grid.cell).abs() <= MOST_CELLS) {
        true => Ok(grid),
        false => Err("has a morph target far larger than itself"),
    }
}

/// Returns the reason why no node transform can undo the grid of a mesh; `None` if one can.
fn why_floats(json: &Value, mesh: usize) -> Option<&'static str> {
    let array = |value: &'_ Value, key: &str| {
        value.get(key).and_then(Value::as_array).cloned().unwrap_or_default()
    };
    let primitives = array(&json["meshes"][mesh], "primitives");
    if !primitives.iter().all(is_surface) {
        return Some("has points or lines");
    }
    // A material's thickness is in the mesh's own units, which quantization changes.
    let volumes = array(json, "materials");
    let has_volume = |i: usize| {
        volumes.get(i).is_some_and(|m| m["extensions"]["KHR_materials_volume"].is_object())
    };
    let mut named = BTreeSet::new();
    primitives.iter().for_each(|primitive| name_materials(primitive, &mut named));
    if named.into_iter().any(has_volume) {
        return Some("has a material with thickness");
    }
    for node in array(json, "nodes").iter().filter(|node| node["mesh"] == mesh) {
        let extensions = node.get("extensions").and_then(Value::as_object);
        let harmless = ["MSFT_lod", "KHR_lights_punctual", "KHR_node_visibility"];
        if extensions.into_iter().flatten().any(|(name, _)| !harmless.contains(&&name[..])) {
            return Some("is shown by a node with an extension");
        }
    }
    None
}

/// Collects the materials of a primitive, including those of its variants.
fn name_materials(value: &Value, into: &mut BTreeSet<usize>) {
    match value {
        Value::Array(values) => values.iter().for_each(|value| name_materials(value, into)),
        Value::Object(entries) => {
            for (key, value) in entries {
                match value.as_u64().filter(|_| key == "material") {
                    Some(material) => drop(into.insert(material as usize)),
                    None => name_materials(value, into),
                }
            }
        }
        _ => {}
    }
}
