//! Coding of a chunk of updates, with one stream per field.
//!
//! Each value is predicted from what the decoder already knows: a node from the previous one, a
//! radius from the distance between the children, and the children's positions from their
//! difference and the offset of their midpoint from the parent.

use std::io;
use std::ops::Range;

use glam::Vec3;
use thiserror::Error;

use super::child_offsets::{ChildOffsets, OffsetStreams};
use super::decoder_state::DecoderState;
use super::exact_coding::{self, Deltas};
use super::header::UNKNOWN_FLAGS;
use super::stage_coding;
use super::streams::{Packer, Unpacker};
use super::wedge_state::WedgeError;
use crate::forest::{NONE, NonFanSplit, Stage};
use crate::implicit::{DetachedUpdate, has_three_corners};
use crate::length16::Length16;
use crate::pack::{error9, error16, radius8, radius16};

/// Reason why a chunk cannot be decoded.
#[derive(Debug, Error)]
pub(super) enum ChunkError {
    /// The compressed data is malformed or ends too early.
    #[error("its compressed data is malformed or ends too early")]
    Decompress(#[from] io::Error),
    /// An update has an invalid field.
    #[error("its update {update} is invalid: {why}")]
    Update { update: usize, why: &'static str },
    /// The wedges of the updates are invalid.
    #[error("{0}")]
    Wedges(&'static str),
    /// Data follows the last update.
    #[error("unexpected data after its last update")]
    TrailingData,
}

/// Flag bits of an update.
const OPEN: u8 = 1;
const FUSED: u8 = 2;
const NON_FAN: u8 = 4;
/// Set if the first or the second child has an exact position: that of a vertex of the finest mesh.
/// Only in lossless files.
const EXACT: [u8; 2] = [8, 16];
/// Set if the update records the wedges of its faces. Only in files with wedges.
const RECORDED: u8 = 32;

/// Encodes a run of updates. Everything before it must be known to the decoder.
pub(super) fn write(state: &DecoderState, run: Range<usize>) -> io::Result<Vec<u8>> {
    let updates = &state.updates[run.clone()];
    let mut packer = Packer::new()?;
    let parents = updates.iter().scan(0, |next, u| {
        let gap = u.parent - *next;
        *next = u.parent + 1;
        Some(gap)
    });
    packer.numbers(&parents.collect::<Vec<_>>())?;
    let flags = |(at, u): (usize, &DetachedUpdate)| {
        let own = [(OPEN, u.is_open), (FUSED, u.fused_with_child), (NON_FAN, u.non_fan.is_some())];
        let exact = state.children(at).map(|child| state.exact_position(child).is_some());
        let recorded = state.wedges.as_ref().is_some_and(|wedges| wedges.is_recorded(at));
        let all = own.into_iter().chain(EXACT.into_iter().zip(exact));
        let all = all.chain([(RECORDED, recorded)]);
        all.filter(|(_, is_so)| *is_so).map(|(flag, _)| flag).sum::<u8>()
    };
    packer.bytes(&run.clone().zip(updates).map(flags).collect::<Vec<_>>())?;
    for side in [0, 1] {
        packer.bytes(&updates.iter().map(|u| u.wings[side]).collect::<Vec<_>>())?;
    }
    write_errors(updates, &mut packer)?;
    let sizes = write_offsets(state, updates, &mut packer)?;
    for non_fan in updates.iter().filter_map(|u| u.non_fan.as_deref()) {
        write_non_fan(non_fan, &mut packer)?;
    }
    if state.is_lossless() {
        let pair =
            |node| state.exact_position(node).map(|exact| [exact, state.predicted_position(node)]);
        let pairs = run.clone().flat_map(|at| state.children(at)).filter_map(pair);
        exact_coding::write(&pairs.collect::<Vec<_>>(), &mut packer)?;
    }
    if state.has_stages {
        let stages: Vec<Stage> = updates.iter().map(|u| u.stage).collect();
        stage_coding::write(
            &stages,
            &errors_above(updates.iter().map(|u| error9(u.error))),
            &mut packer,
        )?;
    }
    if let Some(wedges) = &state.wedges {
        wedges.write_run(&state.updates, run, state.root_count(), &sizes, &mut packer)?;
    }
    packer.finish()
}

/// Encodes errors relative to the least one, and levels relative to the least level with the same
/// error.
fn write_errors(updates: &[DetachedUpdate], packer: &mut Packer) -> io::Result<()> {
    let errors = || updates.iter().map(|u| error9(u.error));
    let least = errors().min().unwrap_or(0);
    let steps: Vec<u32> = errors().map(|error| error - least).collect();
    let count = steps.iter().max().map_or(0, |&most| most as usize + 1);
    let mut levels = vec![u32::MAX; count];
    for (u, &step) in updates.iter().zip(&steps) {
        levels[step as usize] = levels[step as usize].min(u.level.into());
    }
    let above = updates.iter().zip(&steps);
    let above = above.map(|(u, &step)| u32::from(u.level) - levels[step as usize]);
    let above: Vec<u32> = above.collect();
    levels.iter_mut().filter(|level| **level == u32::MAX).for_each(|level| *level = 0);
    packer.numbers(&[least, count as u32])?;
    packer.numbers(&levels)?;
    packer.numbers(&steps)?;
    packer.numbers(&above)
}

/// Returns errors minus the least one.
fn errors_above(errors: impl Iterator<Item = u32> + Clone) -> Vec<u32> {
    let least = errors.clone().min().unwrap_or(0);
    errors.map(|error| error - least).collect()
}

/// Encodes the positions of children and the radii. Returns the classes of their distances.
fn write_offsets(
    state: &DecoderState,
    updates: &[DetachedUpdate],
    packer: &mut Packer,
) -> io::Result<Vec<u8>> {
    let lattice = state.lattice;
    let offsets: Vec<_> = updates
        .iter()
        .map(|u| ChildOffsets::of(lattice, state.stored_position(u.parent), u.children))
        .collect();
    let encoded: Vec<_> = updates
        .iter()
        .zip(&offsets)
        .map(|(u, f)| f.encoded(&state.normal_predictor(u.parent)))
        .collect();
    for k in 0..3 {
        packer.signed(encoded.iter().map(|offset| offset.difference[k]))?;
        packer.signed(encoded.iter().map(|offset| offset.midpoint[k]))?;
    }
    let radii = updates.iter().zip(&offsets);
    packer.signed(
        radii.map(|(u, f)| i32::from(radius8(u.radius)) - i32::from(f.predicted_radius8(lattice))),
    )?;
    Ok(encoded.iter().map(ChildOffsets::size_class).collect())
}

fn write_non_fan(non_fan: &NonFanSplit, packer: &mut Packer) -> io::Result<()> {
    packer.numbers(&[non_fan.second.len() as u32])?;
    packer.numbers(non_fan.second.as_flattened())?;
    packer.numbers(&[non_fan.created_faces.len() as u32])?;
    packer.numbers(non_fan.created_faces.as_flattened())
}

/// Decodes a chunk of `count` updates, numbered from `first` in the file.
///
/// Updates that split a node of a chunk not loaded are kept with [`NONE`] for their parent.
pub(super) fn read(
    state: &mut DecoderState,
    bytes: &[u8],
    first: u32,
    count: usize,
) -> Result<(), ChunkError> {
    state.begin_run(first);
    let mut input = Unpacker::new(bytes)?;
    let fields = FieldStreams::read(&mut input, count)?;
    let FieldStreams { flags, errors, offsets, .. } = &fields;
    let mut next = 0;
    for at in 0..count {
        let bad = |why| ChunkError::Update { update: at, why };
        let made = state.root_count() + 2 * (first + at as u32);
        let update = fields.update(state, at, &mut next, made).map_err(bad)?;
        state.updates.push(update);
    }
    let nodes = state.root_count() + 2 * (first + count as u32);
    let start = state.updates.len() - count;
    for at in (0..count).filter(|&at| flags[at] & NON_FAN != 0) {
        let bad = ChunkError::Update { update: at, why: "the faces it creates are invalid" };
        let non_fan =
            read_non_fan(&mut input, nodes)?.ok_or(bad)?.renumbered(|node| state.local_node(node));
        state.updates[start + at].non_fan = Some(Box::new(non_fan));
    }
    if state.is_lossless() {
        read_exact(state, &mut input, start, flags)?;
    }
    if state.has_stages {
        let stages = stage_coding::read(&errors_above(errors.iter().copied()), &mut input)?;
        for (update, stage) in state.updates[start..].iter_mut().zip(stages) {
            update.stage = stage;
        }
    }
    if let Some(mut wedges) = state.wedges.take() {
        let sizes: Vec<u8> = (0..count).map(|at| offsets.offsets(at).size_class()).collect();
        let is_recorded = |at: usize| flags[at - start] & RECORDED != 0;
        let read = wedges.read_run(state, start, is_recorded, &sizes, &mut input);
        state.wedges = Some(wedges);
        read.map_err(|error| match error {
            WedgeError::Io(error) => ChunkError::Decompress(error),
            WedgeError::Invalid(why) => ChunkError::Wedges(why),
        })?;
    }
    if input.is_at_end()? { Ok(()) } else { Err(ChunkError::TrailingData) }
}

/// Fields of the updates of a chunk, one stream per field.
struct FieldStreams {
    gaps: Vec<u32>,
    flags: Vec<u8>,
    wings: [Vec<u8>; 2],
    errors: Vec<u32>,
    levels: Vec<u32>,
    offsets: OffsetStreams,
}

impl FieldStreams {
    fn read(input: &mut Unpacker<'_>, count: usize) -> Result<Self, ChunkError> {
        let gaps = input.numbers(count)?;
        let flags = input.bytes(count)?;
        let wings = [input.bytes(count)?, input.bytes(count)?];
        let (errors, levels) = read_errors(input, count)?;
        let offsets = OffsetStreams::read(input, count)?;
        Ok(Self { gaps, flags, wings, errors, levels, offsets })
    }

    /// Decodes an update without the faces of a non-fan split and its stage, or returns why it is
    /// invalid.
    ///
    /// The update splits a node numbered from `next` on and below `made`; `next` becomes the number
    /// after it.
    #[inline]
    fn update(
        &self,
        state: &DecoderState,
        at: usize,
        next: &mut u32,
        made: u32,
    ) -> Result<DetachedUpdate, &'static str> {
        let flags = self.flags[at];
        if flags & !flags_of(state) != 0 {
            return Err(UNKNOWN_FLAGS);
        }
        let parent = self.gaps[at].checked_add(*next).filter(|&parent| parent < made);
        let parent = parent.ok_or("it splits a node that does not exist yet")?;
        *next = parent + 1;
        let parent = match state.local_node(parent) {
            // A descendant of a node that is not loaded cannot be used either.
            node if node != NONE && state.creator(node).is_none_or(|up| up.parent != NONE) => node,
            _ => NONE,
        };
        let mut update = DetachedUpdate {
            parent,
            level: u16::try_from(self.levels[at]).map_err(|_| "its level is out of range")?,
            wings: [self.wings[0][at], self.wings[1][at]],
            radius: Length16::default(),
            stage: Stage::default(),
            error: error16(self.errors[at]).ok_or("its error is out of range")?,
            is_open: flags & OPEN != 0,
            fused_with_child: flags & FUSED != 0,
            non_fan: None,
            children: [Vec3::ZERO; 2],
        };
        if parent != NONE {
            self.place(state, at, &mut update)?;
        }
        Ok(update)
    }

    /// Decodes the children's positions and the radius of an update whose parent is loaded.
    #[inline]
    fn place(
        &self,
        state: &DecoderState,
        at: usize,
        update: &mut DetachedUpdate,
    ) -> Result<(), &'static str> {
        let parent = update.parent;
        let offset = self.offsets.offsets(at).decoded(&state.normal_predictor(parent));
        let children = offset.children(state.lattice, state.stored_position(parent));
        let children = children.filter(|children| state.are_finite(children));
        update.children = children.ok_or("its children are out of range")?;
        let radius =
            i64::from(offset.predicted_radius8(state.lattice)) + i64::from(self.offsets.radii[at]);
        let radius = u8::try_from(radius).map_err(|_| "its radius is out of range")?;
        update.radius = radius16(radius);
        update.trouble(state.creator(parent)).map_or(Ok(()), Err)
    }
}

/// Returns the flags that an update of this file may have.
fn flags_of(state: &DecoderState) -> u8 {
    let of_all = OPEN | FUSED | NON_FAN;
    let exact = if state.is_lossless() { EXACT[0] | EXACT[1] } else { 0 };
    of_all | exact | if state.wedges.is_some() { RECORDED } else { 0 }
}

/// Decodes the exact positions of the children that have one, for the updates from `start` on.
fn read_exact(
    state: &mut DecoderState,
    input: &mut Unpacker<'_>,
    start: usize,
    flags: &[u8],
) -> Result<(), ChunkError> {
    let of = |at: usize| {
        let children = state.children(start + at).into_iter().zip(EXACT);
        children.filter(move |(_, flag)| flags[at] & flag != 0).map(move |(child, _)| (at, child))
    };
    let nodes: Vec<_> = (0..flags.len()).flat_map(of).collect();
    let steps = Deltas::read(nodes.len(), input)?;
    for (i, (at, node)) in nodes.into_iter().enumerate() {
        // Without its parent, a child has no position to correct.
        if state.updates[start + at].parent != NONE {
            let added = state.add_exact_position(node, &steps, i);
            added.map_err(|why| ChunkError::Update { update: at, why })?;
        }
    }
    let is_lost = |at: &usize| {
        let (parent, children) = (state.updates[start + at].parent, state.children(start + at));
        let exact = (parent != NONE).then(|| state.exact_position(parent)).flatten();
        exact.is_some() && !children.iter().any(|&child| state.exact_position(child) == exact)
    };
    match (0..flags.len()).find(is_lost) {
        Some(update) => Err(ChunkError::Update {
            update,
            why: "it splits a vertex of the finest mesh, which no child continues",
        }),
        None => Ok(()),
    }
}

/// Decodes errors and levels; the caller checks their range.
fn read_errors(input: &mut Unpacker<'_>, count: usize) -> io::Result<(Vec<u32>, Vec<u32>)> {
    let [least, steps] = input.numbers(2)?[..] else { unreachable!("two numbers were requested") };
    let least_levels = input.numbers(steps as usize)?;
    let mut errors: Vec<u32> = input.numbers(count)?;
    let mut levels: Vec<u32> = input.numbers(count)?;
    for (error, level) in errors.iter_mut().zip(&mut levels) {
        let least_level = least_levels.get(*error as usize).ok_or(io::ErrorKind::InvalidData)?;
        *level = level.saturating_add(*least_level);
        *error = error.saturating_add(least);
    }
    Ok((errors, levels))
}

/// Decodes a split whose faces are not separated by wings. Its nodes, in the file's numbering, must
/// be below `nodes`.
fn read_non_fan(input: &mut Unpacker<'_>, nodes: u32) -> Result<Option<NonFanSplit>, io::Error> {
    let mut list = |size: usize| -> io::Result<Vec<u32>> {
        let count = input.numbers::<u32>(1)?[0] as usize;
        input.numbers(size * count)
    };
    let (second, created_faces) = (list(2)?, list(3)?);
    let are_made = second.iter().chain(&created_faces).all(|&node| node < nodes);
    let (second, created_faces) =
        (second.as_chunks().0.to_vec(), created_faces.as_chunks().0.to_vec());
    // An edge with more than two faces is never contracted.
    let are_faces = created_faces.len() <= 2 && created_faces.iter().all(has_three_corners);
    Ok((are_made && are_faces).then_some(NonFanSplit { second, created_faces }))
}
