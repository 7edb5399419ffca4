//! Grids in the nodes: the transform that turns cells back into places.

use serde_json::{Value, json};

use super::compress::QuantizationGrid;
use super::lod::{give_to_child, moving};

/// Lets every node that shows a mesh with a grid scale and move it to its place.
///
/// A node that has no transform, no children and does not move takes it on; else a new child takes
/// the mesh and the transform, and is not the parent of anything.
pub(super) fn add_transforms(json: &mut Value, grids: &[Option<QuantizationGrid>]) {
    let count = json.get("nodes").and_then(Value::as_array).map_or(0, Vec::len);
    let moving = moving(json);
    for node in 0..count {
        let mesh = json["nodes"][node].get("mesh").and_then(Value::as_u64);
        let grid = mesh.and_then(|mesh| grids.get(mesh as usize).copied().flatten());
        let Some(grid) = grid else { continue };
        let own =
            ["matrix", "translation", "rotation", "scale", "children", "camera", "extensions"];
        let busy = own.iter().any(|key| json["nodes"][node].get(key).is_some());
        let at = if busy || moving.contains(&node) { give_to_child(json, node) } else { node };
        json["nodes"][at]["translation"] = json!(grid.origin);
        json["nodes"][at]["scale"] = [grid.cell; 3].as_slice().into();
    }
}
