//! Writes triangle strips to files: glTF, or lists of vertices in JSON.

use std::cmp::Reverse;
use std::path::Path;

use meshlod::io::write_file;
use meshlod::strip::{MergeTree, StripWedge, Strips};
use meshlod::{Scene, scene_strips};
use serde_json::{Value, json};

use super::StrippedLevel;
use crate::options::constraints::FlatInput;
use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::scene_files;

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

/// Returns true if the output is a scene, and not lists of vertices.
pub(super) fn holds_scene(out: &Path) -> bool {
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
        let strips = scene_strips(scene, &flat.mesh, tree, &strips);
        scene_files::write_stripped(self.path, scene, &strips, session)
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
