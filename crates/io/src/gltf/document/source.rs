//! Source document of a scene read from glTF.

use std::sync::Arc;

use serde_json::Value;

use super::buffers::Buffers;
use super::facts;
use super::facts::{AnimationFacts, FileFacts};
use crate::options::Weld;

/// glTF document of a scene; when the scene is written, everything except the geometry is copied
/// from it.
///
/// Cloning is cheap.
#[derive(Clone, Debug)]
pub struct SourceDocument(pub(crate) Arc<Contents>);

impl SourceDocument {
    /// Returns the number of entries of an array of the document, such as `animations`.
    pub fn count(&self, array: &str) -> usize {
        self.0.json.get(array).and_then(Value::as_array).map_or(0, Vec::len)
    }

    /// Returns the largest scale of texture coordinates by `KHR_texture_transform` in any material;
    /// at least 1.
    pub fn largest_texture_scale(&self) -> f64 {
        self.0.json.get("materials").map_or(1.0, largest_texture_scale)
    }

    /// Reports whether the document may store normals as bytes.
    pub(crate) fn is_quantized(&self) -> bool {
        let used = self.0.json.get("extensionsUsed").and_then(Value::as_array);
        used.into_iter().flatten().any(|name| name == "KHR_mesh_quantization")
    }

    /// Returns the extensions and the sizes of the file.
    pub fn file_facts(&self) -> &FileFacts {
        &self.0.facts
    }

    /// Lists the animations of the document.
    pub fn animations(&self) -> Vec<AnimationFacts> {
        facts::animations(&self.0.json)
    }

    /// Returns the number of joints of each skin.
    pub fn joints(&self) -> Vec<usize> {
        facts::joints(&self.0.json)
    }

    /// Returns the number of nodes with a light.
    pub fn lights(&self) -> usize {
        facts::lights(&self.0.json)
    }

    /// Returns for each primitive of a mesh whether it lacks normals.
    pub(crate) fn lacks_normals(&self, mesh: usize) -> Vec<bool> {
        let primitives = self.0.json["meshes"][mesh]["primitives"].as_array();
        let lacks = |primitive: &Value| primitive["attributes"].get("NORMAL").is_none();
        primitives.into_iter().flatten().map(lacks).collect()
    }
}

/// JSON and buffers of a document, and the policy by which its vertices were welded.
#[derive(Debug)]
pub(crate) struct Contents {
    pub json: Value,
    pub buffers: Buffers,
    pub weld: Weld,
    /// Marks the meshes whose geometry is only in the scene; empty if the document has all.
    pub emptied: Vec<bool>,
    /// Facts of the file before decompression.
    pub facts: FileFacts,
}

/// Returns the greatest factor among all texture transforms within a value; at least 1.
fn largest_texture_scale(value: &Value) -> f64 {
    let (within, own): (Vec<&Value>, _) = match value {
        Value::Array(values) => (values.iter().collect(), None),
        Value::Object(entries) => {
            (entries.values().collect(), entries.get("KHR_texture_transform"))
        }
        _ => return 1.0,
    };
    let own = own.and_then(|transform| transform["scale"].as_array()).into_iter().flatten();
    let factors = own.filter_map(Value::as_f64).map(f64::abs).filter(|factor| factor.is_finite());
    factors.chain(within.into_iter().map(largest_texture_scale)).fold(1.0, f64::max)
}
