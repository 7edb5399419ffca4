//! The geometry of a mesh put into its JSON.

use std::collections::{BTreeMap, BTreeSet};

use meshlod_mesh::{Layer, LayerKind, Mesh};
use serde_json::{Map, Value, json};

use super::buffer_builder::BufferBuilder;
use super::compress::{Compression, CompressionReport, QuantizationGrid};
use super::decompress::MESHOPT;
use super::document::Document;
use super::encode::{self, Arrays, Numbers, Typed};
use super::lod;
use super::schema::{self, parse_target_name};
use crate::Unsupported;

/// Where geometry goes to, and the document that it came from, if any.
pub(super) struct Replacer<'a> {
    pub document: Option<&'a Document<'a>>,
    pub pool: BufferBuilder,
    /// How small numbers are written, if they are.
    pub compression: Option<&'a Compression>,
    /// The farthest that a vertex moved by it.
    pub position_error: f64,
}

impl<'a> Replacer<'a> {
    pub fn new(document: Option<&'a Document<'a>>, pool: BufferBuilder) -> Self {
        Self { document, pool, compression: None, position_error: 0.0 }
    }

    /// Replaces the triangle primitives in the JSON of a mesh by the faces of `mesh`.
    ///
    /// Primitives keep all but their arrays, of which they have the kinds that they had, and those
    /// that no primitive had. Primitives that no face is left of go; of a mesh that has no face
    /// one stays that shows nothing. Positions lie on the grid, if there is one.
    ///
    /// # Errors
    /// When the mesh is not valid, when a face's label names no triangle primitive, or see
    /// [`encode::arrays`].
    pub fn replace(
        &mut self,
        json: &mut Value,
        mesh: &Mesh,
        grid: Option<&QuantizationGrid>,
    ) -> Result<(), Unsupported> {
        let numbers = Numbers { compression: self.compression, grid };
        let name = json.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
        let wrong = |reason: String| Unsupported::new(format!("mesh {name:?}"), reason);
        mesh.validate().map_err(|error| wrong(error.to_string()))?;
        let old = json.get("primitives").and_then(Value::as_array).cloned().unwrap_or_default();
        let faces = faces_by_primitive(mesh, &old).map_err(wrong)?;
        let layers = by_attribute(mesh);
        let known: BTreeSet<String> =
            old.iter().flat_map(attributes).map(|(name, _)| name).collect();
        let mut new = Vec::new();
        for (primitive, faces) in old.iter().zip(&faces) {
            if !is_surface(primitive) {
                new.push(primitive.clone());
            } else if !faces.is_empty() {
                let own = attributes(primitive);
                let of_file = |name: &String| {
                    let accessor = self.document?.accessors.get(*own.get(name)?)?;
                    Some(accessor.component_type)
                };
                let (names, typed): (Vec<&String>, Vec<Typed<'_>>) = layers
                    .iter()
                    .filter(|(name, _)| own.contains_key(*name) || !known.contains(*name))
                    .map(|(name, &layer)| (name, Typed { layer, component: of_file(name) }))
                    .unzip();
                let arrays = encode::arrays(mesh, faces, &typed, numbers)?;
                new.push(self.with_arrays(primitive, arrays, &names));
            }
        }
        if new.is_empty() {
            let point = mesh.positions.first().copied().unwrap_or_default();
            let arrays = encode::nothing(point)?;
            new.push(self.with_arrays(old.first().unwrap_or(&json!({})), arrays, &[]));
        }
        json["primitives"] = new.into();
        Ok(())
    }

    /// What compression came to.
    pub fn report(&self, kept: Vec<String>) -> CompressionReport {
        let [positions, connectivity, attributes] = self.pool.added;
        let max_position_error = self.position_error;
        CompressionReport { positions, connectivity, attributes, max_position_error, kept }
    }

    /// Names the extensions that the arrays need.
    pub fn list_extensions(&self, json: &mut Value) {
        let needed = [
            ("KHR_mesh_quantization", self.pool.is_quantized()),
            (MESHOPT[0], self.pool.is_packed()),
        ];
        for (extension, _) in needed.into_iter().filter(|&(_, needed)| needed) {
            lod::list_extension(json, "extensionsUsed", extension);
            lod::list_extension(json, "extensionsRequired", extension);
        }
    }

    /// The primitive with other arrays, those of `names` in order.
    fn with_arrays(&mut self, primitive: &Value, arrays: Arrays, names: &[&String]) -> Value {
        self.position_error = self.position_error.max(arrays.position_error);
        let mut attributes = Map::new();
        let mut targets: Vec<Map<String, Value>> = Vec::new();
        attributes.insert("POSITION".into(), self.pool.add(arrays.positions).into());
        for (name, blob) in names.iter().zip(arrays.layers) {
            let accessor = self.pool.add(blob).into();
            match parse_target_name(name) {
                None => drop(attributes.insert((*name).clone(), accessor)),
                Some((target, attribute)) => {
                    targets.resize_with(targets.len().max(target + 1), Map::new);
                    targets[target].insert(attribute.to_owned(), accessor);
                }
            }
        }
        let mut new = primitive.clone();
        new["attributes"] = attributes.into();
        new["indices"] = self.pool.add(arrays.indices).into();
        if let Some(entries) = new.as_object_mut() {
            entries.shift_remove("mode");
            entries.shift_remove("targets");
        }
        if !targets.is_empty() {
            new["targets"] = targets.into();
        }
        new
    }
}

/// Whether the JSON of a primitive is of triangles, and so of what is replaced.
pub(super) fn is_surface(primitive: &Value) -> bool {
    matches!(primitive.get("mode").and_then(Value::as_u64), None | Some(4..=6))
}

/// The accessors of a primitive's attributes by layer name.
pub(super) fn attributes(primitive: &Value) -> BTreeMap<String, usize> {
    let typed = <schema::Primitive as serde::Deserialize>::deserialize(primitive);
    typed.ok().and_then(|primitive| primitive.accessors().ok()).into_iter().flatten().collect()
}

/// The faces of each primitive. Without labels, all are of the first that has triangles.
fn faces_by_primitive(mesh: &Mesh, primitives: &[Value]) -> Result<Vec<Vec<u32>>, String> {
    let mut faces = vec![Vec::new(); primitives.len()];
    let only = primitives.iter().position(is_surface).unwrap_or(0);
    for face in 0..mesh.faces.len() {
        let label = mesh.materials.as_ref().map_or(only, |labels| labels.of(face) as usize);
        match faces.get_mut(label) {
            Some(faces) if is_surface(&primitives[label]) => faces.push(face as u32),
            _ => {
                let count = primitives.len();
                return Err(format!(
                    "face f{face} has label {label}, which is none of its {count} triangle primitives"
                ));
            }
        }
    }
    Ok(faces)
}

/// The layers of a mesh by the names of attributes that they are written under.
fn by_attribute(mesh: &Mesh) -> BTreeMap<String, &Layer> {
    let mut named: BTreeMap<String, &Layer> = BTreeMap::new();
    let layers = mesh.attributes.as_ref().map_or(&[][..], |attributes| &attributes.layers);
    for layer in layers {
        let mut name = attribute_name(layer);
        // Two names can become the same; no layer is lost for it.
        while named.contains_key(&name) {
            name.push('_');
        }
        named.insert(name, layer);
    }
    named
}

fn attribute_name(layer: &Layer) -> String {
    match layer.kind {
        LayerKind::Normal => "NORMAL".into(),
        LayerKind::Tangent => "TANGENT".into(),
        LayerKind::Uv(set) => format!("TEXCOORD_{set}"),
        LayerKind::Color(set) => format!("COLOR_{set}"),
        LayerKind::Joints(set) => format!("JOINTS_{set}"),
        LayerKind::Weights(set) => format!("WEIGHTS_{set}"),
        LayerKind::Other if layer.name.starts_with('_') => layer.name.clone(),
        LayerKind::Other if parse_target_name(&layer.name).is_some() => layer.name.clone(),
        // The format wants an underscore and capitals for names of one's own.
        LayerKind::Other => {
            let plain =
                |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' };
            format!("_{}", layer.name.chars().map(plain).collect::<String>())
        }
    }
}
