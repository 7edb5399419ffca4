//! Mends of a document before it is read, each with a note.

use serde_json::Value;

use crate::gltf::document::extensions::{drop_entry, forget_names};
use crate::gltf::document::primitive_kind::is_surface;
use crate::notes::Note;

/// Extensions of primitives that name no vertices, whatever numbers they have.
const WITHOUT_VERTICES: [&str; 3] =
    ["KHR_materials_variants", "EXT_mesh_features", "EXT_structural_metadata"];

/// Removes extensions of triangle primitives that may name vertices, which will be others, such as
/// `CESIUM_primitive_outline`. Extensions that we read have been removed before.
pub(super) fn drop_vertex_names(json: &mut Value) -> Option<Note> {
    let mut dropped: Vec<String> = Vec::new();
    let mut kept: Vec<String> = Vec::new();
    let meshes = json.get_mut("meshes").and_then(Value::as_array_mut);
    let primitives = meshes.into_iter().flatten().filter_map(|mesh| mesh.get_mut("primitives"));
    for primitive in primitives.filter_map(Value::as_array_mut).flatten() {
        let Some(extensions) = primitive.get("extensions").and_then(Value::as_object) else {
            continue;
        };
        let named = |(name, value): (&String, &Value)| {
            let may_name = !WITHOUT_VERTICES.contains(&&name[..]) && has_integer(value);
            (name.clone(), may_name)
        };
        let is_changed = is_surface(primitive);
        for (name, may_name) in extensions.iter().map(named).collect::<Vec<_>>() {
            if may_name && is_changed {
                drop_entry(primitive, &name);
                dropped.push(name);
            } else {
                kept.push(name);
            }
        }
    }
    let count = dropped.len();
    dropped.sort_unstable();
    dropped.dedup();
    let gone: Vec<&str> =
        dropped.iter().filter(|name| !kept.contains(name)).map(String::as_str).collect();
    forget_names(json, &gone);
    let note = Note::left_out(
        count,
        "extension of a primitive that may name vertices",
        "extensions of primitives that may name vertices",
    );
    (count > 0).then(|| note.named(dropped))
}

/// Returns true if there is a number in a value that could be an index.
fn has_integer(value: &Value) -> bool {
    match value {
        Value::Number(number) => number.is_u64(),
        Value::Array(values) => values.iter().any(has_integer),
        Value::Object(entries) => entries.values().any(has_integer),
        _ => false,
    }
}

/// Makes trees of scenes that list children of nodes, as some exporters write them: a node below
/// another that its scene lists is shown there alone, and any other leaves its parent.
pub(super) fn part_roots_from_children(json: &mut Value) -> Option<Note> {
    let parents = parents(json);
    let mut orphans = Vec::new();
    let mut count = 0;
    let scenes = json.get_mut("scenes").and_then(Value::as_array_mut);
    let lists = scenes.into_iter().flatten().filter_map(|scene| scene.get_mut("nodes"));
    for roots in lists.filter_map(Value::as_array_mut) {
        let mut is_listed = vec![false; parents.len()];
        for root in roots.iter().filter_map(index) {
            is_listed.get_mut(root).into_iter().for_each(|listed| *listed = true);
        }
        roots.retain(|root| {
            let Some(root) =
                index(root).filter(|&root| parents.get(root).is_some_and(|p| p.is_some()))
            else {
                return true;
            };
            count += 1;
            let above = std::iter::successors(parents[root], |&node| parents[node]);
            // More steps than nodes are a circle, which is found later.
            let is_below = above.take(parents.len()).any(|node| is_listed[node]);
            if !is_below {
                orphans.push(root);
            }
            !is_below
        });
    }
    let nodes = json.get_mut("nodes").and_then(Value::as_array_mut);
    for node in nodes.into_iter().flatten().filter(|_| !orphans.is_empty()) {
        leave(node, &orphans);
    }
    let note = Note::changed(
        count,
        "node that a scene lists although it is another's child, shown once",
        "nodes that a scene lists although they are children of others, each shown once",
    );
    (count > 0).then_some(note)
}

/// Takes children from a node.
fn leave(node: &mut Value, orphans: &[usize]) {
    let Some(node) = node.as_object_mut() else { return };
    let Some(children) = node.get_mut("children").and_then(Value::as_array_mut) else { return };
    children.retain(|child| index(child).is_none_or(|child| !orphans.contains(&child)));
    if children.is_empty() {
        // An empty list is not allowed.
        node.shift_remove("children");
    }
}

/// Returns the parent of each node, the last one if there are several, which is an error later.
pub(super) fn parents(json: &Value) -> Vec<Option<usize>> {
    let nodes = json.get("nodes").and_then(Value::as_array).map_or(&[][..], |nodes| nodes);
    let mut parents = vec![None; nodes.len()];
    for (i, node) in nodes.iter().enumerate() {
        let children = node.get("children").and_then(Value::as_array);
        for child in children.into_iter().flatten().filter_map(index) {
            if let Some(parent) = parents.get_mut(child) {
                *parent = Some(i);
            }
        }
    }
    parents
}

fn index(value: &Value) -> Option<usize> {
    value.as_u64().and_then(|index| usize::try_from(index).ok())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_listed_child_is_shown_once() {
        let mut both = json!({
            "scenes": [{"nodes": [0, 1, 2]}], "nodes": [{"children": [1]}, {"children": [2]}, {}]
        });
        let note = part_roots_from_children(&mut both).unwrap();
        assert_eq!((note.count, &both["scenes"][0]["nodes"]), (2, &json!([0])));
        let mut alone = json!({ "scenes": [{"nodes": [1]}], "nodes": [{"children": [1]}, {}] });
        assert!(part_roots_from_children(&mut alone).is_some());
        assert_eq!(alone["scenes"][0]["nodes"], json!([1]));
        assert_eq!(alone["nodes"], json!([{}, {}]));
        let mut circle = json!({
            "scenes": [{"nodes": [0]}], "nodes": [{"children": [1]}, {"children": [0]}, {}]
        });
        assert!(part_roots_from_children(&mut circle).is_some());
        let mut sound = json!({ "scenes": [{"nodes": [0]}], "nodes": [{"children": [1]}, {}] });
        assert!(part_roots_from_children(&mut sound).is_none());
    }

    #[test]
    fn extensions_that_may_name_vertices_go_and_others_stay() {
        let mut json = json!({
            "extensionsUsed": ["CESIUM_primitive_outline", "KHR_materials_variants"],
            "meshes": [{"primitives": [{"extensions": {
                "CESIUM_primitive_outline": {"indices": 3},
                "KHR_materials_variants": {"mappings": [{"material": 0, "variants": [0]}]},
                "VENDOR_flag": {"closed": true, "part": 0.5},
            }}, {"mode": 1, "extensions": {"VENDOR_lines": {"indices": 1}}}]}],
        });
        let note = drop_vertex_names(&mut json).unwrap();
        assert_eq!((note.count, note.names), (1, vec!["CESIUM_primitive_outline".to_owned()]));
        let primitives = &json["meshes"][0]["primitives"];
        let left = primitives[0]["extensions"].as_object().unwrap();
        assert!(left.keys().eq(["KHR_materials_variants", "VENDOR_flag"]));
        assert!(primitives[1]["extensions"]["VENDOR_lines"].is_object());
        assert_eq!(json["extensionsUsed"], json!(["KHR_materials_variants"]));
    }
}
