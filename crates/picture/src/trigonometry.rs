//! Tangent and cosine computed with + - * / only, so that they are the same on every machine.
//!
//! Those of the platform's library may differ in the last bit, and with them the pixels.

/// Returns the tangent of an angle in [0, π/2).
pub(crate) fn tangent(angle_rad: f64) -> f64 {
    // Below 0.03 the series is exact to rounding; doubling the angle leads back.
    const HALVINGS: i32 = 6;
    let x = angle_rad / f64::from(1 << HALVINGS);
    let square = x * x;
    let mut tangent =
        x * (1.0 + square * (1.0 / 3.0 + square * (2.0 / 15.0 + square * (17.0 / 315.0))));
    for _ in 0..HALVINGS {
        tangent = 2.0 * tangent / (1.0 - tangent * tangent);
    }
    tangent
}

/// Returns the cosine of an angle in [0, π].
pub(crate) fn cosine(angle_rad: f64) -> f64 {
    let t = tangent(angle_rad.clamp(0.0, std::f64::consts::PI) * 0.5);
    (1.0 - t * t) / (1.0 + t * t)
}

/// Returns the angle in [0, π] of a cosine in [-1, 1], in radians, accurate to 1e-4.
///
/// # References
/// [AS64] 4.4.45.
pub(crate) fn rough_arc_cosine(cosine: f64) -> f64 {
    let x = cosine.abs().min(1.0);
    let series = 1.5707288 + x * (-0.2121144 + x * (0.0742610 - x * 0.0187293));
    let angle = (1.0 - x).sqrt() * series;
    if cosine < 0.0 { std::f64::consts::PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_library() {
        for i in 0..150 {
            let x = f64::from(i) * 0.01;
            assert!((tangent(x) - x.tan()).abs() <= 1e-11 * (1.0 + x.tan().powi(2)), "tan {x}");
            assert!((cosine(2.0 * x) - (2.0 * x).cos()).abs() < 1e-11, "cos {x}");
            assert!((rough_arc_cosine((2.0 * x).cos()) - 2.0 * x).abs() < 1e-4, "acos {x}");
        }
    }
}
