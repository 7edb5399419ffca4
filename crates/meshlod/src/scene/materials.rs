//! Materials of a scene, ready for drawing.

use meshlod_io::{Image, Scene};
use meshlod_picture::{Materials, PaintMaterial, Texture};

/// Returns the materials needed to draw the mesh made by [`Scene::flatten`], and the images that
/// could not be decoded or are drawn smaller than they are.
///
/// There is one entry for every material of the scene, and a light grey one for faces without a
/// material. A material whose image cannot be decoded keeps its colour only. Textures have at most
/// 2^24 texels, see [`Texture::decode`].
///
/// Cost: decoding each image that a material uses, once.
pub fn materials_of(scene: &Scene) -> (Materials, Vec<ImageWarning>) {
    let mut textures = Vec::new();
    let mut warnings = Vec::new();
    let mut texture_of = vec![None; scene.images.len()];
    let mut texture = |index: usize| {
        let image = scene.images.get(index)?;
        *texture_of[index].get_or_insert_with(|| match decode(image) {
            Ok(texture) => {
                warnings.extend(smaller(&texture).map(|reason| ImageWarning::of(image, reason)));
                textures.push(texture);
                Some(textures.len() - 1)
            }
            Err(reason) => {
                warnings.push(ImageWarning::of(image, reason));
                None
            }
        })
    };
    let mut materials: Vec<PaintMaterial> = scene
        .materials
        .iter()
        .map(|material| {
            let [r, g, b, _] = material.base_color;
            let texture = material.base_color_image.and_then(&mut texture);
            PaintMaterial { base_color: [r, g, b], texture }
        })
        .collect();
    materials.push(PaintMaterial { base_color: [0.7; 3], texture: None });
    (Materials { materials, textures }, warnings)
}

/// Returns whether each material of a scene is single-sided, for the mesh made by
/// [`Scene::flatten`]; see [`Style::single_sided`](meshlod_picture::Style::single_sided).
///
/// Only glTF has single-sided materials. Nodes that mirror need nothing: flattening turns their
/// faces over.
pub fn single_sided_materials(scene: &Scene) -> Vec<bool> {
    scene.materials.iter().map(|material| !material.is_double_sided).collect()
}

/// Texture image of a scene that could not be decoded, or is drawn smaller than it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImageWarning {
    /// Name of the image in the scene.
    pub name: String,
    /// Reason why the image is not drawn, or at which size it is.
    pub reason: String,
}

impl ImageWarning {
    fn of(image: &Image, reason: String) -> Self {
        Self { name: image.name.clone(), reason }
    }
}

/// Says at which size an image is drawn, if that is not its own.
fn smaller(texture: &Texture) -> Option<String> {
    let [width, height] = texture.image_size();
    let (drawn_width, drawn_height, _) = texture.levels().next()?;
    let is_smaller = [drawn_width, drawn_height] != [width, height];
    is_smaller.then(|| {
        format!("drawn as {drawn_width} x {drawn_height} of its {width} x {height} pixels")
    })
}

fn decode(image: &Image) -> Result<Texture, String> {
    if image.bytes.is_empty() {
        return Err("the file is not there".into());
    }
    Texture::decode(&image.bytes).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use meshlod_io as io;
    use meshlod_picture::Picture;

    use super::*;

    fn scene() -> Scene {
        let png = Picture::new(1, 1, vec![9; 4]).unwrap().png();
        let image = |name: &str, bytes| Image { name: name.into(), bytes };
        let material = |image| io::Material {
            base_color: [0.1, 0.2, 0.3, 0.4],
            base_color_image: image,
            ..Default::default()
        };
        Scene {
            images: vec![image("cut", png[..20].to_vec()), image("a", png), image("gone", vec![])],
            materials: [Some(1), None, Some(0), Some(2), Some(1), Some(9)].map(material).into(),
            ..Scene::default()
        }
    }

    #[test]
    fn every_material_has_its_colour_and_shared_images_are_read_once() {
        let (materials, _) = materials_of(&scene());
        let textures: Vec<_> = materials.materials.iter().map(|m| m.texture).collect();
        assert_eq!(textures, [Some(0), None, None, None, Some(0), None, None]);
        assert_eq!(materials.textures.len(), 1);
        assert!(materials.materials[..6].iter().all(|m| m.base_color == [0.1, 0.2, 0.3]));
    }

    #[test]
    fn images_that_cannot_be_read_are_named_once() {
        let (_, unread) = materials_of(&scene());
        let names: Vec<_> = unread.iter().map(|image| &image.name[..]).collect();
        assert_eq!(names, ["cut", "gone"]);
    }

    #[test]
    fn a_large_image_is_drawn_smaller_with_a_warning() {
        let (width, height) = (4098, 4098);
        let large = Picture::new(width, height, vec![9; 4 * 4098 * 4098]).unwrap().png();
        let scene = Scene { images: vec![Image { name: "big".into(), bytes: large }], ..scene() };
        let scene = Scene { materials: scene.materials[2..3].to_vec(), ..scene };
        let (materials, warnings) = materials_of(&scene);
        assert_eq!(materials.textures.len(), 1);
        let reason = "drawn as 2049 x 2049 of its 4098 x 4098 pixels".into();
        assert_eq!(warnings, [ImageWarning { name: "big".into(), reason }]);
    }

    #[test]
    fn a_scene_without_materials_has_one_to_paint_with() {
        assert_eq!(materials_of(&Scene::default()).0.materials.len(), 1);
    }
}
