//! The frame that the fast engine works in: floats, around the middle, faces about one in area.
//!
//! Costs go with the sixth power of a length. A scan in metres would have them run out of floats.

use glam::{DVec3, Vec3};
use meshlod_mesh::{Bounds, Mesh};

/// From model units to the engine's and back.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    center: DVec3,
    /// Model units to one of the engine's.
    pub(crate) unit: f64,
}

impl Frame {
    /// The frame of a mesh and its box, in which the diagonal is the root of the number of faces.
    pub(crate) fn new(mesh: &Mesh, bounds: &Bounds) -> Self {
        let unit = bounds.diagonal() / (mesh.faces.len() as f64).sqrt();
        let unit = if unit > 0.0 { unit } else { 1.0 };
        Self { center: bounds.center().into(), unit }
    }

    /// A place in it.
    #[inline]
    pub(crate) fn to_local(&self, position: [f64; 3]) -> Vec3 {
        ((DVec3::from(position) - self.center) / self.unit).as_vec3()
    }

    /// A position out of it.
    #[inline]
    pub(crate) fn to_model(&self, place: Vec3) -> [f64; 3] {
        (place.as_dvec3() * self.unit + self.center).to_array()
    }

    /// The position of a vertex: as it was in the input if it is there still.
    #[inline]
    pub(crate) fn to_model_or_input(&self, input: [f64; 3], place: Vec3) -> [f64; 3] {
        if self.to_local(input) == place { input } else { self.to_model(place) }
    }
}
