//! Node transforms that map quantized positions back to model space.

use serde_json::{Value, json};

use super::grid::QuantizationGrid;
use crate::gltf::write::node_edits::{give_to_child, moving};

/// Makes every node that shows a quantized mesh scale and translate it back to model space.
///
/// The transform goes into the node itself if it has no transform, no children and is not moved by
/// animations or skins; otherwise into a new leaf child that takes over the mesh.
pub(crate) fn add_transforms(json: &mut Value, grids: &[Option<QuantizationGrid>]) {
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
