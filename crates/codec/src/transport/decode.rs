//! Decoding of blocks from untrusted bytes.

use glam::{BVec4A, Vec4};

use super::border::{Border, NODES, Step};
use super::gate::{CONTEXTS, Gate, NEARBY, NEARBY_BITS, NODE_BITS, context, node_at_offset};
use super::header::{OpenHeader, max_values};
use super::lanes::LANES;
use super::layers::{
    BlockGeometry, BlockLayers, LayerTables, LayersFormat, SymbolReader, code_block,
};
use super::models::{Models, STEP_BITS};
use super::predict::{CellVec, MAX_CELLS, Prediction, SpreadScales};
use super::rans::Symbols;
use super::read::{any_number, number, residual};
use super::weld_blocks::checksum;
use crate::bytes::Malformed;

const MASK: usize = NODES - 1;

/// Decoder state for four blocks at a time.
pub(super) struct Decoder {
    lanes: [Lane; LANES],
}

/// Decoder state for one block.
pub(super) struct Lane {
    border: Border,
    gates: Vec<Gate>,
    cells: Box<[Vec4; NODES]>,
    pub(super) faces: Vec<[u16; 3]>,
    /// Tags of vertices that are not welded by cell alone.
    tags: Vec<(u16, u32)>,
    /// Attributes and labels, if the file has any.
    pub(super) layers: Option<BlockLayers>,
}

/// Bytes of a block, and its number of faces: at most [`super::border::MAX_FACES`].
#[derive(Clone, Copy, Debug)]
pub(super) struct BlockBytes<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) faces: usize,
}

/// Scope of a vertex: inside its block, or shared with other blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sharing {
    Inside,
    /// Welded with all vertices in its cell that have this tag.
    Shared(u32),
}

impl Decoder {
    pub(super) fn new() -> Self {
        Self { lanes: std::array::from_fn(|_| Lane::new()) }
    }

    /// Decodes at most as many blocks as there are lanes. An error comes with the index of its
    /// block.
    pub(super) fn decode(
        &mut self,
        blocks: &[BlockBytes],
        header: &OpenHeader,
    ) -> Result<&[Lane], (usize, Malformed)> {
        let models = &header.models;
        let mut symbols: [Symbols; LANES] = std::array::from_fn(|_| Symbols::empty());
        for (k, block) in blocks.iter().enumerate() {
            symbols[k] = Symbols::new(block.bytes).map_err(|wrong| (k, wrong))?;
            self.lanes[k].begin(&mut symbols[k], header.first_bits);
        }
        for lane in &mut self.lanes[blocks.len()..] {
            lane.gates.clear();
        }
        connect(&mut self.lanes[..blocks.len()], &mut symbols, blocks, models);
        let inside = place(&mut self.lanes, &mut symbols, models);
        for (k, lane) in self.lanes[..blocks.len()].iter_mut().enumerate() {
            lane.read_tags(&mut symbols[k]).map_err(|wrong| (k, wrong))?;
            if let Some((format, tables)) = &header.layers {
                let most = max_values(blocks[k].bytes.len());
                let read = lane.read_layers(&mut symbols[k], (format, tables), most);
                read.map_err(|wrong| (k, wrong))?;
            }
            lane.finish(&symbols[k], inside[k]).map_err(|wrong| (k, wrong))?;
        }
        Ok(&self.lanes[..blocks.len()])
    }
}

/// Decodes the connectivity, one step of each block in turn, so that the processor can overlap
/// them.
#[inline(never)]
fn connect(
    lanes: &mut [Lane],
    symbols: &mut [Symbols; LANES],
    blocks: &[BlockBytes],
    models: &Models,
) {
    let mut is_left = true;
    while is_left {
        is_left = false;
        for ((lane, symbols), block) in lanes.iter_mut().zip(&mut *symbols).zip(blocks) {
            if lane.faces.len() < block.faces {
                lane.step(symbols, models);
                is_left = true;
            }
        }
    }
}

/// Decodes the positions of all vertices but the first. Returns false for lanes with a vertex out
/// of range.
#[inline(never)]
fn place(
    lanes: &mut [Lane; LANES],
    symbols: &mut [Symbols; LANES],
    models: &Models,
) -> [bool; LANES] {
    let mut scales = SpreadScales::new();
    let mut outside = [0; LANES];
    let longest = lanes.iter().map(|lane| lane.gates.len()).max().unwrap_or(0);
    for v in 1..longest {
        let gate = |lane: usize| lanes[lane].gates.get(v).copied().unwrap_or_default();
        let gates = [gate(0), gate(1), gate(2), gate(3)];
        let at = |lane: usize, v: u16| lanes[lane].cells[usize::from(v) & MASK];
        let predictions = scales.predict(&gates, models, at);
        let mut places = [Vec4::ZERO; LANES];
        for k in 0..LANES {
            if v >= lanes[k].gates.len() {
                continue;
            }
            let prediction = match gates[k].faces_a {
                0 => Prediction::start(v as u16, &gates[k], models, |v| at(k, v)),
                _ => predictions.of(k),
            };
            places[k] = prediction.take(|_, nearest, (class, low_bits)| {
                let table = &models.residuals[class];
                let residual = residual(&mut symbols[k], table, low_bits);
                let cell = nearest.wrapping_add(residual);
                outside[k] |= cell;
                cell & (MAX_CELLS - 1)
            });
        }
        for k in 0..LANES {
            lanes[k].cells[v & MASK] = places[k];
        }
        let has_gate = gates.map(|gate| gate.faces_a > 0);
        scales.update(&predictions, places, BVec4A::from_array(has_gate));
    }
    outside.map(|bits| (0..MAX_CELLS).contains(&bits))
}

