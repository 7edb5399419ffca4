//! Perceptual colour spaces and colour distances.

use glam::{Mat3, Vec3};

/// Linear sRGB to CIE XYZ, relative to the white point.
const TO_XYZ: Mat3 = Mat3::from_cols(
    Vec3::new(0.4338954, 0.2126368, 0.0177524),
    Vec3::new(0.3762424, 0.715183, 0.1094656),
    Vec3::new(0.1898622, 0.0721802, 0.8727819),
);

/// CIE XYZ, relative to the white point, to linear sRGB.
const FROM_XYZ: Mat3 = Mat3::from_cols(
    Vec3::new(3.080342, -0.9211784, 0.0528813),
    Vec3::new(-1.537399, 1.87593, -0.2040112),
    Vec3::new(-0.542943, 0.0452484, 1.1511299),
);

/// Converts linear sRGB to light, red-green and blue-yellow: YCxCz except for the scale.
pub(crate) fn to_opponent(rgb: Vec3) -> Vec3 {
    let xyz = TO_XYZ * rgb;
    Vec3::new(xyz.y, xyz.x - xyz.y, xyz.y - xyz.z)
}

/// Converts light, red-green and blue-yellow back to linear sRGB.
pub(crate) fn from_opponent(opponent: Vec3) -> Vec3 {
    let [light, red_green, blue_yellow] = opponent.to_array();
    FROM_XYZ * Vec3::new(light + red_green, light, light - blue_yellow)
}

/// Converts linear sRGB to CIE L*a*b*, with a and b fading in the dark (Hunt effect).
///
/// # References
/// [ANA20] eq. 2.
pub(crate) fn hunt_lab(rgb: Vec3) -> Vec3 {
    let [x, y, z] = (TO_XYZ * rgb).to_array().map(lab_curve);
    let lightness = 116.0 * y - 16.0;
    let fade = 0.01 * lightness;
    Vec3::new(lightness, fade * 500.0 * (x - y), fade * 200.0 * (y - z))
}

/// Returns the HyAB distance of two colours: lightness difference plus distance in a and b.
///
/// # References
/// [ANA20] eq. 3.
pub(crate) fn hyab(a: Vec3, b: Vec3) -> f32 {
    let d = a - b;
    d.x.abs() + (d.y * d.y + d.z * d.z).sqrt()
}

/// Cube root with a linear section near zero, as in the definition of L*a*b*.
fn lab_curve(t: f32) -> f32 {
    const DELTA: f32 = 6.0 / 29.0;
    if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_back() {
        for rgb in [Vec3::ONE, Vec3::X, Vec3::new(0.2, 0.5, 0.9)] {
            assert!((from_opponent(to_opponent(rgb)) - rgb).length() < 1e-5, "{rgb}");
        }
    }

    #[test]
    fn lab_is_the_standard_one_where_nothing_fades() {
        assert!((hunt_lab(Vec3::ONE) - Vec3::new(100.0, 0.0, 0.0)).length() < 1e-3);
        assert!(hunt_lab(Vec3::ZERO).length() < 1e-4);
        // Red is L a b 53.24 80.09 67.20.
        let red = hunt_lab(Vec3::X);
        let fade = 0.01 * red.x;
        assert!((red - Vec3::new(53.24, 80.09 * fade, 67.20 * fade)).length() < 0.05, "{red}");
    }
}
