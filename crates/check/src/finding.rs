//! Findings of a check: one variant for each kind, with ids and positions.

use meshlod_mesh::{FaceId, MeshError, VertexId};

use crate::objects::ObjectId;

/// A defect or noteworthy feature of a mesh and where it is.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// A vertex with a NaN or infinite coordinate. Its faces are excluded from the kinds that
    /// follow.
    NonFiniteVertex {
        /// Vertex concerned.
        vertex: VertexId,
    },
    /// A face with a missing vertex. It is excluded from the kinds that follow.
    BadIndex {
        /// Face concerned.
        face: FaceId,
        /// Id of the missing vertex.
        vertex: VertexId,
    },
    /// Attributes, materials or objects that do not match the faces. Mismatched labels are ignored.
    BadAttributes {
        /// First mismatch.
        error: MeshError,
    },
    /// A vertex that no face uses.
    UnusedVertex {
        /// Vertex concerned.
        vertex: VertexId,
    },
    /// Used vertices at bitwise the same position.
    CoincidentVertices {
        /// Vertices at the position, two or more, lowest id first.
        vertices: Vec<VertexId>,
    },
    /// A degenerate face.
    DegenerateFace {
        /// Face concerned.
        face: FaceId,
        /// Kind of degeneracy.
        shape: Degeneracy,
    },
    /// A face with the same three vertices as an earlier one.
    DuplicateFace {
        /// Face concerned.
        face: FaceId,
        /// First face with these vertices.
        of: FaceId,
    },
    /// An edge that its two faces traverse in the same direction.
    InconsistentEdge {
        /// Ends of the edge, lowest id first.
        edge: [VertexId; 2],
        /// Faces of the edge, lowest id first.
        faces: [FaceId; 2],
    },
    /// A loop of boundary edges.
    BoundaryLoop {
        /// Vertices in order along the faces if these agree, starting with the lowest id. None
        /// occurs twice: a pinched boundary is several loops.
        vertices: Vec<VertexId>,
        /// True if the last vertex is connected to the first. False if a non-manifold edge ends the
        /// boundary; the lower end is then first.
        closed: bool,
    },
    /// An edge with three faces or more.
    NonManifoldEdge {
        /// Ends of the edge, lowest id first.
        edge: [VertexId; 2],
        /// Faces of the edge, lowest id first.
        faces: Vec<FaceId>,
    },
    /// A vertex whose faces form more than one fan: edges at the vertex do not connect them all.
    NonManifoldVertex {
        /// Vertex concerned.
        vertex: VertexId,
        /// Number of fans.
        fans: usize,
    },
    /// A closed, consistently oriented shell whose faces point inwards. A shell is a set of faces
    /// connected through edges.
    InsideOut {
        /// First face of the shell.
        face: FaceId,
        /// Signed enclosed volume, below 0, in cubed model units.
        volume: f64,
    },
    /// Two faces of one object that intersect beyond what they share.
    SelfIntersection {
        /// Object of both faces.
        object: ObjectId,
        /// Intersecting faces, lowest id first.
        faces: [FaceId; 2],
        /// Intersection of the faces.
        intersection: Intersection,
    },
    /// Faces of two objects that intersect or touch.
    Contact {
        /// Objects, lowest id first.
        objects: [ObjectId; 2],
        /// A face of each object, in the order of `objects`.
        faces: [FaceId; 2],
        /// Intersection of the faces.
        intersection: Intersection,
    },
    /// The search for intersecting faces was given up because too many pairs are close: there may
    /// be more self-intersections and contacts than reported.
    Crowded {
        /// Number of intersecting pairs found before giving up.
        found: usize,
    },
}

/// Way in which a face is degenerate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Degeneracy {
    /// Two corners are the same vertex.
    RepeatedVertex,
    /// The corners are exactly collinear.
    ZeroArea,
}

/// Intersection of two faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intersection {
    /// Kind of the intersection.
    pub kind: IntersectionKind,
    /// A point of the intersection, in model units.
    pub point: [f64; 3],
    /// Penetration depth in model units: the least distance that one face would have to move along
    /// the normal of the other until it is on one side of it; 0 for faces that only touch or are
    /// coplanar.
    pub depth: f64,
}

/// Kind of the intersection of two faces, exact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum IntersectionKind {
    /// A single point, and neither face passes through the other.
    Point,
    /// A segment, and neither face passes through the other.
    Segment,
    /// The faces pass through each other.
    Crossing,
    /// An area: the faces are coplanar.
    Overlap,
}

