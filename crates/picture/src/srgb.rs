//! Conversion between sRGB and linear light, by tables that are the same on every machine.
//!
//! They are computed at compile time with + - * / only.

/// Linear light of each of the 256 sRGB levels.
pub(crate) static DECODE: [f32; 256] = decode_table();

/// sRGB level of linear light in steps of 1/4096. Near black one level spans 1.24 steps, so
/// decoding and encoding again restores every level.
static ENCODE: [u8; STEPS + 1] = encode_table();
const STEPS: usize = 4096;

/// Returns the sRGB level nearest to a linear value, clamped to [0, 1]; NaN becomes black.
#[inline]
pub(crate) fn encode(linear: f32) -> u8 {
    ENCODE[(linear.clamp(0.0, 1.0) * STEPS as f32 + 0.5) as usize]
}

/// Converts an sRGB colour to linear light.
#[inline]
pub(crate) fn decode(color: [u8; 3]) -> glam::Vec3 {
    glam::Vec3::from(color.map(|level| DECODE[level as usize]))
}

/// Converts an sRGB value in [0, 1] to linear light, interpolating between levels; NaN becomes
/// black.
#[inline]
pub(crate) fn decode_unit(value: f32) -> f32 {
    let at = value.clamp(0.0, 1.0) * 255.0;
    let low = at as usize;
    let high = (low + 1).min(255);
    DECODE[low] + (DECODE[high] - DECODE[low]) * (at - low as f32)
}

const fn decode_table() -> [f32; 256] {
    let mut table = [0.0; 256];
    let mut level = 0;
    while level < 256 {
        table[level] = decode_exact(level as f64 / 255.0) as f32;
        level += 1;
    }
    table
}

const fn encode_table() -> [u8; STEPS + 1] {
    let mut table = [0; STEPS + 1];
    let (mut step, mut level) = (0, 0u8);
    while step <= STEPS {
        let linear = step as f64 / STEPS as f64;
        while level < 255 && decode_exact((level as f64 + 0.5) / 255.0) <= linear {
            level += 1;
        }
        table[step] = level;
        step += 1;
    }
    table
}

/// Evaluates the transfer curve of IEC 61966-2-1.
const fn decode_exact(encoded: f64) -> f64 {
    if encoded <= 0.04045 {
        return encoded / 12.92;
    }
    let x = (encoded + 0.055) / 1.055;
    x * x * fifth_root(x * x)
}

/// Solves y^5 = x by Newton's iteration from above; 20 rounds converge on all of [0.007, 1].
const fn fifth_root(x: f64) -> f64 {
    let mut y = 1.0;
    let mut round = 0;
    while round < 20 {
        y -= (y - x / (y * y * y * y)) / 5.0;
        round += 1;
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_survives_the_round_trip() {
        for level in 0..=255u8 {
            assert_eq!(encode(DECODE[level as usize]), level);
        }
    }

    #[test]
    fn the_curve_is_the_standard_one() {
        for level in [11, 50, 128, 200, 255] {
            let expected = ((level as f64 / 255.0 + 0.055) / 1.055).powf(2.4);
            assert!((DECODE[level] as f64 - expected).abs() < 1e-7, "{level}");
        }
    }

    #[test]
    fn nonsense_is_black_or_white() {
        assert_eq!([f32::NAN, -1.0, f32::INFINITY].map(encode), [0, 0, 255]);
    }
}
