//! Mapping from the vertices of a mesh to the elements of their glTF accessors.

use std::ops::Range;

use serde_json::Value;

use crate::gltf::document::primitive_kind::is_surface;
use crate::gltf::document::source::SourceDocument;

/// Vertices of a glTF primitive, and their POSITION accessor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PrimitiveRows {
    /// Index of the primitive's POSITION accessor in the document.
    pub accessor: usize,
    /// Range of the mesh's vertices that were read from the accessor, in the order of its elements.
    pub vertices: Range<usize>,
}

impl SourceDocument {
    /// Returns, for each primitive of a glTF mesh, its vertices and their POSITION accessor; `None`
    /// for points and lines.
    ///
    /// Vertices are numbered as with [`Weld::Off`](crate::Weld::Off): the elements of all distinct
    /// POSITION accessors in order. The list is empty if there is no such mesh.
    pub fn primitive_rows(&self, mesh: usize) -> Vec<Option<PrimitiveRows>> {
        let json = &self.0.json;
        let primitives =
            json["meshes"][mesh]["primitives"].as_array().map_or(&[][..], Vec::as_slice);
        let index = |value: &Value| value.as_u64().and_then(|index| usize::try_from(index).ok());
        let mut known: Vec<PrimitiveRows> = Vec::new();
        let mut rows = |primitive: &Value| {
            let accessor = index(&primitive["attributes"]["POSITION"])?;
            if let Some(rows) = known.iter().find(|rows| rows.accessor == accessor) {
                return Some(rows.clone());
            }
            let count = index(&json["accessors"][accessor]["count"])?;
            let first = known.last().map_or(0, |last| last.vertices.end);
            known.push(PrimitiveRows { accessor, vertices: first..first + count });
            known.last().cloned()
        };
        let surface = |primitive: &Value| is_surface(primitive).then(|| rows(primitive)).flatten();
        primitives.iter().map(surface).collect()
    }
}
