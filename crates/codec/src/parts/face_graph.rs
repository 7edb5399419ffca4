//! Graph of faces and their neighbours, for partitioning a mesh.

use glam::DVec3;
use meshlod_mesh::{Bounds, Connectivity, FaceId, Mesh, Side, Twin, VertexId};
use rayon::prelude::*;

/// Dual graph of the faces with three different corners.
pub(super) struct FaceGraph<'m> {
    positions: &'m [[f64; 3]],
    /// Faces of the mesh, without those that repeat a vertex.
    pub(super) triangles: Vec<[VertexId; 3]>,
    /// Mesh face of each triangle.
    pub(super) ids: Vec<FaceId>,
    /// Face across each side; [`NONE`] if there is not exactly one.
    across: Vec<[u32; 3]>,
    boxes: Vec<Bounds>,
    centers: Vec<DVec3>,
    bounds: Bounds,
}

const NONE: u32 = u32::MAX;

impl<'m> FaceGraph<'m> {
    pub(super) fn new(mesh: &'m Mesh) -> Self {
        let is_whole = |&[a, b, c]: &[VertexId; 3]| a != b && b != c && c != a;
        let faces = mesh.faces.iter().enumerate().filter(|(_, face)| is_whole(face));
        let (ids, triangles): (_, Vec<_>) =
            faces.map(|(id, &face)| (FaceId::new(id), face)).unzip();
        let connectivity = Connectivity::new(&triangles, mesh.positions.len());
        let across =
            |face: usize, k: usize| match connectivity.twin(Side::new(FaceId::new(face), k)) {
                Twin::Side(side) => side.face().0,
                Twin::Boundary | Twin::NonManifold | Twin::Degenerate => NONE,
            };
        let across = (0..triangles.len()).map(|face| [0, 1, 2].map(|k| across(face, k))).collect();
        let corners = |face: &[VertexId; 3]| face.map(|v| mesh.positions[v.index()]);
        let boxes: Vec<_> = triangles.par_iter().map(|face| Bounds::of(&corners(face))).collect();
        let center = |face| {
            let [a, b, c] = corners(face).map(|corner| DVec3::from(corner) / 3.0);
            a + b + c
        };
        let centers = triangles.par_iter().map(center).collect();
        let mut bounds = Bounds::EMPTY;
        boxes.iter().for_each(|of| bounds.merge(of));
        Self { positions: &mesh.positions, triangles, ids, across, boxes, centers, bounds }
    }

    pub(super) fn faces(&self) -> usize {
        self.triangles.len()
    }

    pub(super) fn position(&self, vertex: VertexId) -> [f64; 3] {
        self.positions[vertex.index()]
    }

    /// Returns the box around a face.
    pub(super) fn face_box(&self, face: u32) -> &Bounds {
        &self.boxes[face as usize]
    }

    /// Returns the middle of a face's corners.
    pub(super) fn center(&self, face: u32) -> DVec3 {
        self.centers[face as usize]
    }

    /// Returns the faces across the sides of a face.
    pub(super) fn neighbours(&self, face: u32) -> impl Iterator<Item = u32> {
        self.across[face as usize].into_iter().filter(|&other| other != NONE)
    }

    /// Returns the Morton code of a point in the bounding box.
    pub(super) fn morton(&self, place: [f64; 3]) -> u64 {
        let side = super::longest_side(&self.bounds).max(f64::MIN_POSITIVE);
        let spread = |x: u64| (0..21).fold(0, |bits, i| bits | (x >> i & 1) << (3 * i));
        (0..3).fold(0, |code, axis| {
            // Points outside saturate to the ends.
            let x = ((place[axis] - self.bounds.min[axis]) / side * f64::from(1 << 21)) as u64;
            code | spread(x.min((1 << 21) - 1)) << axis
        })
    }
}
