//! Resources of a `.mlod` file: bytes between its chunks that mean nothing to the levels.

use super::FileError;
use super::header::{BASE_AT, ENTRY_LEN as CHUNK_ENTRY_LEN, FIXED_LEN};
use super::header::{ResourceIndex, Section, u32_at};
use super::streams::{Packer, Unpacker};

/// Bytes attached to a `.mlod` file, such as an image.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Resource {
    /// Number of chunks of updates that precede it in the file.
    pub after_chunks: usize,
    /// The bytes themselves.
    pub bytes: Vec<u8>,
}

/// Entry of the index for one resource.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ResourceEntry {
    pub(super) stored: Section,
    /// Number of chunks that precede it.
    pub(super) after: u32,
}

/// Length of the number of resources, and of the entry of one.
pub(super) const COUNT_LEN: usize = 4;
pub(super) const ENTRY_LEN: usize = 12;
/// Length of the index in the form of an earlier version.
pub(super) const OLD_RESOURCES_LEN: usize = 16;

/// First byte of a resource: the rest is stored as it is, or compressed.
const PLAIN: u8 = 0;
const COMPRESSED: u8 = 1;
/// Bytes of the length of a compressed resource.
const LENGTH_LEN: usize = 4;

/// Returns the length of an index that begins with this number of resources.
pub(super) fn index_len(count: [u8; COUNT_LEN]) -> usize {
    COUNT_LEN + ENTRY_LEN * u32::from_le_bytes(count) as usize
}

pub(super) fn write_index(resources: &[ResourceEntry], out: &mut Vec<u8>) {
    if resources.is_empty() {
        return;
    }
    out.extend((resources.len() as u32).to_le_bytes());
    for ResourceEntry { stored, after } in resources {
        let words = [stored.bytes, stored.checksum, *after];
        out.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    }
}

/// Decodes an index of resources; `None` if they are not in the order of the file.
pub(super) fn read_index(bytes: &[u8], chunks: usize) -> Option<Vec<ResourceEntry>> {
    let entry = |entry: &[u8]| ResourceEntry {
        stored: Section { bytes: u32_at(entry, 0), checksum: u32_at(entry, 4) },
        after: u32_at(entry, 8),
    };
    let entries: Vec<_> = bytes[COUNT_LEN..].chunks_exact(ENTRY_LEN).map(entry).collect();
    let is_sorted = entries.is_sorted_by_key(|entry| entry.after);
    let are_there = entries.last().is_none_or(|last| last.after as usize <= chunks);
    (is_sorted && are_there).then_some(entries)
}

/// Decodes the index of an earlier version: one resource before the first chunk, one after the last.
pub(super) fn read_old_index(bytes: &[u8], chunks: usize) -> Vec<ResourceEntry> {
    let entry = |(at, after): (usize, u32)| ResourceEntry {
        stored: Section { bytes: u32_at(bytes, at), checksum: u32_at(bytes, at + 4) },
        after,
    };
    [(0, 0), (8, chunks as u32)].map(entry).to_vec()
}

/// Returns the offsets of length and checksum of every section, in the order of the file, given the
/// end of the index of chunks.
pub(super) fn sections(bytes: &[u8], chunks_end: usize, index: ResourceIndex) -> Vec<usize> {
    let chunks: Vec<usize> = (FIXED_LEN..chunks_end).step_by(CHUNK_ENTRY_LEN).collect();
    let all = chunks.len();
    let resources: Vec<(usize, usize)> = match index {
        ResourceIndex::None => Vec::new(),
        ResourceIndex::Old => vec![(chunks_end, 0), (chunks_end + 8, all)],
        ResourceIndex::Counted => (0..u32_at(bytes, chunks_end) as usize)
            .map(|i| chunks_end + COUNT_LEN + ENTRY_LEN * i)
            .map(|at| (at, u32_at(bytes, at + 8) as usize))
            .collect(),
    };
    let (mut sections, mut resources) = (vec![BASE_AT], resources.into_iter().peekable());
    for before in 0..=all {
        while let Some((at, _)) = resources.next_if(|&(_, after)| after <= before) {
            sections.push(at);
        }
        sections.extend(chunks.get(before));
    }
    sections
}

/// Encodes the bytes of a resource, compressed if that makes them fewer.
///
/// # Errors
/// 4 GiB or more.
pub fn pack_resource(bytes: &[u8]) -> Result<Vec<u8>, FileError> {
    let too_large = |_| FileError::ResourcesTooLarge;
    let length = u32::try_from(bytes.len() + 1).map_err(too_large)? - 1;
    let mut packer = Packer::new()?;
    packer.bytes(bytes)?;
    let packed = packer.finish()?;
    Ok(match packed.len() + LENGTH_LEN < bytes.len() {
        true => [&[COMPRESSED][..], &length.to_le_bytes(), &packed].concat(),
        false => [&[PLAIN], bytes].concat(),
    })
}

/// Decodes what [`pack_resource`] encoded; `None` if it is damaged.
pub fn unpack_resource(stored: &[u8]) -> Option<Vec<u8>> {
    let (&form, rest) = stored.split_first()?;
    if form != COMPRESSED {
        return (form == PLAIN).then(|| rest.to_vec());
    }
    let (&length, packed) = rest.split_first_chunk::<LENGTH_LEN>()?;
    let mut unpacker = Unpacker::new(packed).ok()?;
    let bytes = unpacker.bytes(u32::from_le_bytes(length) as usize).ok()?;
    unpacker.is_at_end().ok()?.then_some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_come_back_whether_compressed_or_not() {
        let noise: Vec<u8> =
            (0..2000u64).map(|i| ((i * i * i).wrapping_mul(2_654_435_761) >> 13) as u8).collect();
        for bytes in [&[][..], b"x", &[7; 100_000], &noise] {
            let packed = pack_resource(bytes).unwrap();
            assert_eq!(unpack_resource(&packed).as_deref(), Some(bytes));
            assert!(packed.len() <= bytes.len() + 1);
        }
        assert!(pack_resource(&[7; 100_000]).unwrap().len() < 2_000);
    }

    #[test]
    fn a_length_that_lies_is_refused_without_memory() {
        let mut packed = pack_resource(&[7; 100_000]).unwrap();
        for length in [u32::MAX, 99_999, 100_001] {
            packed[1..5].copy_from_slice(&length.to_le_bytes());
            assert_eq!(unpack_resource(&packed), None, "{length}");
        }
        for bad in [&[][..], &[2, 1], &[1], &[1, 0, 0, 0], &[1, 1, 0, 0, 0, 9]] {
            assert_eq!(unpack_resource(bad), None, "{bad:?}");
        }
    }
}
