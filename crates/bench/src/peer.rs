//! Simplification, compression and strips by meshoptimizer, for comparison.

// The crate has no safe function for simplify with update.
#![allow(unsafe_code)]

mod attributes;
mod border;
mod codec;
mod strips;

use meshlod::mesh::{Mesh, VertexId};

pub use attributes::{GpuMesh, Settings, Update, simplify_with_attributes};
pub use border::simplify_with_border_lock;
pub use codec::meshopt_codec;
pub use meshopt::SimplifyOptions;
pub use strips::meshopt_strips;

/// An indexed triangle mesh in the layout that meshoptimizer takes.
#[derive(Clone, Debug)]
pub struct Indexed {
    /// Coordinates of the vertices, three floats each.
    pub positions: Vec<f32>,
    /// Vertex indices of the triangles, three per face.
    pub indices: Vec<u32>,
}

impl From<&Mesh> for Indexed {
    fn from(mesh: &Mesh) -> Self {
        Self {
            positions: mesh.positions.iter().flatten().map(|&x| x as f32).collect(),
            indices: mesh.faces.iter().flatten().map(|v| v.0).collect(),
        }
    }
}

impl From<&Indexed> for Mesh {
    fn from(indexed: &Indexed) -> Self {
        let (positions, _) = indexed.positions.as_chunks::<3>();
        let (faces, _) = indexed.indices.as_chunks::<3>();
        let mut mesh = Self::new(
            positions.iter().map(|p| p.map(f64::from)).collect(),
            faces.iter().map(|face| face.map(VertexId)).collect(),
        );
        mesh.compact();
        mesh
    }
}

/// Simplifies a mesh to about `faces` faces by `simplify_with_update`, meshoptimizer's most
/// accurate simplification.
pub fn simplify_with_update(input: &Indexed, faces: usize) -> Indexed {
    let mut output = input.clone();
    let vertices = output.positions.len() / 3;
    let mut error = 0.0;
    // SAFETY: every pointer is to an array of the length given with it, indices are those of a
    // valid mesh, and null stands for the absent attributes and locks as the library documents.
    let count = unsafe {
        meshopt::ffi::meshopt_simplifyWithUpdate(
            output.indices.as_mut_ptr(),
            output.indices.len(),
            output.positions.as_mut_ptr(),
            vertices,
            3 * size_of::<f32>(),
            std::ptr::null_mut(),
            0,
            std::ptr::null(),
            0,
            std::ptr::null(),
            faces * 3,
            f32::MAX,
            0,
            &mut error,
        )
    };
    output.indices.truncate(count);
    output
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peer_gives_a_valid_mesh_of_the_size_asked_for() {
        let mesh = meshlod::samples::sphere(2000);
        let level = Mesh::from(&simplify_with_update(&Indexed::from(&mesh), 200));
        level.validate().unwrap();
        assert!((190..=200).contains(&level.faces.len()), "{}", level.faces.len());
    }
}
