//! Images of a material, each with what it is for.

use std::collections::BTreeSet;
use std::sync::Arc;

use meshlod_io::Material;
use meshlod_picture::Texture;

use super::decoded::Role;
use crate::plan::Look;

/// Image of a material.
#[derive(Clone, Debug)]
pub(super) struct Layer {
    /// Index of the image in those of the model.
    pub image: usize,
    pub role: Role,
    pub texture: Arc<Texture>,
}

/// Returns the images that a material uses; those that cannot be decoded are lost.
pub(super) fn take_layers(
    look: &Look,
    material: &mut Material,
    lost: &mut BTreeSet<usize>,
) -> Vec<Layer> {
    let mut layers: Vec<Layer> = Vec::new();
    for (role, image) in slots(material) {
        let Some(image) = *image else { continue };
        if layers.iter().any(|layer| (layer.image, layer.role) == (image, role)) {
            continue;
        }
        match look.decoded.texture(&look.images, image, role) {
            Some(texture) => layers.push(Layer { image, role, texture }),
            None => drop(lost.insert(image)),
        }
    }
    layers
}

/// Puts other images in the places of the layers that they are for. What is no layer has none, nor
/// have statements of MTL, which GLB lacks.
pub(super) fn set_images(material: &mut Material, layers: &[Layer], images: &[usize]) {
    let has_opacity = has_opacity(material);
    for (role, image) in slots(material) {
        let is_own = |layer: &Layer| (Some(layer.image), layer.role) == (*image, role);
        *image = layers.iter().position(is_own).map(|i| images[i]);
    }
    material.shading.opacity_image = material.base_color_image.filter(|_| has_opacity);
    material.mtl.clear();
}

/// Returns true if the image of the base colour also has the opacity, as glTF wants it.
fn has_opacity(material: &Material) -> bool {
    let opacity = material.shading.opacity_image;
    opacity.is_some() && opacity == material.base_color_image
}

fn slots(material: &mut Material) -> [(Role, &mut Option<usize>); 5] {
    let base = if has_opacity(material) { Role::ColorAndOpacity } else { Role::Color };
    let shading = &mut material.shading;
    [
        (base, &mut material.base_color_image),
        (Role::Color, &mut shading.emission_image),
        (Role::Values, &mut shading.metallic_image),
        (Role::Values, &mut shading.roughness_image),
        (Role::Values, &mut shading.normal_image),
    ]
}

#[cfg(test)]
mod tests {
    use meshlod_io::{Image, Shading};
    use meshlod_picture::Picture;

    use super::*;

    #[test]
    fn images_that_cannot_be_decoded_are_left_out() {
        let png = Picture::new(1, 1, vec![9; 4]).unwrap().png();
        let image = |bytes: &[u8]| Image { name: String::new(), bytes: bytes.to_vec() };
        let images = vec![image(b"broken"), image(&png), image(&[])];
        let look = Look { images, ..Look::default() };
        let shading = Shading {
            opacity_image: Some(1),
            emission_image: Some(0),
            metallic_image: Some(1),
            roughness_image: Some(1),
            normal_image: Some(2),
            ..Shading::default()
        };
        let mut material = Material { base_color_image: Some(1), shading, ..Material::default() };
        let mut lost = BTreeSet::new();
        let layers = take_layers(&look, &mut material, &mut lost);
        assert_eq!(lost, BTreeSet::from([0, 2]));
        let found: Vec<_> = layers.iter().map(|layer| (layer.image, layer.role)).collect();
        assert_eq!(found, [(1, Role::ColorAndOpacity), (1, Role::Values)]);
        set_images(&mut material, &layers, &[7, 8]);
        let own = &material.shading;
        assert_eq!([material.base_color_image, own.opacity_image], [Some(7); 2]);
        assert_eq!([own.metallic_image, own.roughness_image], [Some(8); 2]);
        assert_eq!([own.emission_image, own.normal_image], [None; 2]);
    }
}
