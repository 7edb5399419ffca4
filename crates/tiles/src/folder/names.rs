//! Names of files in the folder of a plan, and their removal: others are not ours.

use std::fs;
use std::path::Path;

/// Removes the files of tiles in a folder, and the folder if nothing else is in it.
pub fn remove_tiles(folder: &Path) {
    remove_where(folder, is_of_tile);
    let _ = fs::remove_dir(folder);
}

/// Returns true if a folder is there and holds anything but files of tiles.
pub fn has_other_files(folder: &Path) -> bool {
    let mut entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.any(|entry| !entry.file_name().to_str().is_some_and(is_of_tile))
}

/// Removes the files of a folder that have some names. What cannot be removed does no harm.
pub fn remove_where(folder: &Path, is_meant: impl Fn(&str) -> bool) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_name().to_str().is_some_and(&is_meant) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Returns true for the name of a file of a tile, such as `2-0-3-1.glb`, and of one in the making.
pub fn is_of_tile(name: &str) -> bool {
    let (name, is_part) = match name.strip_prefix('.') {
        Some(name) => (name, true),
        None => (name, false),
    };
    let Some((cell, kind)) = name.split_once('.') else { return false };
    let kind = if is_part { first(kind) } else { kind };
    let numbers: Vec<&str> = cell.split('-').collect();
    ["json", "mesh", "glb"].contains(&kind) && numbers.len() == 4 && numbers.iter().all(is_number)
}

/// Returns true for the name of the file of an image, and of one in the making.
pub(super) fn is_image(name: &str) -> bool {
    let (name, is_part) = match name.strip_prefix('.') {
        Some(name) => (name, true),
        None => (name, false),
    };
    let number = name.strip_prefix("image-");
    number.is_some_and(|number| is_number(&if is_part { first(number) } else { number }))
}

fn is_number(text: &&str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// Returns the part of a name before its first dot.
pub(super) fn first(name: &str) -> &str {
    name.split('.').next().unwrap_or(name)
}
