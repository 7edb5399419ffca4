//! Buffers of the GPU read back.

use wgpu::{Buffer, BufferUsages, MapMode};

use super::Gpu;
use super::buffers::blank_buffer;
use crate::ViewError;

/// Reads the first bytes of a buffer, after all work submitted before. It must be a source of
/// copies, and the number of bytes a multiple of four.
pub(crate) fn read_buffer(gpu: &Gpu, from: &Buffer, bytes: u64) -> Result<Vec<u8>, ViewError> {
    if bytes == 0 {
        return Ok(Vec::new());
    }
    let usage = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
    let copy = blank_buffer(gpu, "read back", bytes, usage);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(from, 0, &copy, 0, bytes);
    gpu.queue.submit([encoder.finish()]);
    map(gpu, &copy)
}

/// Returns the bytes of a mappable buffer, after all work submitted before.
pub(crate) fn map(gpu: &Gpu, buffer: &Buffer) -> Result<Vec<u8>, ViewError> {
    let (send, receive) = std::sync::mpsc::channel();
    buffer.map_async(MapMode::Read, .., move |done| {
        let _ = send.send(done);
    });
    gpu.wait()?;
    let failed = |why: String| ViewError::Failed(why);
    let done = receive.recv().map_err(|error| failed(error.to_string()))?;
    done.map_err(|error| failed(error.to_string()))?;
    let mapped = buffer.get_mapped_range(..).map_err(|error| failed(error.to_string()))?;
    Ok(mapped.to_vec())
}
