//! Options, targets, errors and the report of a simplification.

use std::ops::AddAssign;

use meshlod_mesh::{Locks, MeshError, VertexId};
use thiserror::Error;

use crate::held::Held;
use crate::history::volume::VolumeLoss;
use crate::method::Method;
use crate::refusal::Refusals;

/// Number of faces or error at which a simplification stops.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Target {
    /// At most this number of faces; the result may have a few faces fewer.
    Faces(usize),
    /// At most this fraction of the input's faces, from 0 to 1.
    Ratio(f64),
    /// As few faces as possible with an error of at most this distance, in model units.
    ///
    /// For [`Method::LindstromTurk`] and [`Method::Qem`] the error is checked against the input
    /// itself, at points in both directions; between these points it may be exceeded, mostly by less
    /// than a tenth, in single places by a quarter or more. The other methods rely on their own
    /// estimate, which is no bound. The facade `meshlod` proves the error for every method, and mends
    /// what exceeds it.
    Error(f64),
}

impl Target {
    /// Returns the target unchanged, or an error if it is out of range.
    ///
    /// # Errors
    /// The ratio is outside 0 to 1, or the error is negative or NaN.
    pub fn valid(self) -> Result<Self, SimplifyError> {
        match self {
            Self::Ratio(ratio) if !(0.0..=1.0).contains(&ratio) => {
                Err(SimplifyError::BadTarget(ratio))
            }
            Self::Error(error) if error.is_nan() || error < 0.0 => {
                Err(SimplifyError::BadTarget(error))
            }
            target => Ok(target),
        }
    }

    /// Returns the target number of faces for a mesh of `all` faces; 0 for an error target, which
    /// does not limit the number.
    pub fn faces_of(self, all: usize) -> usize {
        match self {
            Self::Faces(faces) => faces,
            // Rounds down, with a margin for rounding errors: 29 % of 100 is 29.
            Self::Ratio(ratio) => (all as f64 * ratio + 1e-6).floor() as usize,
            Self::Error(_) => 0,
        }
    }
}

/// Factor on the distance that a protected vertex moves. Pixels over 24 views that show what the
/// original hides, with `qem`: fish-clown.obj with its crossings protected, at 25 and 10 %, and
/// fused with its lines protected; suzanne.obj at 50 %:
///
/// | factor | 25 % | 10 % | fused 25 % | fused 10 % | suzanne |
/// |---|--:|--:|--:|--:|--:|
/// | 1 | 12,158 | 49,399 | 2,529 | 22,116 | 10,206 |
/// | 2 | 7,468 | 25,541 | 1,692 | 14,629 | 391 |
/// | 3 | 6,546 | 23,601 | 1,856 | 11,509 | 143 |
/// | 5 | 6,294 | 96,156 | | | 376 |
///
/// From 5 on everything unprotected is contracted first, whatever the cost.
const PROTECTION: f64 = 2.0;

/// Changes that a simplification may make to the topology of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Topology {
    /// Connected components may vanish, and handles close, where that costs less than contracting
    /// further: tunnels are filled, and arms of rings cut. Handles stay within a [`Target::Error`],
    /// where an observer sees contractions, and at seams. Seams of textures and borders of materials
    /// give way where that costs least, so charts may vanish too; within a [`Target::Error`], and in
    /// all runs after one, they stay. Non-manifold vertices move only where
    /// [`meshlod_mesh::condition`] has split them before.
    #[default]
    Free,
    /// Closed surfaces stay closed, manifold surfaces stay manifold, no component or chart
    /// vanishes, and no handle closes.
    Keep,
}

impl Topology {
    /// All treatments of the topology, the default first.
    pub const ALL: [Self; 2] = [Self::Free, Self::Keep];

    /// Returns the name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Keep => "keep",
        }
    }
}

meshlod_mesh::by_name!(Topology, "treatments of the topology");

