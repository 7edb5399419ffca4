//! Triangle strips in glTF, and their levels.

use serde_json::Value;

use super::attribute_names::by_attribute;
use super::buffer::BufferBuilder;
use super::buffer::accessor_use::free_accessors;
use super::new_document::copies::with_copies_as_nodes;
use super::new_document::local_space::localized;
use super::output::{GltfFiles, Output, check_meshes, unreadable};
use super::replacer::Replacer;
use super::settings::CompressionReport;
use super::strip_mesh::{StripCorner, StripMesh};
use super::{arrays, buffer_name, lod, new_document};
use crate::error::Unsupported;
use crate::gltf::document::Document;
use crate::gltf::document::entries::extend;
use crate::gltf::document::primitive_kind::{is_surface, known_attributes};
use crate::scene::Scene;

/// Primitive mode of a triangle strip.
const TRIANGLE_STRIP: u32 = 5;

/// Encodes a scene as a GLB file with triangle strips in place of faces.
///
/// `strips` has an entry for each of the scene's [instances](Scene::instances), in the space of its
/// mesh: a mesh that several nodes show is then written once for each. Or it has fewer, one for each
/// mesh that the scene shows, in their order, which all its nodes share. A primitive has the same
/// vertices at all levels. Levels are linked by `MSFT_lod`; everything else is written as by
/// [`write_glb`](super::write_glb).
///
/// # Errors
/// If the strips do not fit the scene; also errors of [`write_glb`](super::write_glb).
pub fn write_strips_glb(scene: &Scene, strips: &[StripMesh]) -> Result<Vec<u8>, Unsupported> {
    Output::of_strips(scene, strips)?.into_glb(scene)
}

/// Encodes a scene like [`write_strips_glb`], but as a file `stem.gltf` with its buffer and images.
///
/// # Errors
/// Errors of [`write_strips_glb`], except for the size.
pub fn write_strips(
    scene: &Scene,
    strips: &[StripMesh],
    stem: &str,
) -> Result<GltfFiles, Unsupported> {
    strip_files(scene, strips, &|_| buffer_name(stem))
}

/// Encodes a scene like [`write_strips`]; `name` names the buffer by its bytes.
pub(crate) fn strip_files(
    scene: &Scene,
    strips: &[StripMesh],
    name: &dyn Fn(&[u8]) -> String,
) -> Result<GltfFiles, Unsupported> {
    Output::of_strips(scene, strips)?.into_files(scene, name)
}

impl Output {
    fn of_strips(scene: &Scene, strips: &[StripMesh]) -> Result<Self, Unsupported> {
        let Some(source) = &scene.source else {
            let scene = with_copies_as_nodes(scene);
            let (scene, _) = localized(&scene, &[]);
            let mut builder = BufferBuilder::default();
            let json = new_document::document(&scene, &scene.images, &mut builder);
            return finish(json, &scene, Replacer::new(None, builder), strips);
        };
        let source = &source.0;
        let document = Document::new(&source.json, &source.buffers).map_err(unreadable)?;
        check_meshes(scene, &document)?;
        let mut changed = vec![false; document.meshes.len()];
        scene.instances().iter().for_each(|instance| changed[instance.mesh] = true);
        let builder = BufferBuilder::of(&document, &free_accessors(&document, &changed));
        finish(source.json.clone(), scene, Replacer::new(Some(&document), builder), strips)
    }
}

/// Puts the strips and their levels into a document.
fn finish(
    mut json: Value,
    scene: &Scene,
    mut replacer: Replacer<'_>,
    strips: &[StripMesh],
) -> Result<Output, Unsupported> {
    let own = meshes_of_strips(&mut json, scene, strips.len())?;
    let count = json["meshes"].as_array().map_or(0, Vec::len);
    let mut coarser = vec![Vec::new(); count];
    for (&index, strips) in own.iter().zip(strips) {
        let mut levels = replacer.strips(&json["meshes"][index], strips)?.into_iter();
        if let Some(finest) = levels.next() {
            json["meshes"][index] = finest;
        }
        // What draws nothing at any level has none.
        let is_drawn = strips.levels.iter().flatten().any(|strip| !strip.is_empty());
        let levels: Vec<Value> = levels.filter(|_| is_drawn).collect();
        let number = levels.len();
        if number > 0 {
            let first = extend(&mut json, "meshes", levels);
            coarser[index] = (first..first + number).collect();
        }
    }
    if coarser.iter().any(|ids| !ids.is_empty()) {
        lod::link_nodes(&mut json, |mesh| coarser.get(mesh).cloned().unwrap_or_default(), None);
    }
    match json {
        Value::Object(json) => Ok(Output {
            json,
            builder: replacer.builder,
            report: CompressionReport::default(),
            parts: Vec::new(),
        }),
        _ => Err(Unsupported::new("source", "is not a JSON object")),
    }
}

