//! Limits of multiresolution and compressed files: the parts of a scene that they lack.

use meshlod_io::{Note, Scene};

use super::counts::SceneCounts;

/// Lists what a multiresolution or compressed file lacks of a scene; empty if it has all of it.
///
/// Not listed is what depends on how the file is made: unused vertices, degenerate faces, rounding.
pub fn model_limits(scene: &Scene) -> Vec<Note> {
    let hidden = if scene.source.is_some() { 0 } else { SceneCounts::of(scene).hidden_meshes };
    let mut notes: Vec<Note> = [scene.ply_limits(), scene.obj_limits()].concat();
    notes.push(Note::left_out(hidden, "mesh that no node shows", "meshes that no node shows"));
    notes
}
