//! The corpus that is kept: what long runs of the fuzzer found worth trying, in one file a target.
//!
//! An input is its length, four bytes, and its bytes.

use std::fs;
use std::path::{Path, PathBuf};

/// The longest input that is kept, in bytes: longer ones are few, and most of the size.
const LONGEST: usize = 512;

/// The inputs kept for a target; none where there is no file.
///
/// # Panics
/// When the file is damaged.
pub fn kept(target: &str) -> Vec<Vec<u8>> {
    let packed = fs::read(file(target)).unwrap_or_default();
    let (mut rest, mut inputs) = (packed.as_slice(), Vec::new());
    while let Some((length, after)) = rest.split_first_chunk() {
        let (input, next) = after.split_at(u32::from_le_bytes(*length) as usize);
        inputs.push(input.to_vec());
        rest = next;
    }
    inputs
}

/// Keeps the short inputs that a target's corpus holds now, in the order of length and bytes; gives
/// how many.
///
/// # Errors
/// The corpus cannot be read, the file cannot be written.
pub fn keep(target: &str) -> std::io::Result<usize> {
    let files = fs::read_dir(corpus(target))?;
    let mut inputs = files.map(|file| fs::read(file?.path())).collect::<Result<Vec<_>, _>>()?;
    inputs.retain(|input| input.len() <= LONGEST);
    inputs.sort_by(|a, b| a.len().cmp(&b.len()).then(a.cmp(b)));
    let packed: Vec<u8> = inputs
        .iter()
        .flat_map(|input| (input.len() as u32).to_le_bytes().into_iter().chain(input.clone()))
        .collect();
    fs::create_dir_all(file(target).parent().expect("it is in a folder"))?;
    fs::write(file(target), packed)?;
    Ok(inputs.len())
}

/// The folder that the fuzzer reads a target's inputs from, and adds to.
pub fn corpus(target: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target)
}

fn file(target: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("kept").join(target)
}
