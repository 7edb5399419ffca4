//! Vertices of an OBJ file with one colour each.

use meshlod_mesh::{Layer, LayerKind, Mesh};

use crate::vertex_attributes::{SplitMesh, named_layer, split_at_seams_of};

/// Vertices of a coloured mesh, split so that each has one colour.
pub(super) struct ColoredVertices {
    pub colors: Layer,
    pub split: SplitMesh,
}

impl ColoredVertices {
    /// Splits the vertices of a mesh where their colours differ; `None` if it has no colours.
    pub fn of(mesh: &Mesh) -> Option<Self> {
        let colors = rgb(mesh)?;
        let split = split_at_seams_of(mesh, &[&colors]);
        Some(Self { colors, split })
    }
}

/// Counts the vertices that an OBJ file adds because faces disagree on the colour of a vertex.
pub(crate) fn color_splits(mesh: &Mesh) -> usize {
    let vertices = ColoredVertices::of(mesh).map(|colored| colored.split.vertices.len());
    vertices.map_or(0, |vertices| vertices - mesh.positions.len())
}

/// Returns the first colours of a mesh without their opacity.
fn rgb(mesh: &Mesh) -> Option<Layer> {
    let layer = mesh.attributes.as_ref()?.layer(LayerKind::Color(0))?;
    let colors = layer.values.chunks_exact(layer.width.max(1));
    let values = colors.filter_map(|color| color.first_chunk::<3>()).flatten().copied().collect();
    (layer.width >= 3).then(|| named_layer(layer.kind, 3, values))
}
