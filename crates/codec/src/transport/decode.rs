//! Decoding of blocks from untrusted bytes.

use glam::{BVec4A, Vec4};

use super::border::{Border, MAX_FACES, NODES, Step};
use super::fans::{FanEnd, RareStep, add_fan};
use super::gate::{CONTEXTS, Gate, NEARBY, NEARBY_BITS, NODE_BITS, context, node_at_offset};
use super::header::{FaceCoding, OpenHeader, max_values};
use super::lanes::LANES;
use super::layers::{
    BlockGeometry, BlockLayers, LayerTables, LayersFormat, SymbolReader, code_block,
};
use super::models::{Models, STEP_BITS};
use super::predict::{CellVec, MAX_CELLS, SpreadScales};
use super::rans::Symbols;
use super::read::{any_number, number, residual_of};
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
    gates: Box<[Gate; NODES]>,
    vertices: usize,
    cells: Box<[Vec4; NODES]>,
    faces: Box<[[u16; 3]; MAX_FACES]>,
    face_count: usize,
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
            lane.vertices = 0;
        }
        let lanes = &mut self.lanes[..blocks.len()];
        match header.coding {
            FaceCoding::Steps => connect(lanes, &mut symbols, blocks, Lane::step, models),
            FaceCoding::Fans => connect(lanes, &mut symbols, blocks, Lane::fan, models),
        }
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

