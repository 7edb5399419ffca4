//! Meshopt mode 0: elements of any type, stored byte by byte as differences from the element
//! before.
//!
//! Up to 256 elements form a block. Each byte position of the element has its own plane of
//! differences in a block, in groups of 16 that each use as many bits as they need.

use super::stream::{Malformed, Stream};

/// Elements per group.
const GROUP: usize = 16;
/// Maximum number of elements per block.
const MOST: usize = 256;
/// Header byte of version 0; version 1 is one higher.
const HEADER: u8 = 0xa0;
/// Minimum bytes of the tail, for versions 0 and 1.
const TAILS: [usize; 2] = [32, 24];

/// Bit widths that a group can choose from in version 0.
const CHOICES_0: [u32; 4] = [0, 2, 4, 8];
/// Bit widths in version 1, by the control mode of the plane.
const CHOICES_1: [[u32; 4]; 2] = [[0, 1, 2, 4], [1, 2, 4, 8]];

/// Returns the number of elements per block.
fn block_length(stride: usize) -> usize {
    ((8192 / stride) & !(GROUP - 1)).min(MOST)
}

/// Decodes `count` elements of `stride` bytes.
pub(super) fn decode(stream: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, Malformed> {
    let version = match stream.first() {
        Some(&header) if header == HEADER || header == HEADER + 1 => header - HEADER,
        Some(&header) => {
            let reason = format!("header {header:#04x}; attribute streams begin with 0xa0 or 0xa1");
            return Err(Malformed::new(0, reason));
        }
        None => return Err(Malformed::new(0, "the stream is empty")),
    };
    let modes = if version == 0 { 0 } else { stride / 4 };
    let tail = (stride + modes).max(TAILS[usize::from(version)]);
    let (_, mut data, tail) = Stream::split(stream, tail)?;
    let (baseline, modes) = tail[tail.len() - stride - modes..].split_at(stride);
    let channels = channels(modes, stride).map_err(|reason| data.wrong(reason))?;
    check_length(&data, count, stride, version)?;
    let mut bytes = vec![0; count * stride];
    let mut last = baseline.to_vec();
    for block in bytes.chunks_mut(block_length(stride) * stride) {
        decode_block(&mut data, version, &channels, &mut last, block)?;
    }
    data.finish()?;
    Ok(bytes)
}

/// Checks that the stream can hold the planes of all blocks, even at their smallest.
fn check_length(
    data: &Stream<'_>,
    count: usize,
    stride: usize,
    version: u8,
) -> Result<(), Malformed> {
    let block = block_length(stride);
    let least = |elements: usize| match version {
        0 => stride * elements.div_ceil(4 * GROUP),
        _ => stride / 4,
    };
    let rest = Some(count % block).filter(|&rest| rest > 0).map_or(0, least);
    let needed = (count / block).saturating_mul(least(block)).saturating_add(rest);
    if data.left() < needed || count.checked_mul(stride).is_none() {
        let left = data.left();
        let reason = format!("{left} bytes are too few for {count} elements of {stride} bytes");
        return Err(data.wrong(reason));
    }
    Ok(())
}

/// Prediction of four adjacent bytes from those of the element before.
#[derive(Clone, Copy)]
enum Channel {
    Bytes,
    Shorts,
    /// XOR, rotated left by this many bits.
    Words(u32),
}

fn channels(modes: &[u8], stride: usize) -> Result<Vec<Channel>, String> {
    if modes.is_empty() {
        return Ok(vec![Channel::Bytes; stride / 4]);
    }
    let channel = |&mode: &u8| match (mode & 15, mode >> 4) {
        (0, 0) => Ok(Channel::Bytes),
        (1, 0) => Ok(Channel::Shorts),
        (2, turn) => Ok(Channel::Words(u32::from(turn))),
        _ => Err(format!("unknown channel mode {mode:#04x}")),
    };
    modes.iter().map(channel).collect()
}

/// Decodes one block, whose length gives its number of elements; `last` is the element before it.
fn decode_block(
    data: &mut Stream<'_>,
    version: u8,
    channels: &[Channel],
    last: &mut [u8],
    block: &mut [u8],
) -> Result<(), Malformed> {
    let stride = last.len();
    let count = block.len() / stride;
    let controls = if version == 0 { &[][..] } else { data.take(stride / 4)? };
    let mut planes = [[0; MOST]; 4];
    for (c, (&channel, last)) in channels.iter().zip(last.as_chunks_mut().0).enumerate() {
        for (k, plane) in planes.iter_mut().enumerate() {
            let control = controls.get(c).map(|control| control >> (2 * k) & 3);
            read_plane(data, control, &mut plane[..count.next_multiple_of(GROUP)], count)?;
        }
        for (i, element) in block.chunks_exact_mut(stride).enumerate() {
            *last = apply_difference(*last, planes.map(|plane| plane[i]), channel);
            element[4 * c..4 * c + 4].copy_from_slice(last);
        }
    }
    Ok(())
}

fn read_plane(
    data: &mut Stream<'_>,
    control: Option<u8>,
    plane: &mut [u8],
    count: usize,
) -> Result<(), Malformed> {
    let choices = match control {
        None => CHOICES_0,
        Some(mode @ (0 | 1)) => CHOICES_1[usize::from(mode)],
        Some(2) => {
            plane.fill(0);
            return Ok(());
        }
        Some(_) => {
            plane[..count].copy_from_slice(data.take(count)?);
            return Ok(());
        }
    };
    let groups = plane.len() / GROUP;
    let header = data.take(groups.div_ceil(4))?;
    for (g, group) in plane.as_chunks_mut().0.iter_mut().enumerate() {
        let choice = header[g / 4] >> (2 * (g % 4)) & 3;
        read_group(data, choices[usize::from(choice)], group)?;
    }
    Ok(())
}

fn read_group(data: &mut Stream<'_>, bits: u32, group: &mut [u8; GROUP]) -> Result<(), Malformed> {
    match bits {
        0 => group.fill(0),
        8 => group.copy_from_slice(data.take(GROUP)?),
        _ => {
            let packed = data.take(2 * bits as usize)?;
            let per_byte = 8 / bits as usize;
            let sentinel = (1u8 << bits) - 1;
            for (i, value) in group.iter_mut().enumerate() {
                let (byte, at) = (packed[i / per_byte], (i % per_byte) as u32);
                // Single bits are packed from the lowest up, pairs and nibbles from the highest
                // down.
                let shift = if bits == 1 { at } else { 8 - bits * (at + 1) };
                *value = byte >> shift & sentinel;
                if *value == sentinel {
                    *value = data.byte()?;
                }
            }
        }
    }
    Ok(())
}

/// Applies the differences of four bytes to those of the element before.
fn apply_difference(last: [u8; 4], difference: [u8; 4], channel: Channel) -> [u8; 4] {
    match channel {
        Channel::Bytes => std::array::from_fn(|k| {
            let d = difference[k];
            last[k].wrapping_add((d >> 1) ^ 0u8.wrapping_sub(d & 1))
        }),
        Channel::Shorts => {
            let short = |bytes: [u8; 4], k| u16::from_le_bytes([bytes[k], bytes[k + 1]]);
            let next = |k| {
                let d = short(difference, k);
                short(last, k).wrapping_add((d >> 1) ^ 0u16.wrapping_sub(d & 1)).to_le_bytes()
            };
            let ([a, b], [c, d]) = (next(0), next(2));
            [a, b, c, d]
        }
        Channel::Words(turn) => {
            let difference = u32::from_le_bytes(difference).rotate_left(turn);
            (u32::from_le_bytes(last) ^ difference).to_le_bytes()
        }
    }
}

/// Compresses vertex elements of `stride` bytes each (a multiple of 4 up to 256) as a version 0
/// meshopt stream.
///
/// Bytes after the last whole element are dropped. The stream takes at most one byte for the
/// header, 9 for each 8 of the elements rounded up to 16, and 256 for the tail. Cost: O(bytes).
///
/// # Panics
/// If `stride` is not a multiple of 4 from 4 to 256.
pub fn encode(bytes: &[u8], stride: usize) -> Vec<u8> {
    assert!(stride > 0 && stride <= 256 && stride.is_multiple_of(4), "a stride of {stride}");
    let mut out = vec![HEADER];
    let mut last = bytes.get(..stride).unwrap_or(&[0; 256][..stride]).to_vec();
    let baseline = last.clone();
    let whole = &bytes[..bytes.len() / stride * stride];
    for block in whole.chunks(block_length(stride) * stride) {
        for (k, last) in last.iter_mut().enumerate() {
            write_plane(&mut out, block[k..].iter().step_by(stride), last);
        }
    }
    out.resize(out.len() + TAILS[0].saturating_sub(stride), 0);
    out.extend_from_slice(&baseline);
    out
}

fn write_plane<'a>(out: &mut Vec<u8>, plane: impl Iterator<Item = &'a u8>, last: &mut u8) {
    let mut differences: Vec<u8> = plane
        .map(|&byte| {
            let d = byte.wrapping_sub(std::mem::replace(last, byte)) as i8;
            ((d << 1) ^ (d >> 7)) as u8
        })
        .collect();
    differences.resize(differences.len().next_multiple_of(GROUP), 0);
    let groups = differences.as_chunks::<GROUP>().0;
    let header = out.len();
    out.resize(header + groups.len().div_ceil(4), 0);
    for (g, group) in groups.iter().enumerate() {
        let choice = (0..4).min_by_key(|&choice| size(group, CHOICES_0[choice])).unwrap_or(3);
        out[header + g / 4] |= (choice as u8) << (2 * (g % 4));
        write_group(out, CHOICES_0[choice], group);
    }
}

/// Returns the number of bytes that a group takes with a given bit width.
fn size(group: &[u8; GROUP], bits: u32) -> usize {
    match bits {
        0 if group.iter().any(|&value| value != 0) => usize::MAX,
        0 => 0,
        8 => GROUP,
        _ => {
            let sentinel = (1u8 << bits) - 1;
            2 * bits as usize + group.iter().filter(|&&value| value >= sentinel).count()
        }
    }
}

fn write_group(out: &mut Vec<u8>, bits: u32, group: &[u8; GROUP]) {
    match bits {
        0 => {}
        8 => out.extend_from_slice(group),
        _ => {
            let sentinel = (1u8 << bits) - 1;
            for some in group.chunks(8 / bits as usize) {
                out.push(some.iter().fold(0, |byte, &v| byte << bits | v.min(sentinel)));
            }
            out.extend(group.iter().filter(|&&value| value >= sentinel));
        }
    }
}
