//! Attributes of formats that store one set per vertex.

use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh, VertexId, WedgeId};

/// Builds attributes with one wedge per vertex; every layer has a value for each vertex. Returns
/// `None` if there are no layers.
pub(crate) fn per_vertex(
    vertices: usize,
    faces: &[[VertexId; 3]],
    layers: Vec<Layer>,
) -> Option<Attributes> {
    let corners = || faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
    (!layers.is_empty()).then(|| Attributes { corners: corners(), wedge_count: vertices, layers })
}

/// Creates a layer with the conventional name of its kind.
pub(crate) fn named_layer(kind: LayerKind, width: usize, values: Vec<f32>) -> Layer {
    let name = match kind {
        LayerKind::Normal => "normal",
        LayerKind::Uv(_) => "uv",
        LayerKind::Color(_) => "color",
        _ => "",
    };
    Layer { kind, name: name.to_owned(), width, values }
}

/// Pads a layer to this many wedges with default values: opaque white for colours, a unit vector
/// for tangents, else 0.
pub(crate) fn pad(layer: &mut Layer, wedges: usize) {
    let value: Vec<f32> = match layer.kind {
        LayerKind::Color(_) => vec![1.0; layer.width],
        LayerKind::Tangent => vec![1.0, 0.0, 0.0, 1.0],
        _ => vec![0.0; layer.width],
    };
    while layer.values.len() < wedges * layer.width {
        layer.values.extend_from_slice(&value);
    }
}

/// Scales colours to [0, 1]: if any component exceeds 1, all are divided by 255.
pub(crate) fn normalize_colors(colors: &mut [f32]) {
    if colors.iter().any(|&c| c > 1.0) {
        colors.iter_mut().for_each(|c| *c /= 255.0);
    }
}

/// Vertex of a file with one set of attributes per vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SplitVertex {
    pub(crate) vertex: VertexId,
    /// Wedge that holds its attributes; `None` if no face uses the vertex.
    pub(crate) wedge: Option<WedgeId>,
}

/// Vertices and faces of a mesh with one set of attributes per vertex.
pub(crate) struct SplitMesh {
    pub(crate) vertices: Vec<SplitVertex>,
    pub(crate) faces: Vec<[u32; 3]>,
}

/// Splits the vertices of a mesh at its seams: all vertices in order, each with its first wedge,
/// then one more for every further wedge. A mesh without seams keeps its vertices and faces.
pub(crate) fn split_at_seams(mesh: &Mesh) -> SplitMesh {
    split(mesh, |wedge| wedge)
}

/// Splits the vertices of a mesh like [`split_at_seams`], but only where these layers differ.
pub(crate) fn split_at_seams_of(mesh: &Mesh, layers: &[&Layer]) -> SplitMesh {
    match &mesh.attributes {
        Some(attributes) => {
            let first = distinct_wedges(mesh, attributes, layers);
            split(mesh, |wedge| WedgeId(first[wedge.index()]))
        }
        None => split_at_seams(mesh),
    }
}

fn split(mesh: &Mesh, of: impl Fn(WedgeId) -> WedgeId) -> SplitMesh {
    let mut vertices: Vec<SplitVertex> = (0..mesh.positions.len())
        .map(|v| SplitVertex { vertex: VertexId::new(v), wedge: None })
        .collect();
    let mut faces: Vec<[u32; 3]> = mesh.faces.iter().map(|face| face.map(|v| v.0)).collect();
    let Some(attributes) = &mesh.attributes else { return SplitMesh { vertices, faces } };
    let mut row_of: Vec<Option<u32>> = vec![None; attributes.wedge_count];
    for (corner, &wedge) in
        faces.as_flattened_mut().iter_mut().zip(attributes.corners.as_flattened())
    {
        let vertex = VertexId(*corner);
        let wedge = of(wedge);
        *corner = *row_of[wedge.index()].get_or_insert_with(|| {
            if vertices[vertex.index()].wedge.is_none() {
                vertices[vertex.index()].wedge = Some(wedge);
                return vertex.0;
            }
            vertices.push(SplitVertex { vertex, wedge: Some(wedge) });
            vertices.len() as u32 - 1
        });
    }
    SplitMesh { vertices, faces }
}