/// Decodes the connectivity, one step or fan of each block in turn, so that the processor can
/// overlap them.
#[inline(always)]
fn connect(
    lanes: &mut [Lane],
    symbols: &mut [Symbols; LANES],
    blocks: &[BlockBytes],
    add: impl Fn(&mut Lane, &mut Symbols, &Models, usize),
    models: &Models,
) {
    let mut is_left = true;
    while is_left {
        is_left = false;
        for ((lane, symbols), block) in lanes.iter_mut().zip(&mut *symbols).zip(blocks) {
            if lane.face_count < block.faces {
                add(lane, symbols, models, block.faces);
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
    let (mut least, mut greatest) = (Vec4::ZERO, Vec4::ZERO);
    let longest = lanes.iter().map(|lane| lane.vertices).max().unwrap_or(0);
    let shortest = lanes.iter().map(|lane| lane.vertices).min().unwrap_or(0);
    for v in 1..longest {
        let gate = |lane: usize| lanes[lane].gates[v & MASK];
        let gates = [gate(0), gate(1), gate(2), gate(3)];
        let at = |lane: usize, v: u16| lanes[lane].cells[usize::from(v) & MASK];
        let mut predictions = scales.predict(&gates, models, at);
        let has_gate = BVec4A::from_array(gates.map(|gate| gate.faces_a > 0));
        if !has_gate.all() {
            for (lane, gate) in gates.iter().enumerate().filter(|(_, gate)| gate.faces_a == 0) {
                predictions.start(lane, (v as u16, gate), models, |v| at(lane, v));
            }
        }
        let mut residuals = [[0.0; LANES]; 3];
        for (turn, residuals) in residuals.iter_mut().enumerate() {
            let widths = predictions.widths(turn);
            for lane in 0..LANES {
                if v < lanes[lane].vertices {
                    residuals[lane] = residual_of(&mut symbols[lane], models, widths[lane]) as f32;
                }
            }
        }
        let residuals = residuals.map(Vec4::from_array);
        let (places, mut turns) = predictions.decode(residuals);
        if v >= shortest {
            // Lanes that are done decode gates of earlier blocks, for nothing.
            for lane in (0..LANES).filter(|&lane| v >= lanes[lane].vertices) {
                turns.iter_mut().for_each(|turn| turn[lane] = 0.0);
            }
        }
        for turn in turns {
            least = least.min(turn);
            greatest = greatest.max(turn);
        }
        let points = places.each(|x| x.max(Vec4::ZERO).min(Vec4::splat(LAST_CELL))).points();
        for k in 0..LANES {
            lanes[k].cells[v & MASK] = points[k];
        }
        scales.update(&predictions, places, has_gate);
    }
    let is_inside = least.cmpge(Vec4::ZERO) & greatest.cmple(Vec4::splat(LAST_CELL));
    is_inside.into()
}

/// Greatest coordinate of a cell.
const LAST_CELL: f32 = (MAX_CELLS - 1) as f32;

impl Lane {
    fn new() -> Self {
        let cells: Box<[Vec4]> = vec![Vec4::ZERO; NODES].into();
        let gates: Box<[Gate]> = vec![Gate::default(); NODES].into();
        let faces: Box<[[u16; 3]]> = vec![[0; 3]; MAX_FACES].into();
        Self {
            border: Border::new(),
            gates: gates.try_into().expect("as many as there are"),
            vertices: 0,
            cells: cells.try_into().expect("as many as there are"),
            faces: faces.try_into().expect("as many as there are"),
            face_count: 0,
            tags: Vec::new(),
            layers: None,
        }
    }

    /// Returns the decoded faces.
    pub(super) fn faces(&self) -> &[[u16; 3]] {
        &self.faces[..self.face_count]
    }

    #[inline(always)]
    fn push_gate(&mut self, gate: Gate) {
        self.gates[self.vertices & MASK] = gate;
        self.vertices += 1;
    }

    #[inline(always)]
    fn push_face(&mut self, face: [u16; 3]) {
        self.faces[self.face_count % MAX_FACES] = face;
        self.face_count += 1;
    }

    /// Returns the cells of the decoded vertices.
    pub(super) fn cells(&self) -> impl ExactSizeIterator<Item = CellVec> {
        self.cells[..self.vertices].iter().map(|&cell| CellVec::from_vec4(cell))
    }

    fn begin(&mut self, symbols: &mut Symbols, first_bits: [u8; 3]) {
        self.border.clear();
        self.vertices = 0;
        self.face_count = 0;
        let first = first_bits.map(|bits| number(symbols, u32::from(bits)) as f32);
        self.cells[0] = CellVec::from(first).extend(0.0);
    }

    fn finish(&self, symbols: &Symbols, is_inside: bool) -> Result<(), Malformed> {
        symbols.finish(checksum(self.cells()))?;
        if is_inside { Ok(()) } else { Err(wrong("a vertex is outside the grid")) }
    }

    /// Decodes one step at the border.
    #[inline(always)]
    fn step(&mut self, symbols: &mut Symbols, models: &Models, _faces: usize) {
        let Some(at) = self.border.pivot() else { return self.start() };
        let steps = &models.steps[context(&self.border, at) % CONTEXTS];
        let (step, size, offset) = steps.at(symbols.place(STEP_BITS));
        symbols.consume(STEP_BITS, size, offset, 0);
        let face = match step {
            Step::New => {
                let vertex = self.vertices as u16;
                self.push_gate(Gate::at(&self.border, at));
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
        self.push_face(face);
    }

    /// Decodes a fan at the border of a block with this many faces.
    #[inline(always)]
    fn fan(&mut self, symbols: &mut Symbols, models: &Models, faces: usize) {
        let Some(at) = self.border.pivot() else { return self.start() };
        let table = &models.fans[context(&self.border, at) % CONTEXTS];
        let (new, end) = table.read(symbols);
        if new > 0 {
            let left = faces - self.face_count;
            let count = new.min(left) as u16;
            let first = self.vertices as u16;
            let Self { border, gates, vertices, faces, face_count, .. } = self;
            add_fan(border, at, (first, count), |face, gate| {
                gates[*vertices & MASK] = gate;
                *vertices += 1;
                faces[*face_count % MAX_FACES] = face;
                *face_count += 1;
            });
            if new >= left {
                return;
            }
        }
        let face = match end {
            FanEnd::Previous => self.border.add_previous(at),
            FanEnd::Nothing => return self.border.close(at),
            FanEnd::Rare => return self.rare(at, symbols),
        };
        self.push_face(face);
    }

    #[cold]
    fn rare(&mut self, at: u16, symbols: &mut Symbols) {
        let face = match RareStep::read(&self.border, at, symbols) {
            RareStep::New => {
                let vertex = self.vertices as u16;
                self.push_gate(Gate::at(&self.border, at));
                self.border.add_new(at, vertex)
            }
            RareStep::Next => self.border.add_next(at),
            RareStep::Other(other) => self.border.add_other(at, other),
        };
        self.push_face(face);
    }

    /// Adds a separate face.
    #[cold]
    fn start(&mut self) {
        let first = self.vertices as u16;
        let corners = [first, first + 1, first + 2];
        (0..3).for_each(|k| self.push_gate(Gate::corner(k)));
        self.border.start(corners);
        self.push_face(corners);
    }

    fn read_tags(&mut self, symbols: &mut Symbols) -> Result<(), Malformed> {
        self.tags.clear();
        if symbols.uniform(1) == 0 {
            return Ok(());
        }
        for _ in 0..number(symbols, NODE_BITS) {
            let vertex = number(symbols, NODE_BITS) as u16;
            let tag = any_number(symbols);
            if usize::from(vertex) >= self.vertices {
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
        let geometry = BlockGeometry::new(self.faces(), points);
        let mut reader = SymbolReader::new(tables, symbols);
        let layers = code_block(&geometry, format, &mut reader, max_values, None);
        self.layers = Some(layers.ok_or_else(|| wrong("a block has impossible attributes"))?);
        Ok(())
    }

    /// Lists which vertices may also be in other blocks, or in this one again.
    pub(super) fn sharing(&self, out: &mut Vec<Sharing>) {
        out.clear();
        out.resize(self.vertices, Sharing::Inside);
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
