//! Coding of what a file says about its wedges as a whole: attribute layers, materials and objects.

use std::io;

use super::layer_coding::{EXPONENTS, LayerCoding, Numbers};
use super::streams::{Packer, Unpacker};
use super::wedge_state::{WedgeError, WedgeState};
use crate::wedges::WedgeLabels;
use meshlod_mesh::LayerKind;
use meshlod_mesh::octahedral::DirectionCode;

/// Limits that keep a short file from asking for much memory.
const MAX_LAYERS: u32 = 4096;
const MAX_WIDTH: u32 = 64;

pub(super) fn write(wedges: &WedgeState, packer: &mut Packer) -> io::Result<()> {
    let is_wide = |layer: &LayerCoding| layer.width > MAX_WIDTH as usize;
    if wedges.coding.len() > MAX_LAYERS as usize || wedges.coding.iter().any(is_wide) {
        let most = format!(
            "the mesh has more than {MAX_LAYERS} attributes, or one of more than {MAX_WIDTH} values"
        );
        return Err(io::Error::new(io::ErrorKind::InvalidInput, most));
    }
    packer.numbers(&[wedges.coding.len() as u32])?;
    for layer in &wedges.coding {
        let (kind, set) = layer.kind.tag();
        let (coding, parameter) = match layer.numbers {
            Numbers::Bits => (0, 0),
            Numbers::Steps(exponent) => (1, (exponent - EXPONENTS.start()) as u32),
            Numbers::Directions(code) => (2, code.bits()),
        };
        packer.numbers(&[kind.into(), set.into(), layer.width as u32, coding, parameter])?;
        write_text(&layer.name, packer)?;
    }
    let WedgeLabels { names, pairs, .. } = &wedges.labels;
    for names in names {
        packer.numbers(&[names.as_ref().map_or(0, |names| names.len() as u32 + 1)])?;
        names.iter().flatten().try_for_each(|name| write_text(name, packer))?;
    }
    packer.numbers(&[pairs.len() as u32])?;
    packer.numbers(pairs.as_flattened())
}

/// Decodes what [`write`] wrote, without any wedges yet.
pub(super) fn read(input: &mut Unpacker<'_>) -> Result<WedgeState, WedgeError> {
    let layers = one(input)?;
    if layers > MAX_LAYERS {
        return Err(WedgeError::Invalid("it has too many attribute layers"));
    }
    let coding = (0..layers).map(|_| read_layer(input)).collect::<Result<Vec<_>, _>>()?;
    let names = [read_names(input)?, read_names(input)?];
    let pairs = one(input)? as usize;
    let pairs: Vec<[u32; 2]> = input.numbers(2 * pairs)?.as_chunks().0.to_vec();
    let is_label = |which: usize, label: u32| {
        let count = names[which].as_ref().map_or(1, Vec::len);
        (label as usize) < count
    };
    let are_labels = pairs.iter().all(|pair| is_label(0, pair[0]) && is_label(1, pair[1]));
    if pairs.is_empty() || !are_labels {
        return Err(WedgeError::Invalid("a material or object is out of range"));
    }
    Ok(WedgeState::new(coding, WedgeLabels { names, pairs, of_wedges: Vec::new() }))
}

fn read_layer(input: &mut Unpacker<'_>) -> Result<LayerCoding, WedgeError> {
    let bad = WedgeError::Invalid("an attribute layer is invalid");
    let [kind, set, width, coding, parameter] = input.numbers::<u32>(5)?[..] else {
        unreachable!("five numbers were requested")
    };
    let name = read_text(input)?;
    let tag = u8::try_from(kind).ok().zip(u8::try_from(set).ok());
    let kind = tag.and_then(|(kind, set)| LayerKind::from_tag(kind, set));
    let Some(kind) = kind.filter(|kind| {
        (1..=MAX_WIDTH).contains(&width) && kind.width().is_none_or(|own| own == width as usize)
    }) else {
        return Err(bad);
    };
    let steps = i16::try_from(parameter).ok().and_then(|n| n.checked_add(*EXPONENTS.start()));
    let code = DirectionCode::of_bits(parameter).filter(|_| kind.is_direction());
    let numbers = match (coding, steps, code) {
        (0, ..) => Numbers::Bits,
        (1, Some(exponent), _) if EXPONENTS.contains(&exponent) => Numbers::Steps(exponent),
        (2, _, Some(code)) => Numbers::Directions(code),
        _ => return Err(bad),
    };
    Ok(LayerCoding { kind, name, width: width as usize, numbers })
}

fn read_names(input: &mut Unpacker<'_>) -> Result<Option<Vec<String>>, WedgeError> {
    let Some(count) = one(input)?.checked_sub(1) else { return Ok(None) };
    let mut names = Vec::new();
    for _ in 0..count {
        names.push(read_text(input)?);
    }
    Ok(Some(names))
}

fn write_text(text: &str, packer: &mut Packer) -> io::Result<()> {
    packer.numbers(&[text.len() as u32])?;
    packer.bytes(text.as_bytes())
}

fn read_text(input: &mut Unpacker<'_>) -> Result<String, WedgeError> {
    let length = one(input)? as usize;
    String::from_utf8(input.bytes(length)?).map_err(|_| WedgeError::Invalid("a name is not UTF-8"))
}

fn one(input: &mut Unpacker<'_>) -> io::Result<u32> {
    Ok(input.numbers(1)?[0])
}
