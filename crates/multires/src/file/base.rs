//! Coding of the coarsest mesh: vertices and faces, each as the difference from its predecessor.

use std::io;

use thiserror::Error;

use super::decoder_state::{DecoderState, is_finite};
use super::exact_coding::{self, Deltas};
use super::header::{Header, UNKNOWN_FLAGS};
use super::streams::{Packer, Unpacker};
use super::wedge_names;
use super::wedge_state::WedgeError;
use crate::implicit::{BaseMesh, has_three_corners};
use crate::pack::ExactPositions;

/// Reason why the coarsest mesh cannot be decoded.
#[derive(Debug, Error)]
pub(super) enum BaseError {
    /// The compressed data is malformed or ends too early.
    #[error("its compressed data is malformed or ends too early")]
    Decompress(#[from] io::Error),
    #[error("{0}")]
    Invalid(&'static str),
}

impl From<WedgeError> for BaseError {
    fn from(error: WedgeError) -> Self {
        match error {
            WedgeError::Io(error) => Self::Decompress(error),
            WedgeError::Invalid(why) => Self::Invalid(why),
        }
    }
}

pub(super) fn write(state: &DecoderState) -> io::Result<Vec<u8>> {
    let BaseMesh { positions, faces } = &state.base;
    let mut packer = Packer::new()?;
    for k in 0..3 {
        let cells = positions.iter().map(|&p| state.lattice.round(p)[k]);
        packer.signed(cells.scan(0, |last, x| Some(x - std::mem::replace(last, x))))?;
    }
    for k in 0..3 {
        let corners = faces.iter().map(|face| face[k] as i32);
        packer.signed(corners.scan(0, |last, v| Some(v - std::mem::replace(last, v))))?;
    }
    if state.is_lossless() {
        let flags = (0..state.root_count()).map(|root| state.exact_position(root).is_some().into());
        packer.bytes(&flags.collect::<Vec<u8>>())?;
        let pair =
            |root| state.exact_position(root).map(|exact| [exact, state.predicted_position(root)]);
        exact_coding::write(
            &(0..state.root_count()).filter_map(pair).collect::<Vec<_>>(),
            &mut packer,
        )?;
    }
    if let Some(wedges) = &state.wedges {
        wedge_names::write(wedges, &mut packer)?;
        wedges.write_base(state.root_count(), &mut packer)?;
    }
    packer.finish()
}

/// Decodes the coarsest mesh into a new decoder state.
pub(super) fn read(header: &Header, bytes: &[u8]) -> Result<DecoderState, BaseError> {
    let Header { about, lattice, lossless, .. } = *header;
    let (roots, faces) = (header.roots as usize, header.base_faces as usize);
    let mut input = Unpacker::new(bytes)?;
    let [x, y, z, a, b, c] = unpack(&mut input, roots, faces)?;
    let position = |i| {
        lattice
            .checked_position([x[i], y[i], z[i]])
            .filter(|&position| is_finite(&about.frame, position))
    };
    let positions: Option<Vec<_>> = (0..roots).map(position).collect();
    let positions = positions.ok_or(BaseError::Invalid("a vertex is out of range"))?;
    let corner = |v: i64| u32::try_from(v).ok().filter(|&v| (v as usize) < roots);
    let face = |i: usize| Some([corner(a[i])?, corner(b[i])?, corner(c[i])?]);
    let faces: Option<Vec<_>> = (0..faces).map(face).collect();
    let faces = faces.ok_or(BaseError::Invalid("a face refers to a missing vertex"))?;
    if !faces.iter().all(has_three_corners) {
        return Err(BaseError::Invalid("a face repeats a vertex"));
    }
    let exact = if lossless { ExactPositions::lossless() } else { ExactPositions::default() };
    let mut state = DecoderState::new(about.frame, lattice, BaseMesh { positions, faces }, exact);
    state.has_stages = about.has_stages;
    if lossless {
        read_exact(&mut state, &mut input)?;
    }
    if header.has_wedges {
        let mut wedges = wedge_names::read(&mut input)?;
        wedges.read_base(&state, &mut input)?;
        state.wedges = Some(wedges);
    }
    Ok(state)
}

/// Decodes the cells of the vertices and the corners of the faces, one list per axis or corner.
fn unpack(input: &mut Unpacker<'_>, roots: usize, faces: usize) -> io::Result<[Vec<i64>; 6]> {
    let mut all: [Vec<i64>; 6] = Default::default();
    for (k, numbers) in all.iter_mut().enumerate() {
        let steps = input.signed(if k < 3 { roots } else { faces })?;
        numbers.extend(steps.into_iter().scan(0i64, |at, step| {
            *at += i64::from(step);
            Some(*at)
        }));
    }
    Ok(all)
}

/// Decodes the exact positions of the roots that are vertices of the finest mesh.
fn read_exact(state: &mut DecoderState, input: &mut Unpacker<'_>) -> Result<(), BaseError> {
    let flags = input.bytes(state.root_count() as usize)?;
    if flags.iter().any(|&flag| flag > 1) {
        return Err(BaseError::Invalid(UNKNOWN_FLAGS));
    }
    let nodes: Vec<u32> =
        (0..state.root_count()).filter(|&root| flags[root as usize] != 0).collect();
    let steps = Deltas::read(nodes.len(), input)?;
    for (at, node) in nodes.into_iter().enumerate() {
        state.add_exact_position(node, &steps, at).map_err(BaseError::Invalid)?;
    }
    Ok(())
}
