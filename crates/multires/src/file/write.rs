//! Writes a model as a file.

use std::io;

use meshlod_mesh::Bounds;
use rayon::prelude::*;

use super::chunk_plan::{ChunkPlan, PlannedChunk, file_node, plan_chunks};
use super::decoder_state::DecoderState;
use super::header::{ChunkEntry, Header, Section};
use super::lattice::Lattice;
use super::quantize::Quantized;
use super::{FileError, base, chunk};
use crate::cut::Certificate;
use crate::forest::Forest;
use crate::implicit::{Dependencies, DetachedUpdate, Implicit, ModelInfo, Order, SplitRule};

/// How a model is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Storage {
    /// By how much a vertex may be moved, in model units; 0.005 % of the diagonal if nothing is said. Those
    /// of a [lossless](Forest::lossless) forest that are the input's are not moved; others by 0.002 % if
    /// nothing is said.
    pub rounding: Option<f64>,
    /// About how many updates a chunk has: more are a little smaller on disk, fewer are read in smaller
    /// parts. At least 1.
    pub updates_per_chunk: usize,
}

impl Default for Storage {
    fn default() -> Self {
        Self { rounding: None, updates_per_chunk: 1 << 12 }
    }
}

/// Of the diagonal.
const ROUNDING: f64 = 5e-5;
/// The same for what is not kept to the bit where the rest is: fine levels are not to be off by more than
/// they say, and what is read can be [narrow](Implicit::narrowed). The dragon takes 11.1 bytes a vertex at
/// `ROUNDING`, 11.6 at this, 12.4 at a quarter of it and 14.0 in single precision.
const LOSSLESS_ROUNDING: f64 = 2e-5;

/// What [`Archive::write`](super::Archive::write) gives.
pub(super) fn write(
    forest: &Forest,
    storage: &Storage,
) -> Result<(Vec<u8>, Certificate), FileError> {
    let diagonal = diagonal(forest);
    if let Some(rounding) = storage.rounding.filter(|&most| !(0.0..=diagonal).contains(&most)) {
        return Err(FileError::Rounding(rounding));
    }
    let lattice = lattice(forest, storage, diagonal);
    let Quantized { forest, moved } = forest.quantized(lattice)?;
    let order = Order::new(&forest);
    let mt = Implicit::in_order(&forest, &order)?;
    let (certificate, packed) = rayon::join(
        || mt.certify(),
        || {
            let links = Dependencies::in_order(&forest, &order, SplitRule::Strict);
            pack(&mt, &plan_chunks(&mt, &links, storage.updates_per_chunk.max(1)), lattice)
        },
    );
    let (certificate, packed) = (certificate?, packed?);
    let header = Header {
        about: ModelInfo { frame: forest.frame, error_kind: forest.error_kind },
        lattice,
        lossless: forest.exact.is_lossless(),
        diagonal,
        rounding: forest.frame.length_of_model(moved),
        roots: mt.root_count() as u32,
        base_faces: mt.base_faces() as u32,
        base: Section::of(&packed.base),
        chunks: packed.chunks,
    };
    let bytes = [header.to_bytes(), packed.base, packed.bodies.concat()].concat();
    Ok((bytes, certificate))
}

/// All that stands behind the header, and the index.
struct Packed {
    base: Vec<u8>,
    chunks: Vec<ChunkEntry>,
    bodies: Vec<Vec<u8>>,
}

fn pack(mt: &Implicit, plan: &ChunkPlan, lattice: Lattice) -> io::Result<Packed> {
    let nodes = (0..mt.root_count() as u32)
        .chain(plan.order.iter().flat_map(|&update| mt.children(update)));
    let exact = mt.exact().select(nodes);
    let mut state = DecoderState::new(*mt.frame(), lattice, mt.base_mesh(), exact);
    state.begin_run(0);
    state.updates.extend(plan.order.iter().map(|&update| {
        let loose = mt.detached(update);
        let number = |node| file_node(mt, &plan.place, node);
        let non_fan = loose.non_fan.map(|non_fan| Box::new(non_fan.renumbered(number)));
        DetachedUpdate { parent: number(loose.parent), non_fan, ..loose }
    }));
    let write = |chunk: &PlannedChunk| {
        let body = chunk::write(&state, chunk.updates.clone())?;
        let updates = &state.updates[chunk.updates.clone()];
        let entry = ChunkEntry {
            stored: Section::of(&body),
            updates: updates.len() as u32,
            faces: updates.iter().map(DetachedUpdate::created_face_count).sum::<usize>() as u32,
            area: chunk.area,
        };
        Ok((entry, body))
    };
    let written: io::Result<Vec<_>> = plan.chunks.par_iter().map(write).collect();
    let (chunks, bodies) = written?.into_iter().unzip();
    Ok(Packed { base: base::write(&state)?, chunks, bodies })
}

/// The coarsest that is fine enough for a mesh of this diagonal.
pub(super) fn lattice(forest: &Forest, storage: &Storage, diagonal: f64) -> Lattice {
    let part = if forest.exact.is_lossless() { LOSSLESS_ROUNDING } else { ROUNDING };
    let most = storage.rounding.unwrap_or(part * diagonal);
    Lattice::within(forest.frame.length(most))
}

/// Of the finest mesh, in model units.
pub(super) fn diagonal(forest: &Forest) -> f64 {
    let leaves = forest.faces.iter().flatten().map(|&leaf| forest.positions[leaf as usize]);
    let places: Vec<_> = leaves.map(|p| p.map(f64::from)).collect();
    let bounds = Bounds::of(&places);
    if bounds.is_empty() { 0.0 } else { forest.frame.length_of_model(bounds.diagonal()) }
}
