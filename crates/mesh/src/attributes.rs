//! Vertex attributes: layers of values over wedges, with corner indices of their own.

use crate::WedgeId;

/// Meaning of a layer, which decides how it is interpolated and written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LayerKind {
    /// Unit normal, 3 wide.
    Normal,
    /// Texture coordinate set by number, 2 wide, origin at the lower left as in OBJ.
    Uv(u8),
    /// Linear or sRGB colour set by number as the file has it, in [0, 1]; 3 or 4 wide.
    Color(u8),
    /// Unit tangent and handedness, 4 wide.
    Tangent,
    /// Joint indices set by number, whole numbers held as `f32`, 4 wide: never interpolated.
    Joints(u8),
    /// Joint weights set by number, 4 wide.
    Weights(u8),
    /// Any other layer, of any width.
    Other,
}

impl LayerKind {
    /// Returns the width that a layer of this kind must have; `None` if the kind allows several.
    pub fn width(self) -> Option<usize> {
        match self {
            Self::Normal => Some(3),
            Self::Uv(_) => Some(2),
            Self::Tangent | Self::Joints(_) | Self::Weights(_) => Some(4),
            Self::Color(_) | Self::Other => None,
        }
    }
}

/// One attribute: values for every wedge.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Meaning of the values.
    pub kind: LayerKind,
    /// Name in the file; a known kind may have any name.
    pub name: String,
    /// Number of values per wedge.
    pub width: usize,
    /// Values of all wedges, `width` for each, wedge after wedge.
    pub values: Vec<f32>,
}

impl Layer {
    /// Returns the values of one wedge, a slice of `width`.
    #[inline]
    pub fn of(&self, wedge: WedgeId) -> &[f32] {
        &self.values[wedge.index() * self.width..][..self.width]
    }

    /// Returns the values of one wedge, a mutable slice of `width`.
    #[inline]
    pub fn of_mut(&mut self, wedge: WedgeId) -> &mut [f32] {
        &mut self.values[wedge.index() * self.width..][..self.width]
    }
}

/// Attributes of a mesh: wedges at the corners of its faces, and layers of values over the wedges.
///
/// Every wedge belongs to one vertex. An edge whose two faces use different wedges at an end is a
/// seam.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes {
    /// Wedges at the corners of each face, in the order of the mesh's faces.
    pub corners: Vec<[WedgeId; 3]>,
    /// Number of wedges; a layer has this many values times its width.
    pub wedge_count: usize,
    /// Layers of values over the wedges.
    pub layers: Vec<Layer>,
}

impl Attributes {
    /// Returns the first layer of a kind.
    pub fn layer(&self, kind: LayerKind) -> Option<&Layer> {
        self.layers.iter().find(|layer| layer.kind == kind)
    }
}
