//! Where the vertices of a mesh stand in the document.

use std::ops::Range;

use serde_json::Value;

use super::primitives::is_surface;
use super::read::SourceDocument;

/// The positions of a primitive, in a mesh that was read without welding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PrimitiveRows {
    /// The accessor of its POSITION.
    pub accessor: usize,
    /// The vertices of the mesh that are the accessor's rows, in their order.
    pub vertices: Range<usize>,
}

impl SourceDocument {
    /// The vertices of each primitive of a mesh, as [`Weld::Off`](crate::Weld::Off) numbers them:
    /// the rows of one POSITION accessor after those of another, each accessor once. `None` for
    /// points and lines. Empty for a mesh that is not there.
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
