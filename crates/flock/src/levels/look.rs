//! Colours of a model.

use std::borrow::Cow;

use meshlod_mesh::{Layer, LayerKind};
use meshlod_picture::{Materials, Paint, PaintMaterial};

/// Materials of a model, for the pictures by which levels are compared.
#[derive(Clone, Debug, Default)]
pub struct Look {
    /// Materials and textures; without any, vertex colours are shown.
    pub materials: Option<Materials>,
}

/// Colour of models without colours of their own, linear.
const PLAIN: [f32; 3] = [0.75, 0.62, 0.48];

impl Look {
    /// Returns the paint for a mesh of the model.
    pub fn paint(&self) -> Paint<'_> {
        self.materials.as_ref().map_or(Paint::Colors, Paint::Materials)
    }

    /// Returns the materials with which a model of these layers is drawn, a plain one if it has no
    /// colours at all; `None` if its vertex colours are shown.
    pub fn materials_over(&self, layers: &[Layer]) -> Option<Cow<'_, Materials>> {
        match &self.materials {
            Some(materials) => Some(Cow::Borrowed(materials)),
            None if layers.iter().any(is_color) => None,
            None => {
                let plain = PaintMaterial { base_color: PLAIN, texture: None };
                Some(Cow::Owned(Materials { materials: vec![plain], ..Materials::default() }))
            }
        }
    }
}

/// Returns true for the vertex colours that pictures show.
pub(crate) fn is_color(layer: &Layer) -> bool {
    layer.kind == LayerKind::Color(0) && layer.width >= 3
}