/// Options of a mesh simplification.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Options {
    /// Simplification algorithm, which also decides which of the two engines runs it.
    pub method: Method,
    /// Weights of attribute errors in the costs; only methods with [`Method::counts_attributes`]
    /// use them.
    pub weights: AttributeWeights,
    /// True to keep every vertex on a boundary edge in place.
    pub lock_boundary: bool,
    /// Weight of boundary movement in the costs, `None` for the method's default; only methods with
    /// [`Method::weighs_boundaries`] use it.
    ///
    /// Zero ignores boundaries in the costs; the kernel counts values above 1e9 as 1e9.
    /// `lindstrom-turk` and `lindstrom-turk-faces` weigh squared areas under the boundary against
    /// squared volumes, and the methods based on quadrics weigh planes on boundary edges against
    /// planes of faces. `None` selects the method's own weight: 9 for the former, 2 for the latter.
    pub boundary_weight: Option<f64>,
    /// Locks of vertices: to stay in place, to cost more to move, or to move together as ties. Tied
    /// vertices without edges to move along together stay in place.
    pub locks: Locks,
    /// Factor on the distance that a [protected](meshlod_mesh::Lock::Protected) vertex moves, `None`
    /// for 2, which was chosen for contacts between objects; between 1 and 1,000.
    ///
    /// From about 5 on, nearly all that is not protected is contracted first.
    pub protection: Option<f64>,
    /// Changes that are allowed to the topology of the surface.
    pub topology: Topology,
    /// Bounding-box diagonal, in model units, below which a connected component may be removed as a
    /// whole; `None` sets no limit. With [`Topology::Keep`] no component is removed.
    ///
    /// A component vanishes when that costs less than contracting it further. For
    /// [`Method::LindstromTurk`] and [`Method::Qem`] its distance from what remains is the error.
    /// The other methods remove components only below a given size, which counts as the error. One
    /// component always stays, for the former two the largest, and so does one with a locked or tied
    /// vertex.
    pub vanish_below: Option<f64>,
    /// True if surfaces are seen from their fronts only. A component that lies on another and faces
    /// away from it is then measured without that other coat: if it vanished, there would be nothing
    /// to see from its side. Only [`Method::LindstromTurk`] and [`Method::Qem`] use it. Scenes set it
    /// for each mesh with a single-sided material.
    pub single_sided: bool,
    /// True to fit the free vertices of each [settled level](crate::Simplifier::settled_level) to the
    /// input once more, all together. Only [`Method::LindstromTurk`] does it, and not after a run to a
    /// [`Target::Error`]. Volumes, boundaries, seams and locked vertices stay.
    pub polish: bool,
}

impl Options {
    /// Checks that all weights are finite and not negative.
    pub(crate) fn validate(&self) -> Result<(), SimplifyError> {
        self.weights.validate()?;
        if let Some(bad) = self.protection.filter(|factor| !(1.0..=1000.0).contains(factor)) {
            return Err(SimplifyError::BadProtection(bad));
        }
        match self.boundary_weight.filter(|weight| !weight.is_finite() || *weight < 0.0) {
            Some(weight) => Err(SimplifyError::BadWeight(weight)),
            None => Ok(()),
        }
    }

    /// Returns the factor on the cost of a contraction that moves a protected vertex.
    pub(crate) fn protection_of_cost(&self) -> f64 {
        self.protection.unwrap_or(PROTECTION).powi(self.method.cost_power())
    }
}

/// Weights of attribute errors relative to distances in the costs of contractions; 0 ignores an
/// attribute.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct AttributeWeights {
    /// Weight of normals: a deviation of 1 counts as this fraction of the bounding-box diagonal.
    pub normal: f64,
    /// Weight of texture coordinates: a texture sliding by some length counts as this fraction of
    /// that length.
    pub uv: f64,
    /// Weight of colours: a deviation of 1 counts as this fraction of the bounding-box diagonal.
    pub color: f64,
}

impl Default for AttributeWeights {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl AttributeWeights {
    /// Default attribute weights, as a constant.
    pub const DEFAULT: Self = Self { normal: 0.005, uv: 0.5, color: 0.005 };

    /// Attribute weights of zero: costs depend on the geometry alone.
    pub const NONE: Self = Self { normal: 0.0, uv: 0.0, color: 0.0 };

    fn all(&self) -> [f64; 3] {
        [self.normal, self.uv, self.color]
    }

    pub(crate) fn validate(&self) -> Result<(), SimplifyError> {
        match self.all().into_iter().find(|weight| !weight.is_finite() || *weight < 0.0) {
            Some(weight) => Err(SimplifyError::BadWeight(weight)),
            None => Ok(()),
        }
    }
}

/// Reason why a mesh cannot be simplified.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SimplifyError {
    /// The mesh is invalid; see [`meshlod_mesh::Mesh::validate`].
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The mesh to simplify has no faces.
    #[error("the mesh has no faces")]
    NoFaces,
    /// Every face repeats a vertex, so that nothing is left to simplify.
    #[error("none of the {0} faces has three different vertices")]
    AllDegenerate(usize),
    /// The mesh is too small or too large for the computations to stay in range.
    #[error(
        "the diagonal of the mesh must be between 1e-30 and 1e30, not {diagonal:e}: scale the mesh"
    )]
    Extent {
        /// Diagonal of the mesh's bounding box, in model units.
        diagonal: f64,
    },
    /// The number of vertices of the locks is not that of the mesh.
    #[error("the locks cover {found} vertices, but the mesh has {expected}")]
    LockCount {
        /// Number of vertices that the locks are for.
        found: usize,
        /// Number of vertices in the mesh.
        expected: usize,
    },
    /// A tie contains a vertex that does not exist.
    #[error("tie {tie} names vertex {vertex}, but the mesh has only {count} vertices")]
    BadTie {
        /// Index of the tie with the missing vertex.
        tie: usize,
        /// Vertex id that is out of range.
        vertex: VertexId,
        /// Number of vertices in the mesh.
        count: usize,
    },
    /// A vertex occurs in two ties, or twice in one.
    #[error("tie {tie} names vertex {vertex}, which is already tied")]
    TiedTwice {
        /// Index of the second tie, or of the tie that contains the vertex twice.
        tie: usize,
        /// Vertex that occurs twice in the ties.
        vertex: VertexId,
    },
    /// The vertices of a tie are at different positions.
    #[error(
        "the vertices of tie {tie} must share one position, but {} and {} do not",
        vertices[0],
        vertices[1]
    )]
    TornTie {
        /// Index of the tie with the different positions.
        tie: usize,
        /// Two vertices of the tie that are at different positions.
        vertices: [VertexId; 2],
    },
    /// The weight of an attribute or of boundaries is negative or not finite.
    #[error("the weight must be a number of at least 0, not {0}")]
    BadWeight(f64),
    /// The factor on the distance that a protected vertex moves is below 1, above 1,000 or NaN.
    #[error("the protection must be a factor between 1 and 1000, not {0}")]
    BadProtection(f64),
    /// The size below which components may be removed is negative or NaN.
    #[error("the size below which components may vanish must be at least 0, not {0}")]
    BadSize(f64),
    /// The target number of faces, ratio or error is out of range.
    #[error("the target must be a ratio between 0 and 1 or an error of at least 0, not {0}")]
    BadTarget(f64),
}

