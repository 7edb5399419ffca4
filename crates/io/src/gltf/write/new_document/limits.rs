//! Parts of a scene that a new glTF document lacks.

use std::collections::BTreeSet;

use super::missing_uvs::UnmappedMaterials;
use crate::notes::Note;
use crate::obj::mtl::mtl_losses;
use crate::scene::Scene;
use crate::scene::image_file::holds_image;
use crate::scene::material::{Material, Shading};

/// Lists the parts of a scene that a new glTF document lacks.
pub(crate) fn new_document_limits(scene: &Scene) -> Vec<Note> {
    let shown = scene.materials.iter().flat_map(|material| {
        let Shading { normal_image, emission_image, .. } = material.shading;
        let combined = material.shading.metallic_roughness_image();
        [material.base_color_image, combined, normal_image, emission_image]
    });
    let shown: BTreeSet<usize> = shown.flatten().collect();
    let other = shown
        .into_iter()
        .filter_map(|image| scene.images.get(image))
        .filter(|image| !image.bytes.is_empty() && !holds_image(&image.bytes));
    let names: Vec<&str> = other.map(|image| &*image.name).collect();
    let [left_out, changed, apart] = mtl_statements(scene);
    let [separate, opacity] = separate_images(scene);
    vec![
        left_out,
        changed,
        apart,
        separate,
        opacity,
        UnmappedMaterials::of(scene).note(scene),
        Note::left_out(
            names.len(),
            "image that is no PNG, JPEG or WebP",
            "images that are no PNG, JPEG or WebP",
        )
        .named(names)
        .remedied("convert images to PNG or JPEG"),
    ]
}

/// Notes the MTL statements that glTF lacks, and the ones it converts.
fn mtl_statements(scene: &Scene) -> [Note; 3] {
    let losses = scene.materials.iter().map(|material| mtl_losses(material, &scene.images));
    let losses: Vec<_> = losses.collect();
    let note = |note: fn(usize, &str, &str) -> Note, words: Vec<&String>, one, many| {
        let names: BTreeSet<&String> = words.iter().copied().collect();
        note(words.len(), one, many).named(names)
    };
    let apart = losses.iter().map(|lost| lost.apart).sum();
    let left_out = losses.iter().flat_map(|lost| &lost.left_out).collect();
    let changed = losses.iter().flat_map(|lost| &lost.changed).collect();
    [
        note(Note::left_out, left_out, "MTL statement", "MTL statements"),
        note(
            Note::changed,
            changed,
            "MTL statement taken for a roughness or for normals",
            "MTL statements taken for a roughness or for normals",
        ),
        maps_apart(apart),
    ]
}

/// Notes the separate maps that glTF would need in one image, for materials without MTL statements.
fn separate_images(scene: &Scene) -> [Note; 2] {
    let own = scene.materials.iter().filter(|material| material.mtl.is_empty());
    let maps = own.clone().map(|material| {
        let Shading { metallic_image, roughness_image, .. } = material.shading;
        let has_combined = material.shading.metallic_roughness_image().is_some();
        if has_combined { 0 } else { [metallic_image, roughness_image].iter().flatten().count() }
    });
    let maps = maps.sum();
    let is_lost = |material: &&Material| {
        let opacity = material.shading.opacity_image;
        opacity.is_some() && opacity != material.base_color_image
    };
    [
        maps_apart(maps),
        Note::left_out(
            own.filter(is_lost).count(),
            "map of opacity in an image of its own",
            "maps of opacity in images of their own",
        )
        .remedied("put the opacity into the alpha of the colour's image"),
    ]
}

/// Notes roughness and metalness maps in separate images, which glTF combines.
fn maps_apart(count: usize) -> Note {
    let note = Note::left_out(
        count,
        "map of roughness or metalness in an image of its own",
        "maps of roughness or metalness in images of their own",
    );
    note.remedied(
        "glTF has both in one image: make one with roughness in green and metalness in blue, and \
         name it in map_Pr and map_Pm",
    )
}
