//! JSON of glTF files, to compare scenes by.

use std::path::Path;

use serde_json::Value;

/// Returns the JSON of a glTF or GLB file, without what says where arrays are.
pub fn document(path: &Path) -> Value {
    let bytes = std::fs::read(path).unwrap();
    let text = match bytes.strip_prefix(b"glTF") {
        None => &bytes[..],
        Some(rest) => {
            let length = u32::from_le_bytes(rest[8..12].try_into().unwrap()) as usize;
            &rest[16..16 + length]
        }
    };
    let mut json: Value = serde_json::from_slice(text).unwrap();
    let rest = json.as_object_mut().unwrap();
    for key in ["accessors", "bufferViews", "buffers", "asset"] {
        rest.remove(key);
    }
    forget_arrays(&mut json);
    json
}

fn forget_arrays(json: &mut Value) {
    match json {
        Value::Array(values) => values.iter_mut().for_each(forget_arrays),
        Value::Object(entries) => {
            // Images may have moved from files into the buffer.
            let places =
                ["bufferView", "uri", "mimeType", "inverseBindMatrices", "input", "output"];
            places.iter().for_each(|place| drop(entries.remove(*place)));
            entries.remove("mode");
            if entries.contains_key("attributes") {
                entries.remove("indices");
            }
            for (key, value) in entries.iter_mut() {
                match (key.as_str(), value) {
                    ("attributes", Value::Object(names)) => {
                        let mut list: Vec<_> = names.keys().cloned().collect();
                        list.sort();
                        *names = list.into_iter().map(|name| (name, Value::Null)).collect();
                    }
                    (_, value) => forget_arrays(value),
                }
            }
        }
        _ => {}
    }
}
