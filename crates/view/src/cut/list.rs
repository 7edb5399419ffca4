//! Index buffer of the triangles of one group.

use std::sync::OnceLock;

use wgpu::{BindGroup, Buffer, BufferUsages};

use super::dirty::DirtyRanges;
use super::groups::Group;
use super::slots::CutPatch;
use super::staged::Staged;
use crate::Gpu;
use crate::gpu::buffers::{blank_buffer, buffer_of};

/// Triangles of a group by slot, on the GPU.
#[derive(Debug)]
pub(super) struct TriangleList {
    pub(super) group: Group,
    pub(super) buffer: Buffer,
    /// Copy of the buffer; empty slots have no extent.
    pub(super) slots: Vec<[u32; 3]>,
    /// Bindings for drawing face by face, made on first use; `None` if a buffer is too large for
    /// that.
    pub(super) storage: OnceLock<Option<BindGroup>>,
}

/// Slot without a triangle.
pub(super) const EMPTY: [u32; 3] = [0; 3];

const USAGE: BufferUsages =
    BufferUsages::INDEX.union(BufferUsages::STORAGE).union(BufferUsages::COPY_DST);

impl TriangleList {
    /// Creates a list with room for a number of triangles.
    pub(super) fn new(gpu: &Gpu, group: Group, room: usize) -> Self {
        let buffer = blank_buffer(gpu, "cut", (12 * room as u64).max(16), USAGE);
        Self { group, buffer, slots: Vec::new(), storage: OnceLock::new() }
    }

    /// Returns the triangle in a slot; an empty one for a slot that does not exist.
    pub(super) fn at(&self, slot: u32) -> [u32; 3] {
        self.slots.get(slot as usize).copied().unwrap_or(EMPTY)
    }

    /// Writes triangles into slots, and stages the changed ranges. Returns the bytes sent at once,
    /// because the buffer had to grow.
    pub(super) fn write(&mut self, gpu: &Gpu, patches: &[CutPatch], staged: &mut Staged) -> u64 {
        let mut dirty = DirtyRanges::default();
        for patch in patches {
            let slot = patch.slot as usize;
            if slot >= self.slots.len() {
                self.slots.resize(slot + 1, EMPTY);
            }
            self.slots[slot] = patch.vertices.unwrap_or(EMPTY);
            dirty.add(patch.slot);
        }
        if 12 * self.slots.len() as u64 > self.buffer.size() {
            return self.grow(gpu);
        }
        for range in dirty.ranges() {
            let bytes = bytemuck::cast_slice(&self.slots[range.clone()]);
            staged.add(&self.buffer, 12 * range.start as u64, bytes);
        }
        0
    }

    /// Makes a larger buffer of the slots, and returns its size.
    fn grow(&mut self, gpu: &Gpu) -> u64 {
        let length = self.slots.len();
        self.slots.resize(length + length / 2, EMPTY);
        self.buffer = buffer_of(gpu, "cut", bytemuck::cast_slice(&self.slots), USAGE);
        self.slots.truncate(length);
        // It is bound to the old buffer.
        self.storage = OnceLock::new();
        self.buffer.size()
    }
}
