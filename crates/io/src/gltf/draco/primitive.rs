//! Compressed primitives of a document.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::Value;

use crate::error::ParseError;

/// Compressed primitive.
pub(crate) struct Compressed {
    pub place: Place,
    pub extension: Extension,
}

/// `meshes[i].primitives[j].extensions.KHR_draco_mesh_compression`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Extension {
    pub buffer_view: usize,
    /// Attribute → its id in the stream.
    #[cfg_attr(not(feature = "draco"), expect(dead_code, reason = "only checked"))]
    pub attributes: BTreeMap<String, u32>,
}

/// Indices of a mesh and of one of its primitives.
#[derive(Clone, Copy)]
pub(crate) struct Place(pub usize, pub usize);

impl Place {
    pub fn wrong(self, reason: impl Into<String>) -> ParseError {
        ParseError::part(format!("mesh {}, primitive {}", self.0, self.1), reason)
    }

    /// Returns the JSON of the primitive.
    pub fn of(self, json: &Value) -> &Value {
        &json["meshes"][self.0]["primitives"][self.1]
    }
}
