//! Attribute values as integers within an error bound, from which differences are taken.

use meshlod_mesh::octahedral::DirectionCode;
use meshlod_mesh::{AttributeBounds, Layer, LayerKind, WedgeId};

/// Coding of one attribute layer.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LayerCoding {
    pub(crate) kind: LayerKind,
    pub(crate) name: String,
    pub(crate) width: usize,
    pub(crate) numbers: Numbers,
}

/// Meaning of the integers of a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Numbers {
    /// Octahedral directions; tangents also have a sign.
    Directions(DirectionCode),
    /// Multiples of this power of two.
    Steps(i16),
    /// Bit patterns of `f32`, in the order of the values.
    Bits,
}

/// Maximum difference between an integer of a split wedge and the rounded value.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leeway(i32);

impl Leeway {
    /// Returns the step, an odd number, in which the offset of a wedge from the middle of its
    /// children is stored, given their difference.
    pub(super) fn step(self, difference: i32) -> i32 {
        let part = 1 + (difference.unsigned_abs() / 4).min(i32::MAX as u32 - 1) as i32;
        2 * part.min(self.0) + 1
    }
}

/// Bits by which a step may be smaller than the greatest value, the precision of `f32`.
const F32_BITS: i32 = 23;
/// Minimum and maximum exponent of a step.
pub(super) const EXPONENTS: std::ops::RangeInclusive<i16> = -149..=104;

impl LayerCoding {
    /// Chooses the coding of a layer that keeps its values within the bounds, or exactly.
    pub(crate) fn new(layer: &Layer, bounds: Option<&AttributeBounds>) -> Self {
        let wedges = (0..layer.values.len() / layer.width.max(1)).map(WedgeId::new);
        let numbers = match bounds.map(|bounds| bounds.of(layer, wedges)) {
            None => Numbers::Bits,
            Some(bound) if layer.kind.is_direction() => {
                Numbers::Directions(DirectionCode::within(bound))
            }
            Some(bound) => exponent(layer, bound).map_or(Numbers::Bits, Numbers::Steps),
        };
        Self { kind: layer.kind, name: layer.name.clone(), width: layer.width, numbers }
    }

    /// Returns the number of integers of a wedge.
    pub(crate) fn columns(&self) -> usize {
        match self.numbers {
            // Two for a direction, and one for a sign.
            Numbers::Directions(_) => self.width - 1,
            Numbers::Steps(_) | Numbers::Bits => self.width,
        }
    }

    /// Returns the leeway of each integer of a wedge.
    ///
    /// Of texture coordinates a step is seen first: with 7, 3, 2, 1 and 0, fish-bream takes 28.4, 28.5,
    /// 28.6, 28.8 and 29.5 kB, and the FLIP of its cuts at a quarter of the faces is .0499, .0494, .0486,
    /// .0480 and .0474; flight-helmet with 7, 3 and 1 takes 719, 721 and 724 kB for .0214, .0214 and
    /// .0211. Of directions, 3 in place of 6 takes 1.5 % more of flight-helmet for .0209.
    pub(super) fn leeways(&self) -> impl Iterator<Item = Leeway> + '_ {
        let leeway = |column: usize| match (self.numbers, self.kind) {
            (Numbers::Directions(_), _) if column < 2 => Leeway(6),
            (Numbers::Steps(_), LayerKind::Uv(_)) => Leeway(1),
            (Numbers::Steps(_), LayerKind::Color(_)) => Leeway(7),
            // Signs, joints and their weights, exact values, and others of any meaning.
            _ => Leeway(0),
        };
        (0..self.columns()).map(leeway)
    }

    /// Appends the integers of a wedge.
    pub(crate) fn encode(&self, values: &[f32], to: &mut Vec<i32>) {
        match self.numbers {
            Numbers::Directions(code) => {
                let (at, sign) = code.encode(values);
                to.extend(at.into_iter().chain(sign).map(|x| x as i32));
            }
            Numbers::Steps(exponent) => {
                let step = step(exponent);
                to.extend(values.iter().map(|&x| (f64::from(x) / step).round() as i32));
            }
            Numbers::Bits => to.extend(values.iter().map(|x| ordered(x.to_bits() as i32))),
        }
    }

    /// Returns true if the values of a wedge are finite.
    pub(super) fn are_finite(&self, numbers: &[i32]) -> bool {
        match self.numbers {
            Numbers::Directions(_) => true,
            Numbers::Steps(exponent) => {
                let step = step(exponent);
                numbers.iter().all(|&x| ((f64::from(x) * step) as f32).is_finite())
            }
            Numbers::Bits => numbers.iter().all(|&x| f32::from_bits(ordered(x) as u32).is_finite()),
        }
    }

    /// Appends the values of a wedge, or returns `None` if one is not finite.
    pub(crate) fn decode(&self, numbers: &[i32], to: &mut Vec<f32>) -> Option<()> {
        let start = to.len();
        match self.numbers {
            Numbers::Directions(code) => {
                let number = |&x: &i32| x.max(0) as u32;
                let at = [number(&numbers[0]), number(&numbers[1])];
                to.extend(code.decode(at, numbers.get(2).map(number)));
            }
            Numbers::Steps(exponent) => {
                let step = step(exponent);
                to.extend(numbers.iter().map(|&x| (f64::from(x) * step) as f32));
            }
            Numbers::Bits => to.extend(numbers.iter().map(|&x| f32::from_bits(ordered(x) as u32))),
        }
        to[start..].iter().all(|x| x.is_finite()).then_some(())
    }
}

