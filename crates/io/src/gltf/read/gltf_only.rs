//! Parts of a glTF document that neither a scene's fields nor other formats can hold.

use serde_json::Value;

use crate::gltf::document::entries::entries;
use crate::gltf::document::extensions::{DRACO, INSTANCING, MESHOPT};
use crate::gltf::document::primitive_kind::is_surface;
use crate::gltf::document::source::SourceDocument;
use crate::notes::Note;
use crate::scene::Scene;

impl SourceDocument {
    /// Notes the parts of the document that are in no field of the scene.
    pub(crate) fn unheld_parts(&self) -> Vec<Note> {
        unheld_parts(&self.0.json)
    }
}

/// Notes the parts of a document other than surfaces, nodes, materials, skins, animations, cameras
/// and lights, which files of other formats lack.
pub(crate) fn unheld_parts(json: &Value) -> Vec<Note> {
    let curves = points_and_lines(json);
    let scenes = entries(json, "scenes").count().saturating_sub(1);
    let extensions = extensions(json);
    let places = places_of_extras(json);
    let copyrights = usize::from(json.pointer("/asset/copyright").is_some());
    let lines = ("primitive of points or lines", "primitives of points or lines");
    vec![
        Note::left_out(curves.len(), lines.0, lines.1).named(curves),
        Note::left_out(scenes, "scene beside the shown one", "scenes beside the shown one"),
        Note::left_out(extensions.len(), "extension of glTF", "extensions of glTF")
            .named(extensions),
        Note::left_out(places.len(), "entry with extras", "entries with extras").named(places),
        Note::left_out(copyrights, "copyright notice", "copyright notices"),
    ]
}

impl Scene {
    /// Returns true if the scene was read from a document of points or lines, and has no face.
    pub fn has_only_points(&self) -> bool {
        let has_points = |source: &SourceDocument| !points_and_lines(&source.0.json).is_empty();
        self.meshes.iter().all(|mesh| mesh.mesh.faces.is_empty())
            && self.source.as_ref().is_some_and(has_points)
    }
}

/// Returns the mesh of each primitive without faces, by name or as `mesh 3`.
fn points_and_lines(json: &Value) -> Vec<String> {
    let of_mesh = |(index, mesh): (usize, &Value)| {
        let count = entries(mesh, "primitives").filter(|primitive| !is_surface(primitive)).count();
        let name = match mesh["name"].as_str() {
            Some(name) if !name.is_empty() => name.to_owned(),
            _ => format!("mesh {index}"),
        };
        std::iter::repeat_n(name, count)
    };
    entries(json, "meshes").enumerate().flat_map(of_mesh).collect()
}

/// Lists the extensions that are neither in the scene nor noted otherwise.
fn extensions(json: &Value) -> Vec<String> {
    const ELSEWHERE: [&str; 6] =
        ["KHR_mesh_quantization", "KHR_lights_punctual", INSTANCING, MESHOPT[0], MESHOPT[1], DRACO];
    // Those of materials and textures are noted with the materials.
    const OF_MATERIALS: [&str; 4] =
        ["KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_"];
    let is_elsewhere = |name: &str| {
        ELSEWHERE.contains(&name)
            || name != "KHR_materials_variants" && OF_MATERIALS.iter().any(|p| name.starts_with(p))
    };
    let names = entries(json, "extensionsUsed").filter_map(Value::as_str);
    names.filter(|name| !is_elsewhere(name)).map(str::to_owned).collect()
}

/// Lists the entries of the document that have extras anywhere inside, as in `nodes 3`.
fn places_of_extras(json: &Value) -> Vec<String> {
    let mut places = Vec::new();
    for (key, value) in json.as_object().into_iter().flatten() {
        match value {
            _ if key == "extras" => places.push("document".to_owned()),
            Value::Array(values) => {
                let with = values.iter().enumerate().filter(|(_, value)| has_extras(value));
                places.extend(with.map(|(index, _)| format!("{key} {index}")));
            }
            _ if has_extras(value) => places.push(key.clone()),
            _ => {}
        }
    }
    places
}

/// Reports whether there are extras at any depth, which the JSON parser bounds. Names of morph
/// targets do not count, since the targets are noted.
fn has_extras(value: &Value) -> bool {
    match value {
        Value::Array(values) => values.iter().any(has_extras),
        Value::Object(entries) => entries.iter().any(|(key, value)| match key.as_str() {
            "extras" => value.as_object().is_none_or(|all| all.keys().any(|k| k != "targetNames")),
            _ => has_extras(value),
        }),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn what_other_formats_lack_is_counted_and_named() {
        let json = json!({
            "asset": { "version": "2.0", "copyright": "2026 Someone" },
            "extras": 1,
            "scenes": [{ "nodes": [0] }, { "nodes": [1], "extras": {} }, {}],
            "nodes": [{ "mesh": 0 }, { "extras": { "tag": 7 } }],
            "meshes": [
                { "primitives": [{ "mode": 1 }, { "mode": 4 }, { "mode": 0 }] },
                { "name": "grid", "primitives": [{ "mode": 3 }, {}],
                  "extras": { "targetNames": ["smile"] } },
            ],
            "extensionsUsed": ["KHR_materials_unlit", "KHR_materials_variants", "VRM"],
        });
        let notes = unheld_parts(&json);
        let texts: Vec<String> = notes.iter().map(Note::to_string).collect();
        let expected = [
            "3 primitives of points or lines (mesh 0, mesh 0, grid)",
            "2 scenes beside the shown one",
            "2 extensions of glTF (KHR_materials_variants, VRM)",
            "2 entries with extras (document, nodes 1)",
            "1 copyright notice",
        ];
        assert_eq!(texts, expected);
    }

    #[test]
    fn a_plain_or_damaged_document_has_nothing_beside() {
        for json in [json!({ "meshes": [{ "primitives": [{}] }], "scenes": [{}] }), json!([7])] {
            assert!(unheld_parts(&json).iter().all(|note| note.count == 0));
        }
    }
}
