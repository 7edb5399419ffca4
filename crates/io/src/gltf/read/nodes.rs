//! Nodes of a glTF document: their transforms, and the check that they form trees.

use glam::{DMat4, DQuat, DVec3};
use serde_json::Value;

use super::instancing;
use crate::error::ParseError;
use crate::gltf::document::schema::GltfScene;
use crate::gltf::document::{Document, missing, schema};
use crate::scene::{Node, Scene};

/// Maximum number of faces a scene may show, over all instances; 2^28 take about 10 GB when
/// flattened.
const MOST_SHOWN_FACES: usize = 1 << 28;

/// Largest entry of a world transform that keeps 32-bit positions finite.
const GREATEST_ENTRY: f64 = 1e200;

/// Reads nodes and roots into a scene that already has its meshes.
///
/// Coarser levels linked by `MSFT_lod` stay in the list, but are neither roots nor children.
pub(crate) fn read(document: &Document<'_>, scene: &mut Scene) -> Result<(), ParseError> {
    let json = document.json;
    let nodes: Vec<schema::GltfNode> = schema::array(json, "nodes", "node")?;
    let parents = parents(&nodes)?;
    check_trees(&nodes, &parents)?;
    let hidden = levels(json, nodes.len());
    scene.roots = roots(json, &parents)?.into_iter().filter(|&root| !hidden[root]).collect();
    for (i, node) in nodes.into_iter().enumerate() {
        if let Some(mesh) = node.mesh.filter(|&mesh| mesh >= scene.meshes.len()) {
            return Err(missing("mesh", mesh, scene.meshes.len()));
        }
        let transform = transform(&node).map_err(|e| ParseError::part(format!("node {i}"), e))?;
        let instances = match node.mesh {
            Some(_) => instancing::transforms(document, i)?,
            None => Vec::new(),
        };
        scene.nodes.push(Node {
            name: node.name.unwrap_or_default(),
            transform: transform.to_cols_array_2d(),
            mesh: node.mesh,
            instances,
            children: node.children.into_iter().filter(|&child| !hidden[child]).collect(),
        });
    }
    check_instances(scene)
}

/// Computes one flag per node: true if it is a coarser level of another node by `MSFT_lod`.
pub(crate) fn levels(json: &Value, count: usize) -> Vec<bool> {
    let mut hidden = vec![false; count];
    let nodes = json.get("nodes").and_then(Value::as_array);
    for node in nodes.into_iter().flatten() {
        let ids = node.pointer("/extensions/MSFT_lod/ids").and_then(Value::as_array);
        for id in ids.into_iter().flatten().filter_map(Value::as_u64) {
            if let Some(hidden) = hidden.get_mut(id as usize) {
                *hidden = true;
            }
        }
    }
    hidden
}

fn parents(nodes: &[schema::GltfNode]) -> Result<Vec<Option<usize>>, ParseError> {
    let mut parents = vec![None; nodes.len()];
    for (i, node) in nodes.iter().enumerate() {
        for &child in &node.children {
            let Some(parent) = parents.get_mut(child) else {
                return Err(missing("node", child, nodes.len()));
            };
            if let Some(other) = parent.replace(i) {
                let reason = format!("is a child of node {other} and of node {i}");
                return Err(ParseError::part(format!("node {child}"), reason));
            }
        }
    }
    Ok(parents)
}

/// Checks for cycles: with at most one parent each, nodes unreachable from the roots form cycles.
fn check_trees(nodes: &[schema::GltfNode], parents: &[Option<usize>]) -> Result<(), ParseError> {
    let mut reached = vec![false; nodes.len()];
    let mut stack: Vec<usize> = (0..nodes.len()).filter(|&i| parents[i].is_none()).collect();
    while let Some(node) = stack.pop() {
        reached[node] = true;
        stack.extend_from_slice(&nodes[node].children);
    }
    match reached.iter().position(|&reached| !reached) {
        None => Ok(()),
        Some(node) => {
            let reason = "is part of a cycle: it is its own ancestor";
            Err(ParseError::part(format!("node {node}"), reason))
        }
    }
}

/// Returns the roots of the default scene or, without scenes, every node that has no parent.
fn roots(json: &Value, parents: &[Option<usize>]) -> Result<Vec<usize>, ParseError> {
    let scenes: Vec<GltfScene> = schema::array(json, "scenes", "scene")?;
    let shown = match json.get("scene") {
        None => 0,
        Some(shown) => shown
            .as_u64()
            .ok_or_else(|| ParseError::part("scene", "must be the index of a scene"))?
            as usize,
    };
    if scenes.is_empty() {
        return Ok((0..parents.len()).filter(|&node| parents[node].is_none()).collect());
    }
    let Some(GltfScene { nodes }) = scenes.get(shown) else {
        return Err(missing("scene", shown, scenes.len()));
    };
    for &node in nodes {
        match parents.get(node) {
            None => return Err(missing("node", node, parents.len())),
            Some(Some(parent)) => {
                let reason = format!("lists node {node}, which is a child of node {parent}");
                return Err(ParseError::part(format!("scene {shown}"), reason));
            }
            Some(None) => {}
        }
    }
    Ok(nodes.clone())
}

