//! Encoding of a forest as a `.mlod` file.

use std::io;

use meshlod_mesh::{AttributeBounds, Bounds};
use rayon::prelude::*;

use super::chunk_plan::{ChunkPlan, PlannedChunk, file_node, plan_chunks};
use super::decoder_state::DecoderState;
use super::header::{ChunkEntry, Header, Section};
use super::lattice::Lattice;
use super::quantize::Quantized;
use super::wedge_state::WedgeState;
use super::{FileError, base, chunk, header};
use crate::cut::Certificate;
use crate::forest::{Forest, used_leaves};
use crate::implicit::{Dependencies, DetachedUpdate, Implicit, ModelInfo, Order, SplitRule};

/// Options for writing a `.mlod` file.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Storage {
    /// Largest distance that rounding may move a vertex, in model units; `None` for the default.
    ///
    /// The default is 0.005 % of the bounding-box diagonal; for a [lossless](Forest::lossless)
    /// forest it is 0.002 %, and vertices of the input are not moved at all.
    pub rounding: Option<f64>,
    /// Approximate number of updates (vertex splits) in a chunk of the file, at least 1.
    ///
    /// Larger chunks make the file a little smaller, smaller ones let a query read less.
    pub updates_per_chunk: usize,
    /// Errors to store.
    pub errors: StoredErrors,
    /// Largest errors of the attributes of the finest mesh; a [lossless](Forest::lossless) forest
    /// keeps them bit for bit.
    ///
    /// The values of a vertex that stands for several may be off by some further steps of the
    /// rounding: one, and a quarter of the difference between the two vertices that it is split
    /// into, but at most six for normals and tangents, seven for colours and one for uvs.
    pub attributes: AttributeBounds,
}

/// Errors to store in a `.mlod` file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum StoredErrors {
    /// The forest's, whatever they are.
    #[default]
    AsRecorded,
    /// Distances of the levels from the input, measured after rounding. Where they are below the
    /// rounding the forest's errors are kept, up to there.
    Measured,
}

impl Default for Storage {
    fn default() -> Self {
        Self {
            rounding: None,
            updates_per_chunk: 1 << 12,
            errors: StoredErrors::AsRecorded,
            attributes: AttributeBounds::default(),
        }
    }
}

/// Default rounding, as a fraction of the diagonal.
const ROUNDING: f64 = 5e-5;
/// Default rounding of a lossless forest, for vertices without an exact position. It is finer, so
/// that fine levels stay within their stated errors; a model read back can still be
/// [packed](Implicit::compacted) into 22 bytes a vertex. The dragon takes 11.1 bytes a vertex at
/// `ROUNDING`, 11.6 at this, 12.4 at a quarter of it and 14.0 in single precision.
const LOSSLESS_ROUNDING: f64 = 2e-5;

/// Encodes a forest, and returns the header with the bytes of the whole file; see
/// [`Archive::encode`](super::Archive::encode).
pub(super) fn write(
    forest: Forest,
    storage: &Storage,
) -> Result<(Header, Vec<u8>, Certificate), FileError> {
    let diagonal = diagonal(&forest);
    if let Some(rounding) = storage.rounding.filter(|&most| !(0.0..=diagonal).contains(&most)) {
        return Err(FileError::Rounding(rounding));
    }
    let lattice = lattice(&forest, storage, diagonal);
    let Quantized { forest, max_displacement } = forest.quantized(lattice, storage.errors);
    let order = Order::for_file(&forest);
    let (mt, links) = rayon::join(
        || Implicit::in_order(&forest, &order),
        || Dependencies::in_order(&forest, &order, SplitRule::Strict),
    );
    let mt = mt?;
    // The model and its dependencies hold all that is written.
    drop((forest, order));
    let has_wedges = mt.wedges().is_some();
    let lossless = mt.exact().is_lossless();
    let (certificate, sections) = rayon::join(
        || mt.certify(),
        || {
            let plan = plan_chunks(&mt, &links, storage.updates_per_chunk.max(1));
            drop(links);
            encode_sections(&mt, &plan, lattice, (!lossless).then_some(&storage.attributes))
        },
    );
    let (certificate, sections) = (certificate?, sections?);
    let header = Header {
        about: ModelInfo {
            frame: *mt.frame(),
            error_kind: mt.error_kind(),
            has_stages: has_wedges,
        },
        lattice,
        lossless,
        has_wedges,
        diagonal,
        rounding: mt.frame().model_length(max_displacement),
        roots: mt.root_count() as u32,
        base_faces: mt.base_faces() as u32,
        base: Section::of(&sections.base),
        chunks: sections.chunks,
        resources: Vec::new(),
        has_old_resources: false,
    };
    let bytes = [header.to_bytes(), sections.base, sections.bodies.concat()].concat();
    Ok((header, bytes, certificate))
}

