//! Rounding of a layer's values to integers, and back.

use glam::DVec3;
use meshlod_mesh::octahedral::DirectionCode;
use meshlod_mesh::{AttributeBounds, Layer, LayerKind, WedgeId};

use super::quantizer::UniformQuantizer;
use crate::bytes::{Malformed, Reader};

/// Attribute layer without its values: what it is, and how integers stand for its values.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LayerCoding {
    pub(crate) kind: LayerKind,
    pub(crate) name: String,
    /// Number of values per wedge.
    pub(crate) width: usize,
    numbers: Numbers,
    /// Largest error of a value: in radians for directions, else in the unit of the values.
    pub(crate) max_error: f64,
}

/// Meaning of the integers.
#[derive(Clone, Debug, PartialEq)]
enum Numbers {
    /// Octahedral directions; tangents also have a sign.
    Directions(DirectionCode),
    /// Uniformly quantized values.
    Values(UniformQuantizer),
}

impl LayerCoding {
    /// Chooses the coarsest integers that keep the values of these wedges within bounds.
    pub(crate) fn new(layer: &Layer, wedges: &[WedgeId], bounds: &AttributeBounds) -> Self {
        let bound = bounds.of(layer, wedges.iter().copied());
        let numbers = if layer.kind.is_direction() {
            Numbers::Directions(DirectionCode::within(bound))
        } else {
            let values = wedges.iter().map(|&wedge| layer.of(wedge));
            Numbers::Values(UniformQuantizer::new(values, layer.width, bound))
        };
        let (kind, name, width) = (layer.kind, layer.name.clone(), layer.width);
        Self { kind, name, width, numbers, max_error: 0.0 }
    }

    /// Returns true if the file formats can hold the layer.
    pub(crate) fn is_storable(layer: &Layer) -> bool {
        let is_name = u16::try_from(layer.name.len()).is_ok();
        is_name && (1..=usize::from(u8::MAX)).contains(&layer.width)
    }

    /// Returns how many integers stand for the values of a wedge.
    pub(crate) fn components(&self) -> usize {
        match self.numbers {
            // Tangents also have a sign.
            Numbers::Directions(_) => self.width.min(4) - 1,
            Numbers::Values(_) => self.width,
        }
    }

    /// Returns the bits of each of the two integers of a direction; `None` for other values.
    pub(crate) fn direction_bits(&self) -> Option<u32> {
        match self.numbers {
            Numbers::Directions(code) => Some(code.bits()),
            Numbers::Values(_) => None,
        }
    }

    /// Rounds the values of a wedge to integers.
    pub(crate) fn numbers(&self, values: &[f32]) -> Vec<u32> {
        match &self.numbers {
            Numbers::Directions(code) => {
                let (at, sign) = code.encode(values);
                at.into_iter().chain(sign).collect()
            }
            Numbers::Values(quantizer) => quantizer.numbers(values),
        }
    }

    /// Appends the values that integers stand for.
    pub(crate) fn values(&self, numbers: &[u32], values: &mut Vec<f32>) {
        match &self.numbers {
            Numbers::Directions(code) => {
                values.extend(code.decode([numbers[0], numbers[1]], numbers.get(2).copied()));
            }
            Numbers::Values(quantizer) => quantizer.values(numbers, values),
        }
    }

    /// Returns the error of a decoded value; 0 for a direction of zero length.
    pub(crate) fn error(&self, was: &[f32], is: &[f32]) -> f64 {
        if self.kind.is_direction() {
            let was = direction(was);
            return if was.length() > 0.0 { was.angle_between(direction(is)) } else { 0.0 };
        }
        let apart = |(&was, &is): (&f32, &f32)| (f64::from(was) - f64::from(is)).abs();
        was.iter().zip(is).map(apart).fold(0.0, f64::max)
    }

    /// Returns the size in bytes.
    pub(crate) fn bytes(&self) -> usize {
        let numbers = match &self.numbers {
            Numbers::Directions(_) => 1,
            Numbers::Values(quantizer) => quantizer.bytes(),
        };
        // Kind, set, width, largest error, and length of the name.
        13 + self.name.len() + numbers
    }

    pub(crate) fn store(&self, out: &mut Vec<u8>) {
        let (kind, set) = self.kind.tag();
        out.extend([kind, set, self.width as u8]);
        out.extend(self.max_error.to_le_bytes());
        out.extend((self.name.len() as u16).to_le_bytes());
        out.extend(self.name.as_bytes());
        match &self.numbers {
            Numbers::Directions(code) => out.push(code.bits() as u8),
            Numbers::Values(quantizer) => quantizer.store(out),
        }
    }

    pub(crate) fn restore(reader: &mut Reader) -> Result<Self, Malformed> {
        let (kind, set, width) = (reader.u8()?, reader.u8()?, usize::from(reader.u8()?));
        let kind = LayerKind::from_tag(kind, set);
        let kind = kind.ok_or_else(|| reader.wrong("a layer has an unknown kind"))?;
        if width == 0 || kind.width().is_some_and(|only| only != width) {
            return Err(reader.wrong(format!("a layer of kind {kind} cannot have {width} values")));
        }
        let max_error = reader.f64()?;
        let name = usize::from(reader.u16()?);
        let name = String::from_utf8(reader.take(name)?.to_vec());
        let name = name.map_err(|_| reader.wrong("the name of a layer is not UTF-8"))?;
        let numbers = if kind.is_direction() {
            let bits = u32::from(reader.u8()?);
            let code = DirectionCode::of_bits(bits);
            let wrong = || reader.wrong(format!("directions cannot have {bits} bits"));
            Numbers::Directions(code.ok_or_else(wrong)?)
        } else {
            Numbers::Values(UniformQuantizer::restore(width, reader)?)
        };
        Ok(Self { kind, name, width, numbers, max_error })
    }
}

fn direction(values: &[f32]) -> DVec3 {
    DVec3::new(values[0].into(), values[1].into(), values[2].into())
}
