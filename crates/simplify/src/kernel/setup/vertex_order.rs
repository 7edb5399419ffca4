//! The order of the vertices in the kernel: along a space-filling curve, whatever the order of the
//! file.
//!
//! Vertices near each other are then near in memory, and a run of vertices is a part of the surface
//! with a short border.

use glam::Vec3;
use meshlod_mesh::{Mesh, VertexId};
use meshlod_spatial::curve_order;
use rayon::prelude::*;

use crate::kernel::mesh::local_frame::Frame;

/// The two ids of each vertex.
pub(crate) struct Order {
    /// The kernel's ids, by those of the input.
    ids: Vec<u32>,
    /// The input's ids, by those of the kernel.
    inputs: Vec<u32>,
}

impl Order {
    /// Orders the vertices of a mesh. Also returns their places in the frame, in that order.
    pub(crate) fn new(mesh: &Mesh, frame: &Frame) -> (Self, Vec<Vec3>) {
        // Unused vertices may be anywhere; used ones are within this.
        let within = Vec3::splat((mesh.faces.len() as f32).sqrt());
        let near = |p: Vec3| p.clamp(-within, within).to_array();
        let keys: Vec<[f32; 3]> =
            mesh.positions.par_iter().map(|&p| near(frame.to_local(p))).collect();
        let inputs = curve_order(&keys);
        let mut ids = vec![0; inputs.len()];
        for (id, &input) in (0..).zip(&inputs) {
            ids[input as usize] = id;
        }
        let place = |&input: &u32| frame.to_local(mesh.positions[input as usize]);
        let places = inputs.par_iter().map(place).collect();
        (Self { ids, inputs }, places)
    }

    /// Returns the kernel's id of a vertex.
    #[inline]
    pub(crate) fn id(&self, input: VertexId) -> u32 {
        self.ids[input.index()]
    }

    /// Returns the input's id of a vertex.
    #[inline]
    pub(crate) fn input(&self, id: u32) -> u32 {
        self.inputs[id as usize]
    }

    /// Returns the kernel's ids of a face's corners.
    #[inline(always)]
    pub(crate) fn face(&self, &[a, b, c]: &[VertexId; 3]) -> [u32; 3] {
        // `map` over an array is not inlined, and took a tenth of the time.
        [self.ids[a.index()], self.ids[b.index()], self.ids[c.index()]]
    }
}

/// Returns true if the three vertices of a face are different.
#[inline(always)]
pub(crate) fn is_face([a, b, c]: [u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// Returns the faces of a mesh in the kernel's ids, or those with copies of vertices if there are
/// any.
pub(crate) fn numbers<'a>(
    mesh: &'a Mesh,
    order: &'a Order,
    split: Option<&'a [[u32; 3]]>,
) -> impl Iterator<Item = [u32; 3]> + Clone + 'a {
    (0..mesh.faces.len()).map(move |i| match split {
        Some(split) => split[i],
        None => order.face(&mesh.faces[i]),
    })
}
