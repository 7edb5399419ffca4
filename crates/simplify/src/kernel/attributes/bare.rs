//! [`AttributeModel`] for a surface without attributes. It compiles to nothing.

use std::ops::Range;

use meshlod_mesh::Attributes;

use crate::kernel::attributes::{AttributeModel, AttributeStore, RecordedValues};
use crate::kernel::collapse::edge_ring::EdgeRing;
use crate::kernel::collapse::{Collapse, Ends, Mobility};
use crate::kernel::handles::PER_CUT;
use crate::kernel::mesh::one_ring::Vertices;
use crate::kernel::mesh::vertex::VertexQuadric;
use crate::kernel::metric::Metric;
use crate::kernel::metric::edge_quadric::{Costs, EdgeQuadrics, EdgeSide};
use crate::kernel::metric::edge_quadric_f64::EdgeQuadricF64;
use crate::kernel::simd::LANES;
use crate::refusal::Refusal;

/// Attribute model of a surface without attributes: the geometric metric alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NoAttributes<M>(pub(crate) M);

impl<M: Metric> AttributeModel for NoAttributes<M> {
    type Metric = M;

    #[inline(always)]
    fn add_attribute_quadrics(&self, _: [EdgeSide<u32>; 2], _: &mut EdgeQuadrics) {}

    #[inline(always)]
    fn seam_costs(&self, _: &Vertices, _: EdgeSide<u32>, _: &[u32; LANES]) -> Option<Costs> {
        None
    }

    #[inline(always)]
    fn orient(&self, vertices: &Vertices, v: u32, target: u32) -> Result<Ends, Refusal> {
        by_pins(vertices, v, target)
    }

    #[inline(always)]
    fn with_attributes(&self, _: &Ends, geometry: EdgeQuadricF64) -> EdgeQuadricF64 {
        geometry
    }

    #[inline(always)]
    fn cost_onto(&self, _: &Vertices, _: &Ends) -> f32 {
        0.0
    }

    #[inline(always)]
    fn preview(&mut self, _: &Vertices, _: &EdgeRing, _: &Collapse) -> bool {
        false
    }

    #[inline(always)]
    fn apply(&mut self, _: &mut Vertices, _: &EdgeRing, _: &Collapse) -> VertexQuadric {
        VertexQuadric::default()
    }

    type Whole = ();

    fn part(&mut self, _: &Vertices, _: [[u32; 2]; PER_CUT]) {}

    fn rejoin(&mut self, _: [u32; PER_CUT], (): ()) {}

    #[inline(always)]
    fn prefetch(&self, _: u32) -> u32 {
        0
    }

    #[inline(always)]
    fn record(&mut self, _: u32) {}

    fn skip_record(&mut self) {}

    fn recorded(&mut self) -> Vec<RecordedValues> {
        Vec::new()
    }
}

impl<M: Metric> AttributeStore for NoAttributes<M> {
    type Metric = M;
    type Part<'p>
        = Self
    where
        Self: 'p;

    fn cut(&mut self, _: &[Range<usize>]) {}

    fn parts(&mut self, count: usize) -> Vec<Self> {
        vec![*self; count]
    }

    fn attributes(&self, _: impl Iterator<Item = (u32, [u32; 3])>) -> Option<Attributes> {
        None
    }

    fn all_attributes(&self, _: impl Iterator<Item = [u32; 3]>) -> Option<Attributes> {
        None
    }
}

/// Decides which end of an edge is contracted into the other by pins and ties alone. A tied end
/// stays in place if the other end is not tied.
#[inline(always)]
pub(crate) fn by_pins(vertices: &Vertices, v: u32, target: u32) -> Result<Ends, Refusal> {
    let [first, second] = [v, target].map(|v| vertices.get(v).flags);
    match (first.stays_beside(second), second.stays_beside(first)) {
        (false, false) => Ok(Ends::free(v, target)),
        (true, false) => Ok(Ends { mobility: Mobility::Fixed, ..Ends::free(v, target) }),
        (false, true) => Ok(Ends { mobility: Mobility::Fixed, ..Ends::free(target, v) }),
        (true, true) => Err(Refusal::Locked),
    }
}
