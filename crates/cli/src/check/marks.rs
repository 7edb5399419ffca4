//! Marks on the pictures of a mesh check: faces and edges coloured by their defect.

use meshlod::Mesh;
use meshlod::check::{Finding, Objects};
use meshlod::mesh::{FaceId, VertexId};

use meshlod::jobs::is_touch;

/// A defect or contact that pictures mark by a colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mark {
    Broken,
    NonManifold,
    Crossing,
    SelfCrossing,
    Inconsistent,
    InsideOut,
    Boundary,
    Touching,
}

impl Mark {
    /// All marks; where several apply to a face, the first wins.
    pub const ALL: [Self; 8] = [
        Self::Broken,
        Self::NonManifold,
        Self::Crossing,
        Self::SelfCrossing,
        Self::Inconsistent,
        Self::InsideOut,
        Self::Boundary,
        Self::Touching,
    ];

    /// Returns whether the mark may be where nothing is wrong.
    pub fn may_be_meant(self) -> bool {
        matches!(self, Self::Boundary | Self::Touching)
    }

    pub fn color(self) -> [u8; 3] {
        match self {
            Self::Broken => [24, 24, 24],
            Self::NonManifold => [200, 0, 128],
            Self::Crossing => [214, 40, 24],
            Self::SelfCrossing => [122, 62, 208],
            Self::Inconsistent => [126, 74, 28],
            Self::InsideOut => [20, 150, 140],
            Self::Boundary => [24, 110, 230],
            // Hardly darker than unmarked faces: nothing to look for.
            Self::Touching => [168, 196, 180],
        }
    }

    /// Returns the description of the mark for the legend.
    pub fn about(self) -> &'static str {
        match self {
            Self::Broken => "degenerate or duplicate face",
            Self::NonManifold => "non-manifold edge or vertex",
            Self::Crossing => "face that crosses or overlaps another object",
            Self::SelfCrossing => "face that intersects its own object",
            Self::Inconsistent => "edge whose faces are inconsistently oriented",
            Self::InsideOut => "component that is inside out",
            Self::Boundary => "boundary: the surface ends",
            Self::Touching => "objects touch, as parts may",
        }
    }
}

/// Marks on the faces, edges and vertices of a checked mesh.
pub struct Marks {
    pub of_face: Vec<Option<Mark>>,
    pub edges: Vec<([VertexId; 2], Mark)>,
    pub vertices: Vec<(VertexId, Mark)>,
}

/// Limit of drawn edges; no picture could show more.
const MOST_EDGES: usize = 200_000;

impl Marks {
    pub fn new(mesh: &Mesh) -> Self {
        let of_face = vec![None; mesh.faces.len()];
        Self { of_face, edges: Vec::new(), vertices: Vec::new() }
    }

    pub fn add(&mut self, mesh: &Mesh, objects: &Objects, finding: &Finding) {
        match finding {
            Finding::DegenerateFace { face, .. } | Finding::DuplicateFace { face, .. } => {
                self.face(*face, Mark::Broken);
                let [a, b, c] = mesh.faces[face.index()];
                [[a, b], [b, c], [c, a]].into_iter().for_each(|edge| self.edge(edge, Mark::Broken));
            }
            Finding::InconsistentEdge { edge, .. } => self.edge(*edge, Mark::Inconsistent),
            Finding::NonManifoldEdge { edge, .. } => self.edge(*edge, Mark::NonManifold),
            Finding::NonManifoldVertex { vertex, .. } => {
                self.vertices.push((*vertex, Mark::NonManifold));
            }
            Finding::BoundaryLoop { vertices, closed } => {
                let ends = closed.then(|| [vertices[vertices.len() - 1], vertices[0]]);
                let pairs = vertices.windows(2).map(|pair| [pair[0], pair[1]]);
                pairs.chain(ends).for_each(|edge| self.edge(edge, Mark::Boundary));
            }
            Finding::InsideOut { face, .. } => {
                let component = objects.component_of_face[face.index()];
                let of = |f: &usize| objects.component_of_face[*f] == component;
                (0..mesh.faces.len())
                    .filter(of)
                    .for_each(|f| self.face(FaceId::new(f), Mark::InsideOut));
            }
            Finding::SelfIntersection { faces, .. } => {
                faces.iter().for_each(|face| self.face(*face, Mark::SelfCrossing));
            }
            Finding::Contact { faces, intersection, .. } => {
                let mark =
                    if is_touch(intersection.kind) { Mark::Touching } else { Mark::Crossing };
                faces.iter().for_each(|face| self.face(*face, mark));
            }
            Finding::NonFiniteVertex { .. }
            | Finding::BadIndex { .. }
            | Finding::BadAttributes { .. }
            | Finding::UnusedVertex { .. }
            | Finding::CoincidentVertices { .. }
            | Finding::Crowded { .. } => {}
        }
    }

    /// Returns the marks that occur on the mesh, in the order of [`Mark::ALL`].
    pub fn used(&self) -> Vec<Mark> {
        let of_edges = self.edges.iter().map(|(_, mark)| *mark);
        let of_vertices = self.vertices.iter().map(|(_, mark)| *mark);
        let all = self.of_face.iter().flatten().copied().chain(of_edges).chain(of_vertices);
        let mut seen = [false; Mark::ALL.len()];
        all.for_each(|mark| seen[mark as usize] = true);
        Mark::ALL.into_iter().filter(|&mark| seen[mark as usize]).collect()
    }

    fn face(&mut self, face: FaceId, mark: Mark) {
        let of = &mut self.of_face[face.index()];
        *of = Some(of.map_or(mark, |known| known.min(mark)));
    }

    fn edge(&mut self, edge: [VertexId; 2], mark: Mark) {
        if self.edges.len() < MOST_EDGES {
            self.edges.push((edge, mark));
        }
    }
}
