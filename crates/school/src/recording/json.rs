//! JSON files with a line end.

use serde::Serialize;

/// Returns a value as JSON in lines, for people.
pub fn pretty(value: &impl Serialize) -> Vec<u8> {
    with_line_end(serde_json::to_vec_pretty(value))
}

/// Returns a value as JSON in one line, for long lists.
pub fn compact(value: &impl Serialize) -> Vec<u8> {
    with_line_end(serde_json::to_vec(value))
}

fn with_line_end(bytes: serde_json::Result<Vec<u8>>) -> Vec<u8> {
    let mut bytes = bytes.expect("strings are the only keys");
    bytes.push(b'\n');
    bytes
}
