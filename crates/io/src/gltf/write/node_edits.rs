//! Changes to the nodes of a document that keep its animations and skins working.

use std::collections::BTreeSet;

use serde_json::{Map, Value};

use crate::gltf::document::entries::extend;

/// Finds the nodes moved by animations or skins; a sibling node would not follow them.
pub(crate) fn moving(json: &Value) -> BTreeSet<usize> {
    let array = |value: &Value, key: &str| {
        value.get(key).and_then(Value::as_array).cloned().unwrap_or_default()
    };
    let channels = array(json, "animations").into_iter().flat_map(|a| array(&a, "channels"));
    let animated = channels.map(|channel| channel["target"]["node"].clone());
    let joints = array(json, "skins").into_iter().flat_map(|skin| array(&skin, "joints"));
    animated.chain(joints).filter_map(|node| node.as_u64()).map(|node| node as usize).collect()
}

/// Moves the mesh of a node, with its skin and weights, to a new child and returns the child.
pub(crate) fn give_to_child(json: &mut Value, node: usize) -> usize {
    let mut child = Map::new();
    if let Some(parent) = json["nodes"][node].as_object_mut() {
        for key in ["mesh", "skin", "weights"] {
            if let Some(value) = parent.shift_remove(key) {
                child.insert(key.into(), value);
            }
        }
    }
    let number = extend(json, "nodes", vec![child.into()]);
    extend(&mut json["nodes"][node], "children", vec![number.into()]);
    // Animations of morph target weights follow the mesh.
    let animations = json.get_mut("animations").and_then(Value::as_array_mut);
    let channels = animations
        .into_iter()
        .flatten()
        .filter_map(|animation| animation.get_mut("channels")?.as_array_mut())
        .flatten();
    for target in channels.filter_map(|channel| channel.get_mut("target")) {
        if target["path"] == "weights" && target["node"] == node {
            target["node"] = number.into();
        }
    }
    number
}
