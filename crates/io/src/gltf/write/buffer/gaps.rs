//! Removal of the free entries among accessors and buffer views, whose references are renumbered.

use serde_json::{Map, Value};

use crate::gltf::document::extensions::{INSTANCING, is_understood};

/// Places of the document that refer to accessors; `*` stands for every entry.
const ACCESSORS: [&[&str]; 7] = [
    &["meshes", "*", "primitives", "*", "indices"],
    &["meshes", "*", "primitives", "*", "attributes", "*"],
    &["meshes", "*", "primitives", "*", "targets", "*", "*"],
    &["skins", "*", "inverseBindMatrices"],
    &["nodes", "*", "extensions", INSTANCING, "attributes", "*"],
    &["animations", "*", "samplers", "*", "input"],
    &["animations", "*", "samplers", "*", "output"],
];

/// Reports whether all references to accessors and views can be found: unknown extensions may hold
/// others.
pub(crate) fn knows_references(json: &Map<String, Value>) -> bool {
    json.iter().all(|(key, value)| match (key.as_str(), value) {
        ("extensions", Value::Object(extensions)) => {
            extensions.iter().all(|(name, own)| is_understood(name) && knows_within(own))
        }
        ("extras", _) => true,
        (_, value) => knows_within(value),
    })
}

fn knows_within(value: &Value) -> bool {
    match value {
        Value::Array(values) => values.iter().all(knows_within),
        Value::Object(entries) => knows_references(entries),
        _ => true,
    }
}

/// Removes the free accessors, and makes the document refer to the new indices of the others.
pub(crate) fn close_accessors(
    json: &mut Map<String, Value>,
    accessors: &mut Vec<Value>,
    free: &[usize],
) {
    let new = remove(accessors, free);
    for path in ACCESSORS {
        let Some((key, rest)) = path.split_first() else { continue };
        if let Some(value) = json.get_mut(*key) {
            renumber_at(value, rest, &new);
        }
    }
}

/// Removes the free views, and makes the document and its accessors refer to the new indices of the
/// others.
pub(crate) fn close_views(
    json: &mut Map<String, Value>,
    accessors: &mut [Value],
    views: &mut Vec<Value>,
    free: &[usize],
) {
    let new = remove(views, free);
    renumber_views_of(json, &new);
    accessors.iter_mut().for_each(|value| renumber_views(value, &new));
}

/// Removes these entries; returns the new index of each entry that stays.
fn remove(values: &mut Vec<Value>, free: &[usize]) -> Vec<usize> {
    let mut is_free = vec![false; values.len()];
    free.iter().for_each(|&at| is_free[at] = true);
    let mut is_removed = is_free.iter();
    values.retain(|_| is_removed.next() == Some(&false));
    let mut next = 0;
    let index = |&free: &bool| {
        let index = next;
        next += usize::from(!free);
        index
    };
    is_free.iter().map(index).collect()
}

/// Renumbers the references at a path within a value.
fn renumber_at(value: &mut Value, path: &[&str], new: &[usize]) {
    match (path.split_first(), value) {
        (None, value) => renumber(value, new),
        (Some((&"*", rest)), Value::Array(values)) => {
            values.iter_mut().for_each(|value| renumber_at(value, rest, new));
        }
        (Some((&"*", rest)), Value::Object(entries)) => {
            entries.iter_mut().for_each(|(_, value)| renumber_at(value, rest, new));
        }
        (Some((key, rest)), value) => {
            if let Some(value) = value.get_mut(*key) {
                renumber_at(value, rest, new);
            }
        }
    }
}

/// Renumbers the numbers under the key `bufferView`; the JSON parser bounds the depth.
fn renumber_views(value: &mut Value, new: &[usize]) {
    match value {
        Value::Array(values) => values.iter_mut().for_each(|value| renumber_views(value, new)),
        Value::Object(entries) => renumber_views_of(entries, new),
        _ => {}
    }
}

/// Renumbers the views of an object, but for its extras, whose keys mean what the application says.
fn renumber_views_of(entries: &mut Map<String, Value>, new: &[usize]) {
    for (key, value) in entries {
        match key.as_str() {
            "bufferView" => renumber(value, new),
            "extras" => {}
            _ => renumber_views(value, new),
        }
    }
}

fn renumber(reference: &mut Value, new: &[usize]) {
    if let Some(&index) = reference.as_u64().and_then(|old| new.get(old as usize)) {
        *reference = index.into();
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn object(json: Value) -> Map<String, Value> {
        json.as_object().cloned().unwrap()
    }

    #[test]
    fn every_reference_follows_its_accessor() {
        let mut json = object(json!({
            "meshes": [{ "primitives": [
                { "attributes": { "POSITION": 1 }, "indices": 3, "targets": [{ "NORMAL": 4 }] },
            ] }],
            "skins": [{ "inverseBindMatrices": 5 }],
            "nodes": [{ "extensions": { INSTANCING: { "attributes": { "SCALE": 6 } } } }],
            "animations": [{ "samplers": [{ "input": 7, "output": 8 }] }],
        }));
        let mut accessors: Vec<Value> = (0..9).map(Value::from).collect();
        close_accessors(&mut json, &mut accessors, &[2, 0]);
        assert_eq!(accessors, [1, 3, 4, 5, 6, 7, 8]);
        let expected = json!({
            "meshes": [{ "primitives": [
                { "attributes": { "POSITION": 0 }, "indices": 1, "targets": [{ "NORMAL": 2 }] },
            ] }],
            "skins": [{ "inverseBindMatrices": 3 }],
            "nodes": [{ "extensions": { INSTANCING: { "attributes": { "SCALE": 4 } } } }],
            "animations": [{ "samplers": [{ "input": 5, "output": 6 }] }],
        });
        assert_eq!(Value::Object(json), expected);
    }

    #[test]
    fn images_and_sparse_values_follow_their_views() {
        let mut json = object(json!({ "images": [{ "bufferView": 3 }, { "uri": "a.png" }] }));
        let mut accessors =
            [json!({ "bufferView": 1, "sparse": { "values": { "bufferView": 2 } } })];
        let mut views: Vec<Value> = (0..4).map(Value::from).collect();
        close_views(&mut json, &mut accessors, &mut views, &[0]);
        assert_eq!(views, [1, 2, 3]);
        assert_eq!(json["images"][0]["bufferView"], 2);
        let sparse = json!({ "bufferView": 0, "sparse": { "values": { "bufferView": 1 } } });
        assert_eq!(accessors, [sparse]);
    }

    #[test]
    fn extras_keep_their_numbers() {
        let extras = json!({ "bufferView": 1 });
        let mut json = object(json!({ "extras": extras, "images": [{ "extras": extras }] }));
        let mut accessors = [json!({ "bufferView": 1, "extras": [extras] })];
        close_views(&mut json, &mut accessors, &mut vec![Value::Null; 2], &[0]);
        assert_eq!(json, object(json!({ "extras": extras, "images": [{ "extras": extras }] })));
        assert_eq!(accessors, [json!({ "bufferView": 0, "extras": [extras] })]);
    }

    #[test]
    fn unknown_extensions_may_refer_to_anything() {
        let with = |name: &str| {
            let extensions = json!({ name: { "indices": 1 } });
            object(json!({ "extras": { "extensions": { "X": 1 } },
                           "nodes": [{ "extensions": extensions }] }))
        };
        assert!(knows_references(&with("KHR_lights_punctual")));
        assert!(!knows_references(&with("CESIUM_primitive_outline")));
    }
}
