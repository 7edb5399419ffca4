//! Mends of a document before it is read, each with a note.

use std::collections::BTreeSet;

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
    let mut count = 0;
    let mut dropped = BTreeSet::new();
    let meshes = json.get_mut("meshes").and_then(Value::as_array_mut);
    let primitives = meshes.into_iter().flatten().filter_map(|mesh| mesh.get_mut("primitives"));
    let primitives = primitives.filter_map(Value::as_array_mut).flatten();
    for primitive in primitives.filter(|primitive| is_surface(primitive)) {
        let extensions = primitive.get("extensions").and_then(Value::as_object);
        let may_name = |(name, value): &(&String, &Value)| {
            !WITHOUT_VERTICES.contains(&&name[..]) && has_integer(value)
        };
        let named = extensions.into_iter().flatten().filter(may_name);
        for name in named.map(|(name, _)| name.clone()).collect::<Vec<_>>() {
            drop_entry(primitive, &name);
            dropped.insert(name);
            count += 1;
        }
    }
    if count == 0 {
        return None;
    }
    let mut left = BTreeSet::new();
    add_names(json, &mut left);
    let gone: Vec<&str> = dropped.difference(&left).map(String::as_str).collect();
    forget_names(json, &gone);
    let note = Note::left_out(
        count,
        "extension of a primitive that may name vertices",
        "extensions of primitives that may name vertices",
    );
    Some(note.named(dropped))
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

/// Adds the names of all extensions that entries of a document have.
fn add_names(value: &Value, names: &mut BTreeSet<String>) {
    match value {
        Value::Array(values) => values.iter().for_each(|value| add_names(value, names)),
        Value::Object(entries) => {
            let own = entries.get("extensions").and_then(Value::as_object);
            names.extend(own.into_iter().flat_map(|own| own.keys().cloned()));
            entries.values().for_each(|value| add_names(value, names));
        }
        _ => {}
    }
}

/// Makes trees of the scene that is shown where it lists children of nodes, as some exporters write
/// them: a node below another that the scene lists is shown there alone, and any other leaves its
/// parent, and the place that this gives it.
pub(super) fn part_roots_from_children(json: &mut Value) -> [Option<Note>; 2] {
    let parents = parents(json);
    let shown = shown_scene(json);
    let roots = json.pointer_mut("/scenes").and_then(Value::as_array_mut);
    let roots = roots.and_then(|scenes| scenes.get_mut(shown)?.get_mut("nodes")?.as_array_mut());
    let Some(roots) = roots else { return [None, None] };
    let mut is_listed = vec![false; parents.len()];
    for root in roots.iter().filter_map(index) {
        is_listed.get_mut(root).into_iter().for_each(|listed| *listed = true);
    }
    let is_shown = at_or_below(&parents, &is_listed);
    let mut is_orphan = vec![false; parents.len()];
    let (mut below, mut orphans) = (0, 0);
    roots.retain(|root| {
        let root = index(root).filter(|&root| root < parents.len());
        match root.and_then(|root| Some((root, parents[root]?))) {
            Some((_, parent)) if is_shown[parent] => {
                below += 1;
                false
            }
            Some((root, _)) => {
                orphans += usize::from(!std::mem::replace(&mut is_orphan[root], true));
                true
            }
            None => true,
        }
    });
    if orphans > 0 {
        let nodes = json.get_mut("nodes").and_then(Value::as_array_mut);
        nodes.into_iter().flatten().for_each(|node| leave(node, &is_orphan));
    }
    let notes = [
        (
            below,
            "node that the scene lists although it is another's child, shown once",
            "nodes that the scene lists although they are children of others, each shown once",
        ),
        (
            orphans,
            "node that the scene lists alone, shown without its parent's transform",
            "nodes that the scene lists alone, shown without their parents' transforms",
        ),
    ];
    notes.map(|(count, one, many)| (count > 0).then(|| Note::changed(count, one, many)))
}

/// Returns for each node whether it or one above it is listed.
fn at_or_below(parents: &[Option<usize>], is_listed: &[bool]) -> Vec<bool> {
    let mut known: Vec<Option<bool>> = vec![None; parents.len()];
    let mut path = Vec::new();
    for node in 0..parents.len() {
        let mut at = Some(node);
        while let Some(above) = at.filter(|&above| known[above].is_none()) {
            // Met again in a circle, which is an error later, it counts as listed.
            known[above] = Some(true);
            path.push(above);
            at = parents[above];
        }
        let mut is_shown = at.and_then(|above| known[above]).unwrap_or(false);
        for below in path.drain(..).rev() {
            is_shown |= is_listed[below];
            known[below] = Some(is_shown);
        }
    }
    known.into_iter().map(|known| known.unwrap_or(false)).collect()
}

