//! Many small changes of buffers, sent to the GPU at once.

use std::ops::Range;

use wgpu::{Buffer, BufferUsages, CommandEncoder};

use crate::Gpu;
use crate::gpu::buffers::buffer_of;

/// Changes of buffers that are collected, and then copied from one buffer.
///
/// `Queue::write_buffer` takes a buffer for each change, which costs more than the bytes.
#[derive(Debug, Default)]
pub(super) struct Staged {
    bytes: Vec<u8>,
    copies: Vec<Copy>,
}

#[derive(Debug)]
struct Copy {
    from: Range<u64>,
    to: Buffer,
    at: u64,
}

impl Staged {
    /// Adds bytes that belong at an offset of a buffer, both multiples of four.
    pub(super) fn add(&mut self, to: &Buffer, at: u64, bytes: &[u8]) {
        let start = self.bytes.len() as u64;
        self.bytes.extend_from_slice(bytes);
        self.copies.push(Copy { from: start..self.bytes.len() as u64, to: to.clone(), at });
    }

    /// Uploads everything and records its copies, and returns the number of bytes.
    pub(super) fn record(self, gpu: &Gpu, encoder: &mut CommandEncoder) -> u64 {
        if self.bytes.is_empty() {
            return 0;
        }
        let from = buffer_of(gpu, "changes of a cut", &self.bytes, BufferUsages::COPY_SRC);
        for Copy { from: Range { start, end }, to, at } in &self.copies {
            encoder.copy_buffer_to_buffer(&from, *start, to, *at, end - start);
        }
        self.bytes.len() as u64
    }
}