impl Lane {
    fn new() -> Self {
        let cells: Box<[Vec4]> = vec![Vec4::ZERO; NODES].into();
        Self {
            border: Border::new(),
            gates: Vec::with_capacity(NODES),
            cells: cells.try_into().expect("as many as there are"),
            faces: Vec::new(),
            tags: Vec::new(),
            layers: None,
        }
    }

    /// Returns the cells of the decoded vertices.
    pub(super) fn cells(&self) -> impl ExactSizeIterator<Item = CellVec> {
        self.cells[..self.gates.len()].iter().map(|&cell| CellVec::from_vec4(cell))
    }

    fn begin(&mut self, symbols: &mut Symbols, first_bits: [u8; 3]) {
        self.border.clear();
        self.gates.clear();
        self.faces.clear();
        let first = first_bits.map(|bits| number(symbols, u32::from(bits)) as f32);
        self.cells[0] = CellVec::from(first).extend(0.0);
    }

    fn finish(&self, symbols: &Symbols, is_inside: bool) -> Result<(), Malformed> {
        symbols.finish(checksum(self.cells()))?;
        if is_inside { Ok(()) } else { Err(wrong("a vertex is outside the grid")) }
    }

    /// Decodes one step at the border.
    #[inline(always)]
    fn step(&mut self, symbols: &mut Symbols, models: &Models) {
        let Some(at) = self.border.pivot() else { return self.start() };
        let steps = &models.steps[context(&self.border, at) % CONTEXTS];
        let (step, size, offset) = steps.at(symbols.place(STEP_BITS));
        symbols.consume(STEP_BITS, size, offset, 0);
        let face = match step {
            Step::New => {
                let vertex = self.gates.len() as u16;
                self.gates.push(Gate::at(&self.border, at));
                self.border.add_new(at, vertex)
            }
            Step::Previous => self.border.add_previous(at),
            Step::Next => self.border.add_next(at),
            Step::Nothing => return self.border.close(at),
            Step::Other => {
                let other = other(&self.border, at, symbols);
                self.border.add_other(at, other)
            }
        };
        self.faces.push(face);
    }

    /// Adds a separate face.
    #[cold]
    fn start(&mut self) {
        let first = self.gates.len() as u16;
        let corners = [first, first + 1, first + 2];
        self.gates.extend([Gate::corner(0), Gate::corner(1), Gate::corner(2)]);
        self.border.start(corners);
        self.faces.push(corners);
    }

    fn read_tags(&mut self, symbols: &mut Symbols) -> Result<(), Malformed> {
        self.tags.clear();
        if symbols.uniform(1) == 0 {
            return Ok(());
        }
        for _ in 0..number(symbols, NODE_BITS) {
            let vertex = number(symbols, NODE_BITS) as u16;
            let tag = any_number(symbols);
            if usize::from(vertex) >= self.gates.len() {
                return Err(wrong("a tag names a vertex that does not exist"));
            }
            self.tags.push((vertex, tag));
        }
        Ok(())
    }

    /// Decodes attributes and labels; the block has at most this many values.
    fn read_layers(
        &mut self,
        symbols: &mut Symbols,
        (format, tables): (&LayersFormat, &LayerTables),
        max_values: usize,
    ) -> Result<(), Malformed> {
        let points = self.cells().map(|cell| cell.as_dvec3()).collect();
        let geometry = BlockGeometry::new(&self.faces, points);
        let mut reader = SymbolReader::new(tables, symbols);
        let layers = code_block(&geometry, format, &mut reader, max_values, None);
        self.layers = Some(layers.ok_or_else(|| wrong("a block has impossible attributes"))?);
        Ok(())
    }

    /// Lists which vertices may also be in other blocks, or in this one again.
    pub(super) fn sharing(&self, out: &mut Vec<Sharing>) {
        out.clear();
        out.resize(self.gates.len(), Sharing::Inside);
        for vertex in self.border.vertices() {
            out[usize::from(vertex)] = Sharing::Shared(0);
        }
        for &(vertex, tag) in &self.tags {
            out[usize::from(vertex)] = Sharing::Shared(tag);
        }
    }
}

#[cold]
fn other(border: &Border, at: u16, symbols: &mut Symbols) -> u16 {
    let place = symbols.place(NEARBY_BITS) as u16;
    let mut start = 0;
    for (by, size) in NEARBY {
        if place < start + size {
            symbols.consume(NEARBY_BITS, u32::from(size), u32::from(place - start), 0);
            return node_at_offset(border, at, by);
        }
        start += size;
    }
    symbols.consume(
        NEARBY_BITS,
        (1 << NEARBY_BITS) - u32::from(start),
        u32::from(place - start),
        0,
    );
    border.known(number(symbols, NODE_BITS) as u16)
}

fn wrong(reason: &str) -> Malformed {
    Malformed { at: 0, reason: reason.into() }
}
