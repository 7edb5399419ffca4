//! Instances of a node's mesh by `EXT_mesh_gpu_instancing`.

use glam::{DMat4, DQuat, DVec3};
use serde_json::Value;

use crate::error::ParseError;
use crate::gltf::document::Document;
use crate::gltf::document::extensions::INSTANCING;

/// Reads the instance transforms of a node, from the space of the mesh to the node's; empty without
/// the extension or its attributes.
///
/// Attributes other than `TRANSLATION`, `ROTATION` and `SCALE` are specific to a program, and kept
/// like the rest of the document.
///
/// # Errors
/// Attributes of the wrong type, of different lengths or without entries; rotations that are not
/// unit quaternions.
pub(crate) fn transforms(
    document: &Document<'_>,
    node: usize,
) -> Result<Vec<[[f64; 4]; 4]>, ParseError> {
    let wrong = |reason: String| ParseError::part(format!("node {node}"), reason);
    let Some(extension) = document.json["nodes"][node]["extensions"].get(INSTANCING) else {
        return Ok(Vec::new());
    };
    let Some(attributes) = extension.get("attributes").and_then(Value::as_object) else {
        return Ok(Vec::new());
    };
    let mut count = None;
    for (name, accessor) in attributes {
        let accessor = accessor.as_u64().and_then(|at| document.accessors.get(at as usize));
        let Some(accessor) = accessor else {
            return Err(wrong(format!("its instances' {name} is not an accessor of the file")));
        };
        let first = *count.get_or_insert(accessor.count);
        if accessor.count != first {
            let reason = format!("its instances have {first} and {} {name}s", accessor.count);
            return Err(wrong(reason));
        }
    }
    let Some(count) = count else { return Ok(Vec::new()) };
    if count == 0 {
        let reason = format!("its {INSTANCING} has no instances; remove the extension or the mesh");
        return Err(wrong(reason));
    }
    let read = |name: &str, width: usize| match attributes.get(name).and_then(Value::as_u64) {
        None => Ok(None),
        Some(accessor) => {
            let read = document.floats(accessor as usize)?;
            match read.width == width {
                true => Ok(Some(read.values)),
                false => Err(wrong(format!("its instances' {name} must be of type VEC{width}"))),
            }
        }
    };
    let parts = [read("TRANSLATION", 3)?, read("SCALE", 3)?, read("ROTATION", 4)?];
    // Instances without any of these would need no bytes at all.
    document.spend(&format!("node {node}"), count)?;
    (0..count).map(|i| transform(&parts, i).map_err(wrong)).collect()
}

/// Returns the transform of instance `i` from translations, scales and rotations.
fn transform(parts: &[Option<Vec<f32>>; 3], i: usize) -> Result<[[f64; 4]; 4], String> {
    let [translations, scales, rotations] = parts;
    let vector = |values: &Option<Vec<f32>>, default: f64| match values {
        Some(values) => DVec3::from_array(std::array::from_fn(|k| f64::from(values[3 * i + k]))),
        None => DVec3::splat(default),
    };
    let rotation = match rotations {
        Some(values) => DQuat::from_array(std::array::from_fn(|k| f64::from(values[4 * i + k]))),
        None => DQuat::IDENTITY,
    };
    // Bytes and shorts are well off unit length.
    let length = rotation.length();
    if !(0.5..2.0).contains(&length) {
        return Err(format!(
            "instance {i} must be turned by a unit quaternion, not one of {length}"
        ));
    }
    let (scale, translation) = (vector(scales, 1.0), vector(translations, 0.0));
    let matrix = DMat4::from_scale_rotation_translation(scale, rotation.normalize(), translation);
    Ok(matrix.to_cols_array_2d())
}
