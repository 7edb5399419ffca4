//! Reading the base colours, sides and images of a glTF document.

use serde_json::Value;

use super::document::{Document, missing};
use super::new_document::mime_type;
use super::schema::{self, Texture};
use super::uri::{self, Uri};
use crate::{Image, Material, ParseError, Resolve};

/// Reads the materials; every image they refer to must be below `images`.
pub(super) fn materials(json: &Value, images: usize) -> Result<Vec<Material>, ParseError> {
    let textures: Vec<Texture> = schema::array(json, "textures", "texture")?;
    let materials: Vec<schema::GltfMaterial> = schema::array(json, "materials", "material")?;
    let read = |material: schema::GltfMaterial| {
        let surface = material.pbr_metallic_roughness;
        let base_color_image = match surface.base_color_texture {
            None => None,
            Some(texture) => match textures.get(texture.index) {
                None => return Err(missing("texture", texture.index, textures.len())),
                Some(texture) => texture.webp_source().or(texture.source),
            },
        };
        if let Some(image) = base_color_image.filter(|&image| image >= images) {
            return Err(missing("image", image, images));
        }
        Ok(Material {
            name: material.name.unwrap_or_default(),
            base_color: surface.base_color_factor.unwrap_or([1.0; 4]),
            base_color_image,
            is_double_sided: material.double_sided,
        })
    };
    materials.into_iter().map(read).collect()
}

impl Texture {
    /// Returns the image that `EXT_texture_webp` gives the texture; its source, if it has one, is
    /// the same picture for programs that do not know WebP.
    fn webp_source(&self) -> Option<usize> {
        let extension = self.extensions.get("EXT_texture_webp")?;
        extension.get("source")?.as_u64().map(|source| source as usize)
    }
}

/// Reads the images, still encoded. An image whose file is missing gets no bytes, which costs the
/// pictures something but not the geometry. A file that is not an image gets none either: a
/// document from elsewhere must not make the writer copy arbitrary files from this machine.
pub(super) fn images(
    document: &Document<'_>,
    resolve: Resolve<'_>,
) -> Result<Vec<Image>, ParseError> {
    let images: Vec<schema::GltfImage> = schema::array(document.json, "images", "image")?;
    let mut read = |(i, image): (usize, schema::GltfImage)| {
        let named = |bytes: &[u8]| file_name(image.name.clone(), i, bytes);
        if let Some(view) = image.buffer_view {
            let (_, bytes) = document.view(view)?;
            return Ok(Image { name: named(bytes), bytes: bytes.to_vec() });
        }
        Ok(match image.uri.as_deref().map(uri::parse) {
            Some(Ok(Uri::Data(bytes))) => Image { name: named(&bytes), bytes },
            Some(Ok(Uri::File(name))) => {
                let bytes = resolve(&name).filter(|bytes| mime_type(bytes).is_some());
                Image { bytes: bytes.unwrap_or_default(), name }
            }
            Some(Err(_)) | None => Image { name: named(&[]), bytes: Vec::new() },
        })
    };
    images.into_iter().enumerate().map(&mut read).collect()
}

/// Makes a file name for an embedded image, as other formats write images to files.
fn file_name(name: Option<String>, index: usize, bytes: &[u8]) -> String {
    let name = name.filter(|name| !name.is_empty()).unwrap_or_else(|| format!("image{index}"));
    let suffix = match mime_type(bytes) {
        Some("image/png") => ".png",
        Some("image/jpeg") => ".jpg",
        Some("image/webp") => ".webp",
        _ => "",
    };
    if name.to_ascii_lowercase().ends_with(suffix) { name } else { format!("{name}{suffix}") }
}
