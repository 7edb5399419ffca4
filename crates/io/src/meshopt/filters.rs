//! Meshopt filters: transforms applied after a stream is decoded, and their inverses for encoding.

use super::Filter;

/// Applies a filter to elements of `stride` bytes; the stride must be valid for the filter.
pub(crate) fn apply(filter: Filter, stride: usize, bytes: &mut [u8]) {
    match (filter, stride) {
        (Filter::None, _) => {}
        (Filter::Octahedral, 4) => small(bytes, |e| octahedral(e, 127.0)),
        (Filter::Octahedral, _) => wide(bytes, |e| octahedral(e, 32767.0)),
        (Filter::Quaternion, _) => wide(bytes, quaternion),
        (Filter::Exponential, _) => {
            for word in bytes.as_chunks_mut::<4>().0 {
                *word = exponential(i32::from_le_bytes(*word)).to_le_bytes();
            }
        }
        (Filter::Color, 4) => {
            small(bytes, |[y, co, cg, a]| color([y & 0xff, co, cg, a & 0xff], 255.0))
        }
        (Filter::Color, _) => {
            wide(bytes, |[y, co, cg, a]| color([y & 0xffff, co, cg, a & 0xffff], 65535.0));
        }
    }
}

/// Transforms elements of four signed bytes.
fn small(bytes: &mut [u8], change: impl Fn([i32; 4]) -> [i32; 4]) {
    for element in bytes.as_chunks_mut::<4>().0 {
        *element = change(element.map(|b| i32::from(b as i8))).map(|x| x as u8);
    }
}

/// Transforms elements of four signed shorts.
fn wide(bytes: &mut [u8], change: impl Fn([i32; 4]) -> [i32; 4]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let shorts = element.as_chunks::<2>().0;
        let number = |k: usize| i32::from(i16::from_le_bytes(shorts[k]));
        let changed = change([number(0), number(1), number(2), number(3)]);
        for (k, bytes) in element.as_chunks_mut::<2>().0.iter_mut().enumerate() {
            *bytes = (changed[k] as u16).to_le_bytes();
        }
    }
}

