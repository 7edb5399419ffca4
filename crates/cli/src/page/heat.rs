//! Logarithmic colour scale shared by all heat maps, in percent of the diagonal.

use meshlod::picture::{ColorMap, Values};

/// Exponents of ten, in percent of the diagonal, of the first and the last colour.
const DECADES: [i32; 2] = [-3, 0];

/// Converts distances in model units to values on the colour scale, for
/// [`Paint`](meshlod::picture::Paint).
pub fn values(errors: &[f64], diagonal: f64) -> Vec<f32> {
    let decade = |error: &f64| (100.0 * error / diagonal).log10() as f32;
    errors.iter().map(|error| decade(error).max(DECADES[0] as f32)).collect()
}

/// Returns the values together with their colour map and range.
pub fn scale(values: &[f32]) -> Values<'_> {
    Values { values, map: ColorMap::Heat, range: DECADES.map(|decade| decade as f32) }
}

/// Returns the colours of the scale, from smallest to largest, as a CSS gradient.
pub fn gradient() -> String {
    const STOPS: u8 = 16;
    let stop = |i: u8| {
        let [r, g, b] = ColorMap::Heat.color(f32::from(i) / f32::from(STOPS));
        format!("#{r:02x}{g:02x}{b:02x}")
    };
    let stops: Vec<String> = (0..=STOPS).map(stop).collect();
    format!("linear-gradient(90deg, {})", stops.join(", "))
}

/// Returns the evenly spaced labels of the colour scale: percentages of the diagonal.
pub fn ticks() -> Vec<String> {
    let [low, high] = DECADES;
    (low..=high).map(|decade| format!("{}%", 10f64.powi(decade))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_decades_of_the_diagonal_and_none_is_the_least() {
        let found = values(&[0.0, 1e-9, 0.02, 2.0], 20.0);
        assert!(found[..2] == [-3.0, -3.0] && (found[2] + 1.0).abs() < 1e-6 && found[3] == 1.0);
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(ticks(), ["0.001%", "0.01%", "0.1%", "1%"]);
        assert!(gradient().matches('#').count() == 17);
    }
}
