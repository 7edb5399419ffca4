//! Position of a finding.

use meshlod_mesh::{FaceId, Mesh, VertexId};

use crate::finding::{Finding, Intersection};

impl Finding {
    /// Returns the position of the finding in a mesh, the one that was checked; `None` for a finding
    /// without a position.
    pub fn place(&self, mesh: &Mesh) -> Option<[f64; 3]> {
        let vertex = |v: VertexId| mesh.positions.get(v.index()).copied();
        let face = |f: FaceId| {
            let corners = mesh.faces.get(f.index())?.map(vertex);
            let [a, b, c] = [corners[0]?, corners[1]?, corners[2]?];
            Some([0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0))
        };
        match self {
            Self::NonFiniteVertex { vertex: v }
            | Self::UnusedVertex { vertex: v }
            | Self::NonManifoldVertex { vertex: v, .. } => vertex(*v),
            Self::CoincidentVertices { vertices } | Self::BoundaryLoop { vertices, .. } => {
                vertex(*vertices.first()?)
            }
            Self::InconsistentEdge { edge: [a, b], .. }
            | Self::NonManifoldEdge { edge: [a, b], .. } => {
                let (a, b) = (vertex(*a)?, vertex(*b)?);
                Some([0, 1, 2].map(|axis| (a[axis] + b[axis]) / 2.0))
            }
            Self::BadIndex { face: f, .. }
            | Self::DegenerateFace { face: f, .. }
            | Self::DuplicateFace { face: f, .. }
            | Self::InsideOut { face: f, .. } => face(*f),
            Self::SelfIntersection { intersection: Intersection { point, .. }, .. }
            | Self::Contact { intersection: Intersection { point, .. }, .. } => Some(*point),
            Self::BadAttributes { .. } | Self::Crowded { .. } => None,
        }
    }
}
