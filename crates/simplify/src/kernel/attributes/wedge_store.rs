//! The attributes of a whole surface, and its parts.

use std::marker::PhantomData;
use std::ops::Range;

use crate::kernel::attributes::attribute_quadric::AttributeQuadric;
use crate::kernel::attributes::corners::Corners;
use crate::kernel::attributes::layers::AttributeLayers;
use crate::kernel::attributes::scratch::Scratch;
use crate::kernel::attributes::seam_sectors::{NO_LIST, SeamSectors, Sector};
use crate::kernel::attributes::slots::{SlotRanges, Slots};
use crate::kernel::attributes::uncosted_values::CarriedLayers;
use crate::kernel::attributes::wedge_quadrics::{Record, WedgeQuadrics};
use crate::kernel::mesh::vertex::NO_VERTEX;
use crate::kernel::metric::Metric;

/// Quadrics and values of all wedges of a surface, by slot. [`WedgeQuadrics`] says what they are.
pub(crate) struct WedgeStore<'m, M, const K: usize> {
    metric: PhantomData<M>,
    pub(crate) quadrics: Vec<AttributeQuadric<K>>,
    pub(crate) merged_into: Vec<u32>,
    charts: Vec<u32>,
    /// Values of the uncosted layers by slot.
    carried: Vec<Vec<f32>>,
    /// Index of each vertex's list of sectors in its part; empty in a mesh without seams.
    list_of_vertex: Vec<u32>,
    pub(crate) layers: AttributeLayers<'m>,
    pub(crate) corners: Corners<'m>,
    /// The parts of the surface in order, and what is in no part.
    parts: Vec<AttributePart<K>>,
}

/// Attributes of a part of a surface beside the values by slot.
struct AttributePart<const K: usize> {
    slots: SlotRanges,
    lists: Vec<Vec<Sector>>,
    seams_hold: bool,
    /// Working memory, allocated once, since simplification may go on step by step.
    scratch: Box<Scratch<K>>,
    record: Record,
}

impl<'m, M: Metric, const K: usize> WedgeStore<'m, M, K> {
    /// Returns wedges that have their values, but no quadrics and no seams yet.
    pub(crate) fn without_faces(layers: AttributeLayers<'m>, corners: Corners<'m>) -> Self {
        let wedges: Vec<u32> = corners.wedges().map(|wedge| corners.source(wedge)).collect();
        let values = |&wedge: &u32| match wedge {
            NO_VERTEX => AttributeQuadric::EMPTY,
            wedge => AttributeQuadric::of_values(layers.channels_of(wedge)),
        };
        let quadrics: Vec<AttributeQuadric<K>> = wedges.iter().map(values).collect();
        let with_seams = if corners.others.is_empty() { 0 } else { corners.vertices() };
        let mut store = Self {
            metric: PhantomData,
            merged_into: vec![NO_VERTEX; quadrics.len()],
            quadrics,
            charts: corners.charts(layers.textures().as_deref()),
            carried: layers.uncosted_values(&wedges),
            list_of_vertex: vec![NO_LIST; with_seams],
            layers,
            corners,
            parts: Vec::new(),
        };
        let all = 0..store.corners.vertices();
        store.cut_into(&[all]);
        store
    }

    /// Sets whether no seam gives way.
    pub(crate) fn hold_seams(&mut self, seams_hold: bool) {
        self.parts.iter_mut().for_each(|part| part.seams_hold = seams_hold);
    }

    /// Cuts the wedges by ranges of their vertices.
    pub(crate) fn cut_into(&mut self, ranges: &[Range<usize>]) {
        let end = ranges.last().map_or(0, |last| last.end);
        let beyond = end..self.corners.vertices();
        let seams_hold = self.parts.iter().all(|part| part.seams_hold);
        let mut before = std::mem::take(&mut self.parts);
        let mut old = before.iter_mut().peekable();
        for range in ranges.iter().cloned().chain((!beyond.is_empty()).then_some(beyond)) {
            let mut lists = Vec::new();
            if !self.list_of_vertex.is_empty() {
                for v in range.clone() {
                    while old.next_if(|part| part.slots.vertices.end <= v).is_some() {}
                    let list = &mut self.list_of_vertex[v];
                    if *list != NO_LIST
                        && let Some(part) = old.peek_mut()
                    {
                        lists.push(std::mem::take(&mut part.lists[*list as usize]));
                        *list = lists.len() as u32 - 1;
                    }
                }
            }
            let (slots, record) = (self.corners.slots_of(range), Record::default());
            let scratch = Scratch::new();
            self.parts.push(AttributePart { slots, lists, seams_hold, scratch, record });
        }
    }

    /// Borrows the first `count` parts.
    pub(crate) fn in_parts(&mut self, count: usize) -> Vec<WedgeQuadrics<'_, M, K>> {
        let (vertices, none) = (self.corners.vertices(), AttributeQuadric::EMPTY);
        let Self { quadrics, merged_into, charts, carried, .. } = self;
        let Self { list_of_vertex, layers, corners, parts, .. } = self;
        let ranges: Vec<SlotRanges> = parts.iter().map(|part| part.slots.clone()).collect();
        let no_others = |of: &SlotRanges| SlotRanges { others: 0..0, ..of.clone() };
        let of_vertices: Vec<SlotRanges> = ranges.iter().map(no_others).collect();
        let one = (vertices, 1);
        let all = parts.iter_mut().take(count);
        let all = all.zip(Slots::cut(quadrics, one, &ranges));
        let all = all.zip(Slots::cut(merged_into, one, &ranges));
        let all = all.zip(Slots::cut(charts, one, &ranges));
        let all = all.zip(Slots::cut(list_of_vertex, one, &of_vertices));
        let all = all.zip(CarriedLayers::cut(&layers.uncosted, carried, vertices, &ranges));
        let mut borrowed = Vec::with_capacity(count);
        for (((((part, quadrics), merged_into), charts), of_vertex), carried) in all {
            let AttributePart { lists, seams_hold, scratch, record, .. } = part;
            borrowed.push(WedgeQuadrics {
                metric: PhantomData,
                quadrics,
                merged_into,
                seams: SeamSectors { of_vertex, lists },
                seams_hold,
                charts,
                layers,
                carried,
                corners,
                scratch,
                record,
                none,
            });
        }
        borrowed
    }

    /// Borrows the whole surface, which must be in one part.
    pub(crate) fn whole(&mut self) -> WedgeQuadrics<'_, M, K> {
        self.in_parts(1).remove(0)
    }

    /// Returns the value of an uncosted layer, by its number, at a slot.
    pub(crate) fn uncosted(&self, number: usize, slot: u32) -> &[f32] {
        let width = self.layers.uncosted[number].width;
        &self.carried[number][slot as usize * width..][..width]
    }
}
