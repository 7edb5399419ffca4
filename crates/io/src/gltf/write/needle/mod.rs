//! Levels as the client of `NEEDLE_progressive` loads them: a small document, which the client opens,
//! and a GLB file for each finer level of each mesh and each larger size of each image.
//!
//! Reading order: `meshes`, which writes levels; `images`, which writes sizes; `densities`, by which
//! the client chooses a level; `stand_in`, which keeps primitives that lost their faces; `part`,
//! which names files and gives ids.
//!
//! The client identifies a mesh or texture by its `guid`, alone among all that a page has loaded,
//! and replaces the geometry of each primitive by that with the same index in the file of a level.
//! So each level keeps all primitives of a mesh, in order, each with the attributes that it had: by
//! these, three.js chose the material when it opened the document.

mod densities;
pub(crate) mod images;
mod meshes;
pub(crate) mod part;
pub(crate) mod stand_in;

use serde_json::Value;

use super::empty_meshes::detach_meshes;
use super::levels::{Level, Needle, check_levels};
use super::quantized::grid::QuantizationGrid;
use super::replacer::Replacer;
use crate::error::Unsupported;
use crate::gltf::document::extensions::{NEEDLE, drop_entry, list_extension};
use crate::scene::{Image, Scene};
use meshes::MeshChain;

/// Puts the coarsest level of each mesh and the smallest size of each image into the document, and
/// returns the files of all others.
///
/// `levels` are the coarser levels in the coordinates of the document.
pub(crate) fn add(
    json: &mut Value,
    scene: &Scene,
    levels: &[Level],
    needle: &Needle<'_>,
    grids: &[Option<QuantizationGrid>],
    replacer: &mut Replacer<'_>,
) -> Result<Vec<Image>, Unsupported> {
    check_levels(levels, scene.meshes.len())?;
    for key in ["meshes", "textures"] {
        let old = json.get_mut(key).and_then(Value::as_array_mut);
        old.into_iter().flatten().for_each(|entry| drop_entry(entry, NEEDLE));
    }
    let templates = json.get("meshes").and_then(Value::as_array).cloned().unwrap_or_default();
    let (mut parts, mut gone) = (Vec::new(), Vec::new());
    for (index, template) in templates.iter().enumerate() {
        let (finest, grid) = (&scene.meshes[index].mesh, grids[index].as_ref());
        let mut new = template.clone();
        if finest.faces.is_empty() {
            if replacer.replace(&mut new, finest, grid)? {
                gone.push(index);
            }
        } else {
            let chain = MeshChain::of(index, finest, levels);
            let (coarsest, files) = chain.write(template, grid, needle, replacer)?;
            new = coarsest;
            parts.extend(files);
        }
        json["meshes"][index] = new;
    }
    detach_meshes(json, &gone);
    parts.extend(images::add(json, scene, needle, &mut replacer.builder)?);
    if !parts.is_empty() {
        list_extension(json, "extensionsUsed", NEEDLE);
    }
    Ok(parts)
}
