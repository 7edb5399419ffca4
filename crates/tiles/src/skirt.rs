//! Skirts: strips that hang from the border of a tile and hide gaps to tiles of other levels.

use meshlod_mesh::{Labels, Mesh, VertexId};
use rustc_hash::FxHashMap;

use crate::cell::{Cell, grid_step};
use crate::plan::Plan;
use crate::tile::TileMesh;

/// Returns the skirt of a tile, in steps of the lattice: from each border edge inwards, as deep as
/// the error of the next coarser level; `None` if the tile has no border. `mesh` is the mesh of the
/// tile as it will be shown.
pub fn skirt(plan: &Plan, cell: Cell, tile: &TileMesh, mesh: &Mesh) -> Option<Mesh> {
    let coarser = usize::from(cell.depth.saturating_sub(1));
    let error: f64 = plan.errors[coarser..].iter().sum();
    // The grid goes on for half a cell beyond its sides.
    let depth = error.min(f64::from(cell.width()) / 4.0);
    let step = f64::from(grid_step(cell.depth));
    if tile.border.is_empty() || depth == 0.0 {
        return None;
    }
    let normals = normals(mesh);
    let edges: FxHashMap<[VertexId; 2], ()> = tile.border.iter().map(|&edge| (edge, ())).collect();
    let mut new = Mesh { positions: mesh.positions.clone(), ..Mesh::default() };
    new.attributes = mesh.attributes.clone().map(|mut attributes| {
        attributes.corners.clear();
        attributes
    });
    new.materials = mesh
        .materials
        .as_ref()
        .map(|labels| Labels { names: labels.names.clone(), of_face: Vec::new() });
    let mut low: FxHashMap<VertexId, VertexId> = FxHashMap::default();
    for (face, corners) in mesh.faces.iter().enumerate() {
        for i in 0..3 {
            let [a, b] = [corners[i], corners[(i + 1) % 3]];
            if !edges.contains_key(&[a, b]) {
                continue;
            }
            let [under_a, under_b] = [a, b].map(|v| {
                *low.entry(v).or_insert_with(|| {
                    let (at, normal) = (mesh.positions[v.index()], normals[v.index()]);
                    let down = [0, 1, 2].map(|axis| at[axis] - depth * normal[axis]);
                    let down = down.map(|x| (x / step).round() * step);
                    new.positions.push(down);
                    VertexId::new(new.positions.len() - 1)
                })
            });
            new.faces.extend([[b, a, under_a], [b, under_a, under_b]]);
            if let Some(attributes) = &mut new.attributes {
                let wedges = mesh.corner_wedges(face);
                let [of_a, of_b] = [wedges[i], wedges[(i + 1) % 3]];
                let [copy_a, copy_b] = [of_a, of_b].map(|wedge| {
                    for layer in &mut attributes.layers {
                        let own = layer.of(wedge).to_vec();
                        layer.values.extend(own);
                    }
                    attributes.wedge_count += 1;
                    meshlod_mesh::WedgeId::new(attributes.wedge_count - 1)
                });
                attributes.corners.extend([[of_b, of_a, copy_a], [of_b, copy_a, copy_b]]);
            }
            if let (Some(labels), Some(of)) = (&mut new.materials, &mesh.materials) {
                labels.of_face.extend([of.of(face); 2]);
            }
        }
    }
    new.compact();
    (!new.faces.is_empty()).then_some(new)
}

/// Returns the unit normal of each vertex, from the areas of its faces; zero where they cancel out.
fn normals(mesh: &Mesh) -> Vec<[f64; 3]> {
    let mut normals = vec![[0.0; 3]; mesh.positions.len()];
    for &face in &mesh.faces {
        let [a, b, c] = mesh.triangle(face);
        let area = (b - a).cross(c - a).to_array();
        for v in face {
            (0..3).for_each(|axis| normals[v.index()][axis] += area[axis]);
        }
    }
    for normal in &mut normals {
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        let scale = if length > 0.0 { 1.0 / length } else { 0.0 };
        normal.iter_mut().for_each(|x| *x *= scale);
    }
    normals
}
