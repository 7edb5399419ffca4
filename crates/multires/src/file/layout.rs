//! Offsets of the sections of a `.mlod` file.

use super::header::Header;

/// Offsets of the sections of a file.
#[derive(Debug, Default)]
pub(super) struct Layout {
    /// End of the base mesh.
    pub(super) base_end: u64,
    pub(super) chunks: Vec<u64>,
    pub(super) resources: Vec<u64>,
    /// Length of the whole file.
    pub(super) end: u64,
}

impl Layout {
    pub(super) fn new(header: &Header) -> Self {
        let base_end = header.len() + u64::from(header.base.bytes);
        let mut this = Self { base_end, end: base_end, ..Self::default() };
        let mut resources = header.resources.iter().peekable();
        for before in 0..=header.chunks.len() {
            while let Some(entry) = resources.next_if(|entry| entry.after as usize <= before) {
                this.resources.push(this.end);
                this.end += u64::from(entry.stored.bytes);
            }
            if let Some(entry) = header.chunks.get(before) {
                this.chunks.push(this.end);
                this.end += u64::from(entry.stored.bytes);
            }
        }
        this
    }
}
