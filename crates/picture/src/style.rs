//! How a picture shall look.

use meshlod_mesh::{LayerKind, Mesh};

use crate::{ColorMap, Texture};

/// How a mesh is drawn. Colours are sRGB.
#[derive(Clone, Debug)]
pub struct Style<'a> {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The colour of the surface.
    pub paint: Paint<'a>,
    /// How round it looks.
    pub normals: Normals,
    /// The light on it.
    pub lighting: Lighting,
    /// How the inner sides of faces look.
    pub back_faces: BackFaces,
    /// Lines along the edges of all faces.
    pub wireframe: Option<Wireframe>,
    /// What is behind.
    pub background: Background,
    /// How edges are smoothed.
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
    /// The style in which pictures of two meshes are compared, beside
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

/// The colour of a surface, before light.
#[derive(Clone, Debug)]
pub enum Paint<'a> {
    /// One colour.
    Plain([u8; 3]),
    /// One colour per face.
    FaceColors(&'a [[u8; 3]]),
    /// One number per face, as a colour.
    FaceValues(Values<'a>),
    /// One number per vertex, as a colour; numbers are blended over faces, and only then coloured.
    VertexValues(Values<'a>),
    /// The mesh's first colour layer, taken as sRGB; light grey where it has none.
    Colors,
    /// The colour and texture of each face's material.
    Materials(&'a Materials),
    /// A checkerboard of so many squares a side over the first uv layer.
    Checker {
        /// Squares per unit of uv.
        squares: u32,
    },
}

impl<'a> Paint<'a> {
    /// The paint in which a mesh is compared with its levels: its materials where they have a
    /// texture, else a checkerboard over its uvs, its colours, the colours of its materials, or
    /// the default: the first of these that it has.
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

/// Numbers over a mesh and how they become colours.
#[derive(Clone, Copy, Debug)]
pub struct Values<'a> {
    /// One per face or per vertex. NaN is shown grey.
    pub values: &'a [f32],
    /// The colours.
    pub map: ColorMap,
    /// The numbers with the first and the last colour of the map; beyond them it does not change.
    pub range: [f32; 2],
}

/// Materials by label: `mesh.materials` names an entry for every face. A mesh without labels is
/// all of the first.
#[derive(Clone, Debug, Default)]
pub struct Materials {
    /// One per name of the mesh's material labels.
    pub materials: Vec<PaintMaterial>,
    /// What they share.
    pub textures: Vec<Texture>,
}

/// What a surface is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintMaterial {
    /// Linear RGB.
    pub base_color: [f32; 3],
    /// What multiplies it, by index into [`Materials::textures`]; looked up by the first uv layer.
    pub texture: Option<usize>,
}

/// How round a surface looks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Normals {
    /// Every face is flat.
    Flat,
    /// One normal per vertex: no edge is sharp.
    #[default]
    Smooth,
    /// Smooth where neighbouring faces bend by less than an angle, sharp where by more.
    Creased {
        /// The angle, in radians.
        crease_rad: f64,
    },
    /// The mesh's normal layer; smooth where it has none.
    FromMesh,
}

/// The light on a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lighting {
    /// From the upper left, with a soft sky and a faint gloss: for pictures to look at.
    #[default]
    Studio,
    /// From the eye, with an even rest: for pictures to compare.
    Headlight,
    /// Mostly even, a little from the eye: for colours that mean something, as in heat maps.
    Soft,
    /// Colours as they are.
    Unlit,
}

/// How the inner sides of faces look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BackFaces {
    /// As the outer ones.
    #[default]
    Same,
    /// In one colour, whatever the paint: turned faces and holes catch the eye.
    Tint([u8; 3]),
}

impl BackFaces {
    /// A red that no surface is mistaken for.
    pub const RED: Self = Self::Tint([196, 92, 78]);
}

/// Lines along the edges of all faces. They fade where faces become too small for them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wireframe {
    /// The colour, not lit.
    pub color: [u8; 3],
    /// Width of a line between two faces, in pixels.
    pub width_px: f32,
    /// How much of the surface a line hides, 0 to 1.
    pub opacity: f32,
}

impl Default for Wireframe {
    fn default() -> Self {
        Self { color: [24, 32, 46], width_px: 1.2, opacity: 0.75 }
    }
}

/// What is behind the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Background {
    /// Nothing: alpha says how much of a pixel is covered.
    Transparent,
    /// One colour.
    Plain([u8; 3]),
    /// From one colour at the top to another at the bottom.
    Gradient {
        /// At the top.
        top: [u8; 3],
        /// At the bottom.
        bottom: [u8; 3],
    },
}

impl Default for Background {
    fn default() -> Self {
        Self::Gradient { top: [250, 251, 253], bottom: [222, 227, 234] }
    }
}

/// How many samples a pixel is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Antialiasing {
    /// One: hard edges.
    Off,
    /// 2 by 2.
    Four,
    /// 3 by 3.
    #[default]
    Nine,
    /// 4 by 4.
    Sixteen,
}

impl Antialiasing {
    /// Samples along a pixel's side.
    pub(crate) fn across(self) -> u32 {
        match self {
            Self::Off => 1,
            Self::Four => 2,
            Self::Nine => 3,
            Self::Sixteen => 4,
        }
    }
}
