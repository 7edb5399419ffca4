//! Stand-ins for primitives without faces, which have to stay for their number.

use meshlod_mesh::{Attributes, Layer, Mesh, VertexId, WedgeId};

/// Makes a mesh of one triangle without area that has the bounds and the attributes of some faces of
/// `finest`, or of all its faces if there are none.
///
/// The client computes from the bounds how large the primitive is on the screen, and whether it is
/// seen: a single point would never be seen, and never refined.
pub(crate) fn stand_in(finest: &Mesh, faces: &[u32]) -> Mesh {
    let all: Vec<u32>;
    let faces = match faces.is_empty() {
        true => {
            all = (0..finest.faces.len() as u32).collect();
            &all
        }
        false => faces,
    };
    let mut points = faces.iter().flat_map(|&face| finest.faces[face as usize]);
    let first = points.next().map(|v| finest.positions[v.index()]).unwrap_or_default();
    let (mut min, mut max) = (first, first);
    for point in points.map(|v| finest.positions[v.index()]) {
        for axis in 0..3 {
            min[axis] = min[axis].min(point[axis]);
            max[axis] = max[axis].max(point[axis]);
        }
    }
    let attributes = finest.attributes.as_ref().zip(faces.first());
    let attributes = attributes.map(|(own, &face)| twice(own, own.corners[face as usize][0]));
    Mesh { attributes, ..Mesh::new(vec![min, max], vec![[0, 1, 1].map(VertexId)]) }
}

/// Gives two wedges the values of one.
fn twice(own: &Attributes, wedge: WedgeId) -> Attributes {
    let layer = |layer: &Layer| Layer {
        kind: layer.kind,
        name: layer.name.clone(),
        width: layer.width,
        values: layer.of(wedge).repeat(2),
    };
    Attributes {
        corners: vec![[0, 1, 1].map(WedgeId)],
        wedge_count: 2,
        layers: own.layers.iter().map(layer).collect(),
    }
}
