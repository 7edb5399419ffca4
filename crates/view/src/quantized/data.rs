//! Positions of a scheme, as the GPU takes them.

use std::borrow::Cow;
use std::ops::Range;

use wgpu::{Buffer, BufferUsages};

use super::pipelines::SchemeShader;
use crate::gpu::buffers::buffer_of;
use crate::{Gpu, ViewError};

/// Positions of a scheme, as the GPU takes them.
pub(super) struct SchemeData<'a> {
    pub origin: [f64; 3],
    /// Sides of a cell.
    pub scale: [f64; 3],
    pub shader: SchemeShader,
    /// Bytes that vertices are fetched from; `None` if shaders read their bits.
    pub fetched: Option<Cow<'a, [u8]>>,
    /// Stored words, and headers of parts or blocks.
    pub storages: [Cow<'a, [u8]>; 2],
    /// Faces of each instance.
    pub runs: Vec<Range<u32>>,
    /// Offset of each part from the origin in cells, if there are parts.
    pub offsets: Option<Vec<[i32; 4]>>,
}

/// Most bytes of stored bits: shaders count bits in 32 bits.
const MOST_WORD_BYTES: u64 = 1 << 29;

impl<'a> SchemeData<'a> {
    /// Returns positions whose stored bits shaders read: words and headers, with all faces in one
    /// instance.
    pub fn of_bits(
        shader: SchemeShader,
        origin: [f64; 3],
        words: &'a [u64],
        headers: &[impl bytemuck::Pod],
        faces: usize,
    ) -> Self {
        Self {
            origin,
            scale: [1.0; 3],
            shader,
            fetched: None,
            storages: [
                Cow::Borrowed(bytemuck::cast_slice(words)),
                Cow::Owned(bytemuck::cast_slice(headers).to_vec()),
            ],
            runs: one_run(faces),
            offsets: None,
        }
    }

    /// Fails if the positions are beyond the limits of the GPU or of the shaders.
    pub fn check(&self, gpu: &Gpu) -> Result<(), ViewError> {
        let fetched = self.fetched.as_deref().map_or(0, <[u8]>::len);
        gpu.check_buffer("the compressed vertices", fetched as u64)?;
        let [words, headers] = self.storages.each_ref().map(|bytes| bytes.len() as u64);
        let what = "the bits of compressed positions";
        gpu.check_storage(what, words)?;
        if words > MOST_WORD_BYTES {
            return Err(ViewError::TooLarge { what, needed: words, limit: MOST_WORD_BYTES });
        }
        gpu.check_storage("the headers of compressed positions", headers)
    }

    /// Returns the size of vertices and headers, in bytes.
    pub fn bytes(&self) -> usize {
        let fetched = self.fetched.as_deref().map_or(0, <[u8]>::len);
        fetched + self.storages.iter().map(|bytes| bytes.len()).sum::<usize>()
    }
}

/// Returns the range of all faces, as one instance.
pub(super) fn one_run(faces: usize) -> Vec<Range<u32>> {
    std::iter::once(0..faces as u32).collect()
}

/// Creates a storage buffer that is large enough for a binding of any of the shaders.
pub(super) fn storage_of(gpu: &Gpu, bytes: &[u8], usage: BufferUsages) -> Buffer {
    const LEAST: usize = 64;
    let mut padded = Cow::Borrowed(bytes);
    if bytes.len() < LEAST {
        padded.to_mut().resize(LEAST, 0);
    }
    buffer_of(gpu, "compressed positions", &padded, BufferUsages::STORAGE | usage)
}
