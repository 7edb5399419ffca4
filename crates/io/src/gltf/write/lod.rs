//! Levels of detail in glTF: linked by the extension `MSFT_lod`, or side by side in the scene.

use serde_json::{Value, json};

use super::quantized::grid::QuantizationGrid;
use super::replacer::Replacer;
use crate::error::Unsupported;
use crate::gltf::document::entries::extend;
use crate::gltf::document::extensions::{MSFT_LOD, list_extension};
use crate::gltf::document::primitive_kind::is_surface;
use crate::gltf::read::nodes;
use crate::gltf::write::levels::{Level, Levels, LodLayout, check_levels};
use crate::gltf::write::node_edits::{give_to_child, moving};

/// Adds the levels of all meshes with triangles, and the nodes that show them.
///
/// `templates` are the meshes of the document before their geometry was replaced, `grids` the
/// quantization grids of their positions.
pub(crate) fn add(
    json: &mut Value,
    templates: &[Value],
    grids: &[Option<QuantizationGrid>],
    Levels { levels, layout, .. }: Levels<'_>,
    replacer: &mut Replacer<'_>,
) -> Result<(), Unsupported> {
    check_levels(levels, templates.len())?;
    let of_mesh = add_meshes(json, templates, grids, levels, replacer)?;
    let coverage: Vec<f64> = levels.iter().map(|level| level.screen_coverage).collect();
    let ids = |mesh: usize| of_mesh.get(mesh).cloned().unwrap_or_default();
    match layout {
        LodLayout::Linked => link_nodes(json, ids, Some(&coverage)),
        LodLayout::Siblings => show_all(json, ids),
    }
    Ok(())
}

/// Links every node with a mesh to new nodes for its coarser levels, whose mesh indices are
/// `ids_of(mesh)`; `coverage` is the screen coverage of each level, if known.
pub(crate) fn link_nodes(
    json: &mut Value,
    ids_of: impl Fn(usize) -> Vec<usize>,
    coverage: Option<&[f64]>,
) {
    let count = json.get("nodes").and_then(Value::as_array).map_or(0, Vec::len);
    let hidden = nodes::levels(json, count);
    let moving = moving(json);
    for node in (0..count).filter(|&node| !hidden[node]) {
        let Some(mesh) = json["nodes"][node].get("mesh").and_then(Value::as_u64) else { continue };
        let ids = ids_of(mesh as usize);
        if ids.is_empty() {
            continue;
        }
        let has_children = json["nodes"][node].get("children").is_some();
        let name = base_name(json, node, mesh as usize);
        let shown =
            if has_children || moving.contains(&node) { give_to_child(json, node) } else { node };
        link(json, shown, &name, &ids, coverage);
    }
    list_extension(json, "extensionsUsed", MSFT_LOD);
}

/// Adds to every node with a mesh a child for each level; `ids_of(mesh)` are the meshes of the
/// coarser ones.
fn show_all(json: &mut Value, ids_of: impl Fn(usize) -> Vec<usize>) {
    let count = json.get("nodes").and_then(Value::as_array).map_or(0, Vec::len);
    let hidden = nodes::levels(json, count);
    for node in (0..count).filter(|&node| !hidden[node]) {
        let Some(mesh) = json["nodes"][node].get("mesh").and_then(Value::as_u64) else { continue };
        let coarser = ids_of(mesh as usize);
        if coarser.is_empty() {
            continue;
        }
        let name = base_name(json, node, mesh as usize);
        let extensions = json["nodes"][node].get_mut("extensions");
        if let Some(extensions) = extensions.and_then(Value::as_object_mut) {
            extensions.shift_remove(MSFT_LOD);
        }
        let finest = give_to_child(json, node);
        json["nodes"][finest]["name"] = format!("{name}_LOD0").into();
        let coarser = add_coarser(json, finest, &name, &coarser);
        let coarser = coarser.into_iter().map(Value::from).collect();
        extend(&mut json["nodes"][node], "children", coarser);
    }
}

/// Adds the meshes that have triangles, level after level, and returns the indices of the levels of
/// each mesh.
fn add_meshes(
    json: &mut Value,
    templates: &[Value],
    grids: &[Option<QuantizationGrid>],
    levels: &[Level],
    replacer: &mut Replacer<'_>,
) -> Result<Vec<Vec<usize>>, Unsupported> {
    let first = json["meshes"].as_array().map_or(0, Vec::len);
    let mut of_mesh = vec![Vec::new(); templates.len()];
    let mut new = Vec::new();
    for (k, level) in levels.iter().enumerate() {
        let meshes = templates.iter().zip(&level.meshes).zip(grids).zip(&mut of_mesh);
        for (((template, mesh), grid), ids) in meshes.filter(|(((t, _), _), _)| has_surface(t)) {
            let mut coarse = template.clone();
            replacer.replace(&mut coarse, mesh, grid.as_ref())?;
            if let Some(name) = template.get("name").and_then(Value::as_str) {
                coarse["name"] = format!("{name}_LOD{}", k + 1).into();
            }
            ids.push(first + new.len());
            new.push(coarse);
        }
    }
    if !new.is_empty() {
        extend(json, "meshes", new);
    }
    Ok(of_mesh)
}

/// Returns true if a mesh has triangles.
fn has_surface(mesh: &Value) -> bool {
    let primitives = mesh.get("primitives").and_then(Value::as_array);
    primitives.is_some_and(|primitives| primitives.iter().any(is_surface))
}

fn base_name(json: &Value, node: usize, mesh: usize) -> String {
    let name = |value: &Value| value.get("name").and_then(Value::as_str).map(str::to_owned);
    let named = name(&json["nodes"][node])
        .or_else(|| name(&json["meshes"][mesh]))
        .filter(|name| !name.is_empty())
        .unwrap_or_else(|| format!("node{node}"));
    named.strip_suffix("_LOD0").map(str::to_owned).unwrap_or(named)
}

/// Adds nodes for the coarser levels with the transform of `node`, and links them to it.
fn link(json: &mut Value, node: usize, name: &str, meshes: &[usize], coverage: Option<&[f64]>) {
    let ids = add_coarser(json, node, name, meshes);
    let shown = &mut json["nodes"][node];
    shown["name"] = format!("{name}_LOD0").into();
    set(shown, "extensions", MSFT_LOD, json!({ "ids": ids }));
    if let Some(coverage) = coverage {
        // Minimum coverage of each level; the last level is shown down to zero.
        let least: Vec<f64> = coverage.iter().copied().chain([0.0]).collect();
        set(shown, "extras", "MSFT_screencoverage", json!(least));
    }
}

/// Adds nodes for the coarser levels with the transform of `node`; returns their indices.
fn add_coarser(json: &mut Value, node: usize, name: &str, meshes: &[usize]) -> Vec<usize> {
    let shown = json["nodes"][node].clone();
    let coarser = meshes.iter().enumerate().map(|(k, &mesh)| {
        let mut coarse = shown.clone();
        if let Some(coarse) = coarse.as_object_mut() {
            for key in ["children", "camera", "extensions", "extras"] {
                coarse.shift_remove(key);
            }
        }
        coarse["mesh"] = mesh.into();
        coarse["name"] = format!("{name}_LOD{}", k + 1).into();
        coarse
    });
    let first = extend(json, "nodes", coarser.collect());
    (first..first + meshes.len()).collect()
}

/// Sets an entry of an object of a node, replacing extras that are not an object.
fn set(node: &mut Value, object: &str, key: &str, value: Value) {
    if !node[object].is_object() {
        node[object] = json!({});
    }
    node[object][key] = value;
}
