//! Uploads in slices, so that frames go on while a large mesh is sent.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use wgpu::{Buffer, BufferDescriptor, BufferUsages, PollType};

use crate::Gpu;
use crate::renderer::buffer_of;

/// Bytes that are sent at a time. Frames wait for one slice at most: a few milliseconds, on a bus and
/// in software.
const SLICE: usize = 16 << 20;

/// Creates a buffer with contents.
///
/// What is larger than a slice is sent slice by slice, each when the GPU is done with the one before:
/// then nothing that another thread draws waits for more than one. Blocks this thread meanwhile.
pub(crate) fn upload_sliced(
    gpu: &Gpu,
    label: &str,
    contents: &[u8],
    usage: BufferUsages,
) -> Buffer {
    if contents.len() <= SLICE {
        return buffer_of(gpu, label, contents, usage);
    }
    let buffer = gpu.device.create_buffer(&BufferDescriptor {
        label: Some(label),
        size: contents.len().next_multiple_of(4) as u64,
        usage: usage | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    for (slice, at) in contents.chunks(SLICE).zip((0u64..).step_by(SLICE)) {
        gpu.queue.write_buffer(&buffer, at, slice);
        settle(gpu);
    }
    buffer
}

/// Submits what was written, and waits until the GPU is done with it, without holding what other
/// threads need to submit.
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
