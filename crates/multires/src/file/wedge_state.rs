//! Wedges of the nodes decoded so far, and their coding in the base section and in chunks.
//!
//! The values of a wedge are predicted from those of its parent, and of a second child's wedge also
//! from the first child's, as the parent mostly lies between.

use std::collections::BTreeMap;
use std::io;
use std::ops::Range;

use glam::Vec3;
use meshlod_mesh::{AttributeBounds, WedgeId};

use super::decoder_state::DecoderState;
use super::layer_coding::{LayerCoding, Leeway};
use super::streams::{Packer, Unpacker};
use super::wedge_records::{self, RecordShape};
use crate::forest::NONE;
use crate::implicit::DetachedUpdate;
use crate::wedges::{DetachedWedges, LOST, WedgeLabels, WedgeNumbers, Wedges};

/// Wedges in the file's order of nodes; in part of a file, of the nodes that are loaded.
pub(super) struct WedgeState {
    pub(super) coding: Vec<LayerCoding>,
    /// Leeway of each column.
    pub(super) leeways: Vec<Leeway>,
    /// Names and pairs, with the pairs of wedges.
    pub(super) labels: WedgeLabels,
    /// First wedge of each node, and the end of the last.
    first: Vec<u32>,
    /// True if values are coded by pairs of children, and not in the form of earlier versions.
    pub(super) in_pairs: bool,
    /// Integers of all wedges, a row for each.
    pub(super) numbers: Vec<i32>,
    /// Relations of all wedges.
    pub(super) kin: Vec<Kin>,
    /// Records of updates next to seams.
    records: BTreeMap<u32, Vec<u16>>,
    /// Wedges at the corners of the base mesh's faces.
    base: Vec<[u32; 3]>,
}

/// Reason why wedges cannot be decoded.
pub(super) enum WedgeError {
    Io(io::Error),
    Invalid(&'static str),
}

impl From<io::Error> for WedgeError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

const OUT_OF_RANGE: &str = "a wedge is out of range";

impl WedgeState {
    /// Creates the state of a file without any wedges yet.
    pub(super) fn new(coding: Vec<LayerCoding>, labels: WedgeLabels) -> Self {
        Self {
            leeways: coding.iter().flat_map(LayerCoding::leeways).collect(),
            coding,
            labels,
            first: vec![0],
            in_pairs: true,
            numbers: Vec::new(),
            kin: Vec::new(),
            records: BTreeMap::new(),
            base: Vec::new(),
        }
    }

    /// Encodes the wedges of a model, with its nodes and updates in the order of the file. Values
    /// are kept within the bounds, or exactly.
    pub(super) fn of_model(
        all: &Wedges,
        bounds: Option<&AttributeBounds>,
        nodes: &[u32],
        updates: &[u32],
        state: &DecoderState,
    ) -> Self {
        let wedges = || nodes.iter().flat_map(|&node| all.of(node));
        let layers = all.values.layers(0..all.wedge_count() as u32);
        let coding = layers.iter().map(|layer| LayerCoding::new(layer, bounds)).collect();
        let mut this = Self::new(coding, all.labels.unpacked(wedges()));
        this.first.extend(nodes.iter().scan(0, |end, &node| {
            *end += all.count(node);
            Some(*end)
        }));
        for wedge in wedges() {
            for (coding, layer) in this.coding.iter().zip(&layers) {
                coding.encode(layer.of(WedgeId(wedge)), &mut this.numbers);
            }
        }
        // Roots have the same numbers in both orders.
        this.base = all.base.clone();
        for (at, &update) in (0..).zip(updates) {
            this.records.extend(all.record(update).map(|record| (at, record)));
        }
        this.start_kin(state);
        for (at, update) in state.updates.iter().enumerate() {
            this.link(&this.lineage(update.parent, at as u32, state.root_count()), state, at);
        }
        for (at, update) in state.updates.iter().enumerate().rev() {
            let lineage = this.lineage(update.parent, at as u32, state.root_count());
            this.derive_parents(&lineage);
        }
        this
    }

    /// Returns true if an update has a record.
    pub(super) fn is_recorded(&self, update: usize) -> bool {
        self.records.contains_key(&(update as u32))
    }

    pub(super) fn columns(&self) -> usize {
        self.coding.iter().map(LayerCoding::columns).sum()
    }

