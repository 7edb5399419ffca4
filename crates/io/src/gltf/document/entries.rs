//! Arrays of a document.

use serde_json::Value;

/// Iterates over an array of a document; empty if absent.
pub(crate) fn entries<'a>(json: &'a Value, key: &str) -> impl Iterator<Item = &'a Value> {
    json.get(key).and_then(Value::as_array).into_iter().flatten()
}

/// Appends to an array of the document, creating it if needed; returns the index of the first
/// entry.
pub(crate) fn extend(json: &mut Value, key: &str, new: Vec<Value>) -> usize {
    let mut values = match json[key].take() {
        Value::Array(values) => values,
        _ => Vec::new(),
    };
    let first = values.len();
    values.extend(new);
    json[key] = values.into();
    first
}
