//! What the engine asks of attributes; [`NoAttributes`] where there are none, and nothing is left of it in the
//! code.

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
pub(crate) mod uncosted_layers;
pub(crate) mod update_at_seams;
pub(crate) mod update_smooth;
pub(crate) mod uv_flips;
pub(crate) mod wedge_pairs;
pub(crate) mod wedge_quadrics;

use crate::kernel::collapse::edge_ring::EdgeRing;
use crate::kernel::collapse::{Collapse, Ends};
use crate::kernel::mesh::one_ring::Vertices;
use crate::kernel::mesh::vertex::VertexQuadric;
use crate::kernel::metric::Metric;
use crate::kernel::metric::edge_quadric::{Costs, EdgeQuadrics, EdgeSide};
use crate::kernel::metric::edge_quadric_f64::EdgeQuadricF64;
use crate::kernel::simd::LANES;
use crate::refusal::Refusal;
use meshlod_mesh::{Attributes, WedgeId};

/// Attributes, as costs and contractions have to do with them.
pub(crate) trait AttributeModel: Sized + Send + Sync {
    /// What the surface itself costs.
    type Metric: Metric;

    /// Whether the surface may be worked on in parts.
    const IN_PARTS: bool;

    /// What each of so many parts looks like.
    fn for_parts(self, parts: usize) -> Vec<Self>;

    /// Adds to the squares of edges what attributes leave of them where they are best.
    fn add_attribute_quadrics(&self, sides: [EdgeSide<u32>; 2], edges: &mut EdgeQuadrics);

    /// What eight edges cost if any of their vertices is on a seam. Of those without such an end,
    /// what they cost if both may go anywhere.
    fn seam_costs(
        &self,
        vertices: &Vertices,
        us: EdgeSide<u32>,
        vs: &[u32; LANES],
    ) -> Option<Costs>;

    /// Which end of an edge goes into which.
    fn orient(&self, vertices: &Vertices, v: u32, target: u32) -> Result<Ends, Refusal>;

    /// The squares of an edge with free ends, by those of the geometry.
    fn with_attributes(&self, ends: &Ends, geometry: EdgeQuadricF64) -> EdgeQuadricF64;

    /// What attributes cost where `v1` goes to the place of `v0`.
    fn cost_onto(&self, vertices: &Vertices, ends: &Ends) -> f32;

    /// Finds what a contraction that may be otherwise makes of attributes; whether it turns a face over
    /// in its texture.
    fn preview(&mut self, vertices: &Vertices, edge_ring: &EdgeRing, collapse: &Collapse) -> bool;

    /// Carries out what was last looked ahead to, before the vertices themselves change; gives what the
    /// star of the new vertex has beside its faces.
    fn apply(
        &mut self,
        vertices: &mut Vertices,
        edge_ring: &EdgeRing,
        collapse: &Collapse,
    ) -> VertexQuadric;

    /// Reads what is wanted of a vertex soon.
    fn prefetch(&self, v: u32) -> u32;

    /// What faces have by now, by their numbers and their corners as the engine was given them.
    fn attributes(&self, faces: impl Iterator<Item = (u32, [u32; 3])>) -> Option<Attributes>;

    /// The same of all faces, dead ones too, with every wedge in its place.
    fn all_attributes(&self, faces: impl Iterator<Item = [u32; 3]>) -> Option<Attributes>;

    /// Takes down the values that a contraction has given to a vertex: the next of those that are logged.
    fn record(&mut self, vertex: u32);

    /// Counts a logged step that gives no vertex new values.
    fn skip_record(&mut self);

    /// What was taken down.
    fn recorded(&mut self) -> Vec<RecordedValues>;
}

/// The values that a wedge has after a contraction, by the number of that in the log.
#[derive(Clone, Debug)]
pub(crate) struct RecordedValues {
    pub(crate) number: usize,
    pub(crate) wedge: WedgeId,
    /// In all layers, one after the other.
    pub(crate) values: Vec<f32>,
}
