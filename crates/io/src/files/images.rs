//! Image files written beside a mesh file.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::beside::Beside;
use super::names::{bare_name, inner_path};
use super::staged::StagedFiles;
use crate::error::{IoError, Unsupported};
use crate::format::Format;
use crate::scene::Image;

/// Stages an image under its name in the folder of `path`, unless it is already there. An existing
/// file with different contents is not overwritten.
pub(super) fn stage_image(
    path: &Path,
    image: &Image,
    staged: &mut StagedFiles,
) -> Result<(), IoError> {
    if is_beside(path, image) {
        return Ok(());
    }
    let Some(name) = inner_path(&image.name) else {
        let reason = "its name points outside the folder; write .glb, which embeds images";
        return Err(IoError::unsupported(
            path,
            Unsupported::new(format!("image {:?}", image.name), reason),
        ));
    };
    let target = path.parent().unwrap_or(Path::new("")).join(name);
    if staged.has(&target) {
        return Ok(());
    }
    if target.exists() {
        let reason = "another image of that name already exists; move it, or write .glb";
        return Err(IoError::unsupported(&target, Unsupported::new("image", reason)));
    }
    staged.add(&target, |out| out.write_all(&image.bytes))
}

/// Renames images so that they can be written to the folder of `path`: names that point outside it
/// become bare file names, and names that another image of the scene or a file in the folder has
/// get a number, since that file may belong to another model.
pub(super) fn use_own_names(path: &Path, images: &mut [Image]) {
    let mut taken: HashMap<PathBuf, usize> = HashMap::new();
    for i in 0..images.len() {
        let image = &images[i];
        if image.bytes.is_empty() {
            continue;
        }
        let inner = inner_path(&image.name);
        if inner.is_none() && is_beside(path, image) {
            continue;
        }
        let last = || Path::new(&image.name).file_name().map(PathBuf::from);
        let bare = || bare_name(&image.name).map(PathBuf::from).or_else(last);
        let Some(file) = inner.clone().or_else(bare) else { continue };
        let file = if is_beside(path, image) { file } else { shortened(file) };
        let is_free = |name: &PathBuf| match taken.get(name) {
            Some(&other) => images[other].bytes == image.bytes,
            None => {
                let named = Image { name: name.to_string_lossy().into_owned(), ..image.clone() };
                !path.with_file_name("").join(name).exists() || is_beside(path, &named)
            }
        };
        let numbered = (2..).map(|number| with_number(&file, number));
        let free = std::iter::once(file.clone()).chain(numbered).find(is_free);
        let free = free.unwrap_or_else(|| file.clone());
        if inner.as_ref() != Some(&free) {
            images[i].name = free.to_string_lossy().into_owned();
        }
        taken.entry(free).or_insert(i);
    }
}

/// Maximum length of a file name, in bytes; most file systems allow 255, and a number and a
/// temporary suffix are added.
const MOST_NAME: usize = 180;

/// Shortens the stem of a file name that is too long.
fn shortened(file: PathBuf) -> PathBuf {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    if name.len() <= MOST_NAME {
        return file;
    }
    let dot = name.rfind('.').filter(|&dot| dot > 0 && name.len() - dot <= MOST_NAME / 2);
    let (stem, suffix) = name.split_at(dot.unwrap_or(name.len()));
    let most = MOST_NAME - suffix.len();
    let end = (0..=most).rev().find(|&end| stem.is_char_boundary(end)).unwrap_or(0);
    file.with_file_name(format!("{}{suffix}", &stem[..end]))
}

/// Adds a number to the stem of a file name, as in `wood-2.png`.
fn with_number(file: &Path, number: u32) -> PathBuf {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let suffix = file.extension().map(|suffix| format!(".{}", suffix.to_string_lossy()));
    file.with_file_name(format!("{stem}-{number}{}", suffix.unwrap_or_default()))
}

/// Reports whether the file named by an image, relative to the folder of `path`, has the same
/// bytes.
fn is_beside(path: &Path, image: &Image) -> bool {
    let found = Beside::of(path, Format::Obj).find(&image.name);
    found.is_some_and(|file| fs::read(file).is_ok_and(|found| found == image.bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_keep_their_suffix() {
        let short = |name: &str| shortened(name.into()).to_string_lossy().into_owned();
        assert_eq!(short("maps/wood.png"), "maps/wood.png");
        let long = short(&format!("maps/{}.png", "é".repeat(150)));
        assert!(long.len() <= MOST_NAME + 5 && long.starts_with("maps/éé"), "{long}");
        assert!(long.ends_with("é.png"), "{long}");
        assert_eq!(short(&"a".repeat(300)).len(), MOST_NAME);
        assert_eq!(short(&format!("a.{}", "b".repeat(300))).len(), MOST_NAME);
    }
}
