//! Numbers as people write them, such as `1.5M`, and what to write in place of `10,000` or `1mm`.

/// Characters that separate thousands somewhere in the world.
const SEPARATORS: [char; 5] = [',', '.', '\'', '_', ' '];

/// Multipliers of whole numbers.
const SCALES: [(char, f64); 2] = [('k', 1e3), ('m', 1e6)];

/// Units of memory in bytes.
const MEMORY: [(&str, f64); 4] = [("K", 1e3), ("M", 1e6), ("G", 1e9), ("T", 1e12)];

/// Units of length in metres. Those that end like another come before it.
const UNITS: [(&str, f64); 9] = [
    ("um", 1e-6),
    ("µm", 1e-6),
    ("mm", 1e-3),
    ("cm", 1e-2),
    ("km", 1e3),
    ("inch", 0.0254),
    ("in", 0.0254),
    ("ft", 0.3048),
    ("m", 1.0),
];

/// Parses a finite number.
pub fn number(text: &str) -> Result<f64, String> {
    match finite(text) {
        Some(number) => Ok(number),
        None => Err(not_a_number(text)),
    }
}

/// Parses a whole number of at least 0: `10000`, `10k`, `1.5M` or `1e4`.
pub fn whole(text: &str) -> Result<usize, String> {
    let text = text.trim();
    if is_end_of_thousands(text) {
        return Err("commas separate values: write 10000, not 10,000".into());
    }
    let number = text.parse().ok().or_else(|| scaled(text));
    number.ok_or_else(|| match without_separators(text) {
        Some(plain) => format!("write it without separators: {plain}"),
        None => "it must be a whole number of at least 0, such as 5000 or 5k".into(),
    })
}

/// Parses a number of bytes with a unit, such as `500M` or `1.5GB`.
pub fn bytes(text: &str) -> Result<usize, String> {
    let upper = text.trim().to_ascii_uppercase();
    let number = upper.trim_end_matches("IB").trim_end_matches('B');
    let found = MEMORY.into_iter().find_map(|(unit, scale)| {
        let number = finite(number.strip_suffix(unit)?).filter(|number| *number > 0.0)?;
        Some((number * scale) as usize)
    });
    found.ok_or_else(|| "it must be a number of bytes with a unit, such as 500M or 2G".into())
}

/// Returns `10000` for `10,000`, `10.000` and the like.
pub fn without_separators(text: &str) -> Option<String> {
    let groups: Vec<&str> = text.split(SEPARATORS).collect();
    let is_group = |group: &&str| group.len() == 3 && is_digits(group);
    let (first, rest) = groups.split_first()?;
    let is_first = is_digits(first) && first.len() <= 3 && !first.starts_with('0');
    (is_first && !rest.is_empty() && rest.iter().all(is_group)).then(|| groups.concat())
}

/// Returns a length with a unit, such as `1mm`, in metres.
pub fn metres(text: &str) -> Option<f64> {
    let text = text.trim();
    let (number, metres) =
        UNITS.into_iter().find_map(|(unit, metres)| Some((text.strip_suffix(unit)?, metres)))?;
    let found = finite(number).filter(|number| *number >= 0.0)? * metres;
    found.is_finite().then_some(found)
}

fn finite(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

fn not_a_number(text: &str) -> String {
    if text.trim().is_empty() {
        return "a number is missing".into();
    }
    match finite(&text.replacen(',', ".", 1)) {
        Some(number) => format!("write it with a point: {number}"),
        None => format!("{text:?} is not a number"),
    }
}

/// Multiplies a number by what its last letter or its exponent says, if that makes it whole.
fn scaled(text: &str) -> Option<usize> {
    let scale = SCALES.into_iter().find_map(|(letter, scale)| {
        Some((text.strip_suffix([letter, letter.to_ascii_uppercase()])?, scale))
    });
    let (number, scale) = scale.or_else(|| text.contains(['e', 'E']).then_some((text, 1.0)))?;
    let number = finite(number)? * scale;
    let is_near = (number - number.round()).abs() < 1e-9 * number;
    let is_whole = number == 0.0 || (1.0..1e15).contains(&number) && is_near;
    is_whole.then(|| number.round() as usize)
}

/// Reports whether a value is what a comma leaves of `10,000` in a list.
pub fn is_end_of_thousands(text: &str) -> bool {
    text.len() == 3 && text.starts_with('0') && is_digits(text)
}

fn is_digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_may_be_short() {
        let cases =
            [("0", 0), ("5000", 5000), ("10k", 10_000), ("1.5M", 1_500_000), ("2e4", 20_000)];
        for (text, number) in cases {
            assert_eq!(whole(text), Ok(number), "{text}");
        }
        for bad in ["", "k", "1.5", "1.2345k", "-1k", "infk", "nank", "1e99", "10%", "1 k k"] {
            assert!(whole(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn separators_of_thousands_are_told() {
        for text in ["10,000", "10.000", "10_000", "10'000", "10 000"] {
            assert_eq!(whole(text).unwrap_err(), "write it without separators: 10000");
        }
        assert!(whole("000").unwrap_err().contains("commas separate values"));
        assert_eq!(without_separators("1,234,567").as_deref(), Some("1234567"));
        for text in ["0.250", "1000,000", "1,00", "1,", "", ",000"] {
            assert_eq!(without_separators(text), None, "{text}");
        }
    }

    #[test]
    fn a_decimal_comma_is_told() {
        assert_eq!(number("0,1").unwrap_err(), "write it with a point: 0.1");
        assert_eq!(number("1,2,3").unwrap_err(), "\"1,2,3\" is not a number");
    }

    #[test]
    fn lengths_have_units() {
        let cases = [("1mm", 1e-3), ("2.5 cm", 2.5 * 1e-2), ("3m", 3.0), ("1in", 0.0254)];
        for (text, length) in cases {
            assert_eq!(metres(text), Some(length), "{text}");
        }
        for bad in ["1", "mm", "-1mm", "1px", "1%", "xm"] {
            assert_eq!(metres(bad), None, "{bad}");
        }
    }
}
