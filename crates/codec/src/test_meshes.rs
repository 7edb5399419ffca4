//! Meshes for the tests of the schemes.

use meshlod_fixtures::{grid, two_objects};
use meshlod_mesh::Mesh;
use meshlod_samples as samples;

/// Meshes that are closed, open, flat and in two components, without attributes that matter.
pub(crate) fn meshes() -> Vec<Mesh> {
    vec![
        samples::sphere(3000),
        samples::gyroid(4000),
        samples::terrain(2000),
        grid(9),
        two_objects(),
    ]
}
