//! Lattice: words as they are stored, and an integer shear for every 32 vertices.

use bytemuck::{Pod, Zeroable};
use meshlod::codec::{StoredLattice, StoredShear};

use super::data::SchemeData;
use super::pipelines::SchemeShader;

/// `Shear` of lattice.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct GpuShear {
    start: u32,
    middle: [i32; 3],
    spans: u32,
    slopes: u32,
    bends: u32,
    padding: u32,
}

/// Added to the bits of numbers that a single vertex has.
const SINGLE: u8 = 128;

/// Returns words and shears of lattice blocks.
pub(super) fn data<'a>(stored: &StoredLattice<'a>, faces: usize) -> SchemeData<'a> {
    let middle = stored.most.map(|most| most / 2);
    let shear = |block: &StoredShear| GpuShear::new(block, middle);
    let shears: Vec<GpuShear> = stored.blocks.iter().map(shear).collect();
    let cell = f64::from(stored.exponent).exp2();
    let place = |axis: usize| (stored.first[axis] + i64::from(middle[axis])) as f64 * cell;
    let widest = stored.blocks.iter().map(|block| block.width).max();
    let shader = match stored.blocks.iter().all(is_narrow) {
        false => SchemeShader::WideLattice,
        true => SchemeShader::Lattice { has_three_words: widest > Some(64) },
    };
    let origin = [place(0), place(1), place(2)];
    let data = SchemeData::of_bits(shader, origin, stored.words, &shears, faces);
    SchemeData { scale: [cell; 3], ..data }
}

/// Returns true if the short path decodes a block: four vertices in at most 96 bits, and heights
/// whose products fit in 31 bits and whose quotients in 22.
fn is_narrow(block: &StoredShear) -> bool {
    let [across_u, across_v, _] = block.spans().map(|span| span as i64);
    let [uu, uv, vv] = block.bends.map(|x| i64::from(x).abs());
    // A slope is at most 1.
    let v = across_v / 2 + across_u / 2 + 2;
    let u = across_u / 2 + v + 2;
    let fits = |product: i64, span: i64| product < 1 << 31 && product / (64 * span) < (1 << 21);
    let is_flat = block.bends == [0; 3];
    let is_level = fits(u * (uu * u + uv * v), across_u) && fits(vv * v * v, across_v);
    block.tuple == 4 && block.width <= 96 && (is_flat || is_level)
}

impl GpuShear {
    fn new(block: &StoredShear, middle: [i32; 3]) -> Self {
        let axis = usize::from(block.axis);
        let [x, y, z] = block.span_codes;
        let [uu, uv, vv] = block.bends.map(|bend| bend as u8);
        let width = if block.tuple == 1 { SINGLE + block.width } else { block.width };
        let away = |k: usize| block.middle[k].wrapping_sub(middle[(axis + 1 + k) % 3]);
        Self {
            // Checked before: 2^32 bits are the most.
            start: block.start as u32,
            middle: [away(0), away(1), away(2)],
            spans: u32::from_le_bytes([x, y, z, block.axis]),
            slopes: u32::from_le_bytes(block.slopes.map(|slope| slope as u8)),
            bends: u32::from_le_bytes([uu, uv, vv, width]),
            padding: 0,
        }
    }
}