    fn of(&self, node: u32) -> Range<u32> {
        self.first[node as usize]..self.first[node as usize + 1]
    }

    pub(super) fn row(&self, wedge: u32) -> &[i32] {
        &self.numbers[wedge as usize * self.columns()..][..self.columns()]
    }

    /// Encodes the wedges of the roots.
    pub(super) fn write_base(&self, roots: u32, packer: &mut Packer) -> io::Result<()> {
        let counts: Vec<u32> = (0..roots).map(|root| self.of(root).len() as u32).collect();
        packer.numbers(&counts)?;
        packer.numbers(self.base.as_flattened())?;
        let wedges = 0..self.first[roots as usize];
        for column in 0..self.columns() {
            let numbers = wedges.clone().map(|wedge| self.row(wedge)[column]);
            let steps = numbers.scan(0, |last, x| Some(x.wrapping_sub(std::mem::replace(last, x))));
            packer.signed(steps)?;
        }
        if self.labels.pairs.len() > 1 {
            packer.numbers(&wedges.map(|wedge| self.labels.of(wedge)).collect::<Vec<_>>())?;
        }
        Ok(())
    }

    /// Decodes the wedges of the roots and of the base faces.
    pub(super) fn read_base(
        &mut self,
        state: &DecoderState,
        input: &mut Unpacker<'_>,
    ) -> Result<(), WedgeError> {
        let (roots, faces) = (state.root_count() as usize, state.base.faces.len());
        let wedges = self.extend_first(&input.numbers(roots)?)? as usize;
        self.base = input.numbers(3 * faces)?.as_chunks().0.to_vec();
        if self.base.iter().flatten().any(|&wedge| wedge as usize >= wedges) {
            return Err(WedgeError::Invalid(OUT_OF_RANGE));
        }
        let columns = self.columns();
        self.numbers = vec![0; wedges * columns];
        for column in 0..columns {
            let mut last = 0i32;
            for (wedge, step) in input.signed(wedges)?.into_iter().enumerate() {
                last = last.wrapping_add(step);
                self.numbers[wedge * columns + column] = last;
            }
        }
        self.start_kin(state);
        if self.labels.pairs.len() > 1 {
            self.labels.of_wedges = input.numbers(wedges)?;
            self.check_labels()?;
        }
        Ok(())
    }

    fn check_labels(&self) -> Result<(), WedgeError> {
        let is_pair = |&pair: &u32| (pair as usize) < self.labels.pairs.len();
        let are_pairs = self.labels.of_wedges.iter().all(is_pair);
        are_pairs.then_some(()).ok_or(WedgeError::Invalid("a material or object is out of range"))
    }

    /// Appends nodes with these numbers of wedges. Returns the number of all wedges.
    fn extend_first(&mut self, counts: &[u32]) -> Result<u32, WedgeError> {
        for &count in counts {
            let last = self.first[self.first.len() - 1];
            let is_count = (1..u32::from(LOST)).contains(&count);
            let end = last.checked_add(count).filter(|_| is_count);
            self.first.push(end.ok_or(WedgeError::Invalid("a vertex has no wedge, or too many"))?);
        }
        Ok(self.first[self.first.len() - 1])
    }

    /// Adds the relations of the roots' wedges: they have none.
    fn start_kin(&mut self, state: &DecoderState) {
        for root in 0..state.root_count() {
            let kin = Kin { parent: NONE, sibling: NONE, place: state.stored_position(root) };
            self.kin.extend(self.of(root).map(|_| kin));
        }
    }

    /// Adds the relations of the wedges of an update's children.
    fn link(&mut self, lineage: &[Lineage], state: &DecoderState, update: usize) {
        let [first, second] =
            children(state.root_count(), update).map(|c| state.stored_position(c));
        for of in lineage {
            let place = if of.is_second { second } else { first };
            let parent = of.parent.unwrap_or(NONE);
            self.kin.push(Kin { parent, sibling: of.sibling.unwrap_or(NONE), place });
            if let Some(sibling) = of.sibling {
                self.kin[sibling as usize].sibling = of.wedge;
            }
        }
    }

    fn record_shape(&self, roots: u32, update: usize, length: usize) -> RecordShape {
        RecordShape { length, counts: children(roots, update).map(|c| self.of(c).len() as u32) }
    }

