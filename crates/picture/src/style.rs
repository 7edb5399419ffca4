//! Look of a picture.

use meshlod_mesh::{LayerKind, Mesh};

use crate::{ColorMap, Texture};

/// Style in which a mesh is rendered. Colours are sRGB.
#[derive(Clone, Debug)]
pub struct Style<'a> {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Colour of the surface.
    pub paint: Paint<'a>,
    /// Shading normals.
    pub normals: Normals,
    /// Lighting of the surface.
    pub lighting: Lighting,
    /// Look of faces seen from behind.
    pub back_faces: BackFaces,
    /// Lines along the edges of all faces.
    pub wireframe: Option<Wireframe>,
    /// Background of the picture.
    pub background: Background,
    /// Number of samples per pixel.
    pub antialiasing: Antialiasing,
}

impl Default for Style<'_> {
    fn default() -> Self {
        Self {
            size: [1024, 1024],
            paint: Paint::default(),
            normals: Normals::default(),
            lighting: Lighting::default(),
            back_faces: BackFaces::default(),
            wireframe: None,
            background: Background::default(),
            antialiasing: Antialiasing::default(),
        }
    }
}

impl Style<'_> {
    /// Returns the style for comparing pictures of two meshes, together with
    /// [`Camera::icosahedron_views`](crate::Camera::icosahedron_views): 1024 by 1024, headlight
    /// plus ambient, mid-grey background.
    pub fn comparison() -> Self {
        Self {
            normals: Normals::FromMesh,
            lighting: Lighting::Headlight,
            background: Background::Plain([128; 3]),
            ..Self::default()
        }
    }
}

/// Colour of a surface before lighting.
#[derive(Clone, Debug)]
pub enum Paint<'a> {
    /// One colour.
    Plain([u8; 3]),
    /// One colour per face.
    FaceColors(&'a [[u8; 3]]),
    /// One number per face, shown through a colour map.
    FaceValues(Values<'a>),
    /// One number per vertex, interpolated over faces, then shown through a colour map.
    VertexValues(Values<'a>),
    /// First colour layer of the mesh, taken as sRGB; light grey if it has none.
    Colors,
    /// Colour and texture of each face's material.
    Materials(&'a Materials),
    /// Checkerboard over the first uv layer.
    Checker {
        /// Squares per unit of uv.
        squares: u32,
    },
}

impl<'a> Paint<'a> {
    /// Chooses the paint for comparing a mesh with its levels: the first that applies of its
    /// materials, if they have a texture, a checkerboard over its uvs, its colours, the colours of
    /// its materials, and the default.
    ///
    /// `materials` has an entry for every material label of the mesh, or at least one.
    pub fn comparison(mesh: &Mesh, materials: &'a Materials) -> Self {
        let layers = |kind| mesh.attributes.as_ref().and_then(|all| all.layer(kind));
        let labels = mesh.materials.as_ref().map_or(&[0][..], |labels| &labels.of_face);
        let used = || labels.iter().filter_map(|&label| materials.materials.get(label as usize));
        if used().any(|material| material.texture.is_some()) {
            return Self::Materials(materials);
        }
        if layers(LayerKind::Uv(0)).is_some() {
            return Self::Checker { squares: 16 };
        }
        if layers(LayerKind::Color(0)).is_some() {
            return Self::Colors;
        }
        match used().any(|material| material.base_color != [1.0; 3]) {
            true => Self::Materials(materials),
            false => Self::default(),
        }
    }
}

impl Default for Paint<'_> {
    fn default() -> Self {
        Self::Plain([226, 208, 186])
    }
}

/// Numbers over a mesh, and the colour map that shows them.
#[derive(Clone, Copy, Debug)]
pub struct Values<'a> {
    /// One number per face or per vertex; NaN is shown grey.
    pub values: &'a [f32],
    /// Colour map for the numbers.
    pub map: ColorMap,
    /// Numbers at the first and the last colour of the map; others are clamped.
    pub range: [f32; 2],
}

/// Materials by label: each material label of a mesh is an index into these. A mesh without labels
/// uses the first for all faces.
#[derive(Clone, Debug, Default)]
pub struct Materials {
    /// One material per material label of the mesh.
    pub materials: Vec<PaintMaterial>,
    /// Textures that the materials refer to.
    pub textures: Vec<Texture>,
}

/// Material of a surface in [`Paint::Materials`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintMaterial {
    /// Base colour, linear RGB.
    pub base_color: [f32; 3],
    /// Index of a texture in [`Materials::textures`] that multiplies the base colour; it is sampled
    /// with the first uv layer.
    pub texture: Option<usize>,
}

/// Shading normals of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Normals {
    /// Flat shading: one normal per face.
    Flat,
    /// Smooth shading: one normal per vertex.
    #[default]
    Smooth,
    /// Smooth where the angle between neighbouring faces is below a limit, sharp elsewhere.
    Creased {
        /// Crease angle, in radians.
        crease_rad: f64,
    },
    /// Normal layer of the mesh; smooth if it has none.
    FromMesh,
}

/// Lighting of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lighting {
    /// From the upper left, with a soft sky and a faint gloss, for pictures to look at.
    #[default]
    Studio,
    /// From the eye, with uniform ambient light, for pictures to compare.
    Headlight,
    /// Mostly uniform, a little from the eye, for colours that carry meaning, as in heat maps.
    Soft,
    /// No lighting: colours are shown unchanged.
    Unlit,
}

/// Look of faces seen from behind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BackFaces {
    /// Like front faces.
    #[default]
    Same,
    /// One colour regardless of the paint, so that flipped faces and holes stand out.
    Tint([u8; 3]),
}

impl BackFaces {
    /// Tint in a red that is not mistaken for a surface colour.
    pub const RED: Self = Self::Tint([196, 92, 78]);
}

/// Lines along the edges of all faces; they fade where faces become too small for them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wireframe {
    /// Colour of the lines, not lit.
    pub color: [u8; 3],
    /// Width of a line between two faces, in pixels.
    pub width_px: f32,
    /// Opacity of the lines, 0 to 1.
    pub opacity: f32,
}

impl Default for Wireframe {
    fn default() -> Self {
        Self { color: [24, 32, 46], width_px: 1.2, opacity: 0.75 }
    }
}

/// Background of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Background {
    /// Transparent: alpha is the covered fraction of a pixel.
    Transparent,
    /// One colour.
    Plain([u8; 3]),
    /// Vertical gradient.
    Gradient {
        /// Colour at the top.
        top: [u8; 3],
        /// Colour at the bottom.
        bottom: [u8; 3],
    },
}

impl Default for Background {
    fn default() -> Self {
        Self::Gradient { top: [250, 251, 253], bottom: [222, 227, 234] }
    }
}

/// Number of samples per pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Antialiasing {
    /// One sample: aliased edges.
    Off,
    /// 2 by 2 samples.
    Four,
    /// 3 by 3 samples.
    #[default]
    Nine,
    /// 4 by 4 samples.
    Sixteen,
}

impl Antialiasing {
    /// Returns the number of samples per pixel side.
    pub(crate) fn across(self) -> u32 {
        match self {
            Self::Off => 1,
            Self::Four => 2,
            Self::Nine => 3,
            Self::Sixteen => 4,
        }
    }
}
