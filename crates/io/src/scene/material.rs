//! Materials of a scene.

use serde::{Deserialize, Serialize};

/// Material of a scene.
///
/// Properties beyond these are kept in [`Material::mtl`] or, for glTF, in the source document only.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Material {
    /// Name of the material in the file; empty if it has none.
    pub name: String,
    /// Base colour of the material, linear RGBA.
    pub base_color: [f32; 4],
    /// Texture that multiplies the base colour, by index into
    /// [`Scene::images`](crate::Scene::images).
    pub base_color_image: Option<usize>,
    /// False if faces are visible only from the front, where their corners run counterclockwise.
    /// Only glTF has such materials.
    pub is_double_sided: bool,
    /// How the surface reflects and emits light.
    pub shading: Shading,
    /// Lines that define the material in an MTL library, all but `newmtl`; empty for other formats.
    ///
    /// They are written to MTL unchanged, except lines that contradict the fields above.
    pub mtl: Vec<MtlStatement>,
}

/// Reflection and emission of a material, in the metallic-roughness model. Images are indices into
/// [`Scene::images`](crate::Scene::images).
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(default)]
pub struct Shading {
    /// Metalness, from 0 to 1.
    pub metallic: f32,
    /// Texture whose blue channel multiplies the metalness.
    pub metallic_image: Option<usize>,
    /// Perceptual roughness, from 0 to 1.
    pub roughness: f32,
    /// Texture whose green channel multiplies the roughness.
    pub roughness_image: Option<usize>,
    /// Normals in tangent space.
    pub normal_image: Option<usize>,
    /// Factor of the x and y coordinates of those normals.
    pub normal_scale: f32,
    /// Emitted light, linear RGB; may exceed 1.
    pub emission: [f32; 3],
    /// Texture that multiplies the emitted light.
    pub emission_image: Option<usize>,
    /// Texture whose alpha channel multiplies the opacity.
    pub opacity_image: Option<usize>,
}

/// Line of an MTL library.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct MtlStatement {
    /// Text of the line; if it names an image, up to that name.
    pub text: String,
    /// Image that the line names, if any.
    pub map: Option<MtlMap>,
}

/// Image named by a line of an MTL library.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct MtlMap {
    /// Index of the image in [`Scene::images`](crate::Scene::images).
    pub image: usize,
    /// Name of the image as the library spells it.
    pub name: String,
    /// Text of the line after the name.
    pub rest: String,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [1.0; 4],
            base_color_image: None,
            is_double_sided: true,
            shading: Shading::default(),
            mtl: Vec::new(),
        }
    }
}

impl Default for Shading {
    fn default() -> Self {
        Self {
            metallic: 0.0,
            metallic_image: None,
            roughness: 1.0,
            roughness_image: None,
            normal_image: None,
            normal_scale: 1.0,
            emission: [0.0; 3],
            emission_image: None,
            opacity_image: None,
        }
    }
}

impl Material {
    /// Returns the images of the material, possibly with duplicates.
    pub fn images(&self) -> impl Iterator<Item = usize> {
        let Shading { metallic_image, roughness_image, normal_image, .. } = self.shading;
        let Shading { emission_image, opacity_image, .. } = self.shading;
        let own = [
            self.base_color_image,
            metallic_image,
            roughness_image,
            normal_image,
            emission_image,
            opacity_image,
        ];
        let maps = self.mtl.iter().filter_map(|line| Some(line.map.as_ref()?.image));
        own.into_iter().flatten().chain(maps)
    }

    /// Adds a number to the index of each image, for images that come behind others.
    pub fn shift_images(&mut self, by: usize) {
        let Shading { metallic_image, roughness_image, normal_image, .. } = &mut self.shading;
        let own = [&mut self.base_color_image, metallic_image, roughness_image, normal_image];
        own.into_iter().flatten().for_each(|image| *image += by);
        let Shading { emission_image, opacity_image, .. } = &mut self.shading;
        [emission_image, opacity_image].into_iter().flatten().for_each(|image| *image += by);
        let maps = self.mtl.iter_mut().filter_map(|line| line.map.as_mut());
        maps.for_each(|map| map.image += by);
    }
}

impl Shading {
    /// Returns the image that holds both metalness and roughness, if any: glTF cannot store two.
    pub(crate) fn metallic_roughness_image(&self) -> Option<usize> {
        match (self.metallic_image, self.roughness_image) {
            (Some(a), Some(b)) => (a == b).then_some(a),
            // What the other channel holds is multiplied by zero.
            (Some(a), None) => (self.roughness == 0.0).then_some(a),
            (None, Some(b)) => (self.metallic == 0.0).then_some(b),
            (None, None) => None,
        }
    }
}
