//! Materials and images of a scene as resources of compressed files, `.mlq` and `.mlz`.
//!
//! docs/formats/mlz.md specifies the bytes.

use meshlod_io::{Image, Material, Scene};
use meshlod_mesh::Mesh;
use thiserror::Error;

/// No image.
const NONE: u32 = u32::MAX;

/// The materials or images of a file are damaged.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the materials in the file are damaged")]
pub struct BadMaterials;

/// Encodes the materials and images of a scene for a compressed file of its flattened mesh; no bytes
/// if there are no materials.
///
/// Of a material only what [`Material`] has is kept.
pub fn pack_materials(materials: &[Material], images: &[Image]) -> Vec<u8> {
    let mut bytes = Vec::new();
    if materials.is_empty() {
        return bytes;
    }
    put_count(&mut bytes, materials.len());
    for material in materials {
        put(&mut bytes, material.name.as_bytes());
        bytes.extend(material.base_color.iter().flat_map(|x| x.to_le_bytes()));
        let image = material.base_color_image.map_or(NONE, |image| image as u32);
        bytes.extend(image.to_le_bytes());
        bytes.push(material.is_double_sided.into());
    }
    put_count(&mut bytes, images.len());
    for image in images {
        put(&mut bytes, image.name.as_bytes());
        put(&mut bytes, &image.bytes);
    }
    bytes
}

/// Decodes what [`pack_materials`] encoded.
/// # Errors
/// Damaged bytes.
pub fn unpack_materials(bytes: &[u8]) -> Result<(Vec<Material>, Vec<Image>), BadMaterials> {
    if bytes.is_empty() {
        return Ok(Default::default());
    }
    let mut input = PackedBytes(bytes);
    let count = input.count()?;
    let mut materials = Vec::new();
    for _ in 0..count {
        let name = input.text()?;
        let base_color = [input.f32()?, input.f32()?, input.f32()?, input.f32()?];
        let base_color_image = Some(input.count()?).filter(|&image| image != NONE as usize);
        let is_double_sided = input.take(1)?[0] != 0;
        materials.push(Material { name, base_color, base_color_image, is_double_sided });
    }
    let mut images = Vec::new();
    for _ in 0..input.count()? {
        images.push(Image { name: input.text()?, bytes: input.piece()?.to_vec() });
    }
    let is_image = |material: &Material| material.base_color_image.is_none_or(|i| i < images.len());
    let is_sound = input.0.is_empty() && materials.iter().all(is_image);
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

fn put_count(to: &mut Vec<u8>, count: usize) {
    to.extend((count as u32).to_le_bytes());
}

fn put(to: &mut Vec<u8>, bytes: &[u8]) {
    put_count(to, bytes.len());
    to.extend(bytes);
}

/// Bytes still to be decoded.
struct PackedBytes<'b>(&'b [u8]);

impl<'b> PackedBytes<'b> {
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

    fn materials() -> (Vec<Material>, Vec<Image>) {
        let image = |name: &str, bytes: &[u8]| Image { name: name.into(), bytes: bytes.to_vec() };
        let images = vec![image("small", &[7]), image("large", &[5; 300]), image("gone", &[])];
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
        let packed = pack_materials(&materials, &images);
        assert_eq!(unpack_materials(&packed), Ok((materials, images)));
        assert!(pack_materials(&[], &[]).is_empty());
        assert_eq!(unpack_materials(&[]), Ok(Default::default()));
    }

    #[test]
    fn damaged_bytes_are_refused() {
        let (materials, images) = materials();
        let packed = pack_materials(&materials, &images);
        for length in 1..packed.len() {
            assert_eq!(unpack_materials(&packed[..length]), Err(BadMaterials), "{length}");
        }
        for at in 0..packed.len() {
            let mut changed = packed.clone();
            changed[at] ^= 0x80;
            // No panic; some changes give other materials.
            unpack_materials(&changed).ok();
        }
    }
}
