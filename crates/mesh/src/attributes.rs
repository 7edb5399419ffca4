//! Vertex attributes, such as normals and texture coordinates, stored per wedge.

use std::fmt;

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
    /// Whole numbers that name something, such as a class or an instance, any number of them per
    /// wedge, held as `f32` and never interpolated.
    Label,
}

impl LayerKind {
    /// Returns the number of values per wedge that a layer of this type must have; `None` if it may
    /// vary.
    pub fn width(self) -> Option<usize> {
        match self {
            Self::Normal => Some(3),
            Self::Uv(_) => Some(2),
            Self::Tangent | Self::Joints(_) | Self::Weights(_) => Some(4),
            Self::Color(_) | Self::Other | Self::Label => None,
        }
    }

    /// Returns true for layers of unit directions: normals and tangents.
    pub fn is_direction(self) -> bool {
        matches!(self, Self::Normal | Self::Tangent)
    }

    /// Returns true for layers that their names tell apart.
    pub fn is_named(self) -> bool {
        matches!(self, Self::Other | Self::Label)
    }

    /// Returns true unless a mean of values has no meaning: joints and their weights, which go
    /// together, and labels.
    pub fn is_blended(self) -> bool {
        !matches!(self, Self::Joints(_) | Self::Weights(_) | Self::Label)
    }

    /// Returns two bytes that stand for the type in files: its code and the number of its set.
    pub fn tag(self) -> (u8, u8) {
        match self {
            Self::Normal => (0, 0),
            Self::Uv(set) => (1, set),
            Self::Color(set) => (2, set),
            Self::Tangent => (3, 0),
            Self::Joints(set) => (4, set),
            Self::Weights(set) => (5, set),
            Self::Other => (6, 0),
            Self::Label => (7, 0),
        }
    }

    /// Returns the type that two bytes of a file encode; `None` for unknown bytes.
    pub fn from_tag(code: u8, set: u8) -> Option<Self> {
        let kinds = [
            Self::Normal,
            Self::Uv(set),
            Self::Color(set),
            Self::Tangent,
            Self::Joints(set),
            Self::Weights(set),
            Self::Other,
            Self::Label,
        ];
        kinds.into_iter().nth(code.into())
    }
}

impl fmt::Display for LayerKind {
    /// Writes the type as a word with the number of its set, such as `normal` or `uv0`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Normal => f.write_str("normal"),
            Self::Uv(set) => write!(f, "uv{set}"),
            Self::Color(set) => write!(f, "color{set}"),
            Self::Tangent => f.write_str("tangent"),
            Self::Joints(set) => write!(f, "joints{set}"),
            Self::Weights(set) => write!(f, "weights{set}"),
            Self::Other => f.write_str("other"),
            Self::Label => f.write_str("label"),
        }
    }
}

/// Writes the type as a text, as `Display` does.
#[cfg(feature = "serde")]
impl serde::Serialize for LayerKind {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
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

/// Largest errors allowed for the attributes of a mesh.
///
/// A bound below the resolution of `f32` is met as closely as `f32` allows.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct AttributeBounds {
    /// Largest error of normals and tangents, in radians, down to .00004 (16 bits for each of two
    /// coordinates).
    ///
    /// A direction of zero length decodes to an arbitrary one.
    pub direction_rad: f64,
    /// Largest error of texture coordinates, where 1 is the whole texture.
    pub uv: f64,
    /// Largest error of colours, whose values range from 0 to 1.
    pub color: f64,
    /// Largest error of joint weights, whose values range from 0 to 1.
    pub weight: f64,
    /// Largest error of all other attributes, as a fraction of the range of their values.
    pub other: f64,
}

impl Default for AttributeBounds {
    /// Directions to a third of a degree, texture coordinates to half a texel of 4096, colours and
    /// weights to 8 bits, all others to 16 bits.
    fn default() -> Self {
        Self {
            direction_rad: 0.006,
            uv: 1.0 / 8192.0,
            color: 1.0 / 512.0,
            weight: 1.0 / 512.0,
            other: 1.0 / 65_536.0,
        }
    }
}

impl AttributeBounds {
    /// Returns the bound of a layer over these wedges, in the layer's unit.
    pub fn of(&self, layer: &Layer, wedges: impl Iterator<Item = WedgeId>) -> f64 {
        match layer.kind {
            LayerKind::Normal | LayerKind::Tangent => self.direction_rad,
            LayerKind::Uv(_) => self.uv,
            LayerKind::Color(_) => self.color,
            LayerKind::Weights(_) => self.weight,
            // Integers.
            LayerKind::Joints(_) | LayerKind::Label => 0.5,
            LayerKind::Other => {
                let values = wedges.flat_map(|wedge| layer.of(wedge));
                let range = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[min, max], &x| {
                    [min.min(x.into()), max.max(x.into())]
                });
                self.other * (range[1] - range[0]).max(0.0)
            }
        }
    }
}
