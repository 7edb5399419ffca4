//! Sample mesh of a trefoil knot.

use std::f64::consts::TAU;

use glam::DVec3;
use meshlod_mesh::Mesh;

use crate::grid::{self, Size};

/// Turns around the y axis and around the tube of the torus that the knot winds on.
const TURNS: [f64; 2] = [2.0, 3.0];
/// Distance from the axis to the center line of that torus.
const RING: f64 = 0.6;
/// Radius of the tube of that torus.
const WINDING: f64 = 0.28;
/// Radius of the tube of the knot.
const TUBE: f64 = 0.13;
/// Length of the knot over the circumference of its tube, so that quads are nearly square.
const ASPECT: f64 = 11.5;

/// Builds a closed tube along the (2, 3) torus knot, the trefoil.
///
/// Faces: within half a ring of quads of `faces`, under 1 % from 10,000 on; at least 300, below
/// which strands would intersect.
pub fn knot(faces: usize) -> Mesh {
    let size = Size::for_faces(faces.max(300), ASPECT);
    grid::wrapped(size, |column, row| {
        let frame = frame(column as f64 / size.columns as f64);
        let (sin, cos) = (TAU * row as f64 / size.rows as f64).sin_cos();
        frame.center + TUBE * (cos * frame.out + sin * frame.side)
    })
}

/// A point of the knot and two unit vectors perpendicular to it.
struct CurveFrame {
    center: DVec3,
    /// Outward from the tube of the torus: a frame that closes after one turn, and never twists
    /// abruptly as a Frenet frame does.
    out: DVec3,
    side: DVec3,
}

fn frame(t: f64) -> CurveFrame {
    let [p, q] = TURNS;
    let (sin_u, cos_u) = (TAU * p * t).sin_cos();
    let (sin_v, cos_v) = (TAU * q * t).sin_cos();
    let radial = DVec3::new(sin_u, 0.0, cos_u);
    let out = cos_v * radial + sin_v * DVec3::Y;
    let radius = RING + WINDING * cos_v;
    let along = p * radius * DVec3::new(cos_u, 0.0, -sin_u)
        + q * WINDING * (cos_v * DVec3::Y - sin_v * radial);
    CurveFrame { center: RING * radial + WINDING * out, out, side: out.cross(along).normalize() }
}
