//! What a user may ask for, and what comes back beside the mesh.

use meshlod_mesh::{Locks, MeshError, VertexId};
use thiserror::Error;

use crate::engine::locks::Held;
use crate::history::volume::VolumeLoss;
use crate::refusal::Refusals;

/// An algorithm by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// Quadric error metrics with optimal placement [GH97].
    Qem,
    /// The same, but every vertex of the result is one of the input: half-edge contraction.
    QemEndpoint,
    /// Memoryless, with the volume conserved exactly [LT98].
    #[default]
    LindstromTurk,
    /// The same of faces instead of edges.
    LindstromTurkFaces,
    /// Face constriction with the volume conserved exactly [LJ05].
    LeeJang,
    /// Face constriction to the mean of the corners [Wu01].
    Wu,
    /// Edges in the order of quadrics, with the volume conserved exactly [KJ04].
    KimJang,
    /// Progressive meshes [Hop96]: the energy of samples, at its least for every contraction.
    Pm,
    /// Simple polygon reduction [Mel98]: length times turn, onto vertices of the input.
    Spr,
}

impl Method {
    /// Every method.
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

    /// Its name on the command line and in reports.
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

    /// With which power of a length its costs grow: those of quadrics are squared distances times
    /// areas, those of swept volumes squared volumes, those of samples squared distances.
    pub fn cost_power(self) -> i32 {
        match self {
            Self::Qem | Self::QemEndpoint | Self::KimJang => 4,
            Self::LindstromTurk | Self::LindstromTurkFaces => 6,
            Self::Pm => 2,
            Self::LeeJang | Self::Wu | Self::Spr => 1,
        }
    }

    /// Whether attributes count in its costs, by [`Options::weights`]. All methods place them.
    pub fn counts_attributes(self) -> bool {
        matches!(self, Self::Qem | Self::QemEndpoint | Self::LindstromTurk)
    }

    /// Whether what boundaries move has a weight of its own in its costs, [`Options::boundary_weight`].
    pub fn weighs_boundaries(self) -> bool {
        match self {
            Self::Qem | Self::QemEndpoint | Self::KimJang => true,
            Self::LindstromTurk | Self::LindstromTurkFaces => true,
            Self::LeeJang | Self::Wu | Self::Pm | Self::Spr => false,
        }
    }

    /// Whether every contraction with a closed ring that is free to choose its place conserves the
    /// volume.
    pub fn conserves_volume(self) -> bool {
        match self {
            Self::LindstromTurk | Self::LindstromTurkFaces | Self::LeeJang | Self::KimJang => true,
            Self::Qem | Self::QemEndpoint | Self::Wu | Self::Pm | Self::Spr => false,
        }
    }

    /// The method of that name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }
}

/// How far to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// To this many faces or the next number below that contractions reach.
    Faces(usize),
    /// To this part of the input's faces, between 0 and 1.
    Ratio(f64),
    /// As far as the error stays within this, in model units: by the algorithm's own estimate, and in
    /// the fast engine by distances from the input, both ways.
    Error(f64),
}

impl Target {
    /// Itself, if it is one.
    ///
    /// # Errors
    /// A ratio outside 0 to 1, an error below 0, NaN.
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

    /// The number of faces to go to from `all`; 0 for an error, which sets none.
    pub fn faces_of(self, all: usize) -> usize {
        match self {
            Self::Faces(faces) => faces,
            // Never more than asked for, but 29 % of 100 is 29.
            Self::Ratio(ratio) => (all as f64 * ratio + 1e-6).floor() as usize,
            Self::Error(_) => 0,
        }
    }
}

/// How to simplify.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// The algorithm; `None` for [`Method::default`].
    pub method: Option<Method>,
    /// How much attributes count where the method counts them, see [`Method::counts_attributes`].
    pub weights: AttributeWeights,
    /// Keep every vertex of a boundary edge where it is.
    pub lock_boundary: bool,
    /// What it costs to move a boundary, where the method counts that, see
    /// [`Method::weighs_boundaries`]: a factor, 0 for nothing, more than 1e9 as 1e9. Of squared areas under
    /// the boundary against squared volumes in `lindstrom-turk`, of planes on boundary edges against
    /// those of faces in `qem`. `None` for the method's own, which is 9 in `lindstrom-turk`, 2 in `qem`.
    pub boundary_weight: Option<f64>,
    /// What must stay, or move together. Where vertices of a tie do not find edges to move along
    /// together, they stay.
    pub locks: Locks,
    /// A connected component whose box has a shorter diagonal than this, in model units, may vanish
    /// as a whole, where nothing of it can be spared for less; not one with a vertex that a lock or a
    /// tie holds, and not the last. Its size then counts as an error. `None`: none ever vanishes.
    pub vanish_below: Option<f64>,
}

