//! Formatting of numbers for people.

pub use meshlod_io::grouped as count;

/// Formats a number of faces with its noun: 1 face, 2 faces.
pub fn faces(number: usize) -> String {
    format!("{} face{}", count(number), plural(number))
}

/// Returns the plural ending of a noun: nothing for 1, else `s`.
pub fn plural(number: usize) -> &'static str {
    if number == 1 { "" } else { "s" }
}

/// Formats a number with six significant digits: 0.00123457, 12.3457, 1.23457e12.
pub fn value(number: f64) -> String {
    digits(number, 6)
}

/// Formats a coordinate with six significant digits, and with as many more as it takes to tell four
/// of the extent of a mesh along its axis: 4649776.0094 where that is 0.0921.
pub fn coordinate(number: f64, extent: f64) -> String {
    let places = |x: f64| if x == 0.0 { 0 } else { x.abs().log10().floor() as i32 };
    let more = if extent > 0.0 { places(number) - places(extent) + 4 } else { 0 };
    digits(number, more.clamp(6, 17))
}

/// Formats a percentage with four significant digits: 0.01235%.
pub fn percent(number: f64) -> String {
    if number.is_finite() { format!("{}%", digits(number, 4)) } else { "-".into() }
}

/// Formats a relative change as a signed percentage; a dash if the original value was zero.
pub fn change(before: f64, after: f64) -> String {
    let change = 100.0 * (after - before) / before.abs();
    match change {
        _ if !change.is_finite() => "-".into(),
        _ if change < 0.0 => percent(change),
        _ => format!("+{}", percent(change)),
    }
}

fn digits(number: f64, digits: i32) -> String {
    if number == 0.0 || !number.is_finite() {
        return number.to_string();
    }
    let places = number.abs().log10().floor() as i32;
    if !(-5..12).contains(&places) {
        return format!("{number:.*e}", (digits - 1) as usize);
    }
    let text = format!("{number:.*}", (digits - 1 - places).max(0) as usize);
    if text.contains('.') {
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_have_commas() {
        assert_eq!([0, 999, 1_000, 871_414].map(count), ["0", "999", "1,000", "871,414"]);
    }

    #[test]
    fn values_keep_the_digits_that_matter() {
        let texts = [0.0, 1.0, -0.001_234_567_8, 12.345_678, 871_414.4, 1.5e-9, 2e15].map(value);
        assert_eq!(
            texts,
            ["0", "1", "-0.00123457", "12.3457", "871414", "1.50000e-9", "2.00000e15"]
        );
        assert_eq!(value(f64::NAN), "NaN");
    }

    #[test]
    fn coordinates_tell_their_extent() {
        let (from, to) = (4_649_776.0, 4_649_776.092_13);
        assert_eq!(coordinate(from, to - from), "4649776");
        assert_eq!(coordinate(to, to - from), "4649776.09213");
        assert_eq!(coordinate(12.345_678, 20.0), "12.3457");
        assert_eq!([coordinate(0.0, 1.0), coordinate(3.0, 0.0)], ["0", "3"]);
    }

    #[test]
    fn changes_have_a_sign() {
        assert_eq!((change(2.0, 3.0), change(2.0, 1.0)), ("+50%".into(), "-50%".into()));
        assert_eq!((change(-2.0, -1.0), change(0.0, 1.0)), ("+50%".into(), "-".into()));
    }
}
