//! Local frame of the kernel: centred coordinates in single precision, scaled so that faces have an
//! area of about one.
//!
//! Costs grow with the sixth power of a length. In the units of a scan in metres they would leave
//! the range of floats.

use glam::{DVec3, Vec3};
use meshlod_mesh::{Bounds, Mesh};

/// Transformation between model units and the local frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    center: DVec3,
    /// Length of the frame's unit in model units.
    pub(crate) unit: f64,
}

impl Frame {
    /// Returns the frame of a mesh with these bounds. In it the diagonal is the square root of the
    /// number of faces.
    pub(crate) fn new(mesh: &Mesh, bounds: &Bounds) -> Self {
        let unit = bounds.diagonal() / (mesh.faces.len() as f64).sqrt();
        let unit = if unit > 0.0 { unit } else { 1.0 };
        Self { center: bounds.center().into(), unit }
    }

    /// Converts a position from model units to the frame.
    #[inline]
    pub(crate) fn to_local(self, position: [f64; 3]) -> Vec3 {
        ((DVec3::from(position) - self.center) / self.unit).as_vec3()
    }

    /// Converts a position from the frame to model units.
    #[inline]
    pub(crate) fn to_model(self, place: Vec3) -> [f64; 3] {
        (place.as_dvec3() * self.unit + self.center).to_array()
    }

    /// Converts a place to model units; the exact input position if the vertex is still there.
    #[inline]
    pub(crate) fn to_model_or_input(self, input: [f64; 3], place: Vec3) -> [f64; 3] {
        if self.to_local(input) == place { input } else { self.to_model(place) }
    }
}
