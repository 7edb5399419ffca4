//! Uses of the accessors of a document.

use serde_json::Value;

use crate::gltf::document::Document;
use crate::gltf::document::extensions::INSTANCING;
use crate::gltf::document::primitive_kind::{attributes, is_surface};

/// Computes one flag per accessor: true if only triangles of changed meshes use it, or if it is
/// empty and unused.
pub(crate) fn free_accessors(document: &Document<'_>, changed: &[bool]) -> Vec<bool> {
    free_accessors_with(document, changed, &[], &|_| false)
}

/// Computes the flags of [`free_accessors`] if the marked skins get new matrices and some samplers,
/// given by animation and index, new keys.
pub(crate) fn free_accessors_with(
    document: &Document<'_>,
    changed: &[bool],
    new_skins: &[bool],
    is_new_sampler: &dyn Fn((usize, usize)) -> bool,
) -> Vec<bool> {
    let count = document.accessors.len();
    let (mut replaced, mut kept) = (vec![false; count], vec![false; count]);
    let meshes = document.json.get("meshes").and_then(Value::as_array);
    for (mesh, &changed) in meshes.into_iter().flatten().zip(changed) {
        mark_primitives(mesh, |primitive| changed && is_surface(primitive), &mut replaced);
        mark_primitives(mesh, |primitive| !(changed && is_surface(primitive)), &mut kept);
    }
    let is_new = |skin: usize| new_skins.get(skin) == Some(&true);
    mark_skins(document.json, is_new, &mut replaced);
    mark_skins(document.json, |skin| !is_new(skin), &mut kept);
    mark_instances(document.json, &mut kept);
    mark_samplers(document.json, is_new_sampler, &mut replaced);
    mark_samplers(document.json, |place| !is_new_sampler(place), &mut kept);
    let is_empty = document.accessors.iter().map(|accessor| accessor.count == 0);
    let free = replaced.iter().zip(is_empty).map(|(&replaced, is_empty)| replaced || is_empty);
    free.zip(kept).map(|(free, kept)| free && !kept).collect()
}

/// Computes one flag per accessor: true if animations use it and nothing else does, except
/// triangles of the marked meshes.
pub(crate) fn animation_accessors(document: &Document<'_>, emptied: &[bool]) -> Vec<bool> {
    let mut animated = vec![false; document.accessors.len()];
    mark_samplers(document.json, |_| true, &mut animated);
    let mut others = vec![false; animated.len()];
    mark_skins(document.json, |_| true, &mut others);
    mark_instances(document.json, &mut others);
    let meshes = document.json.get("meshes").and_then(Value::as_array);
    for (mesh, &emptied) in meshes.into_iter().flatten().zip(emptied) {
        mark_primitives(mesh, |primitive| !(emptied && is_surface(primitive)), &mut others);
    }
    animated.iter().zip(others).map(|(&animated, other)| animated && !other).collect()
}

/// Marks the accessors of the selected skins.
fn mark_skins(json: &Value, is_meant: impl Fn(usize) -> bool, marks: &mut [bool]) {
    let skins = json.get("skins").and_then(Value::as_array).into_iter().flatten();
    for (_, skin) in skins.enumerate().filter(|&(skin, _)| is_meant(skin)) {
        mark(skin.get("inverseBindMatrices"), marks);
    }
}

fn mark_instances(json: &Value, marks: &mut [bool]) {
    let nodes = json.get("nodes").and_then(Value::as_array).into_iter().flatten();
    for attributes in nodes.map(|node| &node["extensions"][INSTANCING]["attributes"]) {
        let attributes = attributes.as_object().into_iter().flatten();
        attributes.for_each(|(_, accessor)| mark(Some(accessor), marks));
    }
}

/// Marks the accessors of the selected samplers, given by animation and index.
fn mark_samplers(json: &Value, is_meant: impl Fn((usize, usize)) -> bool, marks: &mut [bool]) {
    let animations = json.get("animations").and_then(Value::as_array).into_iter().flatten();
    for (animation, all) in animations.enumerate() {
        let samplers = all.get("samplers").and_then(Value::as_array).into_iter().flatten();
        for (_, sampler) in samplers.enumerate().filter(|&(at, _)| is_meant((animation, at))) {
            ["input", "output"].into_iter().for_each(|key| mark(sampler.get(key), marks));
        }
    }
}

/// Marks the accessors of the selected primitives of a mesh.
fn mark_primitives(mesh: &Value, is_meant: impl Fn(&Value) -> bool, marks: &mut [bool]) {
    let primitives = mesh.get("primitives").and_then(Value::as_array);
    for primitive in primitives.into_iter().flatten().filter(|&primitive| is_meant(primitive)) {
        mark(primitive.get("indices"), marks);
        for accessor in attributes(primitive).into_values() {
            marks.get_mut(accessor).into_iter().for_each(|mark| *mark = true);
        }
    }
}

fn mark(accessor: Option<&Value>, marks: &mut [bool]) {
    let index = accessor.and_then(Value::as_u64);
    if let Some(mark) = index.and_then(|index| marks.get_mut(index as usize)) {
        *mark = true;
    }
}
