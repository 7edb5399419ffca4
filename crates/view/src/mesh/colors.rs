//! Colours of a surface, as the GPU takes them.

use std::borrow::Cow;

use meshlod::Mesh;
use meshlod::mesh::LayerKind;
use meshlod::picture::{Materials, Paint, PaintMaterial, PictureError, Texture, Values};

use crate::placement::linear;

/// Colours of a mesh: of its materials, its vertices and its faces. They are multiplied.
pub(crate) struct Surface<'a> {
    pub materials: Vec<SurfaceMaterial<'a>>,
    pub vertex_colors: VertexColors,
    pub face_colors: Option<Cow<'a, [[u8; 3]]>>,
}

/// Linear colour, texture and sides.
#[derive(Clone)]
pub(crate) struct SurfaceMaterial<'a> {
    pub base_color: [f32; 3],
    pub texture: Option<Cow<'a, Texture>>,
    /// Faces are seen only from the front.
    pub is_single_sided: bool,
}

/// sRGB colours of vertices.
pub(crate) enum VertexColors {
    White,
    /// First vertex colours of the mesh.
    Wedges,
    Vertices(Vec<[u8; 3]>),
}

/// Fallback colour where the paint's attribute is missing.
const BARE: [u8; 3] = [205; 3];

/// Colour of values that are not a number.
const NOT_A_NUMBER: [u8; 3] = [128; 3];

impl<'a> Surface<'a> {
    /// Finds the colours of a mesh in a paint.
    ///
    /// # Errors
    /// A paint that does not match the mesh.
    pub(crate) fn new(mesh: &'a Mesh, paint: &Paint<'a>) -> Result<Self, PictureError> {
        let layer = |kind| mesh.attributes.as_ref().and_then(|all| all.layer(kind));
        let has_colors = layer(LayerKind::Color(0)).is_some_and(|layer| layer.width >= 3);
        let has_uv = layer(LayerKind::Uv(0)).is_some();
        Ok(match *paint {
            Paint::Plain(color) => Self::plain(color),
            Paint::FaceColors(colors) => {
                check("colours of faces", colors.len(), mesh.faces.len())?;
                Self { face_colors: Some(Cow::Borrowed(colors)), ..Self::white() }
            }
            Paint::FaceValues(values) => {
                check("values of faces", values.values.len(), mesh.faces.len())?;
                Self { face_colors: Some(mapped(&values).into()), ..Self::white() }
            }
            Paint::VertexValues(values) => {
                check("values of vertices", values.values.len(), mesh.positions.len())?;
                Self { vertex_colors: VertexColors::Vertices(mapped(&values)), ..Self::white() }
            }
            Paint::Colors if has_colors => {
                Self { vertex_colors: VertexColors::Wedges, ..Self::white() }
            }
            Paint::Checker { squares } if has_uv => {
                let texture = Some(Cow::Owned(Texture::checker(squares)));
                let checker =
                    SurfaceMaterial { base_color: [1.0; 3], texture, is_single_sided: false };
                Self { materials: vec![checker], ..Self::white() }
            }
            Paint::Colors | Paint::Checker { .. } => Self::plain(BARE),
            Paint::Materials(all) => {
                Self { materials: materials(mesh, all, has_uv)?, ..Self::white() }
            }
        })
    }

    /// Returns a surface of one sRGB colour.
    fn plain(color: [u8; 3]) -> Self {
        let base_color = linear(color);
        Self {
            materials: vec![SurfaceMaterial { base_color, texture: None, is_single_sided: false }],
            vertex_colors: VertexColors::White,
            face_colors: None,
        }
    }

    fn white() -> Self {
        Self::plain([255; 3])
    }

    /// Gives each material label its own material, single-sided where it says so; see
    /// [`Style::single_sided`](meshlod::picture::Style::single_sided).
    pub(crate) fn with_sides(mut self, mesh: &Mesh, single_sided: &[bool]) -> Self {
        let labels = mesh.materials.as_ref().filter(|_| single_sided.contains(&true));
        let Some(labels) = labels else { return self };
        if let [only] = &self.materials[..] {
            self.materials = vec![only.clone(); labels.names.len().max(1)];
        }
        for (material, &is_single_sided) in self.materials.iter_mut().zip(single_sided) {
            material.is_single_sided = is_single_sided;
        }
        self
    }
}

/// Returns the materials of a paint, with textures if the mesh has texture coordinates.
fn materials<'a>(
    mesh: &Mesh,
    all: &'a Materials,
    has_uv: bool,
) -> Result<Vec<SurfaceMaterial<'a>>, PictureError> {
    let expected = mesh.materials.as_ref().map_or(1, |labels| labels.names.len());
    check("materials", all.materials.len(), expected)?;
    let texture = |index: usize| {
        let found = all.textures.get(index).map(Cow::Borrowed);
        let count = all.textures.len();
        found.ok_or(PictureError::NoTexture { material: 0, texture: index, count })
    };
    let material = |material: &PaintMaterial| {
        let texture = material.texture.filter(|_| has_uv).map(texture).transpose()?;
        Ok(SurfaceMaterial { base_color: material.base_color, texture, is_single_sided: false })
    };
    all.materials.iter().map(material).collect()
}

/// Returns the colours of values.
fn mapped(values: &Values<'_>) -> Vec<[u8; 3]> {
    let Values { values, map, range: [low, high] } = *values;
    let span = high - low;
    let per_value = if span != 0.0 && span.is_finite() { 1.0 / span } else { 0.0 };
    let color = |&value: &f32| match value.is_nan() {
        true => NOT_A_NUMBER,
        false => map.color(((value - low) * per_value).clamp(0.0, 1.0)),
    };
    values.iter().map(color).collect()
}

pub(super) fn check(what: &'static str, found: usize, expected: usize) -> Result<(), PictureError> {
    let is_enough = if what == "materials" { found >= expected } else { found == expected };
    if is_enough { Ok(()) } else { Err(PictureError::Length { what, found, expected }) }
}
