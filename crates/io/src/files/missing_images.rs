//! Notes on images that were not found.

use std::path::Path;

use super::names::bare_name;
use crate::notes::Note;
use crate::scene::Scene;

/// Notes the images without bytes, with the expected path of the first one if the folder is known.
pub(crate) fn note_missing_images(scene: &mut Scene, folder: Option<&Path>) {
    let missing = scene.images.iter().filter(|image| image.bytes.is_empty());
    let names: Vec<String> = missing.map(|image| image.name.clone()).collect();
    let Some(first) = names.first() else { return };
    let (one, many) = (
        "image that was not found or cannot be used",
        "images that were not found or cannot be used",
    );
    let mut note = Note::left_out(names.len(), one, many);
    if let Some(folder) = folder {
        note = note.remedied(image_remedy(first, folder));
    }
    scene.notes.push(note.named(names));
}

/// Returns advice on a missing image of a file in this folder.
fn image_remedy(name: &str, folder: &Path) -> String {
    if name.contains("://") {
        return "images are not downloaded; save them beside the model, and name those".to_owned();
    }
    if ["<UDIM>", "<UVTILE>", "%(UDIM)d"].iter().any(|tiles| name.contains(tiles)) {
        return "tiles of UDIM are not read; bake them into one image".to_owned();
    }
    let place = folder.join(bare_name(name).unwrap_or(name));
    format!("put an image at {}", place.display())
}
