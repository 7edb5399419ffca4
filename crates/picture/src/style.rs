//! Style of a rendered picture: colours, lighting, wireframe, background, size.

use meshlod_mesh::{LayerKind, Mesh};

use crate::{ColorMap, Texture};

/// Style in which a mesh is rendered, such as its colours and lighting. Colours are sRGB.
#[derive(Clone, Debug)]
pub struct Style<'a> {
    /// Width and height of the picture, in pixels.
    pub size: [u32; 2],
    /// Source of the surface's colours, such as materials or one plain colour.
    pub paint: Paint<'a>,
    /// Normals used for shading the surface.
    pub normals: Normals,
    /// Lighting of the surface.
    pub lighting: Lighting,
    /// Whether each material label of the mesh is single-sided: its faces are seen only from the
    /// front, where their corners run counterclockwise, as glTF says. Labels beyond the last entry,
    /// and all faces of a mesh without labels, are seen from both sides.
    ///
    /// Faces are not culled if their backs are [tinted](BackFaces::Tint).
    pub single_sided: &'a [bool],
    /// Appearance of faces seen from behind.
    pub back_faces: BackFaces,
    /// Lines drawn along the edges of all faces; `None` for no wireframe.
    pub wireframe: Option<Wireframe>,
    /// Background of the picture.
    pub background: Background,
    /// Antialiasing of edges, as a number of samples per pixel.
    pub antialiasing: Antialiasing,
}

impl Default for Style<'_> {
    fn default() -> Self {
        Self {
            size: [1024, 1024],
            paint: Paint::default(),
            normals: Normals::default(),
            lighting: Lighting::default(),
            single_sided: &[],
            back_faces: BackFaces::default(),
            wireframe: None,
            background: Background::default(),
            antialiasing: Antialiasing::default(),
        }
    }
}

impl<'a> Style<'a> {
    /// Returns the style for comparing a mesh with its levels: that of [`comparison`](Self::comparison)
    /// in the colours of [`Paint::comparison`], with the materials that are seen from the front alone.
    pub fn comparison_of(mesh: &Mesh, materials: &'a Materials, single_sided: &'a [bool]) -> Self {
        Self { paint: Paint::comparison(mesh, materials), single_sided, ..Self::comparison() }
    }

    /// Returns the style for comparing pictures of two meshes, with the cameras of
    /// [`Camera::icosahedron_views`](crate::Camera::icosahedron_views).
    ///
    /// Pictures are 1024 by 1024, lit by headlight plus ambient, on a mid-grey background.
    pub fn comparison() -> Self {
        Self {
            normals: Normals::FromMesh,
            lighting: Lighting::Headlight,
            background: Background::Plain([128; 3]),
            ..Self::default()
        }
    }
}

