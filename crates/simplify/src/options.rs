//! Options, targets, errors and the report of a run.

use meshlod_mesh::{Locks, MeshError, VertexId};
use thiserror::Error;

use crate::engine::locks::Held;
use crate::history::volume::VolumeLoss;
use crate::refusal::Refusals;

/// Simplification algorithm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// Quadric error metrics with optimal placement [GH97].
    Qem,
    /// Quadric error metrics with half-edge contraction: every vertex of the result is a vertex of
    /// the input [GH97].
    QemEndpoint,
    /// Memoryless simplification: edge contraction by swept volume, conserving the volume [LT98].
    #[default]
    LindstromTurk,
    /// Memoryless simplification by face contraction, conserving the volume [LT98].
    LindstromTurkFaces,
    /// Face constriction that conserves the volume [LJ05].
    LeeJang,
    /// Face constriction to the weighted mean of the corners [Wu01].
    Wu,
    /// Edge contraction ordered by quadrics, with positions moved to conserve the volume [KJ04].
    KimJang,
    /// Progressive meshes: minimizes the distance energy of surface samples [Hop96].
    Pm,
    /// Simple polygon reduction: edge length times turning angle, onto vertices of the input
    /// [Mel98].
    Spr,
}

impl Method {
    /// All methods, in a fixed order.
    pub const ALL: [Self; 9] = [
        Self::Qem,
        Self::QemEndpoint,
        Self::LindstromTurk,
        Self::LindstromTurkFaces,
        Self::LeeJang,
        Self::Wu,
        Self::KimJang,
        Self::Pm,
        Self::Spr,
    ];

    /// Returns the method's name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Qem => "qem",
            Self::QemEndpoint => "qem-endpoint",
            Self::LindstromTurk => "lindstrom-turk",
            Self::LindstromTurkFaces => "lindstrom-turk-faces",
            Self::LeeJang => "lee-jang",
            Self::Wu => "wu",
            Self::KimJang => "kim-jang",
            Self::Pm => "pm",
            Self::Spr => "spr",
        }
    }

    /// Returns the power of a length that the method's costs scale with.
    ///
    /// Quadrics give squared distances times areas, swept volumes squared volumes, and samples
    /// squared distances.
    pub fn cost_power(self) -> i32 {
        match self {
            Self::Qem | Self::QemEndpoint | Self::KimJang => 4,
            Self::LindstromTurk | Self::LindstromTurkFaces => 6,
            Self::Pm => 2,
            Self::LeeJang | Self::Wu | Self::Spr => 1,
        }
    }

    /// Returns true if the method's costs include attributes, weighted by [`Options::weights`].
    /// Every method carries attributes along.
    pub fn counts_attributes(self) -> bool {
        matches!(self, Self::Qem | Self::QemEndpoint | Self::LindstromTurk)
    }

    /// Returns true if the method's costs weigh the movement of boundaries by
    /// [`Options::boundary_weight`].
    pub fn weighs_boundaries(self) -> bool {
        match self {
            Self::Qem | Self::QemEndpoint | Self::KimJang => true,
            Self::LindstromTurk | Self::LindstromTurkFaces => true,
            Self::LeeJang | Self::Wu | Self::Pm | Self::Spr => false,
        }
    }

    /// Returns true if every contraction with a closed ring that may choose its position freely
    /// conserves the volume.
    pub fn conserves_volume(self) -> bool {
        match self {
            Self::LindstromTurk | Self::LindstromTurkFaces | Self::LeeJang | Self::KimJang => true,
            Self::Qem | Self::QemEndpoint | Self::Wu | Self::Pm | Self::Spr => false,
        }
    }

    /// Returns the method with this name, if there is one.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }
}

/// Target at which a run stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// At most this many faces; contractions may stop a few faces below.
    Faces(usize),
    /// At most this fraction of the input's faces, between 0 and 1.
    Ratio(f64),
    /// As few faces as possible while the error stays within this, in model units.
    ///
    /// For [`Method::LindstromTurk`] and [`Method::Qem`] the error is checked against the input
    /// itself, at samples in both directions. The other methods rely on their own estimate.
    Error(f64),
}

impl Target {
    /// Checks the target and returns it unchanged.
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

    /// Returns the target number of faces for a mesh of `all` faces, and 0 for an error target,
    /// which sets no number.
    pub fn faces_of(self, all: usize) -> usize {
        match self {
            Self::Faces(faces) => faces,
            // Rounds down, with a margin for rounding errors: 29 % of 100 is 29.
            Self::Ratio(ratio) => (all as f64 * ratio + 1e-6).floor() as usize,
            Self::Error(_) => 0,
        }
    }
}

