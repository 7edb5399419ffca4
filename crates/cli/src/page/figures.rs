//! Figures on the page: as people read them, with the exact values for machines.

use maud::{Markup, html};

use crate::numbers;

/// A figure: `text` is seen, `exact` is what it stands for, as in the JSON.
pub fn figure(exact: f64, text: &str) -> Markup {
    // A real minus is as wide as a plus.
    let minus = text.strip_prefix('-').map(|size| format!("−{size}"));
    html! { data value=(exact) { (minus.as_deref().unwrap_or(text)) } }
}

/// A whole number.
pub fn whole(number: usize) -> Markup {
    html! { data value=(number) { (numbers::count(number)) } }
}

/// A percentage, without its sign.
pub fn percent(percent: f64) -> Markup {
    figure(percent, &digits(percent))
}

/// Below this many percent of a length there is nothing but rounding.
pub const ROUNDING_PERCENT: f64 = 5e-6;

/// Three digits that matter, but never more than five places.
pub fn digits(percent: f64) -> String {
    match percent.abs() {
        size if size < ROUNDING_PERCENT => "0".into(),
        size if size < 0.01 => format!("{percent:.5}"),
        size if size < 0.1 => format!("{percent:.4}"),
        size if size < 1.0 => format!("{percent:.3}"),
        _ => format!("{percent:.2}"),
    }
}

/// A change in percent, with its sign; one that is nearly nothing by its power of ten, since how
/// near tells methods that conserve from those that do not.
pub fn drift(percent: f64) -> String {
    match percent.abs() {
        size if size < 0.001 => power_of_ten(percent),
        _ if percent < 0.0 => digits(percent),
        _ => format!("+{}", digits(percent)),
    }
}

/// A quantity with its sign of which only the size tells something.
pub fn power_of_ten(number: f64) -> String {
    if number == 0.0 { "0".into() } else { format!("{number:+.0e}") }
}

/// A time in milliseconds; from one second on in seconds.
pub fn seconds(seconds: f64) -> String {
    match seconds {
        _ if seconds < 0.0995 => format!("{:.1} ms", 1000.0 * seconds),
        _ if seconds < 0.9995 => format!("{:.0} ms", 1000.0 * seconds),
        _ if seconds < 9.995 => format!("{seconds:.2} s"),
        _ => format!("{seconds:.1} s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_carry_their_exact_values() {
        let text = percent(0.012345678).into_string();
        assert_eq!(text, r#"<data value="0.012345678">0.0123</data>"#);
        let minus = figure(-1.5, &drift(-1.5)).into_string();
        assert_eq!(minus, r#"<data value="-1.5">−1.50</data>"#);
        assert_eq!(whole(20_000).into_string(), r#"<data value="20000">20,000</data>"#);
    }

    #[test]
    fn rounding_is_shown_as_nothing_but_not_in_what_is_conserved() {
        assert_eq!([1e-14, -1e-14, 0.000_012].map(digits), ["0", "0", "0.00001"]);
        let drifts = [3.2e-14, -1e-4, 0.002, 0.0, -12.0].map(drift);
        assert_eq!(drifts, ["+3e-14", "-1e-4", "+0.00200", "0", "-12.00"]);
    }

    #[test]
    fn times_keep_three_digits() {
        assert_eq!(
            [0.0123, 0.456, 7.891, 12.34].map(seconds),
            ["12.3 ms", "456 ms", "7.89 s", "12.3 s"]
        );
    }
}
