//! Blocks: words as they are stored, and a matrix for every 32 vertices.

use bytemuck::{Pod, Zeroable};
use meshlod::codec::{StoredBlock, StoredBlocks};

use super::data::SchemeData;
use super::pipelines::SchemeShader;

/// `Block` of blocks.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct GpuBlock {
    u: [f32; 3],
    start: u32,
    v: [f32; 3],
    widths: u32,
    w: [f32; 3],
    padding: u32,
    first: [f32; 3],
    padding_too: u32,
}

/// Returns words and matrices of blocks.
pub(super) fn data<'a>(stored: &StoredBlocks<'a>, faces: usize) -> SchemeData<'a> {
    let blocks: Vec<GpuBlock> = stored.blocks.iter().map(GpuBlock::new).collect();
    let shader = SchemeShader::Blocks { is_wide: !stored.blocks.iter().all(is_narrow) };
    SchemeData::of_bits(shader, stored.centre, stored.words, &blocks, faces)
}

/// Returns true if the short path decodes a block: pairs of at most 31 bits an axis and 64 in all.
fn is_narrow(block: &StoredBlock) -> bool {
    let bits = block.widths.map(u32::from);
    bits.iter().all(|&width| width <= 31) && bits.iter().sum::<u32>() <= 64
}

impl GpuBlock {
    fn new(block: &StoredBlock) -> Self {
        let [u, v, w] = block.sides.map(|side| side.map(|x| x as f32));
        let [x, y, z] = block.widths;
        Self {
            u,
            // Checked before: 2^32 bits are the most.
            start: block.start as u32,
            v,
            widths: u32::from_le_bytes([x, y, z, 0]),
            w,
            padding: 0,
            first: block.first.map(|x| x as f32),
            padding_too: 0,
        }
    }
}
