//! Uniform quantization with power-of-two steps from zero on, so that equal values are equal
//! integers in every mesh.

use crate::bytes::{Malformed, Reader};

/// Power-of-two step, and the least integer of each component.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct UniformQuantizer {
    exponent: i32,
    least: Vec<i32>,
}

/// Bits by which a step may be smaller than the greatest value, the precision of `f32`.
const F32_BITS: i32 = 23;
/// Least and greatest exponent of `f32`.
const EXPONENTS: [i32; 2] = [-149, 127];

impl UniformQuantizer {
    /// Chooses the largest step that keeps values within a bound.
    pub(super) fn new<'a>(
        values: impl Iterator<Item = &'a [f32]>,
        width: usize,
        bound: f64,
    ) -> Self {
        let mut least = vec![f64::INFINITY; width];
        let mut most: f64 = 0.0;
        for value in values {
            for (least, &x) in least.iter_mut().zip(value) {
                *least = least.min(x.into());
                most = most.max(f64::from(x).abs());
            }
        }
        let finest = floor_log2(most).map_or(EXPONENTS[0], |exponent| exponent - F32_BITS);
        let asked = floor_log2(2.0 * bound).unwrap_or(EXPONENTS[0]);
        let exponent = finest.max(asked).clamp(EXPONENTS[0], EXPONENTS[1]);
        let number = |x: f64| if x.is_finite() { (x / step(exponent)).round() as i32 } else { 0 };
        Self { exponent, least: least.into_iter().map(number).collect() }
    }

    pub(super) fn numbers(&self, values: &[f32]) -> Vec<u32> {
        let number = |(&x, &least): (&f32, &i32)| {
            ((f64::from(x) / step(self.exponent)).round() - f64::from(least)) as u32
        };
        values.iter().zip(&self.least).map(number).collect()
    }

    pub(super) fn values(&self, numbers: &[u32], values: &mut Vec<f32>) {
        values.extend(numbers.iter().zip(&self.least).map(|(&number, &least)| {
            let value = (f64::from(number) + f64::from(least)) * step(self.exponent);
            // Only damaged data leads beyond.
            value.clamp(f32::MIN.into(), f32::MAX.into()) as f32
        }));
    }

    pub(super) fn bytes(&self) -> usize {
        2 + size_of_val(&self.least[..])
    }

    pub(super) fn store(&self, out: &mut Vec<u8>) {
        out.extend((self.exponent as i16).to_le_bytes());
        out.extend(self.least.iter().flat_map(|least| least.to_le_bytes()));
    }

    pub(super) fn restore(width: usize, reader: &mut Reader) -> Result<Self, Malformed> {
        let exponent = i32::from(reader.u16()? as i16);
        if !(EXPONENTS[0]..=EXPONENTS[1]).contains(&exponent) {
            return Err(reader.wrong(format!("a step of 2^{exponent} is out of range for f32")));
        }
        let least = (0..width).map(|_| reader.i32()).collect::<Result<_, _>>()?;
        Ok(Self { exponent, least })
    }
}

fn step(exponent: i32) -> f64 {
    // Exact: a power of two.
    2f64.powi(exponent)
}

/// Returns the exponent of the greatest power of two not above a positive number.
fn floor_log2(x: f64) -> Option<i32> {
    let is_positive = x.is_normal() && x > 0.0;
    is_positive.then(|| (x.to_bits() >> (f64::MANTISSA_DIGITS - 1)) as i32 - (f64::MAX_EXP - 1))
}
