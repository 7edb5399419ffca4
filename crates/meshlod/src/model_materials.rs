//! Materials and images of a scene as resources of our files.
//!
//! In a multiresolution file small images come early, and so does a preview of each large one; the
//! large ones come last. So a truncated file has its textures, if only coarse ones. In a compressed
//! file there are no previews. docs/formats/mlod.md specifies the bytes.

use meshlod_io::{Image, Material, Scene};
use meshlod_mesh::Mesh;
use meshlod_multires::Resources;
use meshlod_picture::{Picture, Texture};
use thiserror::Error;

/// Largest image, in bytes, that comes early as it is.
const SMALL: usize = 1 << 15;
/// Longest side of a preview, in texels.
const PREVIEW: u32 = 128;
/// No image.
const NONE: u32 = u32::MAX;

/// The materials or images of a file are damaged.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the materials in the file are damaged")]
pub struct BadMaterials;

/// Encodes the materials and images of a scene for a multiresolution file of its flattened mesh;
/// `None` if there are no materials.
///
/// Of a material only what [`Material`] has is kept. Cost: decoding each large image.
pub fn pack_materials(materials: &[Material], images: &[Image]) -> Option<Resources> {
    pack(materials, images, SMALL)
}

/// Encodes the materials and images of a scene for a compressed file of its flattened mesh, `.mlq`
/// or `.mlz`; no bytes if there are no materials.
///
/// Of a material only what [`Material`] has is kept.
pub fn pack_whole_materials(materials: &[Material], images: &[Image]) -> Vec<u8> {
    pack(materials, images, usize::MAX).map_or_else(Vec::new, |resources| resources.early)
}

/// Decodes what [`pack_whole_materials`] encoded.
/// # Errors
/// Damaged bytes.
pub fn unpack_whole_materials(bytes: &[u8]) -> Result<(Vec<Material>, Vec<Image>), BadMaterials> {
    if bytes.is_empty() {
        return Ok(Default::default());
    }
    unpack(bytes, None)
}

/// Encodes materials and images; of images larger than `small`, previews come early.
fn pack(materials: &[Material], images: &[Image], small: usize) -> Option<Resources> {
    if materials.is_empty() {
        return None;
    }
    let (mut early, mut late) = (Vec::new(), Vec::new());
    put_count(&mut early, materials.len());
    for material in materials {
        put(&mut early, material.name.as_bytes());
        early.extend(material.base_color.iter().flat_map(|x| x.to_le_bytes()));
        let image = material.base_color_image.map_or(NONE, |image| image as u32);
        early.extend(image.to_le_bytes());
        early.push(material.is_double_sided.into());
    }
    put_count(&mut early, images.len());
    for image in images {
        let preview = if image.bytes.len() > small { preview(image) } else { None };
        put(&mut early, image.name.as_bytes());
        early.push(preview.is_some().into());
        put(&mut early, preview.as_deref().unwrap_or(&image.bytes));
        if preview.is_some() {
            put(&mut late, &image.bytes);
        }
    }
    Some(Resources { early, late: Some(late) })
}

/// Decodes what [`pack_materials`] encoded. Images that a truncated file lacks are previews.
/// # Errors
/// Damaged bytes.
pub fn unpack_materials(
    resources: &Resources,
) -> Result<(Vec<Material>, Vec<Image>), BadMaterials> {
    unpack(&resources.early, resources.late.as_deref())
}

fn unpack(early: &[u8], late: Option<&[u8]>) -> Result<(Vec<Material>, Vec<Image>), BadMaterials> {
    let mut input = Input(early);
    let count = input.count()?;
    let mut materials = Vec::new();
    for _ in 0..count {
        let name = input.text()?;
        let base_color = [input.f32()?, input.f32()?, input.f32()?, input.f32()?];
        let base_color_image = Some(input.count()?).filter(|&image| image != NONE as usize);
        let is_double_sided = input.take(1)?[0] != 0;
        materials.push(Material { name, base_color, base_color_image, is_double_sided });
    }
    let mut late = late.map(Input);
    let mut images = Vec::new();
    for _ in 0..input.count()? {
        let name = input.text()?;
        let is_preview = input.take(1)?[0] != 0;
        let early = input.piece()?;
        let whole = late.as_mut().filter(|_| is_preview).map(Input::piece).transpose()?;
        images.push(Image { name, bytes: whole.unwrap_or(early).to_vec() });
    }
    let is_image = |material: &Material| material.base_color_image.is_none_or(|i| i < images.len());
    let is_whole = input.0.is_empty() && late.is_none_or(|late| late.0.is_empty());
    let is_sound = is_whole && materials.iter().all(is_image);
    is_sound.then_some((materials, images)).ok_or(BadMaterials)
}

/// Returns a scene of a mesh read from one of our files with these materials and images.
pub fn scene_with_materials(
    name: impl Into<String>,
    mesh: Mesh,
    (materials, images): (Vec<Material>, Vec<Image>),
) -> Scene {
    let mut scene = Scene::from_mesh(name, mesh);
    // Faces without a material have one more label.
    let count = materials.len();
    let of_label = |label: &mut Option<usize>| *label = label.filter(|&label| label < count);
    scene.meshes.iter_mut().flat_map(|mesh| &mut mesh.materials).for_each(of_label);
    Scene { materials, images, ..scene }
}

