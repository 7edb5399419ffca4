//! Buffers and uploads: large ones in slices, so that frames go on while a large mesh is sent.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use bytemuck::Pod;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{Buffer, BufferDescriptor, BufferUsages, PollType};

use super::Gpu;

/// Bytes per slice. A frame waits for one slice at most: a few milliseconds, on a bus and in
/// software.
const SLICE: usize = 16 << 20;

/// Size of a buffer without contents, since no buffer may be empty.
const LEAST_BYTES: u64 = 16;

/// Creates a buffer with contents; an empty one gets 16 bytes.
pub(crate) fn buffer_of(gpu: &Gpu, label: &str, contents: &[u8], usage: BufferUsages) -> Buffer {
    if contents.is_empty() {
        return blank_buffer(gpu, label, LEAST_BYTES, usage);
    }
    let descriptor = BufferInitDescriptor { label: Some(label), contents, usage };
    gpu.device.create_buffer_init(&descriptor)
}

/// Creates a buffer of zeros, of a size in bytes.
pub(crate) fn blank_buffer(gpu: &Gpu, label: &str, size: u64, usage: BufferUsages) -> Buffer {
    let label = Some(label);
    gpu.device.create_buffer(&BufferDescriptor { label, size, usage, mapped_at_creation: false })
}

/// Creates a uniform buffer, whose contents can be replaced.
pub(crate) fn uniform_of<T: Pod>(gpu: &Gpu, label: &str, contents: &T) -> Buffer {
    let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
    buffer_of(gpu, label, bytemuck::bytes_of(contents), usage)
}

/// Creates a buffer with contents, sent in slices if they are large.
///
/// Each slice is sent when the GPU is done with the one before, so nothing that another thread
/// draws waits for more than one. Blocks this thread meanwhile.
pub(crate) fn upload_sliced(
    gpu: &Gpu,
    label: &str,
    contents: &[u8],
    usage: BufferUsages,
) -> Buffer {
    if contents.len() <= SLICE {
        return buffer_of(gpu, label, contents, usage);
    }
    let size = contents.len().next_multiple_of(4) as u64;
    let buffer = blank_buffer(gpu, label, size, usage | BufferUsages::COPY_DST);
    for (slice, at) in contents.chunks(SLICE).zip((0u64..).step_by(SLICE)) {
        gpu.queue.write_buffer(&buffer, at, slice);
        settle(gpu);
    }
    buffer
}

/// Submits all writes and waits until the GPU is done with them, without a lock that other threads
/// need to submit.
fn settle(gpu: &Gpu) {
    let done = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&done);
    gpu.queue.submit([]);
    gpu.queue.on_submitted_work_done(move || flag.store(true, Ordering::Release));
    while !done.load(Ordering::Acquire) {
        // A device that was lost never gets done.
        if gpu.is_lost() || gpu.device.poll(PollType::Poll).is_err() {
            return;
        }
        std::thread::sleep(Duration::from_micros(500));
    }
}
