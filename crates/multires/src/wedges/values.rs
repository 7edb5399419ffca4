//! Attribute values of wedges, kept as the integers that a file has for them.
//!
//! Values that were read are as they were decoded, and recorded ones are what the mesh had, both to
//! the bit: a recorded layer is coded by the bit patterns of its values, as in a lossless file.

use meshlod_mesh::{Layer, LayerKind, WedgeId};

use crate::file::LayerCoding;
use crate::pack::PackedTable;

/// Values of wedges that are being collected, in rows of integers.
#[derive(Clone, Debug, Default)]
pub(crate) struct WedgeNumbers {
    pub(crate) coding: Vec<LayerCoding>,
    /// Integers of all layers, wedge after wedge.
    pub(crate) numbers: Vec<i32>,
}

/// Values of the wedges of a model, in as few bits as the ranges of their integers allow.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct WedgeValues {
    coding: Vec<LayerCoding>,
    /// Number of values of a wedge.
    width: usize,
    /// A row for each wedge.
    table: PackedTable,
}

impl WedgeNumbers {
    /// Prepares for values of layers that are to come back to the bit.
    pub(crate) fn exact(layers: &[Layer]) -> Self {
        let coding = layers.iter().map(|layer| LayerCoding::new(layer, None)).collect();
        Self { coding, numbers: Vec::new() }
    }

    /// Adds a wedge, with its values in the layers that this was made for, or zeros.
    pub(crate) fn push(&mut self, layers: &[Layer], wedge: Option<WedgeId>) {
        for (coding, layer) in self.coding.iter().zip(layers) {
            match wedge {
                Some(wedge) => coding.encode(layer.of(wedge), &mut self.numbers),
                None => coding.encode(&vec![0.0; layer.width], &mut self.numbers),
            }
        }
    }

    /// Packs the values of some wedges, in the given order.
    pub(crate) fn packed(&self, wedges: impl Iterator<Item = u32> + Clone) -> WedgeValues {
        let columns = columns(&self.coding);
        let row = |wedge: u32| &self.numbers[wedge as usize * columns..][..columns];
        let table = PackedTable::new(columns, wedges.map(row));
        let width = self.coding.iter().map(|coding| coding.width).sum();
        WedgeValues { coding: self.coding.clone(), width, table }
    }
}

impl WedgeValues {
    /// Returns the number of wedges.
    pub(crate) fn wedge_count(&self) -> usize {
        self.table.rows()
    }

    /// Iterates over what the layers are, without their values.
    pub(crate) fn formats(&self) -> impl ExactSizeIterator<Item = LayerFormat<'_>> + Clone {
        self.coding.iter().map(|coding| LayerFormat {
            kind: coding.kind,
            name: &coding.name,
            width: coding.width,
        })
    }

    /// Returns the number of values of a wedge, over all layers.
    #[inline]
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    /// Returns true if there are no layers.
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.coding.is_empty()
    }

    /// Appends the values of a wedge in all layers.
    pub(crate) fn append(&self, wedge: u32, to: &mut Vec<f32>) {
        self.each_layer(wedge, |_, coding, numbers| {
            // Values that are not finite are what the mesh had.
            let _ = coding.decode(numbers, to);
        });
    }

    /// Returns the layers with the values of the listed wedges.
    pub(crate) fn layers(&self, wedges: impl Iterator<Item = u32> + Clone) -> Vec<Layer> {
        let count = wedges.clone().count();
        let empty = |format: LayerFormat<'_>| Layer {
            kind: format.kind,
            name: format.name.to_owned(),
            width: format.width,
            values: Vec::with_capacity(count * format.width),
        };
        let mut layers: Vec<Layer> = self.formats().map(empty).collect();
        for wedge in wedges {
            self.each_layer(wedge, |at, coding, numbers| {
                let _ = coding.decode(numbers, &mut layers[at].values);
            });
        }
        layers
    }

    /// Returns the values of the listed wedges as they are collected.
    pub(crate) fn unpacked(&self, wedges: impl Iterator<Item = u32>) -> WedgeNumbers {
        let mut numbers = Vec::new();
        wedges.for_each(|wedge| numbers.extend(self.table.row(wedge as usize)));
        WedgeNumbers { coding: self.coding.clone(), numbers }
    }

    /// Replaces the layers of the kind of this one, which has a value for each wedge.
    pub(crate) fn replace(&mut self, layer: &Layer) {
        let kept = |coding: &LayerCoding| coding.kind != layer.kind;
        let mut all = WedgeNumbers { coding: Vec::new(), numbers: Vec::new() };
        all.coding.extend(self.coding.iter().filter(|coding| kept(coding)).cloned());
        let own = LayerCoding::new(layer, None);
        let wedges = 0..(layer.values.len() / layer.width) as u32;
        for wedge in wedges.clone() {
            self.each_layer(wedge, |_, coding, numbers| {
                if kept(coding) {
                    all.numbers.extend(numbers);
                }
            });
            own.encode(layer.of(WedgeId(wedge)), &mut all.numbers);
        }
        all.coding.push(own);
        *self = all.packed(wedges);
    }

    /// Visits the layers of a wedge, each by its place, with the integers that it has there.
    #[inline]
    fn each_layer(&self, wedge: u32, mut visit: impl FnMut(usize, &LayerCoding, &[i32])) {
        // Without layers there may be no rows either.
        if self.is_empty() {
            return;
        }
        let (mut row, mut numbers) = (self.table.row(wedge as usize), [0; LONGEST]);
        for (at, coding) in self.coding.iter().enumerate() {
            let mut left = coding.columns();
            // A layer of more columns is one of single values, which may be decoded in parts.
            while left > 0 {
                let part = &mut numbers[..left.min(LONGEST)];
                part.iter_mut().zip(&mut row).for_each(|(number, next)| *number = next);
                visit(at, coding, part);
                left -= part.len();
            }
        }
    }

    /// Returns the memory used, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.table.bytes()
    }
}

/// Number of integers that are decoded at once: not fewer than a direction has.
const LONGEST: usize = 16;

fn columns(coding: &[LayerCoding]) -> usize {
    coding.iter().map(LayerCoding::columns).sum()
}

/// Kind, name and width of an attribute layer of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerFormat<'m> {
    /// Type of the attribute, such as normals or texture coordinates.
    pub kind: LayerKind,
    /// Name of the attribute in the file.
    pub name: &'m str,
    /// Number of values per wedge, such as 3 for normals.
    pub width: usize,
}
