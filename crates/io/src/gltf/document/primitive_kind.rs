//! Primitives of a mesh: whether they are surfaces, and their attributes.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use super::schema;

/// Reports whether a primitive consists of triangles.
pub(crate) fn is_surface(primitive: &Value) -> bool {
    matches!(primitive.get("mode").and_then(Value::as_u64), None | Some(4..=6))
}

/// Returns the accessors of a primitive's attributes by layer name.
pub(crate) fn attributes(primitive: &Value) -> BTreeMap<String, usize> {
    let typed = <schema::Primitive as serde::Deserialize>::deserialize(primitive);
    typed.ok().and_then(|primitive| primitive.accessors().ok()).into_iter().flatten().collect()
}

/// Collects the attributes of all primitives.
pub(crate) fn known_attributes(primitives: &[Value]) -> BTreeSet<String> {
    primitives.iter().flat_map(attributes).map(|(name, _)| name).collect()
}
