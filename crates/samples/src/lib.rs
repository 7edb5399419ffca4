//! Procedural triangle meshes of any size, the same on every run.
//!
//! Every sample takes the desired number of faces and comes as close to it as its structure allows;
//! its documentation says how close. All fit roughly into [-1, 1]³, with +y up.
//!
//! Closed samples are watertight 2-manifolds without degenerate faces, counter-clockwise seen from
//! outside. Sines and cosines are those of the standard library, so coordinates may differ by an
//! ulp between platforms. Faces do not differ, except in the gyroid, where a lattice point within
//! an ulp of the surface could fall on the other side.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `sphere`, `torus`, `knot`, `gyroid`, `gyroid_slabs`, `tetrahedra` | smooth shapes |
//! | `plate`, `blocks`, `prism`, `parts` | hard ones |
//! | `terrain`, `fish` | natural ones |
//! | `grid`, `random` | what they share |
//!
//! ```
//! let mesh = meshlod_samples::by_name("knot", Some(20_000)).expect("a knot is known");
//! assert!(mesh.faces.len().abs_diff(20_000) < 200);
//! ```
#![forbid(unsafe_code)]

mod blocks;
mod fish;
mod grid;
mod gyroid;
mod gyroid_slabs;
mod knot;
mod parts;
mod plate;
mod prism;
mod random;
mod sphere;
mod terrain;
#[cfg(test)]
mod tests;
mod tetrahedra;
mod torus;

pub use blocks::{boxes, cube, stairs, tunnels, voxels};
pub use fish::fish;
pub use gyroid::gyroid;
pub use gyroid_slabs::GyroidSlabs;
pub use knot::knot;
pub use parts::parts;
pub use plate::plate;
pub use prism::{plates, prism};
pub use random::turned;
pub use sphere::sphere;
pub use terrain::{TerrainRows, colored_terrain, terrain, terrain_color};
pub use torus::{faceted_torus, torus};

use meshlod_mesh::Mesh;

/// Names of all sample meshes, as accepted by [`by_name`].
pub const NAMES: [&str; 16] = [
    "sphere",
    "torus",
    "faceted-torus",
    "knot",
    "gyroid",
    "plate",
    "terrain",
    "fish",
    "cube",
    "plates",
    "prism",
    "boxes",
    "stairs",
    "voxels",
    "tunnels",
    "parts",
];

/// Maximum number of faces of a sample made by [`by_name`]; larger requests are clamped to it.
pub const MAX_FACES: usize = 500_000_000;

/// Number of faces of a terrain that shows it well.
pub const TERRAIN_FACES: usize = 20_000;

/// Maximum number of faces of a sample that is written in passing, by [`TerrainRows`] or [`GyroidSlabs`]:
/// vertices still have 32-bit numbers.
pub const MAX_STREAMED_FACES: usize = 2_000_000_000;

/// Builds the sample mesh of that name with about `faces` faces, or a default number for `None`.
///
/// Returns `None` if the name is unknown.
pub fn by_name(name: &str, faces: Option<usize>) -> Option<Mesh> {
    by_seed(name, faces, 0)
}

/// Builds a sample like [`by_name`], the random parts of `boxes`, `voxels`, `tunnels` and
/// `parts` from a seed.
pub fn by_seed(name: &str, faces: Option<usize>, seed: u64) -> Option<Mesh> {
    let faces = |default: usize| faces.unwrap_or(default).min(MAX_FACES);
    Some(match name {
        "sphere" => sphere(faces(5_000)),
        "torus" => torus(faces(5_000)),
        "faceted-torus" => faceted_torus(faces(10_000)),
        "knot" => knot(faces(10_000)),
        "gyroid" => gyroid(faces(50_000)),
        "plate" => plate(faces(10_000)),
        "terrain" => terrain(faces(TERRAIN_FACES)),
        "fish" => fish(faces(4_000)),
        "cube" => cube(faces(10_000)),
        "plates" => plates(faces(10_000)),
        "prism" => prism(faces(10_000)),
        "boxes" => boxes(faces(20_000), seed),
        "stairs" => stairs(faces(20_000)),
        "voxels" => voxels(faces(50_000), seed),
        "tunnels" => tunnels(faces(40_000), seed),
        "parts" => parts(faces(50_000), seed),
        _ => return None,
    })
}
