//! Coding and predictor of one attribute layer of a file.

use meshlod_mesh::LayerKind;

use crate::attributes::LayerCoding;

/// Attribute layer of a file.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct LayerFormat {
    pub(in super::super) coding: LayerCoding,
    /// Mode of the predictor; its file has the meanings.
    pub(super) mode: u8,
    /// Greatest integer of each component.
    pub(super) most: Vec<u32>,
}

/// Predictor of the values of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Predictor {
    Normals,
    Tangents,
    Uvs,
    Values,
}

/// First contexts of a layer: of bits and of residuals.
#[derive(Clone, Copy, Debug)]
pub(super) struct LayerContexts {
    pub(super) bits: usize,
    pub(super) residuals: usize,
}

impl LayerFormat {
    /// Returns the predictor for the kind of the layer.
    pub(super) fn predictor(&self) -> Predictor {
        match self.coding.kind {
            LayerKind::Normal => Predictor::Normals,
            LayerKind::Tangent => Predictor::Tangents,
            LayerKind::Uv(_) => Predictor::Uvs,
            _ => Predictor::Values,
        }
    }
}
