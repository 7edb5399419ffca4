//! Assignment of updates to chunks, and their order in the file.
//!
//! Updates are grouped into bands of decreasing error, and each band is split into boxes. An update
//! is then moved to the last chunk that holds something it depends on. The chunks up to any point
//! thus form a cut, and a file can be used from its start to the end of any chunk.

use std::ops::Range;

use glam::Vec3;

use super::quantize::{OCTAVES, octave};
use crate::implicit::{Dependencies, Implicit};
use crate::query::{Area, Ball};

/// Order and grouping of a model's updates in its file.
pub(super) struct ChunkPlan {
    /// The model's update at each index of the file.
    pub(super) order: Vec<u32>,
    /// Index in the file of each of the model's updates.
    pub(super) file_index: Vec<u32>,
    pub(super) chunks: Vec<PlannedChunk>,
}

/// Chunk of consecutive updates in file order.
pub(super) struct PlannedChunk {
    pub(super) updates: Range<usize>,
    /// Bounds of its updates and of all updates that depend on them, with the greatest error among
    /// these.
    pub(super) area: Area,
}

/// A band holds at least a quarter of a chunk, unless it is the last.
const MAX_BANDS_PER_CHUNK: usize = 4;

/// Groups the updates into chunks of about `updates_per_chunk`.
pub(super) fn plan_chunks(
    mt: &Implicit,
    links: &Dependencies,
    updates_per_chunk: usize,
) -> ChunkPlan {
    let mut chunk_of = vec![0; mt.update_count()];
    let count = partition_by_error(mt, updates_per_chunk, &mut chunk_of);
    // In reverse, dependencies come before the updates that depend on them.
    let order: Vec<u32> = links.dependents_first().collect();
    for &update in order.iter().rev() {
        let needed = links.of(update).map(|need| chunk_of[need as usize]).max();
        let own = &mut chunk_of[update as usize];
        *own = needed.map_or(*own, |needed| needed.max(*own));
        // The two updates of a face contraction depend on the same updates and are needed as a
        // whole.
        if mt.is_fused_with_child(update) {
            chunk_of[update as usize + 1] = *own;
        }
    }
    let mut members = vec![Vec::new(); count];
    for (update, &chunk) in chunk_of.iter().enumerate() {
        members[chunk as usize].push(update as u32);
    }
    let areas = chunk_areas(mt, links, &chunk_of, count);
    let mut plan = ChunkPlan {
        order: Vec::with_capacity(mt.update_count()),
        file_index: vec![0; mt.update_count()],
        chunks: Vec::new(),
    };
    for (members, area) in members.into_iter().zip(areas).filter(|(all, _)| !all.is_empty()) {
        let start = plan.order.len();
        plan.append(mt, &members, &chunk_of);
        plan.chunks.push(PlannedChunk { updates: start..plan.order.len(), area });
    }
    plan
}

impl ChunkPlan {
    /// Appends a chunk, sorted by the nodes that its updates split, in the file's numbering.
    /// Updates that split a node created within the chunk follow all others.
    fn append(&mut self, mt: &Implicit, members: &[u32], chunk_of: &[u32]) {
        let Some(chunk) = members.first().map(|&update| chunk_of[update as usize]) else { return };
        let start = self.order.len();
        let is_member = |update: u32| chunk_of[update as usize] == chunk;
        let is_apart = |&&update: &&u32| !mt.creator(mt.parent(update)).is_some_and(is_member);
        self.order.extend(members.iter().filter(is_apart));
        let Self { order, file_index, .. } = self;
        order[start..].sort_unstable_by_key(|&update| file_node(mt, file_index, mt.parent(update)));
        let mut at = start;
        while at < order.len() {
            let update = order[at];
            file_index[update as usize] = at as u32;
            at += 1;
            let below = mt.children(update).into_iter().filter_map(|child| mt.update_of(child));
            order.extend(below.filter(|&update| is_member(update)));
        }
    }
}

/// Returns the number in the file of a node whose creating update has been placed.
pub(super) fn file_node(mt: &Implicit, file_index: &[u32], node: u32) -> u32 {
    let roots = mt.root_count() as u32;
    mt.creator(node)
        .map_or(node, |family| roots + 2 * file_index[family as usize] + (node - roots) % 2)
}

/// Assigns updates to chunks, by error bands and by position within a band. Returns the number of
/// chunks.
fn partition_by_error(mt: &Implicit, updates_per_chunk: usize, chunk_of: &mut [u32]) -> usize {
    let mut octaves = vec![Vec::new(); OCTAVES];
    for update in 0..mt.update_count() as u32 {
        octaves[octave(mt.error(update))].push(update);
    }
    let mut count = 0;
    let mut band = Vec::new();
    for (octave, members) in octaves.into_iter().enumerate().rev() {
        band.extend(members);
        if octave == 0 || band.len() >= updates_per_chunk / MAX_BANDS_PER_CHUNK {
            let chunks = band.len().div_ceil(updates_per_chunk);
            bisect(mt, &mut band, count as u32, chunks, chunk_of);
            band.clear();
            count += chunks;
        }
    }
    count
}

/// Splits updates into `chunks` chunks numbered from `first` on, by repeated bisection along the
/// longest side of their bounding box.
fn bisect(mt: &Implicit, updates: &mut [u32], first: u32, chunks: usize, chunk_of: &mut [u32]) {
    if chunks <= 1 {
        updates.iter().for_each(|&update| chunk_of[update as usize] = first);
        return;
    }
    let place = |update: u32| mt.stored_position(mt.parent(update));
    let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for &update in &*updates {
        (min, max) = (min.min(place(update).into()), max.max(place(update).into()));
    }
    let axis = (max - min).max_position();
    let middle = updates.len() * (chunks / 2) / chunks;
    updates.select_nth_unstable_by(middle, |&a, &b| {
        place(a)[axis].total_cmp(&place(b)[axis]).then(a.cmp(&b))
    });
    let (low, high) = updates.split_at_mut(middle);
    bisect(mt, low, first, chunks / 2, chunk_of);
    bisect(mt, high, first + chunks as u32 / 2, chunks - chunks / 2, chunk_of);
}

/// Returns the bounds of each chunk's updates and of all updates that depend on them.
///
/// An update that a query wants then lies in the area of every chunk it depends on, so the chunks
/// whose areas are wanted hold everything the query needs.
fn chunk_areas(mt: &Implicit, links: &Dependencies, chunk_of: &[u32], count: usize) -> Vec<Area> {
    let mut reach: Vec<Area> = (0..mt.update_count() as u32)
        .map(|update| {
            let Ball { center, radius, error } = mt.ball(update);
            Area { min: center - radius, max: center + radius, error }
        })
        .collect();
    let mut areas = vec![Area::EMPTY; count];
    for update in links.dependents_first() {
        // All dependents have been visited.
        let own = reach[update as usize];
        areas[chunk_of[update as usize] as usize].join(&own);
        links.of(update).for_each(|need| reach[need as usize].join(&own));
    }
    areas
}
