//! Attributes as integers, in the same rows as positions, each within an error bound.

mod packed;
mod quantizer;
#[cfg(test)]
mod tests;

use glam::DVec3;
use meshlod_mesh::octahedral::{self, fold, unfold};
use meshlod_mesh::{AttributeBounds, Layer, LayerKind, WedgeId};

pub(crate) use self::packed::PackedRows;
use self::quantizer::UniformQuantizer;
use crate::bytes::{Malformed, Reader};
use crate::patch::Rows;

/// Compressed attribute layer.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PackedLayer {
    kind: LayerKind,
    name: String,
    width: usize,
    coding: Coding,
    numbers: PackedRows,
    /// See [`LayerReport`].
    max_error: f64,
}

#[derive(Clone, Debug, PartialEq)]
enum Coding {
    /// Octahedral directions with this number of bits twice; tangents also have a sign.
    Directions { bits: u32 },
    /// Uniformly quantized values.
    Values(UniformQuantizer),
}

/// Size and error of a compressed attribute layer.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerReport {
    /// Meaning of the values in the layer, such as normals.
    pub kind: LayerKind,
    /// Name of the attribute layer in its file.
    pub name: String,
    /// Compressed size of the layer in bytes, with everything needed to decode it.
    pub bytes: usize,
    /// Largest error of a value in the layer: in radians for directions, else in the unit of the
    /// values.
    pub max_error: f64,
}

/// Least and greatest number of bits, twice, of a direction.
const DIRECTION_BITS: [u32; 2] = octahedral::BITS;

impl PackedLayer {
    /// Compresses a layer; `wedges` are those of the nodes, in the order of the rows.
    pub(crate) fn new(
        layer: &Layer,
        wedges: &[WedgeId],
        rows: Rows,
        bounds: &AttributeBounds,
    ) -> Self {
        let bound = bounds.of(layer, wedges.iter().copied());
        let coding = if layer.kind.is_direction() {
            Coding::Directions { bits: octahedral::bits_within(bound) }
        } else {
            let values = wedges.iter().map(|&wedge| layer.of(wedge));
            Coding::Values(UniformQuantizer::new(values, layer.width, bound))
        };
        let numbers: Vec<u32> =
            wedges.iter().flat_map(|&wedge| coding.numbers(layer.of(wedge))).collect();
        let numbers = PackedRows::new(rows, coding.components(layer.width), &numbers);
        let (kind, name, width) = (layer.kind, layer.name.clone(), layer.width);
        let mut this = Self { kind, name, width, coding, numbers, max_error: 0.0 };
        let decoded = this.decode();
        let values = decoded.values.chunks_exact(width);
        let error = wedges.iter().zip(values).map(|(&wedge, is)| error(kind, layer.of(wedge), is));
        this.max_error = error.fold(0.0, f64::max);
        this
    }

    /// Returns true if the file format can hold the layer.
    pub(crate) fn is_storable(layer: &Layer) -> bool {
        let is_name = u16::try_from(layer.name.len()).is_ok();
        is_name && (1..=usize::from(u8::MAX)).contains(&layer.width)
    }

    /// Decodes the values of all nodes.
    pub(crate) fn decode(&self) -> Layer {
        let numbers = self.numbers.all();
        self.layer(numbers.chunks_exact(self.numbers.components()))
    }

    /// Decodes the values of some nodes, each given by its row and its number there.
    pub(crate) fn decode_some(&self, places: &[(usize, usize)]) -> Layer {
        self.layer(places.iter().map(|&(row, number)| self.numbers.get(row, number)))
    }

    fn layer<T: AsRef<[u32]>>(&self, nodes: impl ExactSizeIterator<Item = T>) -> Layer {
        let mut values = Vec::with_capacity(nodes.len() * self.width);
        nodes.for_each(|numbers| self.coding.values(numbers.as_ref(), &mut values));
        Layer { kind: self.kind, name: self.name.clone(), width: self.width, values }
    }

    pub(crate) fn kind(&self) -> LayerKind {
        self.kind
    }

