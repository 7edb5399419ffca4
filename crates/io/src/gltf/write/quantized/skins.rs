//! Inverse bind matrices that map quantized positions of skinned meshes back to model space.
//!
//! glTF ignores the transforms of nodes with skins. The transforms that
//! [`dequantize_nodes`](super::dequantize_nodes) gives those nodes are for programs that ignore
//! skins, ours included.

use std::collections::BTreeMap;

use serde_json::Value;

use super::grid::QuantizationGrid;
use crate::gltf::document::Document;
use crate::gltf::document::entries::extend;
use crate::gltf::write::buffer::BufferBuilder;

/// Column-major 4×4 matrix.
type Matrix = [f32; 16];

/// Inverse bind matrices by mesh and skin, for the quantized meshes.
#[derive(Default)]
pub(crate) struct SkinMatrices(BTreeMap<(usize, usize), Vec<Matrix>>);

impl SkinMatrices {
    /// Computes the matrices for all nodes that show a mesh with a grid by a skin. A mesh whose
    /// skins cannot be read loses its grid, with the reason appended to `kept`.
    pub fn of(
        document: &Document<'_>,
        grids: &mut [Option<QuantizationGrid>],
        kept: &mut Vec<String>,
    ) -> Self {
        let mut matrices = BTreeMap::new();
        for (_, pair) in skinned(document.json) {
            let (mesh, skin) = pair;
            let Some(grid) = grids.get(mesh).copied().flatten() else { continue };
            if matrices.contains_key(&pair) {
                continue;
            }
            match inverse_bind_matrices(document, skin).and_then(|all| in_cells(&all, &grid)) {
                Some(all) => drop(matrices.insert(pair, all)),
                None => {
                    grids[mesh] = None;
                    let why = "the inverse bind matrices of its skin cannot be scaled";
                    kept.push(format!("mesh {mesh}: positions stay floats, because {why}"));
                }
            }
        }
        matrices.retain(|&(mesh, _), _| grids[mesh].is_some());
        Self(matrices)
    }

    /// Computes one flag per skin: true if new matrices replace all uses of the old ones.
    pub fn replaced(&self, json: &Value) -> Vec<bool> {
        let count = json.get("skins").and_then(Value::as_array).map_or(0, Vec::len);
        let (mut replaced, mut kept) = (vec![false; count], vec![false; count]);
        for (_, pair) in skinned(json) {
            let marks = if self.0.contains_key(&pair) { &mut replaced } else { &mut kept };
            marks.get_mut(pair.1).into_iter().for_each(|mark| *mark = true);
        }
        replaced.iter().zip(kept).map(|(&replaced, kept)| replaced && !kept).collect()
    }

    /// Writes the new matrices: the first mesh of a replaced skin gets the skin itself, others get
    /// a copy.
    pub fn enter(&self, json: &mut Value, builder: &mut BufferBuilder) {
        let mut free = self.replaced(json);
        let mut skins = BTreeMap::new();
        for (pair, all) in &self.0 {
            let own = pair.1;
            let accessor = builder.add_matrices(all);
            let at = match std::mem::replace(&mut free[own], false) {
                true => own,
                false => {
                    let copy = json["skins"][own].clone();
                    extend(json, "skins", vec![copy])
                }
            };
            json["skins"][at]["inverseBindMatrices"] = accessor.into();
            skins.insert(*pair, at);
        }
        for (node, pair) in skinned(json) {
            if let Some(&skin) = skins.get(&pair) {
                json["nodes"][node]["skin"] = skin.into();
            }
        }
    }
}

/// Lists the nodes with a mesh and a skin: node, mesh and skin.
fn skinned(json: &Value) -> Vec<(usize, (usize, usize))> {
    let nodes = json.get("nodes").and_then(Value::as_array).into_iter().flatten();
    let index = |node: &Value, key| node.get(key).and_then(Value::as_u64).map(|i| i as usize);
    let pair = |node| Some((index(node, "mesh")?, index(node, "skin")?));
    nodes.enumerate().filter_map(|(i, node)| Some((i, pair(node)?))).collect()
}

/// Reads the matrices of a skin, one per joint; identities by default. Returns `None` if they are
/// invalid or too few.
fn inverse_bind_matrices(document: &Document<'_>, skin: usize) -> Option<Vec<Matrix>> {
    let skin = document.json.get("skins")?.get(skin).filter(|skin| skin.is_object())?;
    let joints = skin.get("joints")?.as_array()?.len();
    let Some(accessor) = skin.get("inverseBindMatrices") else {
        document.spend("skin", joints * 16).ok()?;
        let identity = std::array::from_fn(|i| if i % 5 == 0 { 1.0 } else { 0.0 });
        return Some(vec![identity; joints]);
    };
    let read = document.floats(accessor.as_u64()? as usize).ok()?;
    if read.width != 16 || read.count() < joints {
        return None;
    }
    Some(read.values.as_chunks().0[..joints].to_vec())
}

/// Multiplies the matrices by the transform from the grid; `None` if that exceeds 32 bits.
fn in_cells(matrices: &[Matrix], grid: &QuantizationGrid) -> Option<Vec<Matrix>> {
    let scaled = |matrix: &Matrix| {
        let old = matrix.map(f64::from);
        let [x, y, z] = grid.origin;
        let moved = |row| old[row] * x + old[row + 4] * y + old[row + 8] * z + old[row + 12];
        let new: Matrix = std::array::from_fn(|i| {
            let value = if i < 12 { old[i] * grid.cell } else { moved(i - 12) };
            value as f32
        });
        new.iter().all(|x| x.is_finite()).then_some(new)
    };
    matrices.iter().map(scaled).collect()
}
