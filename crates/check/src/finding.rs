//! What a check finds: one type, a variant for each kind, with the ids and the place.

use meshlod_mesh::{FaceId, MeshError, VertexId};

use crate::objects::ObjectId;

/// One thing that is wrong, or worth knowing, and where it is.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// A coordinate is NaN or infinite. Faces at it have no part in what follows.
    NonFiniteVertex {
        /// The vertex.
        vertex: VertexId,
    },
    /// A face names a vertex that is not there. It has no part in what follows.
    BadIndex {
        /// The face.
        face: FaceId,
        /// What it names.
        vertex: VertexId,
    },
    /// Attributes, materials or objects do not fit the faces. Labels that do not fit name no objects.
    BadAttributes {
        /// The first that does not fit.
        error: MeshError,
    },
    /// No face uses a vertex.
    UnusedVertex {
        /// The vertex.
        vertex: VertexId,
    },
    /// Used vertices at one place, to the bit.
    CoincidentVertices {
        /// Two or more, lowest id first.
        vertices: Vec<VertexId>,
    },
    /// A face without an inside.
    DegenerateFace {
        /// The face.
        face: FaceId,
        /// How it is degenerate.
        shape: Degeneracy,
    },
    /// A face with the same three vertices as an earlier one.
    DuplicateFace {
        /// The face.
        face: FaceId,
        /// The first with these vertices.
        of: FaceId,
    },
    /// Two faces that run along their edge the same way.
    InconsistentEdge {
        /// Its ends, lowest id first.
        edge: [VertexId; 2],
        /// The two, lowest id first.
        faces: [FaceId; 2],
    },
    /// A loop of edges with one face each.
    BoundaryLoop {
        /// Its vertices, in their order along the faces where these agree, the lowest id first.
        /// None comes twice: a boundary that is pinched is several loops.
        vertices: Vec<VertexId>,
        /// Whether the last vertex is joined to the first. It is not where a non-manifold edge ends
        /// the boundary; then the lower end is first.
        closed: bool,
    },
    /// An edge with three faces or more.
    NonManifoldEdge {
        /// Its ends, lowest id first.
        edge: [VertexId; 2],
        /// Its faces, lowest id first.
        faces: Vec<FaceId>,
    },
    /// A vertex whose faces form more than one fan: through edges at it they do not all hang
    /// together.
    NonManifoldVertex {
        /// The vertex.
        vertex: VertexId,
        /// How many fans.
        fans: usize,
    },
    /// A shell, that is faces that hang together through edges, that is closed, consistently
    /// oriented, and looks inwards.
    InsideOut {
        /// Its first face.
        face: FaceId,
        /// What it encloses, below 0, in cubed model units.
        volume: f64,
    },
    /// Two faces of one object that meet beyond what they share.
    SelfIntersection {
        /// The object.
        object: ObjectId,
        /// The two, lowest id first.
        faces: [FaceId; 2],
        /// How they meet.
        touch: Touch,
    },
    /// Two faces of two objects that meet.
    Contact {
        /// The objects, lowest id first.
        objects: [ObjectId; 2],
        /// A face of each, in the order of the objects.
        faces: [FaceId; 2],
        /// How they meet.
        touch: Touch,
    },
    /// So many faces are close to so many others that the search for what meets was given up: there
    /// may be more self-intersections and contacts than are told.
    Crowded {
        /// How many pairs of faces were found until then.
        found: usize,
    },
}

/// How a face has no inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Degeneracy {
    /// It names a vertex twice.
    RepeatedVertex,
    /// Its corners are on one line, exactly.
    ZeroArea,
}

/// How two faces meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// What they have in common.
    pub kind: TouchKind,
    /// A point of it, in model units.
    pub place: [f64; 3],
    /// How far one of the faces would have to move along the normal of the other until it is on one
    /// side of it, at least, in model units; 0 for those that only touch, or lie in one plane.
    pub depth: f64,
}

/// What two faces have in common, exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum TouchKind {
    /// One point, and neither passes through the other.
    Vertex,
    /// A segment, and neither passes through the other.
    Edge,
    /// They pass through each other.
    Crossing,
    /// An area: they lie in one plane.
    Overlap,
}

/// What kind of finding it is.
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

/// How bad a kind of finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Worth knowing: the mesh can be used.
    Warning,
    /// Most programs will refuse the mesh or do wrong things with it.
    Error,
}

impl Kind {
    /// Every kind, in the order in which they are found.
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

    /// Its name in reports.
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

    /// How bad it is.
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
    /// What kind it is.
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
