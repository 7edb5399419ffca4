//! Room to work in for one contraction, made once.

use crate::kernel::attributes::attribute_quadric::AttributeQuadric;
use crate::kernel::attributes::face_wedges::FaceWedges;
use crate::kernel::collapse::edge_ring::ROOM;

/// Values at corners of spokes, a channel of all in one row, and the lanes beyond their end.
type Rows<const K: usize> = [[f32; ROOM]; K];

/// Room for a contraction.
pub(crate) struct Scratch<const K: usize> {
    /// At `ids[i]` of spoke i.
    pub(crate) first: Rows<K>,
    /// Where there are seams, at `ids[i + 1]` of spoke i, at its apex before and after.
    pub(crate) second: Rows<K>,
    pub(crate) before: Rows<K>,
    pub(crate) after: Rows<K>,
    /// What the field of each spoke becomes, less what it was.
    pub(crate) changes: [AttributeQuadric<K>; ROOM],
    /// What it becomes, where there are seams.
    pub(crate) new: [AttributeQuadric<K>; ROOM],
    /// Where there are none: the new vertex's values.
    pub(crate) values: [f32; K],
    /// Where there are seams: the slots that have new values, and which is where.
    pub(crate) renewed: Vec<NewValues<K>>,
    pub(crate) slots: FaceWedges,
    /// What slots take over that no channel holds.
    pub(crate) uncosted: Vec<f32>,
}

impl<const K: usize> Scratch<K> {
    pub(crate) fn new() -> Box<Self> {
        let (rows, quadrics) = ([[0.0; ROOM]; K], [AttributeQuadric::EMPTY; ROOM]);
        let (first, second, before, after) = (rows, rows, rows, rows);
        let (values, renewed, slots) = ([0.0; K], Vec::new(), FaceWedges::default());
        Box::new(Self {
            first,
            second,
            before,
            after,
            changes: quadrics,
            new: quadrics,
            values,
            renewed,
            slots,
            uncosted: Vec::new(),
        })
    }
}

/// A slot and its new values.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NewValues<const K: usize> {
    pub(crate) slot: u32,
    pub(crate) values: [f32; K],
    /// The slot whose chart it has from now on.
    pub(crate) leader: u32,
    /// What it counts for the place in the textures that its chart has from now on.
    pub(crate) weight: f32,
}
