//! Inputs of the targets: the seeds, and the kept corpus of interesting inputs that long runs of the
//! fuzzers found, one file per target.
//!
//! A kept input is stored as its length in four bytes, followed by its bytes.

use std::fs;
use std::path::{Path, PathBuf};

use crate::seeds::seeds;

/// Longest input that is kept, in bytes; longer ones are few, but make up most of the size.
const LONGEST: usize = 512;

/// Folder of the fuzzers, from that of this crate.
const FUZZ: &str = "../../fuzz";

/// Returns the seeds of a target and its kept inputs.
///
/// # Panics
/// If the file of kept inputs is damaged.
pub fn inputs(target: &str) -> Vec<Vec<u8>> {
    let mut inputs = seeds(target);
    inputs.extend(kept(target));
    inputs
}

/// Writes the inputs of a target into its corpus, where the fuzzer reads them.
///
/// # Panics
/// If the corpus cannot be written.
pub fn plant(target: &str) {
    let folder = corpus(target);
    fs::create_dir_all(&folder).expect("a folder for the corpus");
    for (i, input) in inputs(target).into_iter().enumerate() {
        fs::write(folder.join(format!("seed-{i}")), input).expect("a seed");
    }
}

/// Returns the kept inputs of a target, none if there is no file.
fn kept(target: &str) -> Vec<Vec<u8>> {
    let packed = fs::read(file(target)).unwrap_or_default();
    let (mut rest, mut inputs) = (packed.as_slice(), Vec::new());
    while let Some((length, after)) = rest.split_first_chunk() {
        let (input, next) = after.split_at(u32::from_le_bytes(*length) as usize);
        inputs.push(input.to_vec());
        rest = next;
    }
    inputs
}

/// Keeps the short inputs of a target's current corpus, sorted by length and bytes, and returns
/// their number.
///
/// # Errors
/// If the corpus cannot be read or the file cannot be written.
pub fn keep(target: &str) -> std::io::Result<usize> {
    let files = fs::read_dir(corpus(target))?;
    let mut inputs = files.map(|file| fs::read(file?.path())).collect::<Result<Vec<_>, _>>()?;
    inputs.retain(|input| input.len() <= LONGEST);
    inputs.sort_by(|a, b| a.len().cmp(&b.len()).then(a.cmp(b)));
    let packed: Vec<u8> = inputs
        .iter()
        .flat_map(|input| (input.len() as u32).to_le_bytes().into_iter().chain(input.clone()))
        .collect();
    fs::create_dir_all(file(target).parent().expect("the file is in a folder"))?;
    fs::write(file(target), packed)?;
    Ok(inputs.len())
}

/// Returns the folder that the fuzzer reads a target's inputs from, and adds to.
fn corpus(target: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(FUZZ).join("corpus").join(target)
}

fn file(target: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(FUZZ).join("kept").join(target)
}