    /// Returns the number of values per node.
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    pub(crate) fn report(&self) -> LayerReport {
        LayerReport {
            kind: self.kind,
            name: self.name.clone(),
            bytes: self.bytes(),
            max_error: self.max_error,
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        let coding = match &self.coding {
            Coding::Directions { .. } => 1,
            Coding::Values(quantizer) => quantizer.bytes(),
        };
        // Kind, set, width, largest error, and length of the name.
        13 + self.name.len() + coding + self.numbers.bytes()
    }

    pub(crate) fn store(&self, out: &mut Vec<u8>) {
        let (kind, set) = self.kind.tag();
        out.extend([kind, set, self.width as u8]);
        out.extend(self.max_error.to_le_bytes());
        out.extend((self.name.len() as u16).to_le_bytes());
        out.extend(self.name.as_bytes());
        match &self.coding {
            Coding::Directions { bits } => out.push(*bits as u8),
            Coding::Values(quantizer) => quantizer.store(out),
        }
        self.numbers.store(out);
    }

    pub(crate) fn restore(rows: Rows, reader: &mut Reader) -> Result<Self, Malformed> {
        let (kind, set, width) = (reader.u8()?, reader.u8()?, usize::from(reader.u8()?));
        let kind = LayerKind::from_tag(kind, set);
        let kind = kind.ok_or_else(|| reader.wrong("a layer has an unknown kind"))?;
        if width == 0 || kind.width().is_some_and(|only| only != width) {
            return Err(
                reader.wrong(format!("a layer of kind {kind:?} cannot have {width} values"))
            );
        }
        let max_error = reader.f64()?;
        let name = usize::from(reader.u16()?);
        let name = String::from_utf8(reader.take(name)?.to_vec());
        let name = name.map_err(|_| reader.wrong("the name of a layer is not UTF-8"))?;
        let coding = if kind.is_direction() {
            let bits = u32::from(reader.u8()?);
            if !(DIRECTION_BITS[0]..=DIRECTION_BITS[1]).contains(&bits) {
                return Err(reader.wrong(format!("directions cannot have {bits} bits")));
            }
            Coding::Directions { bits }
        } else {
            Coding::Values(UniformQuantizer::restore(width, reader)?)
        };
        let numbers = PackedRows::restore(rows, coding.components(width), reader)?;
        Ok(Self { kind, name, width, coding, numbers, max_error })
    }
}

impl Coding {
    /// Returns how many integers encode values of a width.
    fn components(&self, width: usize) -> usize {
        match self {
            // Tangents also have a sign.
            Self::Directions { .. } => width.min(4) - 1,
            Self::Values(_) => width,
        }
    }

    fn numbers(&self, values: &[f32]) -> Vec<u32> {
        match self {
            Self::Directions { bits } => {
                let sign = values.get(3).map(|&sign| u32::from(sign < 0.0));
                fold(direction(values), *bits).into_iter().chain(sign).collect()
            }
            Self::Values(quantizer) => quantizer.numbers(values),
        }
    }

    fn values(&self, numbers: &[u32], values: &mut Vec<f32>) {
        match self {
            Self::Directions { bits } => {
                // Only damaged data is out of range.
                let last = (1 << bits) - 1;
                let is = unfold([numbers[0].min(last), numbers[1].min(last)], *bits);
                values.extend(is.to_array().map(|x| x as f32));
                values.extend(numbers.get(2).map(|&sign| if sign == 1 { -1.0 } else { 1.0 }));
            }
            Self::Values(quantizer) => quantizer.values(numbers, values),
        }
    }
}

fn direction(values: &[f32]) -> DVec3 {
    DVec3::new(values[0].into(), values[1].into(), values[2].into())
}

/// Returns the error of a decoded value; 0 for a direction of zero length.
fn error(kind: LayerKind, was: &[f32], is: &[f32]) -> f64 {
    if kind.is_direction() {
        let was = direction(was);
        return if was.length() > 0.0 { was.angle_between(direction(is)) } else { 0.0 };
    }
    was.iter().zip(is).map(|(&was, &is)| (f64::from(was) - f64::from(is)).abs()).fold(0.0, f64::max)
}
