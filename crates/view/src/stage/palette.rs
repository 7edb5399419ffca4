//! Distinct colours for numbered things.

/// Returns the sRGB colour of a number: neighbours in number differ clearly in hue.
pub(crate) fn color_of(number: u32) -> [u8; 3] {
    // Steps of the golden angle never repeat a hue and keep any few of them apart.
    let turn = (f64::from(number) * 0.618_033_988_75 + 0.56).fract() * 6.0;
    let lightness = [0.0, 0.08, -0.08][(number / 7 % 3) as usize];
    let channel = |shift: f64| {
        let away = ((turn + shift) % 6.0 - 3.0).abs();
        let level = 0.66 + lightness + 0.22 * (away - 1.5).clamp(-1.0, 1.0);
        (level * 255.0).round() as u8
    };
    [channel(0.0), channel(4.0), channel(2.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_ten_in_a_row_are_apart() {
        for first in 0..40 {
            let colors: Vec<_> = (first..first + 10).map(color_of).collect();
            for (i, a) in colors.iter().enumerate() {
                for b in &colors[i + 1..] {
                    let apart: i32 =
                        (0..3).map(|k| (i32::from(a[k]) - i32::from(b[k])).abs()).sum();
                    assert!(apart > 20, "{a:?} and {b:?}");
                }
            }
        }
    }
}
