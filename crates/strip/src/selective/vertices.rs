//! Vertices by which the strips of cuts draw the nodes or wedges of a model.

use meshlod_mesh::VertexId;
use meshlod_multires::Implicit;

/// Finds for each node of a model, or for each wedge if it has any, the finest one below that looks
/// the same, so that splits which do not move a vertex leave its triangles alone.
///
/// Different wedges of a node are drawn by different vertices. Cost: linear.
pub(super) fn vertices(mt: &Implicit) -> Vec<VertexId> {
    let has_wedges = mt.wedge_count() > 0;
    let count = if has_wedges { mt.wedge_count() } else { mt.node_count() };
    let mut vertices: Vec<_> = (0..count).map(VertexId::new).collect();
    // Children have higher numbers.
    for node in (0..mt.node_count() as u32).rev() {
        let Some(child) = child_in_place(mt, node) else { continue };
        if !has_wedges {
            vertices[node as usize] = vertices[child as usize];
            continue;
        }
        let below = mt.wedges_of(child);
        for (wedge, parent) in mt.merged_wedges(node).filter(|(wedge, _)| below.contains(wedge)) {
            if vertices[parent as usize].0 == parent && looks_like(mt, wedge, parent) {
                vertices[parent as usize] = vertices[wedge as usize];
            }
        }
    }
    vertices
}

/// Returns the child of a node that is where the node is.
fn child_in_place(mt: &Implicit, node: u32) -> Option<u32> {
    let place = mt.position(node);
    mt.children_of(node)?.into_iter().find(|&child| mt.position(child) == place)
}

/// Returns true if two wedges have the same values to the bit, and the same material.
fn looks_like(mt: &Implicit, a: u32, b: u32) -> bool {
    let bits = |wedge: u32| {
        let mut values = Vec::new();
        mt.append_values(wedge, &mut values);
        values.into_iter().map(f32::to_bits)
    };
    mt.material_of(a) == mt.material_of(b) && bits(a).eq(bits(b))
}
