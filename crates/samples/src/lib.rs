//! Procedural triangle meshes of any size, the same on every run.
//!
//! Every sample takes the number of faces wanted and comes as near as its structure allows; each
//! says how near. Model units are arbitrary: each fits about [-1, 1]³. Up is +y.
//!
//! Closed ones are watertight 2-manifolds without degenerate faces, their faces counter-clockwise
//! seen from outside. Sines and cosines are the standard library's, so that coordinates may differ
//! by an ulp from platform to platform; faces never do, except in the gyroid, where a lattice
//! point within an ulp of the surface could take the other side.
//!
//! ```
//! let mesh = meshlod_samples::by_name("knot", Some(20_000)).expect("a knot is known");
//! assert!(mesh.faces.len().abs_diff(20_000) < 200);
//! ```
#![forbid(unsafe_code)]

mod fish;
mod grid;
mod gyroid;
mod knot;
mod sphere;
mod terrain;
#[cfg(test)]
mod tests;
mod tetrahedra;
mod torus;

pub use fish::fish;
pub use gyroid::gyroid;
pub use knot::knot;
pub use sphere::sphere;
pub use terrain::terrain;
pub use torus::{faceted_torus, torus};

use meshlod_mesh::Mesh;

/// The samples that [`by_name`] knows.
pub const NAMES: [&str; 7] =
    ["sphere", "torus", "faceted-torus", "knot", "gyroid", "terrain", "fish"];

/// The most faces that [`by_name`] makes; it takes a greater wish as this.
pub const MAX_FACES: usize = 500_000_000;

/// The sample of that name with about `faces` faces (its own default where `None`); `None` where
/// the name is unknown.
pub fn by_name(name: &str, faces: Option<usize>) -> Option<Mesh> {
    let (make, default_faces): (fn(usize) -> Mesh, usize) = match name {
        "sphere" => (sphere, 5_000),
        "torus" => (torus, 5_000),
        "faceted-torus" => (faceted_torus, 10_000),
        "knot" => (knot, 10_000),
        "gyroid" => (gyroid, 50_000),
        "terrain" => (terrain, 20_000),
        "fish" => (fish, 4_000),
        _ => return None,
    };
    Some(make(faces.unwrap_or(default_faces).min(MAX_FACES)))
}
