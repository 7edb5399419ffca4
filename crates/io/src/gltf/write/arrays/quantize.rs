//! Quantization of positions and attributes to the integer types that `KHR_mesh_quantization`
//! allows.

use meshlod_mesh::LayerKind;

use super::blob::{Blob, Part, Usage};
use crate::gltf::document::component;
use crate::gltf::write::arrays::blob::{extent, floats};
use crate::gltf::write::quantized::grid::QuantizationGrid;
use crate::gltf::write::settings::Compression;
use crate::meshopt::{Filter, encode_exponential, encode_octahedral};

/// Builds an array of normalised integers, each element padded to a multiple of four bytes.
fn integers(shape: &'static str, component: u32, count: usize, values: &[i32]) -> Blob {
    let width = values.len() / count.max(1);
    let size = if matches!(component, component::I8 | component::U8) { 1 } else { 2 };
    let stride = (width * size).next_multiple_of(4);
    let mut bytes = Vec::with_capacity(count * stride);
    for element in values.chunks_exact(width.max(1)) {
        for value in element {
            bytes.extend_from_slice(&value.to_le_bytes()[..size]);
        }
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    Blob {
        component,
        shape,
        normalized: true,
        count,
        bytes,
        stride: (stride != width * size).then_some(stride),
        extent: None,
        usage: Usage::Vertices,
        part: Part::Attributes,
        filter: Filter::None,
    }
}

/// Quantizes positions to grid cells; also returns the largest distance that one moved.
pub(crate) fn positions(points: &[[f64; 3]], grid: &QuantizationGrid) -> (Blob, f64) {
    let cells: Vec<[u16; 3]> = points.iter().map(|&point| grid.quantized(point)).collect();
    let moved = |(cell, point): (&[u16; 3], &[f64; 3])| {
        let place = grid.place(*cell);
        (0..3).map(|axis| (place[axis] - point[axis]).powi(2)).sum::<f64>().sqrt()
    };
    let error = cells.iter().zip(points).map(moved).fold(0.0, f64::max);
    let values: Vec<i32> = cells.as_flattened().iter().map(|&x| i32::from(x)).collect();
    let component = if grid.most <= 255 { component::U8 } else { component::U16 };
    let floats: Vec<[f32; 3]> = cells.iter().map(|cell| cell.map(f32::from)).collect();
    let blob = Blob {
        normalized: false,
        extent: Some(extent(&floats)),
        part: Part::Positions,
        ..integers("VEC3", component, cells.len(), &values)
    };
    (blob, error)
}

/// Quantizes the deltas of a morph target to whole cells of the position grid; keeps fractions as
/// floats if one exceeds 16 bits.
pub(crate) fn deltas(deltas: &[[f32; 3]], grid: &QuantizationGrid) -> Blob {
    let in_cells = |&x: &f32| f64::from(x) / grid.cell;
    let values: Vec<f64> = deltas.as_flattened().iter().map(in_cells).collect();
    let most = f64::from(i16::MAX);
    if values.iter().any(|x| x.abs() > most) {
        let values: Vec<f32> = values.iter().map(|&x| x as f32).collect();
        let extent = Some(extent(values.as_chunks().0));
        return Blob { extent, ..floats("VEC3", deltas.len(), &values) };
    }
    let whole: Vec<i32> = values.iter().map(|x| x.round() as i32).collect();
    let floats: Vec<f32> = whole.iter().map(|&x| x as f32).collect();
    Blob {
        normalized: false,
        extent: Some(extent(floats.as_chunks().0)),
        ..integers("VEC3", component::I16, deltas.len(), &whole)
    }
}

/// Quantizes a layer to integers or to floats with fewer bits; `None` if it stays unchanged.
pub(crate) fn layer(
    kind: LayerKind,
    width: usize,
    values: &[f32],
    compression: &Compression,
) -> Option<Blob> {
    match kind {
        LayerKind::Normal | LayerKind::Tangent => Some(directions(width, values, compression)),
        LayerKind::Uv(_) if all_in_unit(values) => Some(uvs(values, compression.uv_bits)),
        LayerKind::Uv(_) if compression.meshopt => {
            let bytes = encode_exponential(values, 0.5f64.powi(compression.uv_bits as i32))?;
            let shape = integers("VEC2", component::F32, 0, &[]);
            let (count, filter) = (values.len() / 2, Filter::Exponential);
            Some(Blob { normalized: false, count, bytes, filter, ..shape })
        }
        LayerKind::Color(_) if all_in_unit(values) => {
            let shape = if width == 3 { "VEC3" } else { "VEC4" };
            let bytes: Vec<i32> = values.iter().map(|x| (x * 255.0).round() as i32).collect();
            Some(integers(shape, component::U8, values.len() / width, &bytes))
        }
        _ => None,
    }
}

pub(crate) fn all_in_unit(values: &[f32]) -> bool {
    values.iter().all(|x| (0.0..=1.0).contains(x))
}

/// Quantizes normals, or tangents with their handedness.
fn directions(width: usize, values: &[f32], compression: &Compression) -> Blob {
    let shape = if width == 3 { "VEC3" } else { "VEC4" };
    let small = compression.normal_bits <= 8;
    let (component, greatest) =
        if small { (component::I8, 127.0) } else { (component::I16, 32767.0) };
    let whole: Vec<i32> =
        values.iter().map(|x| (x.clamp(-1.0, 1.0) * greatest).round() as i32).collect();
    let plain = integers(shape, component, values.len() / width, &whole);
    if !compression.meshopt {
        return plain;
    }
    let four = |e: &[f32]| [e[0], e[1], e[2], e.get(3).copied().unwrap_or(0.0)];
    let directions: Vec<[f32; 4]> = values.chunks_exact(width).map(four).collect();
    let bytes = encode_octahedral(&directions, compression.normal_bits);
    Blob { bytes, filter: Filter::Octahedral, ..plain }
}

/// Quantizes texture coordinates in [0, 1]; unused low bits are zero.
fn uvs(values: &[f32], bits: u32) -> Blob {
    let (component, all) = if bits <= 8 { (component::U8, 8) } else { (component::U16, 16) };
    let greatest = f64::from((1u32 << all) - 1);
    let step = f64::from(1u32 << (all - bits));
    let whole = |&x: &f32| ((f64::from(x) * greatest / step).round() * step).min(greatest) as i32;
    integers("VEC2", component, values.len() / 2, &values.iter().map(whole).collect::<Vec<_>>())
}