fn transform(node: &schema::GltfNode) -> Result<DMat4, String> {
    if let Some(matrix) = &node.matrix {
        return Ok(DMat4::from_cols_array(matrix));
    }
    let rotation = DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
    // 32-bit quaternions are slightly off unit length.
    let length = rotation.length();
    if !(0.5..2.0).contains(&length) {
        return Err(format!("its rotation must be a unit quaternion, but has length {length}"));
    }
    Ok(DMat4::from_scale_rotation_translation(
        DVec3::from_array(node.scale.unwrap_or([1.0; 3])),
        rotation.normalize(),
        DVec3::from_array(node.translation.unwrap_or_default()),
    ))
}

/// Checks that all world transforms are finite, and that instancing stays within memory.
fn check_instances(scene: &Scene) -> Result<(), ParseError> {
    let mut faces = 0;
    for instance in scene.instances() {
        let part = || format!("node {}", instance.node);
        let entries = instance.transform.as_flattened();
        if !entries.iter().all(|entry| entry.abs() <= GREATEST_ENTRY) {
            return Err(ParseError::part(part(), "its world transform is not finite"));
        }
        let mesh = &scene.meshes[instance.mesh].mesh;
        faces += mesh.faces.len().max(mesh.positions.len());
        if faces > MOST_SHOWN_FACES {
            let reason = format!("the scene shows more than {MOST_SHOWN_FACES} faces");
            return Err(ParseError::part(part(), reason));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::gltf::document::buffers::Buffers;

    fn read_into(json: &Value, scene: &mut Scene) -> Result<(), ParseError> {
        let buffers = Buffers::new(Vec::new());
        read(&Document::new(json, &buffers)?, scene)
    }

    fn read_nodes(json: Value) -> Result<Scene, String> {
        let mut scene = Scene::default();
        read_into(&json, &mut scene).map_err(|error| error.to_string())?;
        Ok(scene)
    }

    #[test]
    fn circles_and_shared_children_are_errors() {
        for (nodes, place) in [
            (json!([{"children": [1]}, {"children": [0]}]), "node 0"),
            (json!([{"children": [0]}]), "node 0"),
            (json!([{"children": [1]}, {}, {"children": [1]}]), "node 1"),
            (json!([{"children": [1, 1]}, {}]), "node 1"),
            (json!([{"children": [7]}]), "node 7"),
            (json!([{"mesh": 0}]), "mesh 0"),
            (json!([{"rotation": [0, 0, 0, 0]}]), "node 0"),
        ] {
            let error = read_nodes(json!({ "nodes": nodes })).unwrap_err();
            assert!(error.starts_with(place), "{error}");
        }
    }

    #[test]
    fn a_long_chain_of_nodes_is_no_deep_recursion() {
        let node = |i: usize| json!({ "children": if i < 99_999 { vec![i + 1] } else { vec![] } });
        let nodes: Vec<Value> = (0..100_000).map(node).collect();
        assert_eq!(read_nodes(json!({ "nodes": nodes })).unwrap().roots, [0]);
    }

    #[test]
    fn a_transform_beyond_the_numbers_is_an_error() {
        let nodes = json!([
            {"scale": [1e150, 1, 1], "children": [1]},
            {"scale": [1e150, 1, 1], "mesh": 0},
        ]);
        let mut scene = Scene { meshes: vec![crate::SceneMesh::default()], ..Scene::default() };
        let error = read_into(&json!({ "nodes": nodes }), &mut scene).unwrap_err().to_string();
        assert!(error.starts_with("node 1"), "{error}");
    }

    #[test]
    fn coarser_levels_are_not_shown() {
        let nodes = json!([
            {"extensions": {"MSFT_lod": {"ids": [1, 2]}}}, {}, {}, {"children": [0]}
        ]);
        assert_eq!(read_nodes(json!({ "nodes": nodes })).unwrap().roots, [3]);
    }

    #[test]
    fn the_scene_named_is_the_one_shown() {
        let json = json!({
            "scene": 1, "scenes": [{"nodes": [0]}, {"nodes": [1]}], "nodes": [{}, {}]
        });
        assert_eq!(read_nodes(json).unwrap().roots, [1]);
    }
}
