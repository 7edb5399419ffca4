//! Edges of a tile divided in the middle.

use meshlod_mesh::{Attributes, Mesh, VertexId, WedgeId};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::cell::Cell;
use crate::tile::{TileMesh, point_of};

/// Divides all edges inside a tile whose two ends are on one side of its cell. A neighbour may have
/// an edge at the same place, and together they would be an edge of four faces.
pub fn divide_chords(tile: &mut TileMesh, cell: Cell) {
    let border: FxHashSet<_> = tile.border.iter().map(|&edge| sorted(edge)).collect();
    let is_border = tile.border_vertices();
    let sides: Vec<u8> = (0..is_border.len())
        .map(|i| match is_border[i] {
            true => cell.sides_of(point_of(&tile.mesh, VertexId::new(i))),
            false => 0,
        })
        .collect();
    let is_chord = |edge: [VertexId; 2]| {
        let [a, b] = edge.map(|v| sides[v.index()]);
        a & b != 0 && !border.contains(&edge)
    };
    let chords: FxHashSet<_> =
        tile.mesh.faces.iter().flat_map(edges_of).filter(|&edge| is_chord(edge)).collect();
    divide_edges(&mut tile.mesh, &chords);
}

/// Divides edges in the middle, and the faces beside them.
pub fn divide_edges(mesh: &mut Mesh, edges: &FxHashSet<[VertexId; 2]>) {
    if edges.is_empty() {
        return;
    }
    let mut middles: FxHashMap<[VertexId; 2], VertexId> = FxHashMap::default();
    let mut wedges: FxHashMap<[WedgeId; 2], WedgeId> = FxHashMap::default();
    let mut face = 0;
    while face < mesh.faces.len() {
        let corners = mesh.faces[face];
        let found = (0..3).find(|&i| edges.contains(&sorted([corners[i], corners[(i + 1) % 3]])));
        let Some(i) = found else {
            face += 1;
            continue;
        };
        let [first, second] = [i, (i + 1) % 3];
        let ends = sorted([corners[first], corners[second]]);
        let middle = *middles.entry(ends).or_insert_with(|| {
            let [a, b] = ends.map(|v| mesh.positions[v.index()]);
            // Whole steps, as all positions of a tile.
            mesh.positions.push([0, 1, 2].map(|axis| (0.5 * (a[axis] + b[axis])).round()));
            VertexId::new(mesh.positions.len() - 1)
        });
        // This face keeps its first end and is looked at again, a new one takes the second.
        let mut other = corners;
        other[first] = middle;
        mesh.faces[face][second] = middle;
        mesh.faces.push(other);
        if let Some(attributes) = &mut mesh.attributes {
            let corners = attributes.corners[face];
            let pair = [corners[first], corners[second]];
            let ends = if pair[0] < pair[1] { pair } else { [pair[1], pair[0]] };
            let wedge = *wedges.entry(ends).or_insert_with(|| mean_wedge(attributes, ends));
            let mut other = corners;
            other[first] = wedge;
            attributes.corners[face][second] = wedge;
            attributes.corners.push(other);
        }
        if let Some(labels) = &mut mesh.materials {
            labels.of_face.push(labels.of_face[face]);
        }
    }
}

fn mean_wedge(attributes: &mut Attributes, [a, b]: [WedgeId; 2]) -> WedgeId {
    let wedge = WedgeId::new(attributes.wedge_count);
    attributes.wedge_count += 1;
    for layer in &mut attributes.layers {
        let mean: Vec<f32> =
            layer.of(a).iter().zip(layer.of(b)).map(|(x, y)| 0.5 * (x + y)).collect();
        layer.values.extend(mean);
    }
    wedge
}

fn edges_of(face: &[VertexId; 3]) -> [[VertexId; 2]; 3] {
    [0, 1, 2].map(|i| sorted([face[i], face[(i + 1) % 3]]))
}

fn sorted([a, b]: [VertexId; 2]) -> [VertexId; 2] {
    if a < b { [a, b] } else { [b, a] }
}