/// Returns the exponent of the largest step that keeps values within a bound; `None` if integers
/// cannot count such steps up to the greatest value, as with one stray value among millions.
fn exponent(layer: &Layer, bound: f64) -> Option<i16> {
    let most = layer.values.iter().fold(0.0, |most: f64, &x| most.max(f64::from(x).abs()));
    let log2 = |x: f64| if x > 0.0 { x.log2().floor() as i32 } else { i32::MIN / 2 };
    let [finest, asked] = [log2(most) - F32_BITS, log2(2.0 * bound)];
    let exponent = finest.max(asked).clamp((*EXPONENTS.start()).into(), (*EXPONENTS.end()).into());
    (bound == 0.0 || asked >= finest).then_some(exponent as i16)
}

fn step(exponent: i16) -> f64 {
    f64::from(exponent).exp2()
}

/// Maps the bits of `f32` to integers in the order of the values, and back.
fn ordered(bits: i32) -> i32 {
    if bits < 0 { bits ^ i32::MAX } else { bits }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(kind: LayerKind, width: usize, values: &[f32]) -> Layer {
        Layer { kind, name: "it".into(), width, values: values.to_vec() }
    }

    fn again(layer: &Layer, bounds: Option<&AttributeBounds>) -> Vec<f32> {
        let coding = LayerCoding::new(layer, bounds);
        let mut values = Vec::new();
        for wedge in layer.values.chunks(layer.width) {
            let mut numbers = Vec::new();
            coding.encode(wedge, &mut numbers);
            assert_eq!(numbers.len(), coding.columns());
            coding.decode(&numbers, &mut values).unwrap();
        }
        values
    }

    #[test]
    fn values_come_back_within_their_bounds() {
        let bounds = AttributeBounds::default();
        let near = |layer: &Layer, bound: f32| {
            let is = again(layer, Some(&bounds));
            let off = layer.values.iter().zip(&is).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f32::max) <= bound, "{layer:?} {is:?}");
        };
        near(&layer(LayerKind::Uv(0), 2, &[0.1, 0.7, -3.3, 1.0, 2e3, 0.0]), 1.0 / 8192.0);
        near(&layer(LayerKind::Normal, 3, &[0.0, 0.6, 0.8, -1.0, 0.0, 0.0]), 0.006);
        near(&layer(LayerKind::Tangent, 4, &[0.0, 0.6, 0.8, -1.0, 0.0, 0.0, -1.0, 1.0]), 0.006);
        near(&layer(LayerKind::Joints(0), 4, &[0.0, 255.0, 70.0, 3.0]), 0.0);
        near(&layer(LayerKind::Other, 1, &[0.0, 0.0]), 0.0);
        near(&layer(LayerKind::Other, 1, &[1e30, -1e30, 0.0]), 2e30 / 65_536.0);
        // Steps that are fine enough cannot be counted up to the stray value.
        near(&layer(LayerKind::Uv(0), 2, &[0.1, 0.7, 1e9, 0.3]), 1.0 / 8192.0);
        near(&layer(LayerKind::Color(0), 3, &[0.1, 0.7, 3e38]), 1.0 / 512.0);
    }

    #[test]
    fn exact_values_come_back_to_the_bit() {
        let odd = [0.1, -0.0, 1e-40, f32::MAX, f32::MIN, -3.5];
        let is = again(&layer(LayerKind::Other, 2, &odd), None);
        assert_eq!(is.map_bits(), odd.to_vec().map_bits());
        let coding = LayerCoding::new(&layer(LayerKind::Other, 1, &[1.0]), None);
        assert!(coding.decode(&[i32::MAX], &mut Vec::new()).is_none());
    }

    trait MapBits {
        fn map_bits(&self) -> Vec<u32>;
    }

    impl MapBits for Vec<f32> {
        fn map_bits(&self) -> Vec<u32> {
            self.iter().map(|x| x.to_bits()).collect()
        }
    }
}
