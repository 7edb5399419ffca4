//! Wedges of the nodes decoded so far, and their coding in the base section and in chunks.

use std::collections::BTreeMap;
use std::io;
use std::ops::Range;

use meshlod_mesh::{AttributeBounds, LayerKind, WedgeId};

use super::coded_values::{CodedValues, select_rows};
use super::decoder_state::DecoderState;
use super::layer_coding::LayerCoding;
use super::lineage::{Lineage, Role, relate};
use super::range_coder::{Decoder, Encoder};
use super::residual_models::ResidualModels;
use super::streams::{Packer, Unpacker};
use super::wedge_records::{self, RecordShape};
use super::wedge_values;
use crate::forest::NONE;
use crate::implicit::{DetachedUpdate, Implicit};
use crate::wedges::{DetachedWedges, LOST, WedgeLabels, Wedges};

/// Wedges in the file's order of nodes; in part of a file, of the nodes that are loaded.
pub(super) struct WedgeState {
    pub(super) coding: Vec<LayerCoding>,
    /// Names and pairs, with the pairs of wedges.
    pub(super) labels: WedgeLabels,
    /// First wedge of each node, and the end of the last.
    first: Vec<u32>,
    /// Rows of the file, one for each wedge: residuals, or values of the roots' wedges.
    pub(super) rows: Vec<i32>,
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
            coding,
            labels,
            first: vec![0],
            rows: Vec::new(),
            records: BTreeMap::new(),
            base: Vec::new(),
        }
    }

    /// Takes the wedges of a model, for nodes and updates in the order of the file. Values are kept
    /// within the bounds, or exactly.
    pub(super) fn of_model(
        (mt, all): (&Implicit, &Wedges),
        bounds: Option<&AttributeBounds>,
        nodes: &[u32],
        updates: &[u32],
    ) -> Self {
        let wedges = || nodes.iter().flat_map(|&node| all.of(node));
        let layers = all.values.layers(0..all.wedge_count() as u32);
        let coding = layers.iter().map(|layer| LayerCoding::new(layer, bounds)).collect();
        let mut this = Self::new(coding, all.labels.unpacked(wedges()));
        this.first.extend(nodes.iter().scan(0, |end, &node| {
            *end += all.count(node);
            Some(*end)
        }));
        let mut values = Vec::new();
        for wedge in 0..all.wedge_count() as u32 {
            for (coding, layer) in this.coding.iter().zip(&layers) {
                coding.encode(layer.of(WedgeId(wedge)), &mut values);
            }
        }
        let rows = wedge_values::residuals(mt, all, &this.coding, values);
        this.rows = select_rows(&rows, this.columns(), wedges());
        // Roots have the same numbers in both orders.
        this.base = all.base.clone();
        for (at, &update) in (0..).zip(updates) {
            this.records.extend(all.record(update).map(|record| (at, record)));
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

    fn row(&self, wedge: u32) -> &[i32] {
        &self.rows[wedge as usize * self.columns()..][..self.columns()]
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
        self.rows = vec![0; wedges * columns];
        for column in 0..columns {
            let mut last = 0i32;
            for (wedge, step) in input.signed(wedges)?.into_iter().enumerate() {
                last = last.wrapping_add(step);
                self.rows[wedge * columns + column] = last;
            }
        }
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

    /// Returns the length of an update's record without lists of wedges.
    fn least_length(&self, update: &DetachedUpdate, roots: u32, at: usize) -> u32 {
        let wedges: usize = children(roots, at).map(|child| self.of(child).len()).iter().sum();
        (wedges + update.created_face_count()) as u32
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
        let more = |(at, record): (usize, &Vec<u16>)| {
            record.len() as u32 - self.least_length(&updates[at], roots, at)
        };
        packer.numbers(&recorded().zip(records()).map(more).collect::<Vec<_>>())?;
        let shape = |at: usize, length| self.record_shape(roots, at, length);
        let shapes = recorded().zip(records()).map(|(at, all)| (shape(at, all.len()), &all[..]));
        wedge_records::write(shapes, packer)?;
        let mut lineage = Vec::new();
        let mut values = Vec::new();
        for (at, &size) in run.zip(sizes) {
            let start = lineage.len();
            self.relate(updates[at].parent, at as u32, roots, &mut lineage);
            values.extend(in_coding_order(&lineage[start..]).map(|of| (of, size)));
        }
        if self.labels.pairs.len() > 1 {
            let lost = lineage.iter().filter(|of| of.is_lost());
            packer.numbers(&lost.map(|of| self.labels.of(of.wedge)).collect::<Vec<_>>())?;
        }
        let (mut models, mut encoder) = (self.models(), Encoder::new());
        for ((wedge, role), size) in &values {
            models.code(&mut encoder, *role, *size, &mut self.row(*wedge).to_vec());
        }
        packer.encoded(lineage.len() * self.columns(), &encoder.finish())
    }

    /// Decodes the wedges of the updates from `start` on; some of them have records.
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
        let mut lengths: Vec<u32> = input.numbers(recorded.len())?;
        for (length, &at) in lengths.iter_mut().zip(&recorded) {
            *length = length.saturating_add(self.least_length(&updates[at], roots, at));
        }
        let shapes = recorded.iter().zip(&lengths);
        let shape = |(&at, &length)| self.record_shape(roots, at, length as usize);
        let records = wedge_records::read(shapes.map(shape), input)?;
        for (&at, record) in recorded.iter().zip(records) {
            let record = record.into_iter().map(u16::try_from).collect::<Result<Vec<u16>, _>>();
            self.records.insert(at as u32, record.map_err(|_| WedgeError::Invalid(OUT_OF_RANGE))?);
        }
        let (mut lineage, mut values) = (Vec::new(), Vec::new());
        for ((at, update), &size) in (0..).zip(updates).skip(start).zip(sizes) {
            let start = lineage.len();
            self.relate(update.parent, at, roots, &mut lineage);
            values.extend(in_coding_order(&lineage[start..]).map(|of| (of, size)));
        }
        if lineage.iter().any(|of| of.parent.is_none_or(|parent| parent >= of.wedge)) {
            return Err(WedgeError::Invalid(OUT_OF_RANGE));
        }
        self.read_labels(&lineage, input)?;
        let columns = self.columns();
        let bytes = input.encoded(lineage.len() * columns)?;
        let (mut models, mut decoder) = (self.models(), Decoder::new(&bytes));
        self.rows.resize(self.rows.len() + lineage.len() * columns, 0);
        for ((wedge, role), size) in values {
            let row = &mut self.rows[wedge as usize * columns..][..columns];
            models.code(&mut decoder, role, size, row);
        }
        let is_all = decoder.is_at_end();
        is_all.then_some(()).ok_or(WedgeError::Invalid("it has more attribute values than wedges"))
    }

    fn read_labels(
        &mut self,
        lineage: &[Lineage],
        input: &mut Unpacker<'_>,
    ) -> Result<(), WedgeError> {
        if self.labels.pairs.len() < 2 {
            return Ok(());
        }
        let lost = lineage.iter().filter(|of| of.is_lost()).count();
        let mut lost = input.numbers::<u32>(lost)?.into_iter();
        for of in lineage {
            let inherited = of.parent.map_or(0, |parent| self.labels.of(parent));
            let label = if of.is_lost() { lost.next().unwrap_or(0) } else { inherited };
            self.labels.of_wedges.push(label);
        }
        self.check_labels()
    }

    /// Returns the models of all columns. The columns of a layer have equal models, except in
    /// tangents.
    fn models(&self) -> ResidualModels {
        let mut next = 0;
        let columns = self.coding.iter().flat_map(|layer| {
            let start = next;
            let own = layer.kind == LayerKind::Tangent;
            next += if own { layer.columns() } else { 1 };
            (0..layer.columns()).map(move |column| start + if own { column } else { 0 })
        });
        ResidualModels::new(columns)
    }

    /// Appends the wedges of an update's children.
    fn relate(&self, node: u32, update: u32, roots: u32, all: &mut Vec<Lineage>) {
        let above = (node != NONE).then(|| self.of(node));
        let children = children(roots, update as usize).map(|child| self.of(child));
        let record = self.records.get(&update);
        let local = |wedge: usize| match record {
            Some(record) => record.get(wedge).copied().filter(|&local| local != LOST),
            None => Some(0),
        };
        relate(above, children, local, all);
    }

    /// Returns the wedges without values, and what decodes these once the model is assembled.
    pub(super) fn detach(self) -> (DetachedWedges, CodedValues) {
        let columns = self.columns();
        let Self { coding, labels, first, rows, records, base } = self;
        (DetachedWedges { first, records, base, labels }, CodedValues { coding, columns, rows })
    }
}

/// Iterates over the wedges of an update in the order in which their residuals are coded: by pairs,
/// the difference first.
fn in_coding_order(family: &[Lineage]) -> impl Iterator<Item = (u32, Role)> {
    let pairs = family.iter().filter(|of| of.role() == Role::Difference);
    let pairs = pairs.flat_map(|of| {
        let first = of.partner.map(|first| (first, Role::Parent));
        std::iter::once((of.wedge, Role::Difference)).chain(first)
    });
    let others = family.iter().filter(|of| of.role() == Role::Single);
    pairs.chain(others.map(|of| (of.wedge, Role::Single)))
}

/// Returns the two nodes that an update creates.
fn children(roots: u32, update: usize) -> [u32; 2] {
    let first = roots + 2 * update as u32;
    [first, first + 1]
}
