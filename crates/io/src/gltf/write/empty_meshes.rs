//! Meshes that have lost all their faces, removed from nodes.

use serde_json::{Map, Value};

/// Removes these meshes from nodes, with their skins, weights and instances, and drops animations
/// of the weights: glTF allows neither for a node without a mesh.
pub(crate) fn detach_meshes(json: &mut Value, gone: &[usize]) {
    if gone.is_empty() {
        return;
    }
    let mut bare = Vec::new();
    let nodes = json.get_mut("nodes").and_then(Value::as_array_mut);
    for (index, node) in nodes.into_iter().flatten().enumerate() {
        let mesh = node["mesh"].as_u64();
        let Some(node) = node.as_object_mut() else { continue };
        if mesh.is_some_and(|mesh| gone.binary_search(&(mesh as usize)).is_ok()) {
            ["mesh", "skin", "weights"].iter().for_each(|key| drop(node.shift_remove(*key)));
            drop_inner(node, "extensions", "EXT_mesh_gpu_instancing");
            bare.push(index as u64);
        }
    }
    let is_of_bare = |channel: &Value| {
        let target = &channel["target"];
        target["path"] == "weights"
            && target["node"].as_u64().is_some_and(|n| bare.binary_search(&n).is_ok())
    };
    if let Some(animations) = json.get_mut("animations").and_then(Value::as_array_mut) {
        animations.retain_mut(|animation| {
            let channels = animation.get_mut("channels").and_then(Value::as_array_mut);
            channels.is_none_or(|channels| {
                let count = channels.len();
                channels.retain(|channel| !is_of_bare(channel));
                count == 0 || !channels.is_empty()
            })
        });
        if let (true, Some(json)) = (animations.is_empty(), json.as_object_mut()) {
            json.shift_remove("animations");
        }
    }
    let meshes = json.get_mut("meshes").and_then(Value::as_array_mut);
    for (index, mesh) in meshes.into_iter().flatten().enumerate() {
        if let Some(mesh) = mesh.as_object_mut().filter(|_| gone.binary_search(&index).is_ok()) {
            mesh.shift_remove("weights");
            drop_inner(mesh, "extras", "targetNames");
            // Its one triangle has no texture coordinates.
            let primitives = mesh.get_mut("primitives").and_then(Value::as_array_mut);
            let primitives = primitives.into_iter().flatten().filter_map(Value::as_object_mut);
            primitives.for_each(|primitive| drop(primitive.shift_remove("material")));
        }
    }
}

/// Removes an entry of a nested object, and the nested object if it becomes empty.
fn drop_inner(of: &mut Map<String, Value>, outer: &str, inner: &str) {
    let Some(object) = of.get_mut(outer).and_then(Value::as_object_mut) else { return };
    if object.shift_remove(inner).is_some() && object.is_empty() {
        of.shift_remove(outer);
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn nodes_of_lost_meshes_keep_all_else() {
        let weights =
            |node: u32| json!({ "sampler": 0, "target": { "node": node, "path": "weights" } });
        let mut json = json!({
            "nodes": [
                { "name": "a", "mesh": 0, "skin": 0, "weights": [1.0], "children": [1],
                  "extensions": { "EXT_mesh_gpu_instancing": {} } },
                { "name": "b", "mesh": 1, "weights": [0.5] },
            ],
            "meshes": [
                { "weights": [0.0], "extras": { "targetNames": ["x"], "more": 1 }, "primitives": [{ "material": 3 }] },
                { "weights": [0.0], "primitives": [{}] },
            ],
            "animations": [
                { "channels": [weights(0)] },
                { "channels": [weights(0), weights(1)] },
            ],
        });
        let whole = json.clone();
        detach_meshes(&mut json, &[]);
        assert_eq!(json, whole);
        detach_meshes(&mut json, &[0]);
        assert_eq!(json["nodes"][0], json!({ "name": "a", "children": [1] }));
        assert_eq!(json["nodes"][1], whole["nodes"][1]);
        assert_eq!(json["meshes"][0], json!({ "extras": { "more": 1 }, "primitives": [{}] }));
        assert_eq!(json["meshes"][1], whole["meshes"][1]);
        assert_eq!(json["animations"], json!([{ "channels": [weights(1)] }]));
        detach_meshes(&mut json, &[1]);
        assert_eq!(json.get("animations"), None);
    }
}
