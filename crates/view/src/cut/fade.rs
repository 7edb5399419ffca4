//! Triangles that appear and disappear in a dithered transition.

use std::ops::Range;

use wgpu::{Buffer, BufferUsages};

use super::list::{EMPTY, TriangleList};
use super::slots::CutPatch;
use crate::Gpu;
use crate::gpu::buffers::buffer_of;

/// Old and new triangles of a transition, and the changes of the lists at its end.
#[derive(Debug)]
pub(super) struct Fade {
    /// Old triangles, then new ones.
    pub(super) sides: [FadeSide; 2],
    pub(super) changes: Vec<CutPatch>,
}

/// Triangles of one side of a transition, group by group.
#[derive(Debug)]
pub(super) struct FadeSide {
    pub(super) buffer: Buffer,
    /// Indices of each group's triangles.
    pub(super) ranges: Vec<(u32, Range<u32>)>,
}

impl Fade {
    /// Uploads the old and the new triangles of patches, which are in the order of groups.
    pub(super) fn new(gpu: &Gpu, lists: &[TriangleList], changes: &[CutPatch]) -> Self {
        let old = |patch: &CutPatch| lists[patch.group as usize].at(patch.slot);
        let new = |patch: &CutPatch| patch.vertices.unwrap_or(EMPTY);
        let sides = [FadeSide::new(gpu, changes, old), FadeSide::new(gpu, changes, new)];
        Self { sides, changes: changes.to_vec() }
    }

    /// Returns the size of both buffers in bytes.
    pub(super) fn bytes(&self) -> u64 {
        let indices = self.sides.iter().flat_map(|side| &side.ranges);
        indices.map(|(_, range)| 4 * range.len() as u64).sum()
    }
}

impl FadeSide {
    fn new(gpu: &Gpu, changes: &[CutPatch], triangle: impl Fn(&CutPatch) -> [u32; 3]) -> Self {
        let (mut triangles, mut ranges) = (Vec::new(), Vec::new());
        for patches in changes.chunk_by(|a, b| a.group == b.group) {
            let start = 3 * triangles.len() as u32;
            triangles.extend(patches.iter().map(&triangle).filter(|t| *t != EMPTY));
            ranges.push((patches[0].group, start..3 * triangles.len() as u32));
        }
        let bytes = bytemuck::cast_slice(&triangles);
        Self { buffer: buffer_of(gpu, "fade", bytes, BufferUsages::INDEX), ranges }
    }
}