/// Kind of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// [`Finding::NonFiniteVertex`]
    NonFiniteVertex,
    /// [`Finding::BadIndex`]
    BadIndex,
    /// [`Finding::BadAttributes`]
    BadAttributes,
    /// [`Finding::UnusedVertex`]
    UnusedVertex,
    /// [`Finding::CoincidentVertices`]
    CoincidentVertices,
    /// [`Finding::DegenerateFace`]
    DegenerateFace,
    /// [`Finding::DuplicateFace`]
    DuplicateFace,
    /// [`Finding::InconsistentEdge`]
    InconsistentEdge,
    /// [`Finding::BoundaryLoop`]
    BoundaryLoop,
    /// [`Finding::NonManifoldEdge`]
    NonManifoldEdge,
    /// [`Finding::NonManifoldVertex`]
    NonManifoldVertex,
    /// [`Finding::InsideOut`]
    InsideOut,
    /// [`Finding::SelfIntersection`]
    SelfIntersection,
    /// [`Finding::Contact`]
    Contact,
    /// [`Finding::Crowded`]
    Crowded,
}

/// Severity of a kind of finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Noteworthy, but the mesh is usable.
    Warning,
    /// Most programs refuse the mesh or process it incorrectly.
    Error,
}

impl Kind {
    /// All kinds, in the order in which they are checked.
    pub const ALL: [Self; 15] = [
        Self::NonFiniteVertex,
        Self::BadIndex,
        Self::BadAttributes,
        Self::UnusedVertex,
        Self::CoincidentVertices,
        Self::DegenerateFace,
        Self::DuplicateFace,
        Self::InconsistentEdge,
        Self::BoundaryLoop,
        Self::NonManifoldEdge,
        Self::NonManifoldVertex,
        Self::InsideOut,
        Self::SelfIntersection,
        Self::Contact,
        Self::Crowded,
    ];

    /// Returns the name used in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::NonFiniteVertex => "non-finite-vertex",
            Self::BadIndex => "bad-index",
            Self::BadAttributes => "bad-attributes",
            Self::UnusedVertex => "unused-vertex",
            Self::CoincidentVertices => "coincident-vertices",
            Self::DegenerateFace => "degenerate-face",
            Self::DuplicateFace => "duplicate-face",
            Self::InconsistentEdge => "inconsistent-edge",
            Self::BoundaryLoop => "boundary-loop",
            Self::NonManifoldEdge => "non-manifold-edge",
            Self::NonManifoldVertex => "non-manifold-vertex",
            Self::InsideOut => "inside-out",
            Self::SelfIntersection => "self-intersection",
            Self::Contact => "contact",
            Self::Crowded => "crowded",
        }
    }

    /// Returns the severity of the kind.
    pub fn severity(self) -> Severity {
        match self {
            Self::NonFiniteVertex
            | Self::BadIndex
            | Self::BadAttributes
            | Self::DegenerateFace
            | Self::DuplicateFace
            | Self::InconsistentEdge
            | Self::NonManifoldEdge
            | Self::NonManifoldVertex => Severity::Error,
            Self::UnusedVertex
            | Self::CoincidentVertices
            | Self::BoundaryLoop
            | Self::InsideOut
            | Self::SelfIntersection
            | Self::Contact
            | Self::Crowded => Severity::Warning,
        }
    }
}

impl Finding {
    /// Returns the kind of the finding.
    pub fn kind(&self) -> Kind {
        match self {
            Self::NonFiniteVertex { .. } => Kind::NonFiniteVertex,
            Self::BadIndex { .. } => Kind::BadIndex,
            Self::BadAttributes { .. } => Kind::BadAttributes,
            Self::UnusedVertex { .. } => Kind::UnusedVertex,
            Self::CoincidentVertices { .. } => Kind::CoincidentVertices,
            Self::DegenerateFace { .. } => Kind::DegenerateFace,
            Self::DuplicateFace { .. } => Kind::DuplicateFace,
            Self::InconsistentEdge { .. } => Kind::InconsistentEdge,
            Self::BoundaryLoop { .. } => Kind::BoundaryLoop,
            Self::NonManifoldEdge { .. } => Kind::NonManifoldEdge,
            Self::NonManifoldVertex { .. } => Kind::NonManifoldVertex,
            Self::InsideOut { .. } => Kind::InsideOut,
            Self::SelfIntersection { .. } => Kind::SelfIntersection,
            Self::Contact { .. } => Kind::Contact,
            Self::Crowded { .. } => Kind::Crowded,
        }
    }
}
