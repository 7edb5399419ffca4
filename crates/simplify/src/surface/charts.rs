//! Texture charts: groups of a vertex's wedges that share one position in the textures.
//!
//! Wedges of one vertex that differ only in normals and tangents are in one chart: a crease in the
//! shading, not a cut in a texture. A flat-shaded mesh has one wedge per corner and no seams.

use std::cmp::Ordering;

use meshlod_mesh::{Layer, LayerKind, VertexId, WedgeId};

/// Returns true if a layer holds normals or tangents, which wedges keep when their vertex moves.
pub(crate) fn is_shading(layer: &Layer) -> bool {
    is_shading_kind(layer.kind)
}

/// Returns true for the kinds of layers that hold directions.
pub(crate) fn is_shading_kind(kind: LayerKind) -> bool {
    matches!(kind, LayerKind::Normal | LayerKind::Tangent)
}

/// Returns the chart of every wedge, as the lowest wedge of its vertex in it. `labels` holds the
/// material of each wedge, or nothing; wedges of different materials are in different charts.
pub(crate) fn charts(
    layers: &[Layer],
    labels: &[u32],
    count: usize,
    corners: impl Iterator<Item = (VertexId, WedgeId)>,
) -> Vec<WedgeId> {
    let mut charts: Vec<_> = (0..count).map(WedgeId::new).collect();
    if !layers.iter().any(is_shading) {
        return charts;
    }
    let mut vertex = vec![VertexId::default(); count];
    corners.for_each(|(v, wedge)| vertex[wedge.index()] = v);
    let place = |w: WedgeId| (vertex[w.index()], labels.get(w.index()));
    let textures: Vec<&Layer> = layers.iter().filter(|layer| !is_shading(layer)).collect();
    let compare = |a: WedgeId, b: WedgeId| {
        let by_values = || {
            let orders = textures.iter().map(|layer| total_order(layer.of(a), layer.of(b)));
            orders.fold(Ordering::Equal, Ordering::then)
        };
        place(a).cmp(&place(b)).then_with(by_values)
    };
    let mut sorted = charts.clone();
    sorted.sort_by(|&a, &b| compare(a, b));
    for run in sorted.chunk_by(|&a, &b| compare(a, b).is_eq()) {
        run.iter().for_each(|wedge| charts[wedge.index()] = run[0]);
    }
    charts
}

fn total_order(a: &[f32], b: &[f32]) -> Ordering {
    a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).fold(Ordering::Equal, Ordering::then)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(kind: LayerKind, width: usize, values: &[f32]) -> Layer {
        Layer { kind, name: String::new(), width, values: values.to_vec() }
    }

    fn at(vertices: &[u32]) -> impl Iterator<Item = (VertexId, WedgeId)> + '_ {
        vertices.iter().enumerate().map(|(w, &v)| (VertexId(v), WedgeId::new(w)))
    }

    #[test]
    fn normals_alone_make_no_chart() {
        let layers = [layer(LayerKind::Normal, 3, &[0.0; 9])];
        let found = charts(&layers, &[], 3, at(&[5, 5, 6]));
        assert_eq!(found, [WedgeId(0), WedgeId(0), WedgeId(2)]);
    }

    #[test]
    fn uvs_and_materials_do() {
        let uv = layer(LayerKind::Uv(0), 2, &[0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let layers = [layer(LayerKind::Normal, 3, &[0.0; 9]), uv];
        assert_eq!(charts(&layers, &[], 3, at(&[5; 3])), [WedgeId(0), WedgeId(0), WedgeId(2)]);
        let found = charts(&layers, &[1, 2, 1], 3, at(&[5; 3]));
        assert_eq!(found, [WedgeId(0), WedgeId(1), WedgeId(2)]);
    }
}