/// Returns, for each wedge in use, the first wedge of its vertex that equals it in these layers.
///
/// Values are compared bit for bit. Cost: O(n log n), n = wedges of a vertex.
pub(crate) fn distinct_wedges(mesh: &Mesh, attributes: &Attributes, layers: &[&Layer]) -> Vec<u32> {
    let mut owner = vec![None; attributes.wedge_count];
    for (&v, w) in mesh.faces.as_flattened().iter().zip(attributes.corners.as_flattened()) {
        owner[w.index()] = Some(v.0);
    }
    let owned = owner.iter().zip(0..).filter_map(|(owner, wedge)| Some((owner.as_ref()?, wedge)));
    let mut owned: Vec<(u32, u32)> = owned.map(|(&vertex, wedge)| (vertex, wedge)).collect();
    owned.sort_unstable();
    let values = |wedge: u32| {
        layers.iter().flat_map(move |layer| layer.of(WedgeId(wedge))).map(|x| x.to_bits())
    };
    let mut first: Vec<u32> = (0..attributes.wedge_count as u32).collect();
    for around in owned.chunk_by_mut(|a, b| a.0 == b.0) {
        if around.len() < 2 {
            continue;
        }
        around.sort_unstable_by(|a, b| values(a.1).cmp(values(b.1)).then(a.1.cmp(&b.1)));
        for equal in around.chunk_by(|a, b| values(a.1).eq(values(b.1))) {
            equal.iter().for_each(|&(_, wedge)| first[wedge as usize] = equal[0].1);
        }
    }
    first
}

/// Reports whether a layer has different values at one vertex, compared bit for bit.
pub(crate) fn has_seams(mesh: &Mesh, attributes: &Attributes, layer: &Layer) -> bool {
    let mut first = vec![None; mesh.positions.len()];
    let bits = |wedge: WedgeId| layer.of(wedge).iter().map(|x| x.to_bits());
    let mut corners = mesh.faces.as_flattened().iter().zip(attributes.corners.as_flattened());
    corners.any(|(v, &wedge)| {
        let known = *first[v.index()].get_or_insert(wedge);
        known != wedge && !bits(known).eq(bits(wedge))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles over four vertices and an unused one; their wedges as given.
    fn two(corners: [[u32; 3]; 2]) -> Mesh {
        let faces = vec![[0, 1, 2].map(VertexId), [2, 1, 3].map(VertexId)];
        let attributes = Attributes {
            corners: corners.map(|corners| corners.map(WedgeId)).to_vec(),
            wedge_count: 6,
            layers: Vec::new(),
        };
        Mesh { attributes: Some(attributes), ..Mesh::new(vec![[0.0; 3]; 5], faces) }
    }

    #[test]
    fn without_seams_vertices_stay() {
        let split = split_at_seams(&two([[3, 1, 0], [0, 1, 2]]));
        assert_eq!(split.faces, [[0, 1, 2], [2, 1, 3]]);
        let wedges: Vec<Option<u32>> =
            split.vertices.iter().map(|row| row.wedge.map(|w| w.0)).collect();
        assert_eq!(wedges, [Some(3), Some(1), Some(0), Some(2), None]);
    }

    #[test]
    fn further_wedges_come_behind() {
        let split = split_at_seams(&two([[0, 1, 2], [3, 4, 5]]));
        assert_eq!(split.faces, [[0, 1, 2], [5, 6, 3]]);
        assert_eq!(split.vertices[5], SplitVertex { vertex: VertexId(2), wedge: Some(WedgeId(3)) });
        assert_eq!(split.vertices.len(), 7);
    }

    #[test]
    fn colours_of_255_become_unit() {
        let mut colors = [0.0, 255.0, 51.0];
        normalize_colors(&mut colors);
        assert_eq!(colors, [0.0, 1.0, 0.2]);
        normalize_colors(&mut colors);
        assert_eq!(colors, [0.0, 1.0, 0.2]);
    }
}