impl Options {
    /// Refuses weights that are none.
    pub(crate) fn validate(&self) -> Result<(), SimplifyError> {
        self.weights.validate()?;
        match self.boundary_weight.filter(|weight| !weight.is_finite() || *weight < 0.0) {
            Some(weight) => Err(SimplifyError::BadWeight(weight)),
            None => Ok(()),
        }
    }
}

/// How much an error in an attribute counts against an error in distance; 0 not at all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttributeWeights {
    /// A normal that is off by one counts like this part of the diagonal.
    pub normal: f64,
    /// A texture that slides by a length counts like this part of that length.
    pub uv: f64,
    /// A colour that is off by one counts like this part of the diagonal.
    pub color: f64,
}

impl Default for AttributeWeights {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl AttributeWeights {
    /// Those of [`Default`], where a constant is wanted.
    pub const DEFAULT: Self = Self { normal: 0.005, uv: 0.5, color: 0.005 };

    /// Attributes count for nothing: quadrics are those of the geometry alone.
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

/// Why a mesh cannot be simplified at all.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SimplifyError {
    /// It breaks a rule of [`meshlod_mesh::Mesh::validate`].
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// It has no faces.
    #[error("the mesh has no faces")]
    NoFaces,
    /// None of its faces has three different vertices.
    #[error("none of the {0} faces has three different vertices")]
    AllDegenerate(usize),
    /// It is too small or too large to compute with.
    #[error("the mesh is {diagonal:e} from corner to corner; scale it to between 1e-30 and 1e30")]
    Extent {
        /// Of its box.
        diagonal: f64,
    },
    /// The locks are for another mesh.
    #[error("the locks are of {found} vertices, the mesh has {expected}")]
    BadMask {
        /// Its length.
        found: usize,
        /// The number of vertices.
        expected: usize,
    },
    /// A tie names a vertex that is not there.
    #[error("tie {tie} names vertex {vertex} of {count}")]
    BadTie {
        /// The tie.
        tie: usize,
        /// What it names.
        vertex: VertexId,
        /// The number of vertices.
        count: usize,
    },
    /// A vertex is tied and tied again.
    #[error("tie {tie} names vertex {vertex}, which has been tied before")]
    TiedTwice {
        /// The second tie, or the one that names it twice.
        tie: usize,
        /// The vertex.
        vertex: VertexId,
    },
    /// What a tie holds together is apart.
    #[error("tie {tie} is torn: vertices {} and {} are at two places", vertices[0], vertices[1])]
    TornTie {
        /// The tie.
        tie: usize,
        /// Two of its vertices.
        vertices: [VertexId; 2],
    },
    /// A weight that is no weight.
    #[error("{0} is not a weight: give a number of at least 0")]
    BadWeight(f64),
    /// A size below which components may vanish that is no size.
    #[error("{0} is not a size: give a length of at least 0")]
    BadSize(f64),
    /// A target that is no target.
    #[error("{0} is not a target: give a ratio between 0 and 1 or an error of at least 0")]
    BadTarget(f64),
}

/// What a run did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// The algorithm, also where none was named.
    pub method: Method,
    /// Faces of the input, all of them.
    pub input_faces: usize,
    /// Faces of the input left out because they repeat a vertex.
    pub degenerate_faces: usize,
    /// Faces of the input left out because they repeat another face.
    pub duplicate_faces: usize,
    /// Vertices of the input that are kept in place because the surface is not manifold there.
    pub non_manifold_vertices: usize,
    /// Vertices of the input that locks hold.
    pub held: Held,
    /// Faces that are left.
    pub output_faces: usize,
    /// Components that have vanished.
    pub vanished: usize,
    /// Whether the target was reached.
    pub reached: bool,
    /// The greatest distance that the algorithm estimates for any contraction, in model units: an
    /// estimate of the maximum that `measure` finds, not a bound of it. A component that has
    /// vanished counts with its size; how far it was from what is left is not looked at.
    pub error_estimate: f64,
    /// Why candidates were refused, and how often.
    pub refusals: Refusals,
    /// What became of the volume.
    pub volume: VolumeLoss,
}