/// Returns a small version of an image as PNG, if that is smaller.
fn preview(image: &Image) -> Option<Vec<u8>> {
    let texture = Texture::decode(&image.bytes).ok()?;
    let (width, height, texels) =
        texture.levels().find(|(width, height, _)| *width.max(height) <= PREVIEW)?;
    let picture = Picture::new(width, height, texels.as_flattened().to_vec()).ok()?;
    Some(picture.png()).filter(|png| png.len() < image.bytes.len())
}

fn put_count(to: &mut Vec<u8>, count: usize) {
    to.extend((count as u32).to_le_bytes());
}

fn put(to: &mut Vec<u8>, bytes: &[u8]) {
    put_count(to, bytes.len());
    to.extend(bytes);
}

/// Bytes still to be decoded.
struct Input<'b>(&'b [u8]);

impl<'b> Input<'b> {
    fn take(&mut self, count: usize) -> Result<&'b [u8], BadMaterials> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(BadMaterials)?;
        self.0 = rest;
        Ok(taken)
    }

    fn word(&mut self) -> Result<[u8; 4], BadMaterials> {
        self.take(4)?.try_into().map_err(|_| BadMaterials)
    }

    fn count(&mut self) -> Result<usize, BadMaterials> {
        Ok(u32::from_le_bytes(self.word()?) as usize)
    }

    fn f32(&mut self) -> Result<f32, BadMaterials> {
        Some(f32::from_le_bytes(self.word()?)).filter(|x| x.is_finite()).ok_or(BadMaterials)
    }

    fn piece(&mut self) -> Result<&'b [u8], BadMaterials> {
        let count = self.count()?;
        self.take(count)
    }

    fn text(&mut self) -> Result<String, BadMaterials> {
        String::from_utf8(self.piece()?.to_vec()).map_err(|_| BadMaterials)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a picture of noise, which does not compress.
    fn noise(side: u32) -> Image {
        let mut state = 1u64;
        let bytes = (0..4 * side * side).map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 56) as u8
        });
        let png = Picture::new(side, side, bytes.collect()).unwrap().png();
        Image { name: format!("noise {side}"), bytes: png }
    }

    fn materials() -> (Vec<Material>, Vec<Image>) {
        let images = vec![noise(8), noise(300), Image { name: "gone".into(), bytes: Vec::new() }];
        let material = |image| Material {
            name: format!("of {image:?}"),
            base_color: [0.1, 0.2, 0.3, 1.0],
            base_color_image: image,
            is_double_sided: image.is_none(),
        };
        ([Some(1), None, Some(0), Some(2)].map(material).to_vec(), images)
    }

    #[test]
    fn materials_and_images_come_back() {
        let (materials, images) = materials();
        let packed = pack_materials(&materials, &images).unwrap();
        assert_eq!(unpack_materials(&packed), Ok((materials, images)));
        assert_eq!(pack_materials(&[], &[]), None);
    }

    #[test]
    fn compressed_files_have_no_previews() {
        let (materials, images) = materials();
        let packed = pack_whole_materials(&materials, &images);
        assert_eq!(unpack_whole_materials(&packed), Ok((materials, images)));
        assert!(pack_whole_materials(&[], &[]).is_empty());
        assert_eq!(unpack_whole_materials(&[]), Ok(Default::default()));
        for length in 1..packed.len().min(300) {
            assert_eq!(unpack_whole_materials(&packed[..length]), Err(BadMaterials), "{length}");
        }
    }

    #[test]
    fn a_truncated_file_has_previews() {
        let (materials, images) = materials();
        let packed = pack_materials(&materials, &images).unwrap();
        let (same, small) = unpack_materials(&Resources { late: None, ..packed }).unwrap();
        assert_eq!(same, materials);
        let [first, preview, gone] = [0, 1, 2].map(|i| &small[i].bytes);
        assert!(first == &images[0].bytes && gone.is_empty());
        let size = Texture::decode(preview).unwrap().levels().next().map(|(w, h, _)| [w, h]);
        assert_eq!(size, Some([75, 75]));
    }

    #[test]
    fn damaged_bytes_are_refused() {
        let (materials, images) = materials();
        let packed = pack_materials(&materials, &images).unwrap();
        for length in 0..packed.early.len().min(300) {
            let early = packed.early[..length].to_vec();
            assert!(unpack_materials(&Resources { early, late: None }).is_err(), "{length}");
        }
        let late = packed.late.as_ref().map(|late| late[..late.len() - 1].to_vec());
        assert_eq!(unpack_materials(&Resources { late, ..packed.clone() }), Err(BadMaterials));
        for at in 0..packed.early.len().min(400) {
            let mut early = packed.early.clone();
            early[at] ^= 0x80;
            // No panic; some changes give other materials.
            unpack_materials(&Resources { early, ..packed.clone() }).ok();
        }
    }
}
