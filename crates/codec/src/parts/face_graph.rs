//! Graph of faces and their neighbours, for partitioning a mesh.

use glam::{DVec3, Vec3};
use meshlod_mesh::{Bounds, Connectivity, FaceId, Mesh, Side, Twin, VertexId};
use meshlod_spatial::curve_order;
use rayon::prelude::*;

/// Dual graph of the faces with three different corners.
///
/// Faces are in order along a space-filling curve, so that those near each other mostly share a
/// cache line: in a file's order, a million faces take several times as long to partition.
pub(super) struct FaceGraph<'m> {
    positions: &'m [[f64; 3]],
    /// Faces of the mesh, without those that repeat a vertex.
    pub(super) triangles: Vec<[VertexId; 3]>,
    /// Mesh face of each triangle.
    pub(super) ids: Vec<FaceId>,
    boxes: Vec<Bounds>,
    nodes: Vec<FaceNode>,
    /// Middle of each face's corners, in the unit frame.
    centers: Vec<[f32; 3]>,
    frame: UnitFrame,
}

/// Face as the growth of parts sees it: its box in the unit frame, and its neighbours.
struct FaceNode {
    min: Vec3,
    max: Vec3,
    /// Face across each side; [`NONE`] if there is not exactly one.
    across: [u32; 3],
}

/// Frame in which the mesh spans at most 1 along each axis around the origin, so that `f32` will do.
struct UnitFrame {
    bounds: Bounds,
    side: f64,
}

const NONE: u32 = u32::MAX;

impl<'m> FaceGraph<'m> {
    /// Creates the graph of a mesh whose faces have finite corners.
    ///
    /// Cost: O(n), n = faces.
    pub(super) fn new(mesh: &'m Mesh) -> Self {
        let corners = |face: &[VertexId; 3]| face.map(|v| mesh.positions[v.index()]);
        let faces = mesh.faces.iter().enumerate().filter(|(_, face)| is_whole(face));
        let (ids, triangles): (Vec<_>, Vec<_>) =
            faces.map(|(id, &face)| (FaceId::new(id), face)).unzip();
        let frame = UnitFrame::around(triangles.iter().flatten(), &mesh.positions);
        let center = |face: &[VertexId; 3]| {
            let [a, b, c] = corners(face).map(|corner| DVec3::from(corner) / 3.0);
            frame.place((a + b + c).to_array()).to_array()
        };
        let centers: Vec<_> = triangles.par_iter().map(center).collect();
        let order = curve_order(&centers);
        let triangles = in_order(&order, &triangles);
        let boxes: Vec<_> = triangles.par_iter().map(|face| Bounds::of(&corners(face))).collect();
        let connectivity = Connectivity::new(&triangles, mesh.positions.len());
        let node = |(face, of): (usize, &Bounds)| FaceNode {
            min: frame.place(of.min),
            max: frame.place(of.max),
            across: [0, 1, 2].map(|k| match connectivity.twin(Side::new(FaceId::new(face), k)) {
                Twin::Side(side) => side.face().0,
                Twin::Boundary | Twin::NonManifold | Twin::Degenerate => NONE,
            }),
        };
        let nodes = boxes.par_iter().enumerate().map(node).collect();
        let (ids, centers) = (in_order(&order, &ids), in_order(&order, &centers));
        Self { positions: &mesh.positions, triangles, ids, boxes, nodes, centers, frame }
    }

    pub(super) fn faces(&self) -> usize {
        self.triangles.len()
    }

    /// Returns the number of vertices of the mesh, whether faces use them or not.
    pub(super) fn mesh_vertices(&self) -> usize {
        self.positions.len()
    }

    pub(super) fn position(&self, vertex: VertexId) -> [f64; 3] {
        self.positions[vertex.index()]
    }

    /// Returns the box around each face.
    pub(super) fn boxes(&self) -> &[Bounds] {
        &self.boxes
    }

    /// Returns the box around a face.
    pub(super) fn face_box(&self, face: u32) -> &Bounds {
        &self.boxes[face as usize]
    }

    /// Returns the middle of a face's corners, in the unit frame.
    pub(super) fn center(&self, face: u32) -> Vec3 {
        self.centers[face as usize].into()
    }

    /// Returns the middle of a box, in the unit frame.
    pub(super) fn middle(&self, of: &Bounds) -> Vec3 {
        self.frame.place(of.center())
    }

    /// Returns the sides of the box around all faces, in model units.
    pub(super) fn extent(&self) -> DVec3 {
        DVec3::from(self.frame.bounds.max) - DVec3::from(self.frame.bounds.min)
    }

    /// Converts a length in model units to one in the unit frame.
    pub(super) fn unit_length(&self, length: f64) -> f32 {
        (length / self.frame.side) as f32
    }

    /// Returns how far a face reaches from a point along each axis, in the unit frame.
    pub(super) fn reach(&self, face: u32, from: Vec3) -> Vec3 {
        let node = &self.nodes[face as usize];
        (node.max - from).max(from - node.min)
    }

    /// Returns the faces across the sides of a face.
    pub(super) fn neighbours(&self, face: u32) -> impl Iterator<Item = u32> + use<> {
        self.nodes[face as usize].across.into_iter().filter(|&other| other != NONE)
    }
}

impl UnitFrame {
    fn around<'a>(vertices: impl Iterator<Item = &'a VertexId>, positions: &[[f64; 3]]) -> Self {
        let bounds = Bounds::of(vertices.map(|v| &positions[v.index()]));
        let side = super::longest_side(&bounds).max(f64::MIN_POSITIVE);
        Self { bounds, side }
    }

    fn place(&self, at: [f64; 3]) -> Vec3 {
        ((DVec3::from(at) - DVec3::from(self.bounds.center())) / self.side).as_vec3()
    }
}

/// Returns true if a face has three different corners.
pub(super) fn is_whole(&[a, b, c]: &[VertexId; 3]) -> bool {
    a != b && b != c && c != a
}

fn in_order<T: Copy + Send + Sync>(order: &[u32], items: &[T]) -> Vec<T> {
    order.par_iter().map(|&at| items[at as usize]).collect()
}
