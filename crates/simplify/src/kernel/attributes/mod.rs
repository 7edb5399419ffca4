//! Attributes in the kernel: the traits [`AttributeStore`] for a surface and [`AttributeModel`] for a
//! part of it, their implementation by quadrics at the wedges, and
//! [`NoAttributes`](bare::NoAttributes), which compiles to nothing.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `bare`, `attributed` | the two implementations: start with `attributed` |
//! | `layers`, `attribute_quadric`, `wedge_quadrics` | costed layers as channels, and a quadric at each wedge |
//! | `wedge_store`, `slots` | the quadrics of all wedges, cut into parts |
//! | `corners`, `import_export` | from the corners of the input to slots, and back |
//! | `scratch`, `face_wedges`, `seam_sectors`, `wedge_pairs` | the slots around an edge, and which become one |
//! | `new_values`, `update_smooth`, `update_at_seams` | a contraction: new values, then new quadrics |
//! | `seam_costs` | what seams cost |
//! | `uv_flips` | faces that would flip in texture space |
//! | `uncosted_layers`, `uncosted_values` | layers outside the metric |

pub(crate) mod attribute_quadric;
pub(crate) mod attributed;
pub(crate) mod bare;
pub(crate) mod corners;
pub(crate) mod face_wedges;
pub(crate) mod import_export;
pub(crate) mod layers;
pub(crate) mod new_values;
pub(crate) mod scratch;
pub(crate) mod seam_costs;
pub(crate) mod seam_sectors;
pub(crate) mod slots;
pub(crate) mod uncosted_layers;
pub(crate) mod uncosted_values;
pub(crate) mod update_at_seams;
pub(crate) mod update_smooth;
pub(crate) mod uv_flips;
pub(crate) mod wedge_pairs;
pub(crate) mod wedge_quadrics;
pub(crate) mod wedge_store;

use std::ops::Range;

use meshlod_mesh::{Attributes, WedgeId};

use crate::kernel::collapse::edge_ring::EdgeRing;
use crate::kernel::collapse::{Collapse, Ends};
use crate::kernel::handles::PER_CUT;
use crate::kernel::mesh::one_ring::Vertices;
use crate::kernel::mesh::vertex::VertexQuadric;
use crate::kernel::metric::Metric;
use crate::kernel::metric::edge_quadric::{Costs, EdgeQuadrics, EdgeSide};
use crate::kernel::metric::edge_quadric_f64::EdgeQuadricF64;
use crate::kernel::simd::LANES;
use crate::refusal::Refusal;

/// Attributes of a whole surface.
pub(crate) trait AttributeStore: Send + Sync {
    /// Error metric of the geometry.
    type Metric: Metric;

    /// Attributes of a part of the surface.
    type Part<'p>: AttributeModel<Metric = Self::Metric>
    where
        Self: 'p;

    /// Cuts the attributes anew, by ranges of the vertices in order. What is beyond the last range
    /// is in no part.
    fn cut(&mut self, parts: &[Range<usize>]);

    /// Borrows the `count` parts.
    fn parts(&mut self, count: usize) -> Vec<Self::Part<'_>>;

    /// Returns the current attributes of these faces, given by their indices and their corners in
    /// the kernel's vertices.
    fn attributes(&self, faces: impl Iterator<Item = (u32, [u32; 3])>) -> Option<Attributes>;

    /// Returns the current attributes of all faces, dead ones included, with every wedge at its
    /// index.
    fn all_attributes(&self, faces: impl Iterator<Item = [u32; 3]>) -> Option<Attributes>;
}

/// Attribute model of a part of a surface, as needed for costs and contractions. Of the attributes
/// of other parts it knows nothing.
pub(crate) trait AttributeModel: Sized + Send + Sync {
    /// Error metric of the geometry.
    type Metric: Metric;

    /// Adds to the quadrics of eight edges the attribute error that remains with the best values.
    fn add_attribute_quadrics(&self, sides: [EdgeSide<u32>; 2], edges: &mut EdgeQuadrics);

    /// Returns the costs of eight edges if any of their vertices is on a seam. Edges without such
    /// an end are costed as if both ends were free.
    fn seam_costs(
        &self,
        vertices: &Vertices,
        us: EdgeSide<u32>,
        vs: &[u32; LANES],
    ) -> Option<Costs>;

    /// Decides which end of an edge is contracted into which.
    fn orient(&self, vertices: &Vertices, v: u32, target: u32) -> Result<Ends, Refusal>;

    /// Makes seams hold from now on. Returns true if they gave way before.
    fn hold_seams(&mut self) -> bool {
        false
    }

    /// Adds the attributes to the quadric of an edge with free ends.
    fn with_attributes(&self, ends: &Ends, geometry: EdgeQuadricF64) -> EdgeQuadricF64;

    /// Returns the attribute cost of contracting `v1` onto `v0`.
    fn cost_onto(&self, vertices: &Vertices, ends: &Ends) -> f32;

    /// Computes the attributes after a contraction without applying it. Returns whether it flips a
    /// face in uv.
    fn preview(&mut self, vertices: &Vertices, edge_ring: &EdgeRing, collapse: &Collapse) -> bool;

    /// Applies the last preview, before the vertices themselves change. Returns what the quadric of
    /// the new vertex has in addition to its faces.
    fn apply(
        &mut self,
        vertices: &mut Vertices,
        edge_ring: &EdgeRing,
        collapse: &Collapse,
    ) -> VertexQuadric;

    /// Values that [parting](Self::part) replaces.
    type Whole;

    /// Gives the copies of vertices that a cut parts wedges of their own, and renews the quadrics
    /// of both, whose rings are those after the cut. None of them or of their neighbours is on a
    /// seam.
    fn part(&mut self, vertices: &Vertices, copies: [[u32; 2]; PER_CUT]) -> Self::Whole;

    /// Takes back that vertices were parted.
    fn rejoin(&mut self, vertices: [u32; PER_CUT], whole: Self::Whole);

    /// Reads what will soon be needed of a vertex.
    fn prefetch(&self, v: u32) -> u32;

    /// Records the values that a contraction has given to a vertex.
    fn record(&mut self, vertex: u32);

    /// Counts a logged step that gives no vertex new values.
    fn skip_record(&mut self);

    /// Takes the recorded values.
    fn recorded(&mut self) -> Vec<RecordedValues>;
}

/// Attribute values that a contraction gave to a wedge, recorded for observers.
#[derive(Clone, Debug)]
pub(crate) struct RecordedValues {
    /// Index of the contraction in the log.
    pub(crate) number: usize,
    pub(crate) wedge: WedgeId,
    /// Values in all attribute layers, one after the other.
    pub(crate) values: Vec<f32>,
}
