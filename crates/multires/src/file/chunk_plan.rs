//! Which updates go into which chunk, and in which order.
//!
//! Bands of falling error, each parted into boxes. An update goes with the last chunk that holds
//! something it needs: so the chunks up to any one are a cut, and a file is good from its start to any
//! chunk's end.

use std::ops::Range;

use glam::Vec3;

use super::quantize::{OCTAVES, octave};
use crate::implicit::{Dependencies, Implicit};
use crate::query::{Area, Ball};

/// The updates of a model in the order of its file.
pub(super) struct ChunkPlan {
    /// The model's update of each place in the file.
    pub(super) order: Vec<u32>,
    /// The place in the file of each of the model's updates.
    pub(super) place: Vec<u32>,
    pub(super) chunks: Vec<PlannedChunk>,
}

/// A run of the order.
pub(super) struct PlannedChunk {
    pub(super) updates: Range<usize>,
    /// Around all of its updates and all that need any of them; the greatest error.
    pub(super) area: Area,
}

/// A band has at least this part of a chunk, unless it is the last.
const LEAST_IN_BAND: usize = 4;

/// In chunks of about so many updates.
pub(super) fn plan_chunks(
    mt: &Implicit,
    links: &Dependencies,
    updates_per_chunk: usize,
) -> ChunkPlan {
    let mut chunk_of = vec![0; mt.update_count()];
    let count = partition_by_error(mt, updates_per_chunk, &mut chunk_of);
    // What is needed comes first: it is of a higher level.
    let order: Vec<u32> = links.dependents_first().collect();
    for &update in order.iter().rev() {
        let needed = links.of(update).map(|need| chunk_of[need as usize]).max();
        let own = &mut chunk_of[update as usize];
        *own = needed.map_or(*own, |needed| needed.max(*own));
        // What is glued is needed as a whole, and needs the same.
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
        place: vec![0; mt.update_count()],
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
    /// Adds a chunk: by the node that each splits, as the file numbers them. That of an update whose
    /// parent is in the same chunk comes behind all others.
    fn append(&mut self, mt: &Implicit, members: &[u32], chunk_of: &[u32]) {
        let Some(chunk) = members.first().map(|&update| chunk_of[update as usize]) else { return };
        let start = self.order.len();
        let is_member = |update: u32| chunk_of[update as usize] == chunk;
        let is_apart = |&&update: &&u32| !mt.creator(mt.parent(update)).is_some_and(is_member);
        self.order.extend(members.iter().filter(is_apart));
        let Self { order, place, .. } = self;
        order[start..].sort_unstable_by_key(|&update| file_node(mt, place, mt.parent(update)));
        let mut at = start;
        while at < order.len() {
            let update = order[at];
            place[update as usize] = at as u32;
            at += 1;
            let below = mt.children(update).into_iter().filter_map(|child| mt.update_of(child));
            order.extend(below.filter(|&update| is_member(update)));
        }
    }
}

/// The number of a node in the file, where its family has a place.
pub(super) fn file_node(mt: &Implicit, place: &[u32], node: u32) -> u32 {
    let roots = mt.root_count() as u32;
    mt.creator(node).map_or(node, |family| roots + 2 * place[family as usize] + (node - roots) % 2)
}

/// By band, and within it by place; how many chunks there are.
fn partition_by_error(mt: &Implicit, updates_per_chunk: usize, chunk_of: &mut [u32]) -> usize {
    let mut octaves = vec![Vec::new(); OCTAVES];
    for update in 0..mt.update_count() as u32 {
        octaves[octave(mt.error(update))].push(update);
    }
    let mut count = 0;
    let mut band = Vec::new();
    for (octave, members) in octaves.into_iter().enumerate().rev() {
        band.extend(members);
        if octave == 0 || band.len() >= updates_per_chunk / LEAST_IN_BAND {
            let chunks = band.len().div_ceil(updates_per_chunk);
            bisect(mt, &mut band, count as u32, chunks, chunk_of);
            band.clear();
            count += chunks;
        }
    }
    count
}

/// Parts updates into so many chunks from `first` on: halves them again and again, where they are
/// widest.
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

/// Where the updates of each chunk are, and all that need them. So an update that is wanted lies in the
/// area of every chunk that it needs, and the chunks whose areas are wanted hold all that it takes.
fn chunk_areas(mt: &Implicit, links: &Dependencies, chunk_of: &[u32], count: usize) -> Vec<Area> {
    let mut reach: Vec<Area> = (0..mt.update_count() as u32)
        .map(|update| {
            let Ball { center, radius, error } = mt.ball(update);
            Area { min: center - radius, max: center + radius, error }
        })
        .collect();
    let mut areas = vec![Area::EMPTY; count];
    for update in links.dependents_first() {
        // All that need it came before.
        let own = reach[update as usize];
        areas[chunk_of[update as usize] as usize].join(&own);
        links.of(update).for_each(|need| reach[need as usize].join(&own));
    }
    areas
}
