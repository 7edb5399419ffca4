//! Files of progressive meshes, and the scenes into which their levels are put.

use std::fs;
use std::path::Path;

use meshlod::io::{Node, write_file};
use meshlod::simplify::{Progressive, Simplifier};
use meshlod::{Mesh, Options, Scene};

use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;
use crate::simplify_run;

/// Fails if a sequence file cannot be written, before any work is done.
pub fn check(path: &Path, input: &Path, output: &Path) -> Result<(), Failure> {
    if files::is_pipe(path) {
        return Err(Failure::usage("--sequence needs a file, not standard output"));
    }
    files::check_apart(path, &[input, output])?;
    files::check_place(path)
}

/// Fails unless the scene has exactly one mesh, and warns about data that the sequence file at
/// `path` will not store.
pub fn check_scene(
    path: &Path,
    scene: &Scene,
    input: &Path,
    session: &Session,
) -> Result<(), Failure> {
    if scene.meshes.len() != 1 {
        return Err(several_meshes(input));
    }
    let unmoved = Node::default().transform;
    let moved = scene.instances().iter().any(|placed| placed.transform != unmoved);
    if moved || !scene.materials.is_empty() {
        session.warn(format_args!(
            "--sequence does not store nodes and materials; replay --scene {} restores them",
            files::name(input)
        ));
    }
    session.note(path, &[scene.obj_limits(), vec![scene.face_scalar_limits()]].concat())
}

/// Creates the failure for a scene that does not have exactly one mesh.
pub fn several_meshes(input: &Path) -> Failure {
    Failure::at(input, "--sequence needs an input with exactly one mesh")
}

/// Writes a sequence file and then runs `rest`; if that fails, a newly created sequence file is
/// removed.
pub fn write_with(
    path: &Path,
    sequence: &Progressive,
    rest: impl FnOnce() -> Result<(), Failure>,
) -> Result<(), Failure> {
    let is_new = !path.exists();
    write_file(path, &sequence.to_bytes())?;
    rest().inspect_err(|_| {
        if is_new {
            // The first failure is the one to report.
            let _ = fs::remove_file(path);
        }
    })
}

/// Replaces the only mesh of a scene by the current level of a progressive mesh.
pub fn put_into(scene: &mut Scene, sequence: &Progressive, path: &Path) -> Result<(), Failure> {
    let [only] = &scene.meshes[..] else {
        return Err(Failure::at(
            path,
            "does not hold exactly one mesh, as the input of the sequence did",
        ));
    };
    let level = sequence.level();
    if !is_of(&only.mesh, sequence, &level) {
        return Err(Failure::at(
            path,
            "is not the file that the sequence was recorded from, or is welded differently",
        ));
    }
    simplify_run::replace(scene, vec![level]);
    Ok(())
}

/// Returns true if a sequence may come from a mesh, judging by face count and material names.
fn is_of(mesh: &Mesh, sequence: &Progressive, level: &Mesh) -> bool {
    let names = |mesh: &Mesh| mesh.materials.as_ref().map(|labels| labels.names.clone());
    // A sequence leaves out degenerate and duplicate faces, so the slow count is rarely needed.
    let as_many = |faces: usize| faces == sequence.full_faces();
    let cleaned =
        || Simplifier::new(mesh, &Options::default()).map(|simplifier| simplifier.live_faces());
    names(mesh) == names(level) && (as_many(mesh.faces.len()) || cleaned().is_ok_and(as_many))
}