/// Options of a simplification.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Algorithm, which also decides the engine that runs it.
    pub method: Method,
    /// Weights of the attributes in the costs of methods for which [`Method::counts_attributes`] is
    /// true.
    pub weights: AttributeWeights,
    /// True to keep every vertex of a boundary edge in place.
    pub lock_boundary: bool,
    /// Weight of boundary movement in the costs of methods for which [`Method::weighs_boundaries`]
    /// is true.
    ///
    /// Zero ignores boundaries in the costs; the kernel counts values above 1e9 as 1e9.
    /// `lindstrom-turk` and `lindstrom-turk-faces` weigh squared areas under the boundary against
    /// squared volumes, and the methods based on quadrics weigh planes on boundary edges against
    /// planes of faces. `None` selects the method's own weight: 9 for the former, 2 for the latter.
    pub boundary_weight: Option<f64>,
    /// Vertices that stay in place, cost more to move, or move together as ties. Tied vertices
    /// without edges to move along together stay in place.
    pub locks: Locks,
    /// Length of the bounding-box diagonal, in model units, below which a connected component may
    /// vanish as a whole; `None` keeps every component.
    ///
    /// A component vanishes when that costs less than contracting it further. Its size then counts
    /// as an error. The last component never vanishes, nor does one with a locked or tied vertex.
    pub vanish_below: Option<f64>,
}

impl Options {
    /// Checks all weights.
    pub(crate) fn validate(&self) -> Result<(), SimplifyError> {
        self.weights.validate()?;
        match self.boundary_weight.filter(|weight| !weight.is_finite() || *weight < 0.0) {
            Some(weight) => Err(SimplifyError::BadWeight(weight)),
            None => Ok(()),
        }
    }
}

/// Weights of attribute errors against distance; 0 ignores an attribute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttributeWeights {
    /// Weight of normals: a deviation of one counts as this fraction of the bounding-box diagonal.
    pub normal: f64,
    /// Weight of texture coordinates: a texture sliding by a length counts as this fraction of that
    /// length.
    pub uv: f64,
    /// Weight of colours: a deviation of one counts as this fraction of the bounding-box diagonal.
    pub color: f64,
}

impl Default for AttributeWeights {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl AttributeWeights {
    /// Default weights, as a constant.
    pub const DEFAULT: Self = Self { normal: 0.005, uv: 0.5, color: 0.005 };

    /// Weights of zero: costs depend on the geometry alone.
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

/// Error of a simplification that cannot start.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SimplifyError {
    /// The mesh is invalid, see [`meshlod_mesh::Mesh::validate`].
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The mesh has no faces.
    #[error("the mesh has no faces")]
    NoFaces,
    /// None of the faces has three different vertices.
    #[error("none of the {0} faces has three different vertices")]
    AllDegenerate(usize),
    /// The mesh is too small or too large to compute with.
    #[error(
        "the diagonal of the mesh must be between 1e-30 and 1e30, not {diagonal:e}: scale the mesh"
    )]
    Extent {
        /// Diagonal of the bounding box, in model units.
        diagonal: f64,
    },
    /// The locks have a different number of vertices than the mesh.
    #[error("the locks cover {found} vertices, but the mesh has {expected}")]
    LockCount {
        /// Number of vertices in the locks.
        found: usize,
        /// Number of vertices of the mesh.
        expected: usize,
    },
    /// A tie refers to a vertex that does not exist.
    #[error("tie {tie} names vertex {vertex}, but the mesh has only {count} vertices")]
    BadTie {
        /// Index of the tie.
        tie: usize,
        /// Vertex that does not exist.
        vertex: VertexId,
        /// Number of vertices of the mesh.
        count: usize,
    },
    /// A vertex occurs twice in the ties.
    #[error("tie {tie} names vertex {vertex}, which is already tied")]
    TiedTwice {
        /// Index of the second tie, or of the tie that contains the vertex twice.
        tie: usize,
        /// Vertex that occurs twice.
        vertex: VertexId,
    },
    /// The vertices of a tie are not at one position.
    #[error(
        "the vertices of tie {tie} must share one position, but {} and {} do not",
        vertices[0],
        vertices[1]
    )]
    TornTie {
        /// Index of the tie.
        tie: usize,
        /// Two vertices of the tie at different positions.
        vertices: [VertexId; 2],
    },
    /// A weight is negative or not finite.
    #[error("the weight must be a number of at least 0, not {0}")]
    BadWeight(f64),
    /// The size below which components may vanish is negative or NaN.
    #[error("the size below which components may vanish must be at least 0, not {0}")]
    BadSize(f64),
    /// The target is out of range.
    #[error("the target must be a ratio between 0 and 1 or an error of at least 0, not {0}")]
    BadTarget(f64),
}

/// Report of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Algorithm that ran.
    pub method: Method,
    /// Number of faces of the input.
    pub input_faces: usize,
    /// Number of input faces left out because they repeat a vertex.
    pub degenerate_faces: usize,
    /// Number of input faces left out because they repeat another face.
    pub duplicate_faces: usize,
    /// Number of non-manifold input vertices, which are kept in place.
    pub non_manifold_vertices: usize,
    /// Number of input vertices held by locks, by kind.
    pub held: Held,
    /// Number of faces left after the run.
    pub output_faces: usize,
    /// Number of components that have vanished.
    pub vanished: usize,
    /// True if the target was reached.
    pub reached: bool,
    /// Greatest distance estimated for any contraction, in model units.
    ///
    /// This estimates the maximum that `measure` finds and is not an upper bound of it. A component
    /// that has vanished counts with its size; its distance to the remaining surface is not
    /// measured.
    pub error_estimate: f64,
    /// Number of refused candidates, by reason.
    pub refusals: Refusals,
    /// Change of the enclosed volume.
    pub volume: VolumeLoss,
}
