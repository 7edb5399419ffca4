//! Attributes: layers of values over wedges, with corner indices of their own.

use crate::WedgeId;

/// What a layer means, and so how it is interpolated and written.
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
    /// Any other named layer, of any width.
    Other,
}

impl LayerKind {
    /// The width that a layer of this kind must have, where it has only one.
    pub fn width(self) -> Option<usize> {
        match self {
            Self::Normal => Some(3),
            Self::Uv(_) => Some(2),
            Self::Tangent | Self::Joints(_) | Self::Weights(_) => Some(4),
            Self::Color(_) | Self::Other => None,
        }
    }
}

/// One attribute over all wedges.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// What the values mean.
    pub kind: LayerKind,
    /// The file's name of it; for the known kinds the name is free.
    pub name: String,
    /// Values per wedge.
    pub width: usize,
    /// `width` values for each wedge, wedge after wedge.
    pub values: Vec<f32>,
}

impl Layer {
    /// The values of one wedge: a slice of `width`.
    #[inline]
    pub fn of(&self, wedge: WedgeId) -> &[f32] {
        &self.values[wedge.index() * self.width..][..self.width]
    }

    /// The values of one wedge, to change.
    #[inline]
    pub fn of_mut(&mut self, wedge: WedgeId) -> &mut [f32] {
        &mut self.values[wedge.index() * self.width..][..self.width]
    }
}

/// The attributes of a mesh: wedges at the corners of its faces, layers of values over the wedges.
///
/// Every wedge belongs to one vertex. An edge whose two faces use different wedges at an end is a
/// seam.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes {
    /// The wedge of every corner, one triple per face of the mesh, in its order.
    pub corners: Vec<[WedgeId; 3]>,
    /// How many wedges there are; every layer has this many values times its width.
    pub wedge_count: usize,
    /// The layers.
    pub layers: Vec<Layer>,
}

impl Attributes {
    /// The first layer of a kind.
    pub fn layer(&self, kind: LayerKind) -> Option<&Layer> {
        self.layers.iter().find(|layer| layer.kind == kind)
    }
}
