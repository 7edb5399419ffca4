//! Reading the images of a glTF document.

use crate::error::ParseError;
use crate::gltf::document::uri::Uri;
use crate::gltf::document::{Document, schema, uri};
use crate::options::Resolve;
use crate::scene::Image;
use crate::scene::image_file::mime_type;

/// Reads the images without decoding them. An image whose file is missing gets no bytes. A file
/// that is not an image gets none either, so that a document cannot make the writer copy arbitrary
/// files from this machine.
pub(crate) fn read_images(
    document: &Document<'_>,
    resolve: Resolve<'_>,
) -> Result<Vec<Image>, ParseError> {
    let images: Vec<schema::GltfImage> = schema::array(document.json, "images", "image")?;
    let mut read = |(i, image): (usize, schema::GltfImage)| {
        let named = |bytes: &[u8]| file_name(image.name.clone(), i, bytes);
        if let Some(view) = image.buffer_view {
            let length = document.view(view)?.byte_length;
            let bytes = document.part_of_view(view, 0, length)?.unwrap_or_default();
            return Ok(Image { name: named(&bytes), bytes: bytes.into_owned() });
        }
        Ok(match image.uri.as_deref().map(uri::parse) {
            Some(Ok(Uri::Data(bytes))) => Image { name: named(&bytes), bytes },
            Some(Ok(Uri::File(name))) => {
                let bytes = resolve(&name).filter(|bytes| mime_type(bytes).is_some());
                Image { bytes: bytes.unwrap_or_default(), name }
            }
            // Named by its address, so that a note can show it.
            Some(Err(_)) if image.uri.as_ref().is_some_and(|uri| uri.contains("://")) => {
                Image { name: image.uri.unwrap_or_default(), bytes: Vec::new() }
            }
            Some(Err(_)) | None => Image { name: named(&[]), bytes: Vec::new() },
        })
    };
    images.into_iter().enumerate().map(&mut read).collect()
}

/// Makes a file name for an embedded image, for formats that write images to files.
fn file_name(name: Option<String>, index: usize, bytes: &[u8]) -> String {
    let name = name.filter(|name| !name.is_empty()).unwrap_or_else(|| format!("image{index}"));
    // The name is no path, and some systems refuse these characters in one.
    let is_refused = |c: char| c.is_control() || r#"/\:*?"<>|"#.contains(c);
    let name = name.replace(is_refused, "_");
    let suffix = match mime_type(bytes) {
        Some("image/png") => ".png",
        Some("image/jpeg") => ".jpg",
        Some("image/webp") => ".webp",
        Some("image/ktx2") => ".ktx2",
        _ => "",
    };
    if name.to_ascii_lowercase().ends_with(suffix) { name } else { format!("{name}{suffix}") }
}
