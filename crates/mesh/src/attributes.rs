//! Vertex attributes, such as normals and texture coordinates, stored per wedge.

use crate::WedgeId;

/// Type of an attribute layer, such as normals; it determines how values are interpolated and
/// written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LayerKind {
    /// Unit normals, 3 values per wedge.
    Normal,
    /// Texture coordinate set with this number, 2 values per wedge; the origin is at the lower
    /// left, as in OBJ.
    Uv(u8),
    /// Colour set with this number, linear or sRGB as in the file, in [0, 1]; 3 or 4 values per
    /// wedge.
    Color(u8),
    /// Unit tangent and handedness, 4 values per wedge.
    Tangent,
    /// Skinning joint indices of the set with this number: 4 whole numbers per wedge, held as `f32`
    /// and never interpolated.
    Joints(u8),
    /// Skinning weights of the set with this number, 4 values per wedge.
    Weights(u8),
    /// Any other attribute, with any number of values per wedge.
    Other,
}

impl LayerKind {
    /// Returns the number of values per wedge that a layer of this type must have; `None` if it may
    /// vary.
    pub fn width(self) -> Option<usize> {
        match self {
            Self::Normal => Some(3),
            Self::Uv(_) => Some(2),
            Self::Tangent | Self::Joints(_) | Self::Weights(_) => Some(4),
            Self::Color(_) | Self::Other => None,
        }
    }
}

/// Attribute layer: the values of one attribute, such as normals, for all wedges of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Type of the attribute, such as normals or texture coordinates.
    pub kind: LayerKind,
    /// Name of the attribute in the file. It does not determine the type: normals may have any
    /// name.
    pub name: String,
    /// Number of values per wedge, such as 3 for normals.
    pub width: usize,
    /// Values of all wedges, wedge after wedge, `width` values each.
    pub values: Vec<f32>,
}

impl Layer {
    /// Returns the values of one wedge as a slice of length `width`.
    #[inline]
    pub fn of(&self, wedge: WedgeId) -> &[f32] {
        &self.values[wedge.index() * self.width..][..self.width]
    }

    /// Returns the values of one wedge as a mutable slice of length `width`.
    #[inline]
    pub fn of_mut(&mut self, wedge: WedgeId) -> &mut [f32] {
        &mut self.values[wedge.index() * self.width..][..self.width]
    }
}

/// Attributes of a mesh, stored per wedge: a wedge holds the values for one or more corners at a
/// vertex.
///
/// Every wedge belongs to one vertex. An edge whose two faces use different wedges at an end is a
/// seam.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes {
    /// Wedge at each corner of each face, in the order of the mesh's faces and their vertices.
    pub corners: Vec<[WedgeId; 3]>,
    /// Number of wedges; every layer has this many times its width in values.
    pub wedge_count: usize,
    /// Attribute layers, such as normals and texture coordinates, with values for every wedge.
    pub layers: Vec<Layer>,
}

impl Attributes {
    /// Returns the first layer of a type, such as the normals; `None` if there is no such layer.
    pub fn layer(&self, kind: LayerKind) -> Option<&Layer> {
        self.layers.iter().find(|layer| layer.kind == kind)
    }
}