/// Takes children from a node.
fn leave(node: &mut Value, is_orphan: &[bool]) {
    let Some(node) = node.as_object_mut() else { return };
    let Some(children) = node.get_mut("children").and_then(Value::as_array_mut) else { return };
    let goes = |child: usize| is_orphan.get(child).copied().unwrap_or(false);
    children.retain(|child| !index(child).is_some_and(goes));
    if children.is_empty() {
        // An empty list is not allowed.
        node.shift_remove("children");
    }
}

/// Returns the index of the scene that is shown.
pub(super) fn shown_scene(json: &Value) -> usize {
    json.get("scene").and_then(index).unwrap_or(0)
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

/// Reads an index of an entry.
pub(super) fn index(value: &Value) -> Option<usize> {
    value.as_u64().and_then(|index| usize::try_from(index).ok())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_listed_child_is_shown_once() {
        let mended = |mut json: Value| {
            let counts =
                part_roots_from_children(&mut json).map(|note| note.map_or(0, |note| note.count));
            (counts, json)
        };
        let nodes = json!([{"children": [1]}, {"children": [2]}, {}]);
        let (counts, json) = mended(json!({ "scenes": [{"nodes": [0, 1, 2]}], "nodes": nodes }));
        assert_eq!((counts, &json["scenes"][0]["nodes"]), ([2, 0], &json!([0])));
        let (counts, json) = mended(json!({ "scenes": [{"nodes": [2]}], "nodes": nodes }));
        assert_eq!((counts, &json["scenes"][0]["nodes"]), ([0, 1], &json!([2])));
        assert_eq!(json["nodes"], json!([{"children": [1]}, {}, {}]));
        // What another scene lists says nothing of the one that is shown.
        let other = json!({ "scenes": [{"nodes": [0]}, {"nodes": [1]}], "nodes": nodes });
        assert_eq!(mended(other.clone()), ([0, 0], other));
        let circle = json!([{"children": [1]}, {"children": [0]}]);
        mended(json!({ "scenes": [{"nodes": [0]}], "nodes": circle }));
    }

    #[test]
    fn long_chains_and_lists_are_mended_in_linear_time() {
        let count = 100_000;
        let node = |i: usize| if i + 1 < count { json!({"children": [i + 1]}) } else { json!({}) };
        let nodes: Vec<Value> = (0..count).map(node).collect();
        let listed: Vec<usize> = (count / 2..count).collect();
        let mut json = json!({ "scenes": [{ "nodes": listed }], "nodes": nodes });
        let [below, orphans] = part_roots_from_children(&mut json).map(|note| note.unwrap().count);
        assert_eq!((below, orphans), (count / 2 - 1, 1));
    }

    #[test]
    fn extensions_that_may_name_vertices_go_and_others_stay() {
        let mut json = json!({
            "extensionsUsed": ["CESIUM_primitive_outline", "KHR_materials_variants", "OWN"],
            "extensions": {"OWN": {}},
            "meshes": [{"primitives": [{"extensions": {
                "CESIUM_primitive_outline": {"indices": 3},
                "KHR_materials_variants": {"mappings": [{"material": 0, "variants": [0]}]},
                "VENDOR_flag": {"closed": true, "part": 0.5},
                "OWN": {"vertices": [[1, 2]]},
            }}, {"mode": 1, "extensions": {"VENDOR_lines": {"indices": 1}}}]}],
        });
        let note = drop_vertex_names(&mut json).unwrap();
        assert_eq!(
            (note.count, note.names),
            (2, ["CESIUM_primitive_outline", "OWN"].map(String::from).to_vec())
        );
        let primitives = &json["meshes"][0]["primitives"];
        let left = primitives[0]["extensions"].as_object().unwrap();
        assert!(left.keys().eq(["KHR_materials_variants", "VENDOR_flag"]));
        assert!(primitives[1]["extensions"]["VENDOR_lines"].is_object());
        assert_eq!(json["extensionsUsed"], json!(["KHR_materials_variants", "OWN"]));
    }
}
