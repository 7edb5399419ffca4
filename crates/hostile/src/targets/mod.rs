//! The targets, one a file: what each does with hostile bytes, and what must hold then.
//!
//! Scenes are read by `ply`, `obj`, `mtl`, `stl`, `off`, `smf` and `gltf`, of which `draco` and
//! `skeleton` are parts; files of our own by `mlod`, `mlq`, `mlz` and `progressive`. The bytes of
//! `check` and `simplify` are small meshes.

mod check;
mod draco;
mod gltf;
mod mlod;
mod mlq;
mod mlz;
mod mtl;
mod obj;
mod off;
mod ply;
mod progressive;
mod simplify;
mod skeleton;
mod smf;
mod stl;

type Target = fn(&[u8]);

/// Name and function of each target.
const TARGETS: [(&str, Target); 15] = [
    ("check", check::run),
    ("draco", draco::run),
    ("gltf", gltf::run),
    ("mlod", mlod::run),
    ("mlq", mlq::run),
    ("mlz", mlz::run),
    ("mtl", mtl::run),
    ("obj", obj::run),
    ("off", off::run),
    ("ply", ply::run),
    ("progressive", progressive::run),
    ("simplify", simplify::run),
    ("skeleton", skeleton::run),
    ("smf", smf::run),
    ("stl", stl::run),
];

/// Lists the names of the targets.
pub fn targets() -> impl Iterator<Item = &'static str> {
    TARGETS.iter().map(|(name, _)| *name)
}

/// Runs a target with an input.
///
/// # Panics
/// If the input breaks what the target checks: a defect of ours. If there is no such target.
pub fn run(target: &str, input: &[u8]) {
    let named = TARGETS.iter().find(|(name, _)| *name == target);
    let (_, run) = named.unwrap_or_else(|| panic!("there is no target {target}"));
    run(input);
}
