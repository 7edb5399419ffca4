//! Helpers shared by the test suites of this crate.

// Each suite uses a part of this.
#![allow(dead_code)]

use meshlod_fixtures as fixtures;
use meshlod_mesh::Mesh;
use meshlod_samples as samples;
use meshlod_simplify::Method;

/// The methods that the kernel runs.
pub fn kernel_methods() -> impl Iterator<Item = Method> {
    Method::ALL.into_iter().filter(|method| method.runs_in_kernel())
}

/// Small meshes, each with a feature or a defect of its own, and samples.
pub fn meshes() -> Vec<(&'static str, Mesh)> {
    vec![
        ("tetrahedron", fixtures::tetrahedron()),
        ("cube", fixtures::cube()),
        ("grid", fixtures::grid(12)),
        ("fan", fixtures::fan()),
        ("hourglass", fixtures::hourglass()),
        ("moebius", fixtures::moebius(40)),
        ("seam strip", fixtures::seam_strip()),
        ("two objects", fixtures::two_objects()),
        ("sphere", samples::sphere(2000)),
        ("torus", samples::torus(2000)),
        ("knot", samples::knot(3000)),
        ("gyroid", samples::gyroid(3000)),
        ("terrain", samples::terrain(2000)),
        ("fish", samples::fish(2000)),
    ]
}
