//! Writes triangle strips to files: glTF, or lists of vertices in JSON.

use std::path::Path;

use meshlod::io::write_file;
use meshlod::jobs::{StripReport, Stripped, StrippedLevelReport};
use meshlod::strip::{StripWedge, Strips};
use serde_json::{Value, json};

use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::scene_files;

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

/// Writes the strips of all levels of a scene.
pub(super) fn write(
    out: &Path,
    stripped: &Stripped,
    report: &StripReport,
    session: &Session,
) -> Result<(), Failure> {
    session.progress.stage(&format!("writing {}", files::name(out)));
    match holds_scene(out) {
        true => {
            let strips = stripped.strip_meshes();
            scene_files::write_stripped(out, &stripped.scene, &strips, session)
        }
        false => {
            let text = format!("{:#}\n", lists(stripped, report));
            Ok(write_file(out, text.as_bytes())?)
        }
    }
}

/// Builds JSON lists of the vertices of each strip. They are numbered as in the input, each of whose
/// meshes may be there once, or as in the fused mesh, whose positions are then listed. In a mesh with
/// attributes, several objects or materials they are wedges, each with where its values are.
fn lists(Stripped { mesh, tree, levels, .. }: &Stripped, report: &StripReport) -> Value {
    let strips = |(strips, level): (&Strips, &StrippedLevelReport)| {
        let lists = strips.iter().map(|strip| strip.iter().map(|v| v.0).collect::<Vec<_>>());
        json!({
            "size": level.size,
            "triangles": level.triangles,
            "strips": lists.collect::<Vec<_>>(),
        })
    };
    let of_levels = levels.iter().zip(&report.levels).map(strips);
    let mut lists = json!({
        "each_mesh_once": report.each_mesh_once,
        "levels": of_levels.collect::<Vec<_>>(),
    });
    if report.fused.is_some() {
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