/// Encoded sections, with the index of the chunks.
struct EncodedSections {
    base: Vec<u8>,
    chunks: Vec<ChunkEntry>,
    bodies: Vec<Vec<u8>>,
}

fn encode_sections(
    mt: &Implicit,
    plan: &ChunkPlan,
    lattice: Lattice,
    bounds: Option<&AttributeBounds>,
) -> io::Result<EncodedSections> {
    let nodes = (0..mt.root_count() as u32)
        .chain(plan.order.iter().flat_map(|&update| mt.children(update)));
    let nodes: Vec<u32> = nodes.collect();
    let exact = mt.exact().select(nodes.iter().copied());
    let mut state = DecoderState::new(*mt.frame(), lattice, mt.base_mesh(), exact);
    state.has_stages = mt.stage(0).is_some();
    state.begin_run(0);
    state.updates.extend(plan.order.iter().map(|&update| {
        let update = mt.detached(update);
        let number = |node| file_node(mt, &plan.file_index, node);
        let non_fan = update.non_fan.map(|non_fan| Box::new(non_fan.renumbered(number)));
        DetachedUpdate { parent: number(update.parent), non_fan, ..update }
    }));
    let wedges = mt.wedges();
    state.wedges = wedges.map(|all| WedgeState::of_model((mt, all), bounds, &nodes, &plan.order));
    let write = |chunk: &PlannedChunk| {
        let body = chunk::write(&state, chunk.updates.clone())?;
        let updates = &state.updates[chunk.updates.clone()];
        let entry = ChunkEntry {
            stored: Section::of(&body),
            updates: updates.len() as u32,
            faces: updates.iter().map(DetachedUpdate::created_face_count).sum::<usize>() as u32,
            area: header::rounded(&chunk.area),
        };
        Ok((entry, body))
    };
    let written: io::Result<Vec<_>> = plan.chunks.par_iter().map(write).collect();
    let (chunks, bodies) = written?.into_iter().unzip();
    Ok(EncodedSections { base: base::write(&state)?, chunks, bodies })
}

/// Returns the coarsest lattice that meets the requested rounding, or the default one for this
/// diagonal.
pub(super) fn lattice(forest: &Forest, storage: &Storage, diagonal: f64) -> Lattice {
    let part = if forest.exact.is_lossless() { LOSSLESS_ROUNDING } else { ROUNDING };
    let most = storage.rounding.unwrap_or(part * diagonal);
    Lattice::within(forest.frame.local_length(most))
}

/// Returns the bounding-box diagonal of the finest mesh, in model units.
pub(super) fn diagonal(forest: &Forest) -> f64 {
    let leaves = forest.positions.iter().zip(used_leaves(&forest.faces, forest.vertices));
    let places = leaves.filter(|(_, is_used)| *is_used).map(|(place, _)| place.map(f64::from));
    let places: Vec<_> = places.collect();
    let bounds = Bounds::of(&places);
    if bounds.is_empty() { 0.0 } else { forest.frame.model_length(bounds.diagonal()) }
}
