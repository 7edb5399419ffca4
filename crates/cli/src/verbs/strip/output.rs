//! Writes triangle strips to files: glTF, or lists of vertices in JSON.

use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::path::Path;

use meshlod::io::{write_file, write_strips};
use meshlod::strip::{MergeTree, StripWedge, Strips};
use meshlod::{Scene, scene_strips};
use serde_json::{Value, json};

use super::StrippedLevel;
use crate::constraints::FlatInput;
use crate::failure::Failure;
use crate::files;
use crate::numbers::count;
use crate::session::Session;

/// File of strips to write, with what it needs of the input.
pub(super) struct StripOutput<'o> {
    path: &'o Path,
    /// Scene that the strips are written with; `None` for lists of vertices.
    scene: Option<Scene>,
}

/// Fails if the triangle strips cannot be written to the output path.
pub(super) fn check(out: &Path, input: &Path) -> Result<(), Failure> {
    if files::is_pipe(out) {
        return Err(Failure::usage("-: strips cannot go to standard output; name a file"));
    }
    if !holds_scene(out) && !has_suffix(out, "json") {
        let name = files::name(out);
        return Err(Failure::usage(format_args!(
            "{name}: a file of strips must end in .glb, .gltf or .json"
        )));
    }
    files::check_place(out)?;
    files::check_apart(out, &[input])
}

fn holds_scene(out: &Path) -> bool {
    has_suffix(out, "gltf") || has_suffix(out, "glb") || has_suffix(out, "vrm")
}

fn has_suffix(path: &Path, suffix: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(suffix))
}

impl<'o> StripOutput<'o> {
    pub(super) fn new(path: &'o Path, scene: &Scene) -> Self {
        Self { path, scene: holds_scene(path).then(|| scene.clone()) }
    }

    /// Writes the strips of all levels of a flattened scene.
    pub(super) fn write(
        &self,
        flat: &FlatInput,
        tree: &MergeTree,
        levels: &[StrippedLevel],
        session: &Session,
    ) -> Result<(), Failure> {
        session.progress.stage(&format!("writing {}", files::name(self.path)));
        let Some(scene) = &self.scene else {
            let text = format!("{:#}\n", lists(flat, tree, levels));
            return Ok(write_file(self.path, text.as_bytes())?);
        };
        let mut drawn: Vec<_> = levels.iter().filter(|level| !level.strips.is_empty()).collect();
        drawn.sort_by_key(|level| Reverse(level.triangles));
        let strips: Vec<&Strips> = drawn.iter().map(|level| &level.strips).collect();
        write_strips(self.path, scene, &scene_strips(scene, &flat.mesh, tree, &strips))?;
        if let Some(lost) = lost(scene) {
            session.warn(Failure::at(self.path, format_args!("not kept: {lost}")));
        }
        Ok(())
    }
}

/// Builds JSON lists of the vertices of each strip. They are numbered as in the input, or as in the
/// fused mesh, whose positions are then listed; in a mesh with attributes or several objects or
/// materials they are wedges, each with where its values are.
fn lists(input: &FlatInput, tree: &MergeTree, levels: &[StrippedLevel]) -> Value {
    let strips = |level: &StrippedLevel| {
        let lists = level.strips.iter().map(|strip| strip.iter().map(|v| v.0).collect::<Vec<_>>());
        json!({
            "size": level.size.to_string(),
            "triangles": level.triangles,
            "strips": lists.collect::<Vec<_>>(),
        })
    };
    let mut lists = json!({ "levels": levels.iter().map(strips).collect::<Vec<_>>() });
    let mesh = &input.mesh;
    if input.fused.is_some() {
        lists["positions"] = json!(mesh.positions);
    }
    if tree.has_wedges() {
        let wedge = |wedge: &StripWedge| {
            json!({
                "vertex": wedge.vertex.0, "shading": wedge.shading.0, "texture": wedge.texture.0,
            })
        };
        lists["wedges"] = tree.wedges(mesh).iter().map(wedge).collect();
    }
    lists
}

/// Names what glTF does not hold of a scene that was read from another format.
fn lost(scene: &Scene) -> Option<String> {
    if scene.source.is_some() {
        return None;
    }
    let used: BTreeSet<_> = scene.materials.iter().filter_map(|m| m.base_color_image).collect();
    let images = used.iter().filter(|&&image| {
        let bytes = scene.images.get(image).map_or(&[][..], |image| &image.bytes);
        let is_known = bytes.starts_with(b"\x89PNG") || bytes.starts_with(b"\xff\xd8\xff");
        !bytes.is_empty() && !is_known
    });
    let images = images.count();
    let objects = scene.meshes.iter().filter_map(|mesh| mesh.mesh.objects.as_ref());
    let objects = objects.map(|objects| objects.names.len()).sum();
    let parts = [
        (objects, "name of an object", "names of objects"),
        (images, "image that is neither PNG nor JPEG", "images that are neither PNG nor JPEG"),
    ];
    let named = parts.into_iter().filter(|(number, ..)| *number > 0).map(|(number, one, many)| {
        format!("{} {}", count(number), if number == 1 { one } else { many })
    });
    Some(named.collect::<Vec<_>>().join(", ")).filter(|lost| !lost.is_empty())
}
