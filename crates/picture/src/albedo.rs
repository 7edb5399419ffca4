//! Albedo: the colour of a surface before lighting.

use glam::{Vec2, Vec3};
use meshlod_mesh::{Layer, LayerKind, Mesh, WedgeId};

use crate::color_map::Scale;
use crate::error::check_length;
use crate::facet::Fragment;
use crate::srgb;
use crate::{Materials, Paint, PictureError, Texture, Values};

/// [`Paint`] checked against its mesh and prepared for look-ups.
pub(crate) enum Albedo<'a> {
    Plain(Vec3),
    FaceColors(&'a [[u8; 3]]),
    FaceValues(&'a [f32], Scale),
    VertexValues(&'a [f32], Scale),
    Colors(OverWedges<'a>),
    Materials(&'a Materials, Option<OverWedges<'a>>),
    Checker(Texture, OverWedges<'a>),
}

/// Attribute layer with the wedges at the corners of faces.
#[derive(Clone, Copy)]
pub(crate) struct OverWedges<'a> {
    layer: &'a Layer,
    corners: &'a [[WedgeId; 3]],
}

/// Surface colour if the mesh lacks the layer that a paint needs.
const BARE: [u8; 3] = [205, 205, 205];

impl<'a> Albedo<'a> {
    pub(crate) fn new(mesh: &'a Mesh, paint: &Paint<'a>) -> Result<Self, PictureError> {
        let bare = || Self::Plain(srgb::decode(BARE));
        Ok(match *paint {
            Paint::Plain(color) => Self::Plain(srgb::decode(color)),
            Paint::FaceColors(colors) => {
                check_length("colours of faces", colors.len(), mesh.faces.len())?;
                Self::FaceColors(colors)
            }
            Paint::FaceValues(Values { values, map, range }) => {
                check_length("values of faces", values.len(), mesh.faces.len())?;
                Self::FaceValues(values, Scale::new(map, range))
            }
            Paint::VertexValues(Values { values, map, range }) => {
                check_length("values of vertices", values.len(), mesh.positions.len())?;
                Self::VertexValues(values, Scale::new(map, range))
            }
            Paint::Colors => {
                let layer = OverWedges::find(mesh, LayerKind::Color(0));
                layer.filter(|colors| colors.layer.width >= 3).map_or_else(bare, Self::Colors)
            }
            Paint::Materials(materials) => {
                check_materials(mesh, materials)?;
                Self::Materials(materials, OverWedges::find(mesh, LayerKind::Uv(0)))
            }
            Paint::Checker { squares } => match OverWedges::find(mesh, LayerKind::Uv(0)) {
                Some(uv) => Self::Checker(Texture::checker(squares), uv),
                None => bare(),
            },
        })
    }

    /// Returns the linear colour at a fragment.
    pub(crate) fn color(&self, mesh: &Mesh, fragment: &Fragment) -> Vec3 {
        let face = fragment.face;
        match self {
            Self::Plain(color) => *color,
            Self::FaceColors(colors) => srgb::decode(colors[face]),
            Self::FaceValues(values, scale) => scale.color(values[face]),
            Self::VertexValues(values, scale) => {
                let corners = Vec3::from(mesh.faces[face].map(|v| values[v.index()]));
                scale.color(fragment.weights.dot(corners))
            }
            Self::Colors(layer) => {
                let [a, b, c] = layer.corners[face].map(|w| Vec3::from_slice(layer.layer.of(w)));
                Vec3::from(fragment.blend([a, b, c]).to_array().map(srgb::decode_unit))
            }
            Self::Materials(materials, uv) => {
                let label = mesh.materials.as_ref().map_or(0, |labels| labels.of(face) as usize);
                let material = materials.materials[label];
                let color = Vec3::from(material.base_color);
                match (material.texture, uv) {
                    (Some(texture), Some(uv)) => {
                        color * uv.sample(&materials.textures[texture], fragment)
                    }
                    _ => color,
                }
            }
            Self::Checker(texture, uv) => uv.sample(texture, fragment),
        }
    }
}

impl<'a> OverWedges<'a> {
    fn find(mesh: &'a Mesh, kind: LayerKind) -> Option<Self> {
        let attributes = mesh.attributes.as_ref()?;
        Some(Self { layer: attributes.layer(kind)?, corners: &attributes.corners })
    }

    /// Samples a texture at a fragment, with this layer as uv.
    fn sample(&self, texture: &Texture, fragment: &Fragment) -> Vec3 {
        let uv = self.corners[fragment.face].map(|w| Vec2::from_slice(self.layer.of(w)));
        // Differences first: uvs may be far from zero, and pixels small.
        let (along, across) = (uv[1] - uv[0], uv[2] - uv[0]);
        let at = |weights: Vec3| along * weights.y + across * weights.z;
        texture.sample(uv[0] + at(fragment.weights), fragment.steps.map(at))
    }
}

fn check_materials(mesh: &Mesh, materials: &Materials) -> Result<(), PictureError> {
    let found = materials.materials.len();
    let expected = mesh.materials.as_ref().map_or(1, |labels| labels.names.len());
    if found < expected {
        return Err(PictureError::Length { what: "materials", found, expected });
    }
    let count = materials.textures.len();
    for (material, texture) in materials.materials.iter().map(|m| m.texture).enumerate() {
        if let Some(texture) = texture.filter(|&texture| texture >= count) {
            return Err(PictureError::NoTexture { material, texture, count });
        }
    }
    Ok(())
}
