//! Mesh prepared for repeated distance measurements.

use std::sync::{Arc, OnceLock};

use meshlod_mesh::{FaceId, Frame, Mesh, VertexId};
use meshlod_spatial::{Bvh, BvhError, Mates};
use thiserror::Error;

use crate::size::triangle_area;

/// Mesh prepared for distance measurements, with a bounding volume hierarchy and a table for
/// sampling.
#[derive(Clone, Debug)]
pub struct PreparedSurface<'m> {
    pub(crate) mesh: &'m Mesh,
    pub(crate) bvh: Arc<Bvh>,
    /// Cumulative area up to and including each face, in leaf order and in local units.
    pub(crate) area_up_to: Vec<f64>,
    /// Vertices used by faces, in leaf order.
    pub(crate) vertices: Vec<VertexId>,
    pub(crate) diagonal: f64,
    mates: OnceLock<Arc<Mates>>,
}

/// Reason why distances to or from a mesh cannot be measured.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SurfaceError {
    /// The mesh has no faces, or its positions or indices are invalid.
    #[error(transparent)]
    Mesh(#[from] BvhError),
    /// All faces have zero area, so there is nothing to sample.
    #[error("all faces have zero area")]
    ZeroArea,
    /// The mesh is so large or small that squared distances would leave the range of `f64`.
    #[error("the diagonal {diagonal:e} must be between 1e-140 and 1e140: scale the mesh first")]
    Extent {
        /// Length of the diagonal of the mesh's bounding box, in model units.
        diagonal: f64,
    },
}

impl<'m> PreparedSurface<'m> {
    /// Prepares a mesh for distance measurements: builds its bounding volume hierarchy and sampling
    /// table.
    ///
    /// Cost: O(n log n), n = faces; in parallel. Size: about 130 bytes a face.
    ///
    /// # Errors
    /// No faces, invalid faces or positions, zero area, or an extent near the limits of `f64`.
    pub fn new(mesh: &'m Mesh) -> Result<Self, SurfaceError> {
        Self::over(mesh, Arc::new(Bvh::new(mesh)?))
    }

    /// Prepares a mesh whose hierarchy and mates are known, as a run within an error leaves them. They
    /// must be those of this mesh: with others, distances and proofs are wrong.
    ///
    /// Cost: O(n), n = faces.
    ///
    /// # Errors
    /// As [`Self::new`].
    ///
    /// # Panics
    /// The hierarchy has another number of faces.
    pub fn with_hierarchy(
        mesh: &'m Mesh,
        (bvh, mates): (Arc<Bvh>, Arc<Mates>),
    ) -> Result<Self, SurfaceError> {
        assert_eq!(bvh.faces_in_leaf_order().len(), mesh.faces.len(), "faces of the hierarchy");
        let mut prepared = Self::over(mesh, bvh)?;
        prepared.mates = OnceLock::from(mates);
        Ok(prepared)
    }

    fn over(mesh: &'m Mesh, bvh: Arc<Bvh>) -> Result<Self, SurfaceError> {
        let bounds = mesh.bounds();
        let frame = Frame::of(&bounds);
        let mut total = 0.0;
        let area_of = |face: &FaceId| {
            let corners = mesh.faces[face.index()].map(|v| frame.local(mesh.positions[v.index()]));
            total += triangle_area(&corners);
            total
        };
        let area_up_to: Vec<f64> = bvh.faces_in_leaf_order().iter().map(area_of).collect();
        if total <= 0.0 {
            return Err(SurfaceError::ZeroArea);
        }
        let diagonal = bounds.diagonal();
        if !(1e-140..=1e140).contains(&diagonal) {
            return Err(SurfaceError::Extent { diagonal });
        }
        let vertices = used_in_order(mesh, bvh.faces_in_leaf_order());
        Ok(Self { mesh, bvh, area_up_to, vertices, diagonal, mates: OnceLock::new() })
    }

    /// Returns the mesh.
    pub fn mesh(&self) -> &'m Mesh {
        self.mesh
    }

    /// Returns the length of the diagonal of the mesh's bounding box, in model units; unused
    /// vertices do not count.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// Returns the faces that share edges, found when they are first asked for.
    pub(crate) fn mates(&self) -> &Mates {
        self.mates.get_or_init(|| Arc::new(Mates::new(self.mesh, &self.bvh)))
    }

    /// Returns the bounding volume hierarchy over the faces of the mesh.
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }
}

/// Returns the vertices of the faces, each once, in the order of first use.
fn used_in_order(mesh: &Mesh, faces: &[FaceId]) -> Vec<VertexId> {
    let mut seen = vec![false; mesh.positions.len()];
    let corners = faces.iter().flat_map(|face| mesh.faces[face.index()]);
    corners.filter(|v| !std::mem::replace(&mut seen[v.index()], true)).collect()
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
        let surface = PreparedSurface::new(&mesh).unwrap();
        assert_eq!((surface.vertices.len(), surface.diagonal()), (8, 3f64.sqrt()));
    }

    #[test]
    fn what_cannot_be_measured_is_named() {
        let error = |mesh: &Mesh| PreparedSurface::new(mesh).unwrap_err();
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