/// Decodes a unit vector from two octahedral coordinates and the value that stands for 1.
fn octahedral([x, y, one, rest]: [i32; 4], greatest: f32) -> [i32; 4] {
    let (x, y) = (x as f32 / one as f32, y as f32 / one as f32);
    let z = 1.0 - x.abs() - y.abs();
    let fold = z.min(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let length = (x * x + y * y + z * z).sqrt();
    // NaN becomes 0.
    let [x, y, z] = [x, y, z].map(|c| (c / length * greatest).round() as i32);
    [x, y, z, rest]
}

/// Decodes a unit quaternion from three components; the last number tells which one, the largest,
/// is left out.
fn quaternion([x, y, z, last]: [i32; 4]) -> [i32; 4] {
    let one = (last | 3) as f32;
    let range = std::f32::consts::FRAC_1_SQRT_2;
    let [x, y, z] = [x, y, z].map(|c| c as f32 / one * range);
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let mut out = [0; 4];
    for (k, component) in [w, x, y, z].into_iter().enumerate() {
        out[(last as usize + k) % 4] = (component * 32767.0).round() as i32;
    }
    out
}

/// Decodes a float from a 24-bit mantissa and an 8-bit exponent.
fn exponential(word: i32) -> f32 {
    let mantissa = f64::from(word << 8 >> 8);
    (mantissa * 2f64.powi(word >> 24)) as f32
}

/// Decodes RGBA from YCoCg and alpha; the highest set bit of alpha gives the bit depth.
fn color([y, co, cg, alpha]: [i32; 4], greatest: f32) -> [i32; 4] {
    let all = (1 << (32 - alpha.leading_zeros())) - 1;
    let opaque = alpha & (all >> 1);
    let rgba = [y + co - cg, y + cg, y - co - cg, opaque << 1 | opaque & 1];
    rgba.map(|c| (c as f32 * (greatest / all as f32)).round() as i32)
}

/// Encodes unit vectors in octahedral form with `bits` bits per coordinate, as
/// [`Filter::Octahedral`] decodes them.
///
/// The fourth component of each (-1, 0 or 1) is kept. Elements have 4 bytes for up to 8 bits, else
/// 8. Vectors without a direction (zero, not finite) become +z.
///
/// # Panics
/// If `bits` is not in 2 to 16.
pub fn encode_octahedral(directions: &[[f32; 4]], bits: u32) -> Vec<u8> {
    assert!((2..=16).contains(&bits), "{bits} bits");
    let one = ((1i32 << (bits - 1)) - 1) as f64;
    let greatest = if bits <= 8 { 127.0 } else { 32767.0 };
    let element = |&[x, y, z, w]: &[f32; 4]| {
        let [x, y, z] = [x, y, z].map(f64::from);
        let sum = x.abs() + y.abs() + z.abs();
        let usable = sum.is_finite() && sum > 0.0;
        let [mut x, mut y] = if usable { [x / sum, y / sum] } else { [0.0; 2] };
        if usable && z < 0.0 {
            // The lower hemisphere folds over the edges of the upper one.
            (x, y) = ((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y));
        }
        let w = (f64::from(w).clamp(-1.0, 1.0) * greatest).round();
        [(x * one).round(), (y * one).round(), one, w].map(|number| number as i16)
    };
    let elements = directions.iter().flat_map(element);
    if bits <= 8 {
        elements.map(|number| number as u8).collect()
    } else {
        elements.flat_map(i16::to_le_bytes).collect()
    }
}

/// Encodes unit quaternions with `bits` bits for each of their three smaller components, as
/// [`Filter::Quaternion`] decodes them.
///
/// Elements have 8 bytes. A quaternion and its negative, which are one rotation, become the same.
///
/// # Panics
/// If `bits` is not in 4 to 16.
pub fn encode_quaternion(quaternions: &[[f64; 4]], bits: u32) -> Vec<u8> {
    assert!((4..=16).contains(&bits), "{bits} bits");
    let one = (1i32 << (bits - 1)) - 1;
    let element = |q: &[f64; 4]| {
        let at = (1..4).fold(0, |most, k| if q[k].abs() > q[most].abs() { k } else { most });
        let scale = f64::from(one) * std::f64::consts::SQRT_2.copysign(q[at]);
        let most = f64::from(one);
        let part = |k: usize| (q[(at + k) % 4] * scale).round().clamp(-most, most) as i16;
        [part(1), part(2), part(3), (one & !3) as i16 | at as i16]
    };
    quaternions.iter().flat_map(element).flat_map(i16::to_le_bytes).collect()
}

/// Quantizes floats to multiples of `step`, rounded down to a power of two, as
/// [`Filter::Exponential`] decodes them.
///
/// The error is at most half a step, and larger only if a value exceeds 2^23 steps. Returns `None`
/// if a float is not finite or the step cannot be represented.
pub fn encode_exponential(floats: &[f32], step: f64) -> Option<Vec<u8>> {
    const MOST: f64 = ((1 << 23) - 1) as f64;
    let greatest = floats.iter().fold(0.0f64, |most, &x| most.max(f64::from(x).abs()));
    if !(step > 0.0 && floats.iter().all(|x| x.is_finite())) {
        return None;
    }
    // The step, or the smallest power of two for which all mantissas fit in 24 bits.
    let exponent = step.log2().floor().max((greatest / MOST).log2().ceil());
    if !(-100.0..=100.0).contains(&exponent) {
        return None;
    }
    let cell = 2f64.powi(exponent as i32);
    let word = |&x: &f32| {
        let mantissa = (f64::from(x) / cell).round().clamp(-MOST, MOST) as i32;
        ((exponent as i32) << 24 | mantissa & 0x00ff_ffff).to_le_bytes()
    };
    Some(floats.iter().flat_map(word).collect())
}
