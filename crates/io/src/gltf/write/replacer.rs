//! Replacement of the geometry in the JSON of a glTF mesh.

use std::collections::{BTreeMap, BTreeSet};

use meshlod_mesh::{Layer, Mesh};
use serde_json::{Map, Value, json};

use super::arrays;
use super::arrays::{Arrays, Numbers, Typed};
use super::attribute_names::by_attribute;
use super::buffer::BufferBuilder;
use super::needle::stand_in::stand_in;
use super::quantized::grid::QuantizationGrid;
use super::settings::{Compression, CompressionReport};
use crate::error::Unsupported;
use crate::gltf::document::Document;
use crate::gltf::document::extensions::{MESHOPT, list_extension};
use crate::gltf::document::primitive_kind::{attributes, is_surface, known_attributes};
use crate::gltf::document::schema::parse_target_name;

/// Writer of new geometry into the meshes of a document.
pub(crate) struct Replacer<'a> {
    pub document: Option<&'a Document<'a>>,
    pub builder: BufferBuilder,
    /// Compression options, if the output is compressed.
    pub compression: Option<&'a Compression>,
    /// Largest distance that quantization moved a vertex.
    pub position_error: f64,
}

/// Points and lines among the primitives of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lines {
    /// They stay.
    Kept,
    /// A triangle without area takes their place.
    StoodInFor,
}

impl<'a> Replacer<'a> {
    pub fn new(document: Option<&'a Document<'a>>, builder: BufferBuilder) -> Self {
        Self { document, builder, compression: None, position_error: 0.0 }
    }

    /// Replaces the triangle primitives in the JSON of a glTF mesh with the faces of `mesh`.
    ///
    /// Primitives keep everything except their arrays. Each gets its old attributes, and new ones
    /// that no primitive had. A primitive left without faces is dropped; a mesh left without faces
    /// keeps one degenerate primitive. Positions are quantized to the grid, if there is one.
    /// Returns true if the mesh has no faces.
    ///
    /// # Errors
    /// If the mesh is invalid or a face's label is not a triangle primitive; also errors of
    /// [`arrays::arrays`].
    pub fn replace(
        &mut self,
        json: &mut Value,
        mesh: &Mesh,
        grid: Option<&QuantizationGrid>,
    ) -> Result<bool, Unsupported> {
        let numbers = Numbers { compression: self.compression, grid };
        let (old, faces) = primitives(json, mesh)?;
        let layers = by_attribute(mesh);
        let known = known_attributes(&old);
        let mut new = Vec::new();
        for (primitive, faces) in old.iter().zip(&faces) {
            if !is_surface(primitive) {
                new.push(primitive.clone());
            } else if !faces.is_empty() {
                let (names, typed) = self.layers_of(primitive, &layers, &known);
                let arrays = arrays::arrays(mesh, faces, &typed, numbers)?;
                new.extend(self.with_arrays(primitive, arrays, &names));
            }
        }
        let is_empty = new.is_empty();
        if is_empty {
            new = self.nothing(mesh, &old)?;
        }
        json["primitives"] = new.into();
        Ok(is_empty)
    }

    /// Replaces the triangle primitives in the JSON of a glTF mesh like [`replace`](Self::replace),
    /// but keeps all of them, in order; returns the number of faces of each.
    ///
    /// One without faces gets a triangle without area, with the bounds and attributes of its faces
    /// in `finest`, which must have faces.
    ///
    /// # Errors
    /// Those of [`replace`](Self::replace).
    pub fn replace_all(
        &mut self,
        json: &mut Value,
        (mesh, finest): (&Mesh, &Mesh),
        grid: Option<&QuantizationGrid>,
        lines: Lines,
    ) -> Result<Vec<usize>, Unsupported> {
        let numbers = Numbers { compression: self.compression, grid };
        let (old, faces) = primitives(json, mesh)?;
        let (_, faces_before) = primitives(json, finest)?;
        let known = known_attributes(&old);
        let mut new = Vec::new();
        for (at, primitive) in old.iter().enumerate() {
            if !is_surface(primitive) {
                new.extend(match lines {
                    Lines::Kept => vec![primitive.clone()],
                    Lines::StoodInFor => self.nothing(finest, &[])?,
                });
                continue;
            }
            let other: Mesh;
            let (mesh, faces) = match faces[at].is_empty() {
                true => {
                    other = stand_in(finest, &faces_before[at]);
                    (&other, &[0][..])
                }
                false => (mesh, &faces[at][..]),
            };
            let (names, typed) = self.layers_of(primitive, &by_attribute(mesh), &known);
            let arrays = arrays::arrays(mesh, faces, &typed, numbers)?;
            new.extend(self.with_arrays(primitive, arrays, &names));
        }
        json["primitives"] = new.into();
        Ok(faces.iter().map(Vec::len).collect())
    }

