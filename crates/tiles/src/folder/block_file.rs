//! File that says where the pieces of each leaf are in the scratch file.
//!
//! An entry for each task, in their order: index of its first block and number of blocks, as 64 and
//! 32 bits, and a checksum of these numbers and of the blocks. Then follow all blocks: offset,
//! corners, pieces and checksum, as 64 and three times 32 bits. Everything is little-endian. So a
//! task reads its own blocks and nothing else.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use crate::error::TilesError;
use crate::plan::Plan;
use crate::scratch::Block;

/// Bytes of an entry.
const ENTRY: usize = 16;

/// Bytes of a block.
const BLOCK: usize = 20;

/// Returns the file of a plan that has its blocks in memory.
pub fn encode(plan: &Plan) -> Vec<u8> {
    let (mut entries, mut blocks) = (Vec::new(), Vec::new());
    for &node in &plan.tasks {
        let own = &plan.blocks[node as usize];
        let first = blocks.len();
        for block in own {
            blocks.extend(block.offset.to_le_bytes());
            [block.corners, block.pieces, block.checksum]
                .into_iter()
                .for_each(|word| blocks.extend(word.to_le_bytes()));
        }
        let entry =
            [&((first / BLOCK) as u64).to_le_bytes()[..], &(own.len() as u32).to_le_bytes()]
                .concat();
        entries.extend_from_slice(&entry);
        entries.extend(checksum(&entry, &blocks[first..]).to_le_bytes());
    }
    entries.append(&mut blocks);
    entries
}

fn checksum(entry: &[u8], blocks: &[u8]) -> u32 {
    let mut sum = crc32fast::Hasher::new();
    sum.update(entry);
    sum.update(blocks);
    sum.finalize()
}

/// Reads the blocks of a task from the file of a plan with so many tasks.
///
/// # Errors
/// Errors of the system, and a file that is not as it was written.
pub fn read(path: &Path, task: usize, tasks: usize) -> Result<Vec<Block>, TilesError> {
    let found = File::open(path).and_then(|mut file| find(&mut file, task, tasks));
    let bytes = found.map_err(|error| TilesError::system(path, error))?;
    bytes.ok_or_else(|| TilesError::damaged(path, "is cut off or changed")).map(|bytes| {
        let (blocks, _) = bytes.as_chunks::<BLOCK>();
        blocks.iter().map(block).collect()
    })
}

/// Returns the bytes of the blocks of a task; `None` if the file is damaged.
fn find(file: &mut (impl Read + Seek), task: usize, tasks: usize) -> io::Result<Option<Vec<u8>>> {
    let length = file.seek(SeekFrom::End(0))?;
    let start = (tasks * ENTRY) as u64;
    if length < start {
        return Ok(None);
    }
    let mut entry = [0; ENTRY];
    file.seek(SeekFrom::Start((task * ENTRY) as u64))?;
    file.read_exact(&mut entry)?;
    let at = offset(&entry).checked_mul(BLOCK as u64).and_then(|first| first.checked_add(start));
    let size = u64::from(word(&entry, 8)) * BLOCK as u64;
    let Some(at) = at.filter(|at| at.checked_add(size).is_some_and(|end| end <= length)) else {
        return Ok(None);
    };
    let mut bytes = vec![0; size as usize];
    file.seek(SeekFrom::Start(at))?;
    file.read_exact(&mut bytes)?;
    let is_sound = checksum(&entry[..12], &bytes) == word(&entry, 12);
    Ok(is_sound.then_some(bytes))
}

fn block(bytes: &[u8; BLOCK]) -> Block {
    Block {
        offset: offset(bytes),
        corners: word(bytes, 8),
        pieces: word(bytes, 12),
        checksum: word(bytes, 16),
    }
}

fn offset(bytes: &[u8]) -> u64 {
    u64::from(word(bytes, 0)) | u64::from(word(bytes, 4)) << 32
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}