/// Numbers of contractions by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Contractions {
    /// Number of edges contracted by themselves.
    pub edges: usize,
    /// Number of faces contracted as a whole.
    pub faces: usize,
}

impl Contractions {
    /// Returns the share of edges among the contractions, from 0 to 1; `None` if there are none.
    pub fn edge_share(self) -> Option<f64> {
        let all = self.edges + self.faces;
        (all > 0).then(|| self.edges as f64 / all as f64)
    }
}

impl AddAssign for Contractions {
    fn add_assign(&mut self, other: Self) {
        self.edges += other.edges;
        self.faces += other.faces;
    }
}

/// Proof that a level is as near to its input as was asked for, or how near it is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ErrorProof {
    /// Largest distance asked for, in model units.
    pub asked: f64,
    /// Upper bound of the distance between level and input, in both directions, in model units.
    pub proved: f64,
    /// Number of times that contractions were taken back, or the run was repeated, to hold it.
    pub rounds: usize,
}

/// Handles of a surface: a torus has one, and so has a plate with one hole through it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct HandleCounts {
    /// Number of handles before the run, the sum over all components.
    pub before: usize,
    /// Number of handles that have been closed: tunnels filled, or arms of rings cut.
    pub closed: usize,
}

impl AddAssign for HandleCounts {
    fn add_assign(&mut self, other: Self) {
        self.before += other.before;
        self.closed += other.closed;
    }
}

/// Report of a mesh simplification.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Report {
    /// Simplification method that ran.
    pub method: Method,
    /// Number of faces of the input mesh.
    pub input_faces: usize,
    /// Number of input faces left out because they repeat a vertex.
    pub degenerate_faces: usize,
    /// Number of input faces left out because they repeat another face.
    pub duplicate_faces: usize,
    /// Number of non-manifold input vertices, which are kept in place.
    pub non_manifold_vertices: usize,
    /// Numbers of input vertices that are locked, protected or tied.
    pub held: Held,
    /// Number of faces of the simplified mesh.
    pub output_faces: usize,
    /// Numbers of edges and faces contracted.
    pub contractions: Contractions,
    /// Number of connected components that were removed as a whole.
    pub vanished: usize,
    /// Handles of the mesh; `None` where none may close, as with [`Topology::Keep`].
    pub handles: Option<HandleCounts>,
    /// True if the target number of faces was reached, or the error is not proved to be exceeded.
    pub reached: bool,
    /// Greatest estimated distance of any contraction from the input, in model units.
    ///
    /// This estimates the maximum that `measure` finds and is not an upper bound of it. A component
    /// that the kernel has removed counts with its distance from the rest of the input, and one that
    /// the policy engine has removed with its size.
    pub error_estimate: f64,
    /// True if the surface is in several components, more than half of its vertices can go no further,
    /// and the rest has moved by more than a 25th of the diagonal for it: a level of few more faces
    /// would be much nearer. False within an error, and from the methods of the policy engine.
    pub near_limit: bool,
    /// Proof of the distance from the input; `None` if nothing is proved. [`Simplifier`]
    /// proves nothing; the facade `meshlod` does for every [`Target::Error`].
    ///
    /// [`Simplifier`]: crate::Simplifier
    pub proof: Option<ErrorProof>,
    /// Number of refused contractions, by reason.
    pub refusals: Refusals,
    /// Change of the enclosed volume by the contractions.
    pub volume: VolumeLoss,
}
