//! Colours of members and obstacles.

use meshlod_mesh::Layer;
use meshlod_picture::{Materials, Paint, PaintMaterial};

use crate::levels::Look;

/// Colours of members and obstacles.
pub(super) enum OwnedPaint {
    /// Vertex colours.
    Colors,
    /// Materials of the model, and one for obstacles after them.
    Materials(Materials),
}

/// sRGB colour of obstacles, each channel from 0 to 1.
pub const STONE: [f32; 3] = [0.47, 0.45, 0.42];

impl OwnedPaint {
    /// Returns the colours of members whose vertices have these layers.
    pub(super) fn new(look: &Look, layers: &[Layer]) -> Self {
        let materials = look.materials_over(layers);
        materials.map_or(Self::Colors, |all| Self::Materials(with_stone(all.into_owned())))
    }

    /// Returns the paint for pictures.
    pub(super) fn paint(&self) -> Paint<'_> {
        match self {
            Self::Colors => Paint::Colors,
            Self::Materials(materials) => Paint::Materials(materials),
        }
    }

    /// Returns the material of obstacles.
    pub(super) fn stone(&self) -> u32 {
        match self {
            Self::Colors => 0,
            Self::Materials(materials) => materials.materials.len() as u32 - 1,
        }
    }
}

/// Appends the material of obstacles to the model's materials.
fn with_stone(mut materials: Materials) -> Materials {
    // Linear from sRGB, roughly: a shade of grey need not be exact.
    let base_color = STONE.map(|x| x.powf(2.2));
    materials.materials.push(PaintMaterial { base_color, texture: None });
    materials
}
