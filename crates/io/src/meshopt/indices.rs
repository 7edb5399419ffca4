//! Meshopt mode 2: any sequence of indices, as differences from one of two earlier ones.

use super::stream::{Malformed, Stream, unzigzag};

const HEADER: u8 = 0xd1;
const TAIL: usize = 4;

/// Decodes `count` indices.
pub(super) fn decode(stream: &[u8], count: usize) -> Result<Vec<u32>, Malformed> {
    let (header, mut data, _) = Stream::split(stream, TAIL)?;
    if header != HEADER {
        return Err(Malformed::new(
            0,
            format!("header {header:#04x}; index streams begin with 0xd1"),
        ));
    }
    // Each index takes at least one byte.
    if data.left() < count {
        let left = data.left();
        return Err(data.wrong(format!("{left} bytes are too few for {count} indices")));
    }
    let mut last = [0u32; 2];
    let mut indices = Vec::with_capacity(count);
    for _ in 0..count {
        let value = data.varint()?;
        let last = &mut last[value as usize & 1];
        *last = last.wrapping_add(unzigzag(value >> 1));
        indices.push(*last);
    }
    data.finish()?;
    Ok(indices)
}
