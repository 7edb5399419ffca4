//! Findings of a mesh check: one variant for each kind, with ids and positions.

use meshlod_mesh::{FaceId, MeshError, VertexId};

use crate::objects::ObjectId;

/// A defect or noteworthy feature found in a mesh, with the vertices and faces concerned.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "kebab-case"))]
pub enum Finding {
    /// A vertex with a NaN or infinite coordinate. Its faces are excluded from all further checks.
    NonFiniteVertex {
        /// The vertex with the NaN or infinite coordinate.
        vertex: VertexId,
    },
    /// A face that refers to a vertex that does not exist. It is excluded from all further checks.
    BadIndex {
        /// The face that refers to the missing vertex.
        face: FaceId,
        /// Vertex id that is out of range.
        vertex: VertexId,
    },
    /// Attributes, materials or objects whose arrays do not match the faces. Mismatched labels are
    /// ignored.
    BadAttributes {
        /// The first mismatch found; serde writes its message.
        #[cfg_attr(feature = "serde", serde(serialize_with = "as_text"))]
        error: MeshError,
    },
    /// A vertex that no face uses.
    UnusedVertex {
        /// The vertex that no face uses.
        vertex: VertexId,
    },
    /// Two or more used vertices at bitwise the same position.
    CoincidentVertices {
        /// The coincident vertices, lowest id first.
        vertices: Vec<VertexId>,
    },
    /// A face that repeats a vertex or has zero area.
    DegenerateFace {
        /// The degenerate face.
        face: FaceId,
        /// Whether the face repeats a vertex or has zero area.
        shape: Degeneracy,
    },
    /// A face with the same three vertices as an earlier one.
    DuplicateFace {
        /// The later of the two faces.
        face: FaceId,
        /// The first face with these three vertices.
        of: FaceId,
    },
    /// An edge that its two faces traverse in the same direction.
    InconsistentEdge {
        /// The two vertices of the edge, lowest id first.
        edge: [VertexId; 2],
        /// The two faces of the edge, lowest id first.
        faces: [FaceId; 2],
    },
    /// A loop of boundary edges.
    BoundaryLoop {
        /// Vertices of the loop, in the direction of its faces where they agree, starting with the
        /// lowest id. No vertex occurs twice: a pinched boundary is several loops.
        vertices: Vec<VertexId>,
        /// True if the last vertex is connected to the first. If false, the boundary ends at
        /// non-manifold edges, and the end with the lower id comes first.
        closed: bool,
    },
    /// An edge shared by three faces or more.
    NonManifoldEdge {
        /// The two vertices of the edge, lowest id first.
        edge: [VertexId; 2],
        /// All faces of the edge, lowest id first.
        faces: Vec<FaceId>,
    },
    /// A vertex whose faces form more than one fan: they are not all connected through edges at the
    /// vertex.
    NonManifoldVertex {
        /// The non-manifold vertex.
        vertex: VertexId,
        /// Number of separate fans of faces around the vertex.
        fans: usize,
    },
    /// A closed, consistently oriented shell whose faces point inwards. A shell is a set of faces
    /// connected through edges.
    InsideOut {
        /// Lowest-numbered face of the shell.
        face: FaceId,
        /// Signed volume that the shell encloses, negative, in cubic model units.
        volume: f64,
    },
    /// Two faces of one object that intersect elsewhere than in vertices and edges they share.
    SelfIntersection {
        /// The object that both faces belong to.
        object: ObjectId,
        /// The two intersecting faces, lowest id first.
        faces: [FaceId; 2],
        /// Kind, place and depth of the intersection.
        intersection: Intersection,
    },
    /// Faces of two objects that intersect or touch.
    Contact {
        /// The two objects that meet, lowest id first.
        objects: [ObjectId; 2],
        /// One face of each object, in the order of `objects`.
        faces: [FaceId; 2],
        /// Kind, place and depth of the intersection.
        intersection: Intersection,
    },
    /// The search for intersecting faces was given up because too many pairs are close: there may
    /// be more self-intersections and contacts than reported.
    Crowded {
        /// Number of intersecting pairs of faces found before giving up.
        found: usize,
    },
}

#[cfg(feature = "serde")]
fn as_text<S: serde::Serializer>(error: &MeshError, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(error)
}

/// The way in which a face is degenerate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Degeneracy {
    /// Two corners of the face are the same vertex.
    RepeatedVertex,
    /// The corners of the face are three vertices that are exactly collinear.
    ZeroArea,
}

/// Kind, place and penetration depth of the intersection of two faces.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Intersection {
    /// Whether the faces touch, cross or overlap.
    pub kind: IntersectionKind,
    /// A point that lies in both faces, in model units.
    pub point: [f64; 3],
    /// Penetration depth in model units: the least distance that one face would have to move along
    /// the normal of the other until it is on one side of it; 0 for faces that only touch or are
    /// coplanar.
    pub depth: f64,
}

/// Kind of the intersection of two faces, decided exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum IntersectionKind {
    /// The faces touch in a single point without passing through each other.
    Point,
    /// The faces touch along a line segment without passing through each other.
    Segment,
    /// The faces pass through each other.
    Crossing,
    /// The faces are coplanar and overlap in an area.
    Overlap,
}

/// Kind of a mesh defect or other finding, without its details.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Kind {
    /// NaN or infinite coordinates of a vertex: [`Finding::NonFiniteVertex`].
    NonFiniteVertex,
    /// A face with a vertex that does not exist: [`Finding::BadIndex`].
    BadIndex,
    /// Attributes or labels that do not match the faces: [`Finding::BadAttributes`].
    BadAttributes,
    /// A vertex that no face uses: [`Finding::UnusedVertex`].
    UnusedVertex,
    /// Several vertices at one position: [`Finding::CoincidentVertices`].
    CoincidentVertices,
    /// A face that repeats a vertex or has zero area: [`Finding::DegenerateFace`].
    DegenerateFace,
    /// A face with the vertices of an earlier one: [`Finding::DuplicateFace`].
    DuplicateFace,
    /// An edge whose two faces disagree in orientation: [`Finding::InconsistentEdge`].
    InconsistentEdge,
    /// A loop of boundary edges: [`Finding::BoundaryLoop`].
    BoundaryLoop,
    /// An edge with three faces or more: [`Finding::NonManifoldEdge`].
    NonManifoldEdge,
    /// A vertex with several fans of faces: [`Finding::NonManifoldVertex`].
    NonManifoldVertex,
    /// A closed shell whose faces point inwards: [`Finding::InsideOut`].
    InsideOut,
    /// Two intersecting faces of one object: [`Finding::SelfIntersection`].
    SelfIntersection,
    /// Two objects that intersect or touch: [`Finding::Contact`].
    Contact,
    /// A search for intersecting faces that was given up: [`Finding::Crowded`].
    Crowded,
}

/// Severity of a finding, which depends on its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Severity {
    /// The mesh is usable, but the finding is worth knowing.
    Warning,
    /// Most programs reject the mesh or process it incorrectly.
    Error,
}

impl Kind {
    /// All kinds of findings, in the order in which a mesh is checked for them.
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

    /// Returns the name of the kind of finding as used in reports.
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

    /// Returns the severity of findings of this kind.
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
    /// Returns the kind of defect that the finding reports.
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