    /// Encodes the wedges of a run of updates.
    pub(super) fn write_run(
        &self,
        updates: &[DetachedUpdate],
        run: Range<usize>,
        roots: u32,
        sizes: &[u8],
        packer: &mut Packer,
    ) -> io::Result<()> {
        let recorded = || run.clone().filter(|&at| self.is_recorded(at));
        let counts = recorded().flat_map(|at| children(roots, at).map(|node| self.of(node).len()));
        packer.numbers(&counts.map(|count| count as u32).collect::<Vec<_>>())?;
        let records = || recorded().map(|at| &self.records[&(at as u32)]);
        packer.numbers(&records().map(|record| record.len() as u32).collect::<Vec<_>>())?;
        let shape = |at: usize, length| self.record_shape(roots, at, length);
        let shapes = recorded().zip(records()).map(|(at, all)| (shape(at, all.len()), &all[..]));
        wedge_records::write(shapes, packer)?;
        let lineage: Vec<_> =
            run.flat_map(|at| self.lineage(updates[at].parent, at as u32, roots)).collect();
        if self.labels.pairs.len() > 1 {
            let lost = lineage.iter().filter(|of| of.is_lost);
            packer.numbers(&lost.map(|of| self.labels.of(of.wedge)).collect::<Vec<_>>())?;
        }
        self.write_values(&lineage, sizes, packer)
    }

    /// Decodes the wedges of the updates from `start` on, of which some have records.
    pub(super) fn read_run(
        &mut self,
        state: &DecoderState,
        start: usize,
        is_recorded: impl Fn(usize) -> bool,
        sizes: &[u8],
        input: &mut Unpacker<'_>,
    ) -> Result<(), WedgeError> {
        let (updates, roots) = (&state.updates, state.root_count());
        let recorded: Vec<usize> = (start..updates.len()).filter(|&at| is_recorded(at)).collect();
        let mut counts = input.numbers::<u32>(2 * recorded.len())?.into_iter();
        for at in start..updates.len() {
            let mut next = || if is_recorded(at) { counts.next().unwrap_or(0) } else { 1 };
            self.extend_first(&[next(), next()])?;
        }
        let lengths: Vec<u32> = input.numbers(recorded.len())?;
        let records = if self.in_pairs {
            let shapes = recorded.iter().zip(&lengths);
            let shape = |(&at, &length)| self.record_shape(roots, at, length as usize);
            wedge_records::read(shapes.map(shape), input)?
        } else {
            read_plain_records(&lengths, input)?
        };
        for (&at, record) in recorded.iter().zip(records) {
            let record = record.into_iter().map(u16::try_from).collect::<Result<Vec<u16>, _>>();
            self.records.insert(at as u32, record.map_err(|_| WedgeError::Invalid(OUT_OF_RANGE))?);
        }
        let mut lineage = Vec::new();
        for (at, update) in (0..).zip(updates).skip(start) {
            lineage.extend(self.lineage(update.parent, at, roots));
        }
        if lineage.iter().any(|of| of.parent.is_none_or(|parent| parent >= of.wedge)) {
            return Err(WedgeError::Invalid(OUT_OF_RANGE));
        }
        self.read_labels(&lineage, input)?;
        for (i, pair) in (start..).zip(by_update(&lineage)) {
            self.link(pair, state, i);
        }
        self.read_values(&lineage, sizes, input)
    }

    fn read_labels(
        &mut self,
        lineage: &[Lineage],
        input: &mut Unpacker<'_>,
    ) -> Result<(), WedgeError> {
        if self.labels.pairs.len() < 2 {
            return Ok(());
        }
        let lost = lineage.iter().filter(|of| of.is_lost).count();
        let mut lost = input.numbers::<u32>(lost)?.into_iter();
        for of in lineage {
            let inherited = of.parent.map_or(0, |parent| self.labels.of(parent));
            let label = if of.is_lost { lost.next().unwrap_or(0) } else { inherited };
            self.labels.of_wedges.push(label);
        }
        self.check_labels()
    }