/// Returns the indices of the meshes in the document that get so many strips: those that the scene
/// shows, or one for each instance.
fn meshes_of_strips(
    json: &mut Value,
    scene: &Scene,
    strips: usize,
) -> Result<Vec<usize>, Unsupported> {
    let instances = scene.instances();
    if strips == instances.len() {
        return Ok(own_meshes(json, scene));
    }
    let mut shown: Vec<usize> = instances.iter().map(|instance| instance.mesh).collect();
    shown.sort_unstable();
    shown.dedup();
    match strips == shown.len() {
        true => Ok(shown),
        false => {
            let (all, shown) = (instances.len(), shown.len());
            let reason =
                format!("there are {strips}, but the scene has {all} instances of {shown} meshes");
            Err(Unsupported::new("strips", reason))
        }
    }
}

/// Gives every instance of the scene its own mesh, and returns their indices in the document.
fn own_meshes(json: &mut Value, scene: &Scene) -> Vec<usize> {
    let mut is_taken = vec![false; scene.meshes.len()];
    let own = scene.instances().into_iter().map(|instance| {
        if !std::mem::replace(&mut is_taken[instance.mesh], true) {
            return instance.mesh;
        }
        let copy = json["meshes"][instance.mesh].clone();
        let index = extend(json, "meshes", vec![copy]);
        let node = json.get_mut("nodes").and_then(|nodes| nodes.get_mut(instance.node));
        if let Some(node) = node {
            node["mesh"] = index.into();
        }
        index
    });
    own.collect()
}

impl Replacer<'_> {
    /// Returns the JSON of a glTF mesh with triangle strips for its faces, once for each level.
    ///
    /// # Errors
    /// If a strip's label is not a triangle primitive or its corners are not of the mesh; also
    /// errors of [`arrays::strip_arrays`].
    fn strips(&mut self, template: &Value, strips: &StripMesh) -> Result<Vec<Value>, Unsupported> {
        let StripMesh { mesh, levels } = strips;
        let old = template.get("primitives").and_then(Value::as_array).cloned().unwrap_or_default();
        check(strips, &old)?;
        let layers = by_attribute(mesh);
        let known = known_attributes(&old);
        let mut new = vec![Vec::new(); levels.len()];
        for (label, primitive) in old.iter().enumerate() {
            if !is_surface(primitive) {
                new.iter_mut().for_each(|level| level.push(primitive.clone()));
                continue;
            }
            let strips = levels.iter().map(|level| level.get(label).map_or(&[][..], Vec::as_slice));
            let (drawn, strips): (Vec<usize>, Vec<&[StripCorner]>) =
                strips.enumerate().filter(|(_, strip)| !strip.is_empty()).unzip();
            if drawn.is_empty() {
                continue;
            }
            let (names, typed) = self.layers_of(primitive, &layers, &known);
            let arrays = arrays::strip_arrays(mesh, &strips, &typed)?;
            let primitives = self.with_arrays(primitive, arrays, &names);
            for (level, mut primitive) in drawn.into_iter().zip(primitives) {
                primitive["mode"] = TRIANGLE_STRIP.into();
                new[level].push(primitive);
            }
        }
        new.into_iter()
            .enumerate()
            .map(|(level, primitives)| {
                let is_empty = primitives.is_empty();
                let primitives = if is_empty { self.nothing(mesh, &old)? } else { primitives };
                Ok(named(template, level, primitives))
            })
            .collect()
    }
}

/// Returns a copy of a glTF mesh with other primitives, named as a level.
fn named(template: &Value, level: usize, primitives: Vec<Value>) -> Value {
    let mut json = template.clone();
    if let Some(name) = template.get("name").and_then(Value::as_str).filter(|_| level > 0) {
        json["name"] = format!("{name}_LOD{level}").into();
    }
    json["primitives"] = primitives.into();
    json
}

fn check(strips: &StripMesh, primitives: &[Value]) -> Result<(), Unsupported> {
    let StripMesh { mesh, levels } = strips;
    let wrong = |reason: String| Err(Unsupported::new("strips", reason));
    if let Err(error) = mesh.validate() {
        return wrong(error.to_string());
    }
    let wedges = mesh.attributes.as_ref().map(|attributes| attributes.wedge_count);
    for (label, strip) in levels.iter().flat_map(|level| level.iter().enumerate()) {
        if !strip.is_empty() && !primitives.get(label).is_some_and(is_surface) {
            let count = primitives.len();
            return wrong(format!(
                "have label {label}, which is not one of the {count} triangle primitives"
            ));
        }
        let is_bad = |&&(v, w): &&StripCorner| {
            v.index() >= mesh.positions.len() || wedges.is_some_and(|count| w.index() >= count)
        };
        if let Some((vertex, wedge)) = strip.iter().find(is_bad) {
            return wrong(format!("use vertex {vertex} and wedge {wedge}, which the mesh lacks"));
        }
    }
    Ok(())
}
