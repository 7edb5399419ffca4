//! A mesh made ready to be measured.

use meshlod_mesh::{FaceId, Mesh, VertexId};
use meshlod_spatial::{Bvh, BvhError, Frame};
use thiserror::Error;

use crate::size::triangle_area;

/// A mesh made ready to be measured from and against, as often as needed.
#[derive(Clone, Debug)]
pub struct Surface<'m> {
    pub(crate) mesh: &'m Mesh,
    pub(crate) bvh: Bvh,
    /// In the order of the hierarchy: the area up to and with each face, in local units.
    pub(crate) area_up_to: Vec<f64>,
    /// The vertices that faces use, in the order of the hierarchy.
    pub(crate) vertices: Vec<VertexId>,
    pub(crate) diagonal: f64,
}

/// Why a mesh cannot be measured.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SurfaceError {
    /// It has no faces, or is not a mesh.
    #[error(transparent)]
    Mesh(#[from] BvhError),
    /// There is no area to take samples of.
    #[error("all faces have zero area")]
    ZeroArea,
    /// Squared distances would leave the range of `f64`.
    #[error("its diagonal, {diagonal:e}, is outside 1e-140 to 1e140: scale it first")]
    Extent {
        /// The length of the diagonal of its box.
        diagonal: f64,
    },
}

impl<'m> Surface<'m> {
    /// Builds what searching and sampling `mesh` need.
    ///
    /// Cost: O(n log n), n = faces; in parallel. About 130 bytes a face.
    /// # Errors
    /// No faces, invalid faces or positions, no area, or an extent near the end of the floats.
    pub fn new(mesh: &'m Mesh) -> Result<Self, SurfaceError> {
        let bvh = Bvh::new(mesh)?;
        let bounds = mesh.bounds();
        let frame = Frame::of(&bounds);
        let mut total = 0.0;
        let area_of = |face: &FaceId| {
            let corners = mesh.faces[face.index()].map(|v| frame.local(mesh.positions[v.index()]));
            total += triangle_area(&corners);
            total
        };
        let area_up_to: Vec<f64> = bvh.faces_in_order().iter().map(area_of).collect();
        if total <= 0.0 {
            return Err(SurfaceError::ZeroArea);
        }
        let diagonal = bounds.diagonal();
        if !(1e-140..=1e140).contains(&diagonal) {
            return Err(SurfaceError::Extent { diagonal });
        }
        let vertices = used_in_order(mesh, bvh.faces_in_order());
        Ok(Self { mesh, bvh, area_up_to, vertices, diagonal })
    }

    /// The length of the diagonal of the box around the used vertices, in model units.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// The hierarchy over its faces.
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }
}

/// The vertices of some faces, each once, as they are met.
fn used_in_order(mesh: &Mesh, faces: &[FaceId]) -> Vec<VertexId> {
    let mut met = vec![false; mesh.positions.len()];
    let corners = faces.iter().flat_map(|face| mesh.faces[face.index()]);
    corners.filter(|v| !std::mem::replace(&mut met[v.index()], true)).collect()
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::MeshError;

    use super::*;
    use crate::fixtures::{cube, plane, scaled};

    #[test]
    fn only_used_vertices_count() {
        let mut mesh = cube();
        mesh.positions.push([9.0; 3]);
        let surface = Surface::new(&mesh).unwrap();
        assert_eq!((surface.vertices.len(), surface.diagonal()), (8, 3f64.sqrt()));
    }

    #[test]
    fn what_cannot_be_measured_is_named() {
        let error = |mesh: &Mesh| Surface::new(mesh).unwrap_err();
        assert_eq!(error(&Mesh::default()), SurfaceError::Mesh(BvhError::Empty));
        let mut flat = plane(1, 0.0);
        flat.positions.iter_mut().for_each(|position| position[1] = 0.0);
        assert_eq!(error(&flat), SurfaceError::ZeroArea);
        assert!(matches!(error(&scaled(&cube(), 1e200)), SurfaceError::Extent { .. }));
        assert!(matches!(error(&scaled(&cube(), 1e-200)), SurfaceError::Extent { .. }));
        let infinite = error(&scaled(&cube(), f64::INFINITY));
        let SurfaceError::Mesh(BvhError::Mesh(MeshError::NotFinite { .. })) = infinite else {
            panic!("{infinite}");
        };
    }
}