    /// Returns the wedges of an update's children with those that predict them.
    fn lineage(&self, node: u32, update: u32, roots: u32) -> Vec<Lineage> {
        let record = self.records.get(&update);
        let [first, second] = children(roots, update as usize).map(|child| self.of(child));
        let start = first.start;
        let mut all: Vec<Lineage> = Vec::with_capacity(2);
        for wedge in first.clone().chain(second) {
            let local = record
                .map_or(0, |record| record.get((wedge - start) as usize).copied().unwrap_or(LOST));
            let is_lost = local == LOST;
            // A node that is not loaded has no wedges, and its children are never shown.
            let above = if node == NONE {
                Some(0)
            } else {
                self.above(node, if is_lost { 0 } else { local })
            };
            // In the form of earlier versions, lost wedges have the first one above for a parent.
            let is_same = |of: &Lineage| match self.in_pairs {
                true => of.local == local,
                false => of.parent == above,
            };
            let of_first = |of: &&Lineage| !of.is_second && is_same(of) && !is_lost;
            let sibling = all.iter().find(of_first);
            let sibling = sibling.map(|of| of.wedge).filter(|_| wedge >= first.end);
            let is_second = wedge >= first.end;
            all.push(Lineage {
                wedge,
                local,
                update,
                parent: above,
                is_lost,
                is_second,
                sibling,
                partner: None,
            });
        }
        mark_pairs(&mut all);
        all
    }

    fn above(&self, node: u32, local: u16) -> Option<u32> {
        let above = self.of(node);
        Some(above.start + u32::from(local)).filter(|wedge| above.contains(wedge))
    }

    /// Takes the wedges out, once all values are known to be finite.
    pub(super) fn into_detached(self) -> Result<DetachedWedges, &'static str> {
        let columns = self.columns();
        let mut values = Vec::new();
        for row in self.numbers.chunks_exact(columns.max(1)) {
            let mut start = 0;
            values.clear();
            for coding in &self.coding {
                let end = start + coding.columns();
                let decoded = coding.decode(&row[start..end], &mut values);
                decoded.ok_or("an attribute is not finite")?;
                start = end;
            }
        }
        let Self { first, records, base, labels, coding, numbers, .. } = self;
        let values = WedgeNumbers { coding, numbers };
        Ok(DetachedWedges { first, records, base, values, labels })
    }
}

/// A wedge of a child, and those from which its values are predicted.
pub(super) struct Lineage {
    pub(super) wedge: u32,
    pub(super) update: u32,
    /// Number of the parent among the wedges of the split node, or [`LOST`].
    local: u16,
    /// `None` if it is out of range.
    pub(super) parent: Option<u32>,
    is_lost: bool,
    /// True for a wedge of the second child.
    pub(super) is_second: bool,
    /// Wedge of the first child that has the same parent, for one of the second child.
    pub(super) sibling: Option<u32>,
    /// The other of two wedges, one of each child, that their parent's values are coded with: the
    /// first of either child that have this parent.
    pub(super) partner: Option<u32>,
}

/// Relations of a wedge, and its place.
#[derive(Clone, Copy)]
pub(super) struct Kin {
    pub(super) parent: u32,
    /// Wedge of the other child that has the same parent, or [`NONE`].
    pub(super) sibling: u32,
    pub(super) place: Vec3,
}

/// Marks for each parent of an update the first wedge of either child that it has.
fn mark_pairs(all: &mut [Lineage]) {
    for at in 0..all.len() {
        let Some(sibling) = all[at].sibling else { continue };
        // Wedges of an update are numbered one after the other.
        let first = (sibling - all[0].wedge) as usize;
        if all[first].partner.is_none() {
            all[first].partner = Some(all[at].wedge);
            all[at].partner = Some(sibling);
        }
    }
}

/// Decodes records in the form of earlier versions.
fn read_plain_records(lengths: &[u32], input: &mut Unpacker<'_>) -> io::Result<Vec<Vec<i32>>> {
    let length = lengths.iter().fold(0usize, |sum, &length| sum.saturating_add(length as usize));
    let mut numbers = input.numbers::<u32>(length)?.into_iter();
    let record = |&length: &u32| {
        let record = numbers.by_ref().take(length as usize);
        record.map(u32::cast_signed).collect()
    };
    Ok(lengths.iter().map(record).collect())
}

/// Groups the wedges of a run by update.
fn by_update(lineage: &[Lineage]) -> impl Iterator<Item = &[Lineage]> {
    lineage.chunk_by(|a, b| !a.is_second || b.is_second)
}

/// Returns the two nodes that an update creates.
fn children(roots: u32, update: usize) -> [u32; 2] {
    let first = roots + 2 * update as u32;
    [first, first + 1]
}
