//! Numbers on an HTML page, with their exact values for programs.

use maud::{Markup, html};

use crate::text::numbers;

/// Shows a number as `text`, with its exact value as an attribute, as in the JSON output.
pub fn figure(exact: f64, text: &str) -> Markup {
    // A true minus sign is as wide as a plus.
    let minus = text.strip_prefix('-').map(|size| format!("−{size}"));
    html! { data value=(exact) { (minus.as_deref().unwrap_or(text)) } }
}

/// Shows a whole number on an HTML page.
pub fn whole(number: usize) -> Markup {
    html! { data value=(number) { (numbers::count(number)) } }
}

/// Shows a percentage without the percent sign on an HTML page.
pub fn percent(percent: f64) -> Markup {
    figure(percent, &digits(percent))
}

/// Percentage below which a value is only rounding error.
pub const ROUNDING_PERCENT: f64 = 5e-6;

/// Formats a percentage with three significant digits and at most five decimal places.
pub fn digits(percent: f64) -> String {
    match percent.abs() {
        size if size < ROUNDING_PERCENT => "0".into(),
        size if size < 0.01 => format!("{percent:.5}"),
        size if size < 0.1 => format!("{percent:.4}"),
        size if size < 1.0 => format!("{percent:.3}"),
        _ => format!("{percent:.2}"),
    }
}

/// Formats a signed change in percent. One near zero is shown by its power of ten, which tells
/// methods that conserve a quantity from those that do not.
pub fn drift(percent: f64) -> String {
    match percent.abs() {
        size if size < 0.001 => power_of_ten(percent),
        _ if percent < 0.0 => digits(percent),
        _ => format!("+{}", digits(percent)),
    }
}

/// Formats a signed quantity by its order of magnitude.
pub fn power_of_ten(number: f64) -> String {
    if number == 0.0 { "0".into() } else { format!("{number:+.0e}") }
}

/// Formats a time in milliseconds, or in seconds from one second on.
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
