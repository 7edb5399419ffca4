//! Values by slot of the layers that channels do not hold.

use meshlod_mesh::{LayerKind, WedgeId};

use crate::kernel::attributes::layers::UncostedLayer;
use crate::kernel::attributes::slots::{SlotRanges, Slots};
use crate::surface::charts::is_shading_kind;
use crate::surface::interpolate::{LayerValues, Place, interpolate};

/// Values of a part's slots in one uncosted layer.
pub(crate) struct CarriedLayer<'p> {
    kind: LayerKind,
    width: usize,
    values: Slots<'p, f32>,
}

impl LayerValues for CarriedLayer<'_> {
    fn kind(&self) -> LayerKind {
        self.kind
    }

    fn width(&self) -> usize {
        self.width
    }

    fn of(&self, slot: WedgeId) -> &[f32] {
        self.values.row(slot.0, self.width)
    }
}

/// Values of a part's slots in all uncosted layers.
#[derive(Default)]
pub(crate) struct CarriedLayers<'p>(Vec<CarriedLayer<'p>>);

impl<'p> CarriedLayers<'p> {
    /// Cuts the values of the layers by slot into parts; the first `vertices` slots are vertices.
    pub(crate) fn cut(
        layers: &[UncostedLayer],
        values: &'p mut [Vec<f32>],
        vertices: usize,
        parts: &[SlotRanges],
    ) -> Vec<Self> {
        let mut cut: Vec<Self> = parts.iter().map(|_| Self::default()).collect();
        for (&UncostedLayer { kind, width, .. }, values) in layers.iter().zip(values) {
            let slots = Slots::cut(values, (vertices, width), parts);
            for (part, values) in cut.iter_mut().zip(slots) {
                part.0.push(CarriedLayer { kind, width, values });
            }
        }
        cut
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the values of a slot in the layer with this number.
    pub(crate) fn of(&self, number: usize, slot: u32) -> &[f32] {
        self.0[number].of(WedgeId(slot))
    }

    /// Copies all but shading from another slot.
    pub(crate) fn copy_textures(&mut self, slot: u32, other: u32) {
        self.copy_where(slot, other, |kind| !is_shading_kind(kind));
    }

    /// Copies all values from another slot.
    pub(crate) fn copy_all(&mut self, slot: u32, other: u32) {
        self.copy_where(slot, other, |_| true);
    }

    /// Copies joints and their weights from another slot: all wedges of a vertex move as one.
    pub(crate) fn copy_skin(&mut self, slot: u32, other: u32) {
        let is_skin = |kind| matches!(kind, LayerKind::Joints(_) | LayerKind::Weights(_));
        self.copy_where(slot, other, is_skin);
    }

    fn copy_where(&mut self, slot: u32, other: u32, is_copied: impl Fn(LayerKind) -> bool) {
        for layer in self.0.iter_mut().filter(|layer| is_copied(layer.kind)) {
            for i in 0..layer.width {
                let value = layer.values.row(other, layer.width)[i];
                layer.values.row_mut(slot, layer.width)[i] = value;
            }
        }
    }

    /// Appends the values interpolated at a place between slots.
    pub(crate) fn at(&self, place: &Place, values: &mut Vec<f32>) {
        interpolate(&self.0, place, values);
    }

    /// Gives a slot the first of values that were interpolated. Returns the remaining ones.
    pub(crate) fn set<'v>(&mut self, slot: u32, mut values: &'v [f32]) -> &'v [f32] {
        for layer in &mut self.0 {
            let (these, others) = values.split_at(layer.width);
            layer.values.row_mut(slot, layer.width).copy_from_slice(these);
            values = others;
        }
        values
    }
}