    /// Returns the layers of a primitive and their attribute names: its old attributes, and new
    /// ones that no primitive had.
    pub fn layers_of<'l>(
        &self,
        primitive: &Value,
        layers: &BTreeMap<String, &'l Layer>,
        known: &BTreeSet<String>,
    ) -> (Vec<String>, Vec<Typed<'l>>) {
        let own = attributes(primitive);
        let of_file = |name: &String| {
            let accessor = self.document?.accessors.get(*own.get(name)?)?;
            Some(accessor.component_type)
        };
        layers
            .iter()
            .filter(|(name, _)| own.contains_key(*name) || !known.contains(*name))
            .map(|(name, &layer)| (name.clone(), Typed { layer, component: of_file(name) }))
            .unzip()
    }

    /// Returns one degenerate primitive for a mesh without faces.
    pub fn nothing(&mut self, mesh: &Mesh, old: &[Value]) -> Result<Vec<Value>, Unsupported> {
        let point = mesh.positions.first().copied().unwrap_or_default();
        let arrays = arrays::nothing(point)?;
        Ok(self.with_arrays(old.first().unwrap_or(&json!({})), arrays, &[]))
    }

    /// Returns the sizes of the compressed arrays and the quantization error.
    pub fn report(&self, kept: Vec<String>) -> CompressionReport {
        let [positions, connectivity, attributes] = self.builder.added;
        let max_position_error = self.position_error;
        CompressionReport { positions, connectivity, attributes, max_position_error, kept }
    }

    /// Declares the extensions that the new arrays require in the JSON document.
    pub fn list_extensions(&self, json: &mut Value) {
        let needed = [
            ("KHR_mesh_quantization", self.builder.is_quantized()),
            (MESHOPT[0], self.builder.is_compressed()),
        ];
        for (extension, _) in needed.into_iter().filter(|&(_, needed)| needed) {
            list_extension(json, "extensionsUsed", extension);
            list_extension(json, "extensionsRequired", extension);
        }
    }

    /// Returns copies of the primitive with new arrays, one for each array of indices; `names` are
    /// the names of the layers.
    pub fn with_arrays(
        &mut self,
        primitive: &Value,
        arrays: Arrays,
        names: &[String],
    ) -> Vec<Value> {
        self.position_error = self.position_error.max(arrays.position_error);
        let mut attributes = Map::new();
        let mut targets: Vec<Map<String, Value>> = Vec::new();
        attributes.insert("POSITION".into(), self.builder.add(arrays.positions).into());
        for (name, blob) in names.iter().zip(arrays.layers) {
            let accessor = self.builder.add(blob).into();
            match parse_target_name(name) {
                None => drop(attributes.insert(name.clone(), accessor)),
                Some((target, attribute)) => {
                    targets.resize_with(targets.len().max(target + 1), Map::new);
                    targets[target].insert(attribute.to_owned(), accessor);
                }
            }
        }
        let mut new = primitive.clone();
        new["attributes"] = attributes.into();
        // In its place among the entries.
        new["indices"] = Value::Null;
        if let Some(entries) = new.as_object_mut() {
            entries.shift_remove("mode");
            entries.shift_remove("targets");
        }
        if !targets.is_empty() {
            new["targets"] = targets.into();
        }
        let with_indices = |indices| {
            let mut new = new.clone();
            new["indices"] = self.builder.add(indices).into();
            new
        };
        arrays.indices.into_iter().map(with_indices).collect()
    }
}

/// Returns the primitives in the JSON of a glTF mesh, and the faces of `mesh` that each gets.
fn primitives(json: &Value, mesh: &Mesh) -> Result<(Vec<Value>, Vec<Vec<u32>>), Unsupported> {
    let name = json.get("name").and_then(Value::as_str).unwrap_or_default();
    let wrong = |reason: String| Unsupported::new(format!("mesh {name:?}"), reason);
    mesh.validate().map_err(|error| wrong(error.to_string()))?;
    let old = json.get("primitives").and_then(Value::as_array).cloned().unwrap_or_default();
    let faces = faces_by_primitive(mesh, &old).map_err(wrong)?;
    Ok((old, faces))
}

/// Groups the faces by primitive; without labels, all are in the first triangle primitive.
pub(crate) fn faces_by_primitive(
    mesh: &Mesh,
    primitives: &[Value],
) -> Result<Vec<Vec<u32>>, String> {
    let mut faces = vec![Vec::new(); primitives.len()];
    let only = primitives.iter().position(is_surface).unwrap_or(0);
    for face in 0..mesh.faces.len() {
        let label = mesh.materials.as_ref().map_or(only, |labels| labels.of(face) as usize);
        match faces.get_mut(label) {
            Some(faces) if is_surface(&primitives[label]) => faces.push(face as u32),
            _ => {
                let count = primitives.len();
                return Err(format!(
                    "face f{face} has label {label}, which is not one of its {count} triangle \
                     primitives"
                ));
            }
        }
    }
    Ok(faces)
}