/// Source of a surface's colours, before lighting.
#[derive(Clone, Debug)]
pub enum Paint<'a> {
    /// One colour for the whole surface.
    Plain([u8; 3]),
    /// One colour for each face.
    FaceColors(&'a [[u8; 3]]),
    /// One number for each face, shown as a colour through a colour map.
    FaceValues(Values<'a>),
    /// One number for each vertex, interpolated over faces and shown as a colour through a colour
    /// map.
    VertexValues(Values<'a>),
    /// First vertex colours of the mesh, taken as sRGB; light grey if it has none.
    Colors,
    /// Base colour and texture of each face's material.
    Materials(&'a Materials),
    /// Checkerboard over the first texture coordinates of the mesh.
    Checker {
        /// Number of squares per unit of texture coordinates.
        squares: u32,
    },
}

impl<'a> Paint<'a> {
    /// Chooses surface colours that suit the comparison of a mesh with its levels of detail.
    ///
    /// It takes the first that applies: its materials, if they have a texture; a checkerboard over
    /// its texture coordinates; its vertex colours; the colours of its materials; the default.
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

/// Numbers for the faces or vertices of a mesh, and the colour map that shows them.
#[derive(Clone, Copy, Debug)]
pub struct Values<'a> {
    /// Number for each face or each vertex; NaN is shown grey.
    pub values: &'a [f32],
    /// Colour map that turns the numbers into colours.
    pub map: ColorMap,
    /// Numbers shown in the first and the last colour of the map; those beyond are clamped.
    pub range: [f32; 2],
}

/// Materials and textures of a mesh; its material labels are indices into the list of materials.
///
/// A mesh without labels uses the first material for all faces.
#[derive(Clone, Debug, Default)]
pub struct Materials {
    /// Materials of the mesh, one for each material label.
    pub materials: Vec<PaintMaterial>,
    /// Textures that the materials refer to by index.
    pub textures: Vec<Texture>,
}

/// Material of a surface: base colour and texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintMaterial {
    /// Base colour of the material, linear RGB.
    pub base_color: [f32; 3],
    /// Texture that multiplies the base colour, by index into [`Materials::textures`]; it is placed
    /// by the mesh's first texture coordinates.
    pub texture: Option<usize>,
}

/// Normals used for shading a surface: flat, smooth or from the mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Normals {
    /// Flat shading: one normal per face.
    Flat,
    /// Smooth shading: one normal per vertex.
    #[default]
    Smooth,
    /// Smooth shading across edges whose faces meet at less than the crease angle, sharp edges
    /// elsewhere.
    Creased {
        /// Crease angle between the normals of neighbouring faces, in radians.
        crease_rad: f64,
    },
    /// Normals stored in the mesh; smooth shading if it has none.
    FromMesh,
}

/// Lighting of a surface: the light sources and their strengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lighting {
    /// Light from the upper left, with a soft sky and a faint gloss, for pictures to look at.
    #[default]
    Studio,
    /// Light from the eye, with uniform ambient light, for pictures to compare.
    Headlight,
    /// Mostly uniform light, a little of it from the eye, for colours that carry meaning, as in
    /// heat maps.
    Soft,
    /// No lighting: colours are shown unchanged.
    Unlit,
}

/// Appearance of faces seen from behind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BackFaces {
    /// Faces seen from behind look like those seen from the front.
    #[default]
    Same,
    /// Faces seen from behind have this one colour, so that flipped faces and holes stand out.
    Tint([u8; 3]),
}

impl BackFaces {
    /// Red tint for faces seen from behind, which is not mistaken for a surface colour.
    pub const RED: Self = Self::Tint([196, 92, 78]);
}

/// Lines drawn along the edges of all faces; they fade where faces become too small for them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wireframe {
    /// Colour of the wireframe lines, not affected by lighting.
    pub color: [u8; 3],
    /// Width of a wireframe line along an edge between two faces, in pixels.
    pub width_px: f32,
    /// Opacity of the wireframe lines, from 0 (invisible) to 1.
    pub opacity: f32,
}

impl Default for Wireframe {
    fn default() -> Self {
        Self { color: [24, 32, 46], width_px: 1.2, opacity: 0.75 }
    }
}

/// Background of a picture: transparent, one colour or a gradient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Background {
    /// Transparent background: the alpha of a pixel is the fraction that the mesh covers.
    Transparent,
    /// One colour over the whole background.
    Plain([u8; 3]),
    /// Vertical gradient between two colours.
    Gradient {
        /// Colour at the top of the picture.
        top: [u8; 3],
        /// Colour at the bottom of the picture.
        bottom: [u8; 3],
    },
}

impl Default for Background {
    fn default() -> Self {
        Self::Gradient { top: [250, 251, 253], bottom: [222, 227, 234] }
    }
}

/// Antialiasing of edges, as a number of samples per pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Antialiasing {
    /// One sample per pixel: edges are jagged.
    Off,
    /// 2 by 2 samples per pixel.
    Four,
    /// 3 by 3 samples per pixel.
    #[default]
    Nine,
    /// 4 by 4 samples per pixel.
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
