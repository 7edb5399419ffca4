//! Description of attributes, materials and objects in the header.

use super::super::MAX_LAYER_VALUES;
use super::directions::{BY_NEIGHBOURS, DIRECTION_RESIDUALS};
use super::entries::ENTRY_BITS;
use super::labels::LABEL_BITS;
use super::layer_format::{LayerContexts, LayerFormat, Predictor};
use super::models::{LayerTables, TableCodes};
use super::tangents::TANGENT_BITS;
use super::uv::UV_RESIDUALS;
use super::values::{VALUE_BITS, VALUE_MODES, VALUE_RESIDUALS};
use super::wedges::WEDGE_BITS;
use crate::attributes::LayerCoding;
use crate::bytes::{Malformed, Reader};
use crate::labels::{restore_names, store_names};

/// Contents of a block other than its positions and faces.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in super::super) struct LayersFormat {
    pub(in super::super) layers: Vec<LayerFormat>,
    /// Names of materials and of objects.
    pub(in super::super) names: [Option<Vec<String>>; 2],
}

/// Greatest integer of a component: what f32 distinguishes, on both sides of zero.
const MAX_NUMBER: u32 = 1 << 26;

impl LayerFormat {
    /// Returns the ways in which the layer may be predicted. What the surface expects comes first: it
    /// is taken where others are no better.
    pub(super) fn modes(&self) -> Vec<u8> {
        match self.predictor() {
            Predictor::Uvs => vec![0, 2, 4, 6, 8],
            Predictor::Normals => {
                let modes = (0..3).flat_map(|weight| [0, 4, 8].map(|trust| 3 * trust + weight));
                modes.chain([BY_NEIGHBOURS]).collect()
            }
            Predictor::Tangents => vec![0, 4, 8, BY_NEIGHBOURS],
            Predictor::Values => (0..VALUE_MODES).collect(),
        }
    }

    /// Returns the numbers of contexts of the layer.
    pub(super) fn contexts(&self) -> LayerContexts {
        let (bits, residuals) = match self.predictor() {
            Predictor::Normals => (0, DIRECTION_RESIDUALS),
            Predictor::Tangents => (TANGENT_BITS, DIRECTION_RESIDUALS),
            Predictor::Uvs => (0, UV_RESIDUALS),
            Predictor::Values => (VALUE_BITS, VALUE_RESIDUALS),
        };
        LayerContexts { bits: ENTRY_BITS + bits, residuals }
    }

    fn store(&self, out: &mut Vec<u8>) {
        self.coding.store(out);
        out.push(self.mode);
        if self.coding.direction_bits().is_none() {
            out.extend(self.most.iter().flat_map(|most| most.to_le_bytes()));
        }
    }

    fn restore(reader: &mut Reader) -> Result<Self, Malformed> {
        let coding = LayerCoding::restore(reader)?;
        let mode = reader.u8()?;
        let most: Vec<u32> = match coding.direction_bits() {
            Some(bits) => vec![(1 << bits) - 1; coding.components()],
            None => (0..coding.components()).map(|_| reader.u32()).collect::<Result<_, _>>()?,
        };
        if most.iter().any(|&most| most > MAX_NUMBER) {
            return Err(reader.wrong("a layer has integers of more than 26 bits"));
        }
        let this = Self { coding, mode, most };
        match this.modes().contains(&mode) {
            true => Ok(this),
            false => Err(reader.wrong("a layer is predicted in a way that is unknown here")),
        }
    }
}

impl LayersFormat {
    /// Returns true if blocks have nothing but positions and faces.
    pub(in super::super) fn is_empty(&self) -> bool {
        self.layers.is_empty() && self.names == [None, None]
    }

    /// Returns true if a layer has the mode [`BY_NEIGHBOURS`], which only those of directions have.
    pub(in super::super) fn follows_neighbours(&self) -> bool {
        self.layers.iter().any(|layer| layer.mode == BY_NEIGHBOURS)
    }

    /// Returns the number of values of a wedge.
    pub(in super::super) fn width(&self) -> usize {
        self.layers.iter().map(|layer| layer.coding.width).sum()
    }

    /// Returns the layers in the order in which they are coded: tangents last, since they follow
    /// from texture coordinates and normals.
    pub(super) fn order(&self) -> Vec<usize> {
        let is_last = |&at: &usize| self.layers[at].predictor() == Predictor::Tangents;
        let (last, first): (Vec<_>, Vec<_>) = (0..self.layers.len()).partition(is_last);
        [first, last].concat()
    }

    /// Returns the first contexts of each layer; then those of the two kinds of labels, and the
    /// number of all.
    pub(super) fn contexts(&self) -> (Vec<LayerContexts>, [usize; 2], LayerContexts) {
        let bits = if self.layers.is_empty() { 0 } else { WEDGE_BITS };
        let mut at = LayerContexts { bits, residuals: 0 };
        let mut layers = Vec::with_capacity(self.layers.len());
        for layer in &self.layers {
            layers.push(at);
            let LayerContexts { bits, residuals } = layer.contexts();
            at.bits += bits;
            at.residuals += residuals;
        }
        let labels = [at.bits, at.bits + LABEL_BITS];
        at.bits += 2 * LABEL_BITS;
        (layers, labels, at)
    }

    pub(in super::super) fn store(&self, codes: &TableCodes, out: &mut Vec<u8>) {
        out.push(self.layers.len() as u8);
        self.layers.iter().for_each(|layer| layer.store(out));
        self.names.iter().for_each(|names| store_names(names.as_deref(), out));
        codes.store(out);
    }

    pub(in super::super) fn restore(reader: &mut Reader) -> Result<(Self, LayerTables), Malformed> {
        let mut this = Self::default();
        for _ in 0..reader.u8()? {
            this.layers.push(LayerFormat::restore(reader)?);
        }
        if this.width() > MAX_LAYER_VALUES {
            return Err(reader.wrong(format!("a wedge has more than {MAX_LAYER_VALUES} values")));
        }
        this.names = [restore_names(reader)?, restore_names(reader)?];
        let (_, _, all) = this.contexts();
        let codes = TableCodes::restore(all.bits, all.residuals, reader)?;
        Ok((this, LayerTables::new(&codes)))
    }
}
