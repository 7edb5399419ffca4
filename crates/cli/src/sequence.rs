//! Files that keep all levels of a run, and the scenes that their levels belong in.

use std::fs;
use std::path::Path;

use meshlod::io::{Node, write_file};
use meshlod::simplify::{Progressive, Simplifier};
use meshlod::{Mesh, Options, Scene};

use crate::failure::Failure;
use crate::files;
use crate::reduce;
use crate::session::Session;

/// Refuses a sequence that could not be kept in a file, before any work is done.
pub fn check(path: &Path, input: &Path, output: &Path) -> Result<(), Failure> {
    if files::is_pipe(path) {
        return Err(Failure::usage("--sequence needs a file, not standard output"));
    }
    files::check_apart(path, &[input, output])?;
    files::check_place(path)
}

/// Refuses a scene of several meshes, and says what a sequence of this one will not hold.
pub fn check_scene(scene: &Scene, input: &Path, session: &Session) -> Result<(), Failure> {
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
    Ok(())
}

/// Why there is no sequence of a scene.
pub fn several_meshes(input: &Path) -> Failure {
    Failure::at(input, "--sequence needs an input with exactly one mesh")
}

/// Writes a sequence and what goes with it: where that fails, no new file of the sequence stays.
pub fn write_with(
    path: &Path,
    sequence: &Progressive,
    rest: impl FnOnce() -> Result<(), Failure>,
) -> Result<(), Failure> {
    let is_new = !path.exists();
    write_file(path, &sequence.to_bytes())?;
    rest().inspect_err(|_| {
        if is_new {
            // What failed first is what there is to tell.
            let _ = fs::remove_file(path);
        }
    })
}

/// Puts the level at hand in the place of the mesh that the sequence was made of.
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
    reduce::replace(scene, vec![level]);
    Ok(())
}

/// Whether a sequence can be of a mesh, as far as its faces and what they are labelled tell.
fn is_of(mesh: &Mesh, sequence: &Progressive, level: &Mesh) -> bool {
    let names = |mesh: &Mesh| mesh.materials.as_ref().map(|labels| labels.names.clone());
    // Degenerate and duplicate faces are left out of a sequence; only few meshes have some.
    let as_many = |faces: usize| faces == sequence.full_faces();
    let cleaned =
        || Simplifier::new(mesh, &Options::default()).map(|simplifier| simplifier.live_faces());
    names(mesh) == names(level) && (as_many(mesh.faces.len()) || cleaned().is_ok_and(as_many))
}
