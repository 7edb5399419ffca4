//! Levels of one mesh: the coarsest for the document, each other in a file.

use std::mem;

use meshlod_mesh::Mesh;
use serde_json::{Map, Value, json};

use super::densities::{of_one_triangle, rounded};
use super::part::{PartFile, head, id};
use crate::error::Unsupported;
use crate::gltf::document::extensions::{NEEDLE, list_extension};
use crate::gltf::write::buffer::BufferBuilder;
use crate::gltf::write::levels::{Level, Needle, NeedleLevels};
use crate::gltf::write::quantized::grid::QuantizationGrid;
use crate::gltf::write::replacer::{Lines, Replacer, faces_by_primitive};
use crate::gltf::write::same_geometry::same_geometry;
use crate::scene::Image;

/// Distinct levels of a mesh.
pub(crate) struct MeshChain<'a> {
    index: usize,
    /// The levels by number, finest first; at least one.
    levels: Vec<(usize, &'a Mesh)>,
}

/// File of a level before it has an id.
struct LevelDraft {
    number: usize,
    json: Map<String, Value>,
    buffer: Vec<u8>,
    /// Faces of each primitive.
    faces: Vec<usize>,
}

impl<'a> MeshChain<'a> {
    /// Collects the levels of the mesh with an index; those that are the same as the one before are
    /// left out.
    pub fn of(index: usize, finest: &'a Mesh, levels: &'a [Level]) -> Self {
        let mut distinct = vec![(0, finest)];
        for (k, level) in levels.iter().enumerate() {
            let mesh = &level.meshes[index];
            if !distinct.last().is_some_and(|(_, before)| same_geometry(before, mesh)) {
                distinct.push((k + 1, mesh));
            }
        }
        Self { index, levels: distinct }
    }

    /// Writes the coarsest level in place of `template`, a mesh of the document, and returns it with
    /// the files of all others.
    pub fn write(
        &self,
        template: &Value,
        grid: Option<&QuantizationGrid>,
        needle: &Needle<'_>,
        replacer: &mut Replacer<'_>,
    ) -> Result<(Value, Vec<Image>), Unsupported> {
        let (_, finest) = self.levels[0];
        let (&(number, coarsest), finer) = self.levels.split_last().expect("the finest is there");
        let mut shown = template.clone();
        replacer.replace_all(&mut shown, (coarsest, finest), grid, Lines::Kept)?;
        if finer.is_empty() {
            return Ok((shown, Vec::new()));
        }
        let draft = |&(number, mesh)| draft(template, (number, mesh, finest), grid, replacer);
        let drafts = finer.iter().map(draft).collect::<Result<Vec<_>, _>>()?;
        let index = self.index.to_string();
        let texts = [needle.stem.as_bytes(), b"mesh", index.as_bytes()];
        let guid = id(texts.into_iter().chain(drafts.iter().map(|draft| &draft.buffer[..])));
        let primitives = template["primitives"].as_array().map_or(&[][..], |own| own);
        let faces = faces_by_primitive(finest, primitives);
        let faces = faces.map_err(|reason| Unsupported::new(format!("mesh {index}"), reason))?;
        let one = of_one_triangle(finest, &faces);
        let (mut lods, mut files) = (Vec::new(), Vec::new());
        for draft in drafts {
            let (entry, file) = self.finish(draft, &guid, &one, needle)?;
            lods.push(entry);
            files.push(file);
        }
        let extras = extras(number, &needle.levels);
        let own = json!({ "guid": guid, "lods": lods, "extras": extras });
        set_extension(&mut shown, own);
        Ok((shown, files))
    }

    /// Makes a file of a level, and its entry in `lods`.
    fn finish(
        &self,
        draft: LevelDraft,
        guid: &str,
        one_triangle: &[f64],
        needle: &Needle<'_>,
    ) -> Result<(Value, Image), Unsupported> {
        let LevelDraft { number, json: mut document, buffer, faces } = draft;
        let [indices, vertices] = counts(&document);
        set_extension(&mut document["meshes"][0], json!({ "guid": guid }));
        let name = format!("mesh{}_LOD{number}", self.index);
        let part = PartFile::new(needle.stem, &name, document, &buffer)?;
        let densities = faces.iter().zip(one_triangle).map(|(&n, one)| rounded(n as f64 * one));
        let entry = json!({
            "path": part.path,
            "hash": part.hash,
            "densities": densities.collect::<Vec<_>>(),
            "indexCount": indices,
            "vertexCount": vertices,
            "extras": extras(number, &needle.levels),
        });
        Ok((entry, part.file))
    }
}

/// Writes a level of a mesh as a document of its own, without materials: the client takes only
/// geometry from it.
fn draft(
    template: &Value,
    (number, mesh, finest): (usize, &Mesh, &Mesh),
    grid: Option<&QuantizationGrid>,
    replacer: &mut Replacer<'_>,
) -> Result<LevelDraft, Unsupported> {
    let mut new = template.clone();
    let primitives = new.get_mut("primitives").and_then(Value::as_array_mut);
    for primitive in primitives.into_iter().flatten().filter_map(Value::as_object_mut) {
        ["material", "extensions", "extras"]
            .iter()
            .for_each(|key| drop(primitive.shift_remove(*key)));
    }
    let of_document = mem::take(&mut replacer.builder);
    let replaced = replacer.replace_all(&mut new, (mesh, finest), grid, Lines::StoodInFor);
    let builder: BufferBuilder = mem::replace(&mut replacer.builder, of_document);
    let faces = replaced?;
    let mut document = Value::Object(head());
    list_extension(&mut document, "extensionsUsed", NEEDLE);
    // A node, so that other programs show the file.
    document["scene"] = 0.into();
    document["scenes"] = json!([{ "nodes": [0] }]);
    document["nodes"] = json!([{ "mesh": 0 }]);
    document["meshes"] = json!([new]);
    let mut json = document.as_object().cloned().unwrap_or_default();
    let buffer = builder.finish(&mut json);
    Ok(LevelDraft { number, json, buffer, faces })
}

/// Says which level this is and how far from the input, for readers of ours.
fn extras(number: usize, levels: &NeedleLevels<'_>) -> Value {
    let error = match number.checked_sub(1) {
        None => Some(0.0),
        Some(k) => levels.errors.get(k).copied().flatten(),
    };
    json!({ "level": format!("LOD{number}"), "error_measured": error })
}

/// Counts the indices and vertices of the first mesh of a document.
fn counts(json: &Map<String, Value>) -> [u64; 2] {
    let primitives = json["meshes"][0]["primitives"].as_array();
    let count = |accessor: &Value| {
        let accessor = accessor.as_u64().unwrap_or_default() as usize;
        json["accessors"][accessor]["count"].as_u64().unwrap_or_default()
    };
    let all = primitives.into_iter().flatten();
    all.fold([0, 0], |[indices, vertices], primitive| {
        let positions = &primitive["attributes"]["POSITION"];
        [indices + count(&primitive["indices"]), vertices + count(positions)]
    })
}

/// Sets the extension of a mesh or texture.
pub(crate) fn set_extension(of: &mut Value, own: Value) {
    if !of["extensions"].is_object() {
        of["extensions"] = json!({});
    }
    of["extensions"][NEEDLE] = own;
}
